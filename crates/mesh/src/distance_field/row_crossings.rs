//! Exact winding numbers of all nodes of a grid, counted from crossings of its rows with a closed
//! surface.

use std::ops::Range;
use std::sync::atomic::{AtomicI32, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Grid;
use crate::bvh::{Node, UnitFrame};

/// Crossings of triangles with the rows of a grid, the lines through its nodes along x.
///
/// All decisions are exact for coordinates in the unit frame. A row that meets an edge or a vertex
/// is treated as shifted by an infinitesimal step along y, and by an infinitely smaller one along
/// z. So a row enters and leaves a closed surface equally often. The sum of the crossings before a
/// node, +1 inward and −1 outward, is its winding number. On the surface it is the number of either
/// side.
#[derive(Debug)]
pub(super) struct RowCrossings {
    /// Coordinates of the nodes along each axis, in the unit frame.
    nodes: [Vec<f64>; 3],
    nodes_per_length: f64,
    /// Change of the winding number from the previous node of the row to each node.
    changes: Vec<AtomicI32>,
}

impl RowCrossings {
    pub(super) fn new(grid: &Grid, frame: &UnitFrame) -> Self {
        let nodes = [0, 1, 2].map(|axis| {
            let node = |i: usize| {
                let mut steps = [0; 3];
                steps[axis] = i;
                frame.to_unit(grid.node(steps[0], steps[1], steps[2]))[axis]
            };
            (0..grid.dims[axis]).map(node).collect()
        });
        let mut changes = Vec::with_capacity(grid.len());
        changes.resize_with(grid.len(), AtomicI32::default);
        Self { nodes, nodes_per_length: 1.0 / (grid.cell * frame.scale()), changes }
    }

    /// Whether a triangle in the box of this node can meet a row.
    pub(super) fn may_meet(&self, node: &Node) -> bool {
        let is_between = |axis: usize| {
            let [min, max] = [node.min[axis], node.max[axis]].map(f64::from);
            self.range_between(axis, min, max).is_empty()
        };
        !is_between(2) && !is_between(1)
    }

    /// Counts the crossings of one triangle. `vertices` identify corners in common with other
    /// triangles.
    pub(super) fn add(&self, corners: &[DVec3; 3], vertices: &[u32; 3]) {
        let range = |axis: usize| {
            let [a, b, c] = corners.map(|corner| corner[axis]);
            self.range_between(axis, a.min(b).min(c), a.max(b).max(c))
        };
        // Most triangles of a fine mesh do not meet a row.
        let z = range(2);
        let y = if z.is_empty() { 0..0 } else { range(1) };
        if y.is_empty() {
            return;
        }
        let x = range(0);
        for k in z {
            for j in y.clone() {
                // The row crosses the triangle if it passes all three sides on the same side.
                let sides = [0, 1, 2].map(|side| {
                    let next = (side + 1) % 3;
                    let (from, to) = (corners[side], corners[next]);
                    // Evaluate an edge in the same direction for both of its triangles, so that the
                    // results agree.
                    if vertices[side] < vertices[next] { self.side(from, to, j, k) } else { -self.side(to, from, j, k) }
                });
                let orientation = sides[0];
                if orientation == 0 || sides != [orientation; 3] {
                    continue;
                }
                let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
                let [a, b, c] = corners.map(point);
                let is_past = |&x: &f64| {
                    let node = point(DVec3::new(x, self.nodes[1][j], self.nodes[2][k]));
                    // Negative above the triangle.
                    f64::from(orientation) * orient3d(a, b, c, node) < 0.0
                };
                // First node of the row behind the triangle; nodes are sorted, so bisect.
                let past = x.start + self.nodes[0][x.clone()].partition_point(|node| !is_past(node));
                if let Some(change) = self.changes[(k * self.nodes[1].len() + j) * self.nodes[0].len()..]
                    .get(past)
                    .filter(|_| past < self.nodes[0].len())
                {
                    // Rows run along +x, so a triangle that faces +x is crossed from inside.
                    change.fetch_sub(orientation, Ordering::Relaxed);
                }
            }
        }
    }

    /// Side of the line through two points on which a row runs, seen along −x: 1 for left, −1 for
    /// right, 0 if the points coincide.
    fn side(&self, from: DVec3, to: DVec3, j: usize, k: usize) -> i32 {
        let point = |y: f64, z: f64| Coord { x: y, y: z };
        let side = orient2d(point(from.y, from.z), point(to.y, to.z), point(self.nodes[1][j], self.nodes[2][k]));
        // If the row is on the line, the infinitesimal shift decides: first along y, then along z.
        let decisive = [side, from.z - to.z, to.y - from.y].into_iter().find(|&value| value != 0.0);
        decisive.map_or(0, |value| if value > 0.0 { 1 } else { -1 })
    }

    /// Returns the winding numbers in [z, y, x] order.
    pub(super) fn into_winding_numbers(self) -> Vec<i32> {
        let mut numbers: Vec<i32> = self.changes.into_iter().map(AtomicI32::into_inner).collect();
        numbers.par_chunks_mut(self.nodes[0].len()).for_each(|row| {
            let mut number = 0;
            for change in row {
                number += *change;
                *change = number;
            }
        });
        numbers
    }

    /// Indices of the nodes along an axis whose coordinates are in this closed interval. If there
    /// are none, an empty range at the first node behind it.
    fn range_between(&self, axis: usize, min: f64, max: f64) -> Range<usize> {
        let nodes = &self.nodes[axis];
        // Nodes are evenly spaced except for rounding, so start from an estimate and correct it.
        let near = |coordinate: f64| (((coordinate - nodes[0]) * self.nodes_per_length) as usize).min(nodes.len());
        let mut range = near(min).saturating_sub(1)..(near(max) + 2).min(nodes.len());
        while range.start < range.end && nodes[range.start] < min {
            range.start += 1;
        }
        while range.start < range.end && nodes[range.end - 1] > max {
            range.end -= 1;
        }
        range
    }
}
