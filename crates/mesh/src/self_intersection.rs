//! Triangles of a mesh that cross each other, found exactly.

mod exact_triangle;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::bvh::Node;
use crate::{Bvh, BvhError, Cancelled, Monitor, TriMesh};
use exact_triangle::ExactTriangle;

/// Leaves of the hierarchy between two looks at the monitor.
const LEAVES_PER_CHUNK: usize = 256;

/// Why self-intersections could not be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SelfIntersectionError {
    /// The mesh cannot be searched.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Pairs of triangles of one mesh that have points in common beyond the vertices and edges that they share.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SelfIntersections {
    pairs: Vec<[u32; 2]>,
    triangles: Vec<u32>,
}

impl SelfIntersections {
    /// Finds all pairs. The answer is exact: predicates are evaluated as if without rounding.
    ///
    /// Corners at equal positions count as one vertex, whatever their indices. Of two triangles
    ///
    /// - without a common vertex, any contact counts, be it in a point;
    /// - with a common vertex, any contact elsewhere;
    /// - with a common edge, only that both lie in one plane on the same side of the edge;
    /// - with all vertices in common, they always count.
    ///
    /// Triangles without area have no inside to be crossed and are left out.
    ///
    /// # Errors
    /// See [`SelfIntersectionError`].
    pub fn of(mesh: &TriMesh, monitor: &dyn Monitor) -> Result<Self, SelfIntersectionError> {
        let bvh = Bvh::new(&mesh.positions, &mesh.triangles)?;
        Ok(Self::among(&bvh, &mesh.positions, monitor)?)
    }

    /// Finds all pairs among the triangles of a hierarchy over these positions.
    pub(crate) fn among(bvh: &Bvh, positions: &[DVec3], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let triangles = ExactTriangle::all(positions, bvh.triangles());
        let leaves: Vec<&Node> = bvh.nodes().iter().filter(|node| node.count > 0).collect();
        let chunks = leaves.len().div_ceil(LEAVES_PER_CHUNK);
        let done = AtomicUsize::new(0);
        let found: Vec<Vec<[u32; 2]>> = (leaves.par_chunks(LEAVES_PER_CHUNK))
            .map(|leaves| {
                let mut pairs = Vec::new();
                let mut stack = Vec::with_capacity(bvh.stack_capacity());
                for leaf in leaves {
                    pairs_of_leaf(bvh, &triangles, leaf, &mut stack, &mut pairs);
                }
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                monitor.check("self-intersections", done as f64 / chunks as f64)?;
                Ok(pairs)
            })
            .collect::<Result<_, Cancelled>>()?;

        let mut pairs: Vec<[u32; 2]> = (found.into_iter().flatten())
            .map(|slots| {
                let [a, b] = slots.map(|slot| bvh.order()[slot as usize]);
                [a.min(b), a.max(b)]
            })
            .collect();
        pairs.sort_unstable();
        let mut triangles: Vec<u32> = pairs.iter().flatten().copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        Ok(Self { pairs, triangles })
    }

    /// Whether no triangle crosses another.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Pairs of triangle indices, the smaller first, in ascending order.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Indices of the triangles that cross at least one other, in ascending order.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Sum of the areas of these triangles, square model units.
    ///
    /// # Panics
    /// If `mesh` has fewer triangles than the one that was searched.
    pub fn area(&self, mesh: &TriMesh) -> f64 {
        (self.triangles.iter())
            .map(|&triangle| {
                let [a, b, c] = mesh.corners(triangle as usize);
                0.5 * (b - a).cross(c - a).length()
            })
            .fold(0.0, |sum, area| sum + area)
    }
}

/// Adds the crossing pairs of slots whose first triangle is in `leaf` and whose second one comes later.
fn pairs_of_leaf(bvh: &Bvh, triangles: &[ExactTriangle], leaf: &Node, stack: &mut Vec<u32>, pairs: &mut Vec<[u32; 2]>) {
    let nodes = bvh.nodes();
    stack.clear();
    stack.push(0);
    while let Some(index) = stack.pop() {
        let node = &nodes[index as usize];
        if !overlap(node, leaf) {
            continue;
        }
        if node.count == 0 {
            stack.push(node.first + 1);
            stack.push(node.first);
            continue;
        }
        for a in leaf.first..leaf.first + leaf.count {
            for b in node.first.max(a + 1)..node.first + node.count {
                if triangles[a as usize].intersects(&triangles[b as usize]) {
                    pairs.push([a, b]);
                }
            }
        }
    }
}

fn overlap(a: &Node, b: &Node) -> bool {
    (0..3).all(|axis| (a.min[axis] <= b.max[axis]) & (b.min[axis] <= a.max[axis]))
}
