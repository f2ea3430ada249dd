//! Boxes aligned to the surface that they enclose. They prune far more than axis-aligned boxes.
//!
//! From afar, a piece of a surface is a thin plate. The thickness of an axis-aligned box around it
//! is the width of the piece times the sine of its tilt, so many pieces appear nearer than the
//! nearest point. The thickness of an aligned box depends only on how much the piece bends.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::lanes::{LANES, Lanes, cross, direction, perpendicular};
use super::packet::Packet;
use crate::bvh::{LEAF_TRIANGLES, Node};
use crate::extremes::max;

/// An oriented box in `f32`, prepared for distances to a packet of points.
#[derive(Debug, Clone, Copy, bytemuck::Zeroable)]
#[repr(align(64))]
pub(super) struct PackedBox {
    axes: [[f32; 3]; 3],
    /// Coordinates of the center along the axes.
    middle: [f32; 3],
    half: [f32; 3],
    /// Eight times the index of the first child or triangle, plus the number of triangles (zero for
    /// an inner node).
    contents: u32,
}

const _: () = assert!(
    LEAF_TRIANGLES < 8 && size_of::<PackedBox>() == 64,
    "the count has three bits, and a box fills a cache line"
);

impl PackedBox {
    /// The first of the two children; `None` for a leaf.
    #[inline(always)]
    pub(super) fn children(&self) -> Option<usize> {
        self.contents.is_multiple_of(8).then_some(self.contents as usize / 8)
    }

    /// The triangles of a leaf.
    #[inline(always)]
    pub(super) fn triangles(&self) -> Range<u32> {
        self.contents / 8..self.contents / 8 + self.contents % 8
    }

    /// Squared distances from the points to the box.
    #[inline(always)]
    pub(super) fn squared_distances(&self, packet: &Packet) -> Lanes {
        let mut squared = [0.0; LANES];
        for i in 0..LANES {
            let beyond = |axis: usize| {
                let [a, b, c] = self.axes[axis];
                let along = packet.x[i] * a + packet.y[i] * b + packet.z[i] * c;
                max((along - self.middle[axis]).abs() - self.half[axis], 0.0)
            };
            let [u, v, w] = [beyond(0), beyond(1), beyond(2)];
            squared[i] = u * u + v * v + w * w;
        }
        squared
    }
}

/// An oriented bounding box in double precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct OrientedBox {
    pub(super) axes: DMat3,
    /// Smallest and largest coordinates along the axes.
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl OrientedBox {
    /// Creates an empty box. Its first axis is across a piece of the surface, its second along it.
    pub(super) fn across_and_along(normal: DVec3, tangent: DVec3) -> Self {
        let (across, _) = direction(normal.to_array(), [1.0, 0.0, 0.0]);
        let along = perpendicular(across, tangent.to_array());
        let axes = DMat3::from_cols_array_2d(&[across, along, cross(across, along)]);
        Self { axes, min: DVec3::INFINITY, max: DVec3::NEG_INFINITY }
    }

    /// Grows the box to enclose other boxes.
    pub(super) fn enclosing(self, others: &[Self]) -> Self {
        let to_axes = self.axes.transpose();
        others.iter().fold(self, |obb, other| {
            let turn = to_axes * other.axes;
            let middle = turn * (0.5 * (other.min + other.max));
            let spread = DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs());
            let half = spread * (0.5 * (other.max - other.min));
            Self { min: obb.min.min(middle - half), max: obb.max.max(middle + half), ..obb }
        })
    }

    /// Converts the box to `f32` for `node`, with a margin of `rounding`.
    pub(super) fn packed(&self, rounding: f64, node: &Node) -> PackedBox {
        let f = |v: DVec3| [v.x as f32, v.y as f32, v.z as f32];
        PackedBox {
            axes: [f(self.axes.x_axis), f(self.axes.y_axis), f(self.axes.z_axis)],
            middle: f(0.5 * (self.min + self.max)),
            half: f(0.5 * (self.max - self.min) + rounding),
            contents: if node.is_leaf() { 8 * node.first + node.count } else { 8 * node.first },
        }
    }
}

/// Bound on how far rounding to `f32` moves a coordinate along an axis, relative to the largest
/// coordinate plus one. It covers the rounding of the point and the axis, of three products and two
/// sums, of the center and of the difference from it. Larger: needless visits. Smaller than 14 ·
/// 2⁻²⁴: the search could miss a nearest triangle by more than the error bound allows.
pub(super) const COORDINATE_ROUNDING: f64 = 1e-6;
