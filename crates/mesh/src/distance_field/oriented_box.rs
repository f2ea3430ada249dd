//! Boxes along the surface that they hold, which prune far more than boxes along the axes.
//!
//! From afar a surface is a thin shell. A box along the axes around a piece of it is as thick as the piece is wide times the sine
//! of its tilt, and so many pieces look nearer than the nearest point; a box along the piece is only as thick as the piece is bent.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::packet::{LANES, Lanes, Packet};
use super::vector::{cross, direction, perpendicular};
use crate::bvh::{LEAF_TRIANGLES, Node};
use crate::extremes::greater;

/// A box in any orientation, ready for distances to a packet of points.
#[derive(Debug, Clone, Copy, bytemuck::Zeroable)]
#[repr(align(64))]
pub(super) struct OrientedBox {
    axes: [[f32; 3]; 3],
    /// Coordinates of the center along the axes.
    middle: [f32; 3],
    half: [f32; 3],
    /// What it holds: eight times the number of its first child or triangle, plus the number of triangles, zero for an inner node.
    held: u32,
}

const _: () = assert!(LEAF_TRIANGLES < 8 && size_of::<OrientedBox>() == 64, "three bits, and a line of the cache");

impl OrientedBox {
    /// The first of both children, if it has any.
    #[inline(always)]
    pub(super) fn children(&self) -> Option<usize> {
        self.held.is_multiple_of(8).then_some(self.held as usize / 8)
    }

    /// The triangles of a leaf.
    #[inline(always)]
    pub(super) fn triangles(&self) -> Range<u32> {
        self.held / 8..self.held / 8 + self.held % 8
    }

    /// Squared distances to the points.
    #[inline(always)]
    pub(super) fn squared_distances(&self, packet: &Packet) -> Lanes {
        let mut squared = [0.0; LANES];
        for i in 0..LANES {
            let beyond = |axis: usize| {
                let [a, b, c] = self.axes[axis];
                let along = packet.x[i] * a + packet.y[i] * b + packet.z[i] * c;
                greater((along - self.middle[axis]).abs() - self.half[axis], 0.0)
            };
            let [u, v, w] = [beyond(0), beyond(1), beyond(2)];
            squared[i] = u * u + v * v + w * w;
        }
        squared
    }
}

/// A box in any orientation, in full precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shell {
    pub(super) axes: DMat3,
    /// Least and greatest coordinates along the axes.
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Shell {
    /// Holds nothing yet; the first of its axes is across a piece of the surface, the second along it.
    pub(super) fn across_and_along(normal: DVec3, tangent: DVec3) -> Self {
        let (across, _) = direction(normal.to_array(), [1.0, 0.0, 0.0]);
        let along = perpendicular(across, tangent.to_array());
        let axes = DMat3::from_cols_array_2d(&[across, along, cross(across, along)]);
        Self { axes, min: DVec3::INFINITY, max: DVec3::NEG_INFINITY }
    }

    /// Grown around other boxes.
    pub(super) fn holding(self, others: &[Self]) -> Self {
        let to_axes = self.axes.transpose();
        others.iter().fold(self, |shell, other| {
            let turn = to_axes * other.axes;
            let middle = turn * (0.5 * (other.min + other.max));
            let spread = DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs());
            let half = spread * (0.5 * (other.max - other.min));
            Self { min: shell.min.min(middle - half), max: shell.max.max(middle + half), ..shell }
        })
    }

    /// A box around it, grown by `rounding`, for this node.
    pub(super) fn rounded(&self, rounding: f64, node: &Node) -> OrientedBox {
        let f = |v: DVec3| [v.x as f32, v.y as f32, v.z as f32];
        OrientedBox {
            axes: [f(self.axes.x_axis), f(self.axes.y_axis), f(self.axes.z_axis)],
            middle: f(0.5 * (self.min + self.max)),
            half: f(0.5 * (self.max - self.min) + rounding),
            held: if node.is_leaf() { 8 * node.first + node.count } else { 8 * node.first },
        }
    }
}

/// Bound on how far rounding to `f32` moves a coordinate along an axis, over the largest coordinate plus one: of the point and the
/// axis, of three products and two sums, of the middle and the difference to it. Larger: needless visits. Smaller than
/// 14 · 2⁻²⁴: a nearest triangle could be missed by more than the error bound says.
pub(super) const COORDINATE_ROUNDING: f64 = 1e-6;
