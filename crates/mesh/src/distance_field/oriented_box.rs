//! Boxes along the surface that they hold, which prune far more than boxes along the axes.
//!
//! From afar a surface is a thin shell. A box along the axes around a piece of it is as thick as the piece is wide times the sine
//! of its tilt, and so many pieces look nearer than the nearest point; a box along the piece is only as thick as the piece is bent.

use std::ops::Range;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::packet::{LANES, Lanes, Packet};
use crate::Bvh;
use crate::bvh::{LEAF_TRIANGLES, Node};
use crate::extremes::greater;

/// A box in any orientation, ready for distances to a packet of points.
#[derive(Debug, Clone, Copy)]
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

    /// One for each node of the hierarchy, for points whose coordinates are not larger than `largest`.
    pub(super) fn of_nodes(bvh: &Bvh, largest: f64) -> Vec<Self> {
        let of_leaf = |node: &Node| match node.count {
            0 => Piece::default(),
            count => Piece::of_triangles(bvh, node.first..node.first + count),
        };
        let mut pieces: Vec<Piece> = bvh.nodes().par_iter().map(of_leaf).collect();
        // Children come after their parents.
        for (i, node) in bvh.nodes().iter().enumerate().rev().filter(|(_, node)| node.count == 0) {
            pieces[i] = Piece::join(&pieces[node.first as usize], &pieces[node.first as usize + 1]);
        }
        // Boxes of large pieces hold the boxes of the grains in them, which is nearly as tight and far faster.
        let mut grains: Vec<&Piece> = (bvh.nodes().iter().zip(&pieces))
            .filter(|(node, piece)| node.count == 0 && piece.slots.len() > GRAIN)
            .flat_map(|(node, _)| &pieces[node.first as usize..][..2])
            .filter(|child| child.slots.len() <= GRAIN)
            .collect();
        grains.sort_unstable_by_key(|grain| grain.slots.start);
        let shells: Vec<Shell> = grains.par_iter().map(|grain| Shell::along(grain).around(grain, bvh)).collect();
        let first_from = |slot: u32| grains.partition_point(|grain| grain.slots.start < slot);

        let rounding = COORDINATE_ROUNDING * (largest + 1.0);
        (pieces.par_iter().zip(bvh.nodes()))
            .map(|(piece, node)| {
                let shell = Shell::along(piece);
                let shell = if piece.slots.len() <= GRAIN {
                    shell.around(piece, bvh)
                } else {
                    shell.holding(&shells[first_from(piece.slots.start)..first_from(piece.slots.end)])
                };
                shell.rounded(rounding, 8 * node.first + node.count)
            })
            .collect()
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
struct Shell {
    axes: DMat3,
    /// Least and greatest coordinates along the axes.
    min: DVec3,
    max: DVec3,
}

impl Shell {
    /// Holds nothing yet; its axes lie across and along the piece.
    fn along(piece: &Piece) -> Self {
        let normal = piece.normal.try_normalize().unwrap_or(DVec3::X);
        let tangent = piece.tangent - normal * normal.dot(piece.tangent);
        let tangent = tangent.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        let axes = DMat3::from_cols(normal, tangent, normal.cross(tangent));
        Self { axes, min: DVec3::INFINITY, max: DVec3::NEG_INFINITY }
    }

    /// Grown around all corners of the piece.
    fn around(self, piece: &Piece, bvh: &Bvh) -> Self {
        let turn = self.axes.transpose();
        let corners = bvh.corners()[piece.slots.start as usize..piece.slots.end as usize].as_flattened();
        corners.iter().fold(self, |shell, &corner| {
            let turned = turn * corner;
            Self { min: shell.min.min(turned), max: shell.max.max(turned), ..shell }
        })
    }

    /// Grown around other boxes.
    fn holding(self, others: &[Self]) -> Self {
        let to_axes = self.axes.transpose();
        others.iter().fold(self, |shell, other| {
            let turn = to_axes * other.axes;
            let middle = turn * (0.5 * (other.min + other.max));
            let spread = DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs());
            let half = spread * (0.5 * (other.max - other.min));
            Self { min: shell.min.min(middle - half), max: shell.max.max(middle + half), ..shell }
        })
    }

    fn rounded(&self, rounding: f64, held: u32) -> OrientedBox {
        let f = |v: DVec3| v.to_array().map(|x| x as f32);
        OrientedBox {
            axes: [f(self.axes.x_axis), f(self.axes.y_axis), f(self.axes.z_axis)],
            middle: f(0.5 * (self.min + self.max)),
            half: f(0.5 * (self.max - self.min) + rounding),
            held,
        }
    }
}

/// Triangles in a grain at most. Larger: slower to prepare. Smaller: looser boxes of large pieces.
const GRAIN: usize = 64;

/// How a part of the hierarchy lies.
#[derive(Debug, Clone, Default)]
struct Piece {
    /// The triangles below, which are neighbors in leaf order.
    slots: Range<u32>,
    /// Mean of the corners.
    center: DVec3,
    /// Sum of the area vectors of all triangles, turned to the same side: across the piece.
    normal: DVec3,
    /// A direction in which the piece is long.
    tangent: DVec3,
}

impl Piece {
    fn of_triangles(bvh: &Bvh, slots: Range<u32>) -> Self {
        let mut piece = Self { slots: slots.clone(), ..Self::default() };
        for &[a, b, c] in &bvh.corners()[slots.start as usize..slots.end as usize] {
            piece.center += (a + b + c) / (3.0 * slots.len() as f64);
            piece.normal += turned_along(piece.normal, (b - a).cross(c - a));
            for edge in [b - a, c - b, a - c] {
                if edge.length_squared() > piece.tangent.length_squared() {
                    piece.tangent = edge;
                }
            }
        }
        piece
    }

    fn join(one: &Self, other: &Self) -> Self {
        let slots = one.slots.start.min(other.slots.start)..one.slots.end.max(other.slots.end);
        debug_assert_eq!(slots.len(), one.slots.len() + other.slots.len(), "parts of the hierarchy are contiguous");
        let share = one.slots.len() as f64 / slots.len() as f64;
        Self {
            slots,
            center: one.center * share + other.center * (1.0 - share),
            normal: one.normal + turned_along(one.normal, other.normal),
            tangent: other.center - one.center,
        }
    }
}

/// `vector`, or its opposite if that is the one to the same side as `side`.
fn turned_along(side: DVec3, vector: DVec3) -> DVec3 {
    if side.dot(vector) < 0.0 { -vector } else { vector }
}

/// Bound on how far rounding to `f32` moves a coordinate along an axis, over the largest coordinate plus one: of the point and the
/// axis, of three products and two sums, of the middle and the difference to it. Larger: needless visits. Smaller than
/// 14 · 2⁻²⁴: a nearest triangle could be missed by more than the error bound says.
const COORDINATE_ROUNDING: f64 = 1e-6;
