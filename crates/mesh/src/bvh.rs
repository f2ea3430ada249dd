//! A bounding volume hierarchy over triangles, and the closest point on them.

mod build;
mod closest_point;
mod unit_frame;

#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

use crate::Aabb;
use build::Groups;
pub use closest_point::{ClosestPoint, Feature};
pub(crate) use closest_point::{OnTriangle, SquaredDistance, closest_on_triangle};
pub(crate) use unit_frame::UnitFrame;

/// Triangles in a leaf at most: one test of the box for all of them. Larger: more triangles are tried. Smaller: more boxes are, and
/// have to be made.
pub(crate) const LEAF_TRIANGLES: u32 = 6;

/// Relative slack of pruning. Boxes are rounded outward, so the box distance in exact arithmetic is never too large; computed in
/// `f64` from coordinates of size at most a few, it is off by less than ten rounding errors, as is the best squared distance it
/// is compared with. Larger: needless visits. Smaller than 20 · 2⁻⁵³ = 2.3e-15: a nearest triangle could be missed.
const PRUNING_SLACK: f64 = 1.0 + 1e-14;

/// Triangles that one task looks at.
const TRIANGLES_AT_ONCE: usize = 1 << 14;

/// How many triangles at once are taken for one when the hierarchy is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clustering {
    /// Every triangle on its own: for many searches, which then look at less.
    Fine = 1,
    /// As many as a leaf may hold: for few searches, since clustering takes a fraction of the time.
    Coarse = LEAF_TRIANGLES as isize,
}

/// A node: an inner one has its children at `first` and `first + 1`, a leaf has its triangles from `first` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Smallest coordinates in the unit frame, rounded down.
    pub(crate) min: [f32; 3],
    /// Largest coordinates in the unit frame, rounded up.
    pub(crate) max: [f32; 3],
    pub(crate) first: u32,
    /// Triangles below it; at most [`LEAF_TRIANGLES`] in a leaf, and more in inner nodes.
    pub(crate) count: u32,
}

/// Why triangles cannot be searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BvhError {
    /// There is nothing to search.
    #[error("the mesh has no triangles")]
    Empty,
    /// A vertex index points behind the last position.
    #[error("triangle {triangle} uses vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Index of the offending triangle.
        triangle: usize,
        /// The vertex index it holds.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate in use is infinite or not a number.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// Index of the offending vertex.
        vertex: u32,
    },
}

/// A bounding volume hierarchy over the triangles of a mesh, built once and searched from any number of threads.
#[derive(Debug, Clone)]
pub struct Bvh {
    bounds: Aabb,
    frame: UnitFrame,
    nodes: Vec<Node>,
    /// Longest way from the root to a leaf, in nodes.
    depth: usize,
    /// Triangle numbers of the mesh, in leaf order.
    order: Vec<u32>,
    /// Vertex indices, in leaf order.
    triangles: Vec<[u32; 3]>,
    /// Vertices in the unit frame.
    positions: Vec<DVec3>,
}

impl Bvh {
    /// Builds the hierarchy. Zero-area triangles count as the segments or points that they are.
    ///
    /// # Errors
    /// See [`BvhError`].
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, BvhError> {
        let bounds = checked_bounds(positions, triangles)?;
        Ok(Self::within(bounds, positions, triangles, Clustering::Fine, || ()).0)
    }

    /// Builds the hierarchy of triangles that have these [`checked_bounds`]. What is to be done `meanwhile` has a thread to itself
    /// while another one clusters, which cannot be shared.
    pub(crate) fn within<T: Send>(
        bounds: Aabb,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        clustering: Clustering,
        meanwhile: impl FnOnce() -> T + Send,
    ) -> (Self, T) {
        let frame = UnitFrame::around(bounds);
        let positions: Vec<DVec3> = positions.par_iter().map(|&position| frame.inward(position)).collect();
        let mut groups = Groups::new(&positions, triangles, clustering as u32);
        let ((nodes, in_order), done) = rayon::join(|| groups.clustered(), meanwhile);
        let (depth, order) = rayon::join(|| depth(&nodes), || groups.order(&in_order));
        let triangles = order.par_iter().map(|&triangle| triangles[triangle as usize]).collect();
        (Self { bounds, frame, depth, nodes, order, triangles, positions }, done)
    }

    /// The point of the triangles nearest to `point`, and the feature it lies on. Of equally near ones, any, but always the same.
    pub fn closest_point(&self, point: DVec3) -> ClosestPoint {
        let local = self.frame.inward(point);
        let nearest = self.nearest(local, None);
        let corners = &self.corners(nearest.slot);
        let (on_triangle, _) = closest_on_triangle(local, corners);
        ClosestPoint {
            point: self.frame.outward(on_triangle.point),
            distance: nearest.squared.sqrt() / self.frame.scale(),
            triangle: self.order[nearest.slot as usize],
            feature: on_triangle.feature,
        }
    }

    /// The nearest triangle to a point of the unit frame. A good `guess` (a slot in leaf order) saves time and changes nothing
    /// but which one of equally near triangles is found.
    pub(crate) fn nearest(&self, point: DVec3, guess: Option<u32>) -> SquaredDistance {
        let mut best = SquaredDistance { slot: 0, squared: f64::INFINITY };
        if let Some(slot) = guess {
            best = SquaredDistance { slot, squared: closest_on_triangle(point, &self.corners(slot)).1 };
        }
        let mut stack = Vec::with_capacity(self.depth + 1);
        stack.push((0, self.nodes[0].squared_distance(point)));
        while let Some((index, squared)) = stack.pop() {
            if squared > best.squared * PRUNING_SLACK {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.is_leaf() {
                for slot in node.first..node.first + node.count {
                    let (_, squared) = closest_on_triangle(point, &self.corners(slot));
                    if squared < best.squared {
                        best = SquaredDistance { slot, squared };
                    }
                }
            } else {
                let [left, right] = [node.first, node.first + 1]
                    .map(|child| (child, self.nodes[child as usize].squared_distance(point)));
                let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
                stack.push(far);
                stack.push(near);
            }
        }
        best
    }

    /// The box around all triangles, model units.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The frame in which nodes and corners are stored.
    pub(crate) fn frame(&self) -> &UnitFrame {
        &self.frame
    }

    /// Nodes in preorder: the root first, then always the two children of a node beside each other, then all that is below the first of
    /// them, then all below the second. Leaves have their triangles in the same order.
    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Entries that a stack of nodes needs at most in a traversal that pushes both children.
    pub(crate) fn stack_capacity(&self) -> usize {
        self.depth + 1
    }

    /// Number of each triangle in the mesh, in leaf order.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Vertex indices of the triangles, in leaf order.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Corners of a triangle in the unit frame, by its place in leaf order.
    #[inline(always)]
    pub(crate) fn corners(&self, slot: u32) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[slot as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }
}

impl Node {
    #[inline(always)]
    pub(crate) fn is_leaf(&self) -> bool {
        self.count <= LEAF_TRIANGLES
    }

    /// Squared distance from a point of the unit frame to the box, zero inside.
    pub(crate) fn squared_distance(&self, point: DVec3) -> f64 {
        let min = DVec3::from_array(self.min.map(f64::from));
        let max = DVec3::from_array(self.max.map(f64::from));
        (min - point).max(point - max).max(DVec3::ZERO).length_squared()
    }
}

/// The box around all triangles, of which none may name a vertex that is not there or not finite.
///
/// # Errors
/// See [`BvhError`].
pub(crate) fn checked_bounds(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Aabb, BvhError> {
    if triangles.is_empty() {
        return Err(BvhError::Empty);
    }
    let bounds_of = |(number, chunk): (usize, &[[u32; 3]])| {
        let (mut bounds, mut offence) = (Aabb::EMPTY, DVec3::ZERO);
        for (i, triangle) in chunk.iter().enumerate() {
            for &vertex in triangle {
                let Some(&position) = positions.get(vertex as usize) else {
                    // An earlier triangle may have a vertex that is not finite.
                    return first_error(positions, &chunk[..=i], number * TRIANGLES_AT_ONCE);
                };
                bounds = bounds.including(position);
                // What is finite times zero is zero.
                offence += position * 0.0;
            }
        }
        if offence == DVec3::ZERO { Ok(bounds) } else { first_error(positions, chunk, number * TRIANGLES_AT_ONCE) }
    };
    let parts: Vec<_> = triangles.par_chunks(TRIANGLES_AT_ONCE).enumerate().map(bounds_of).collect();
    // In order, so that the first error is the one that counts.
    parts.into_iter().try_fold(Aabb::EMPTY, |bounds, part| Ok(bounds.union(part?)))
}

/// The first error among triangles, which are numbered from `first` on; no bounds if there is none.
fn first_error(positions: &[DVec3], triangles: &[[u32; 3]], first: usize) -> Result<Aabb, BvhError> {
    for (i, triangle) in triangles.iter().enumerate() {
        for &vertex in triangle {
            match positions.get(vertex as usize) {
                None => {
                    let triangle = first + i;
                    return Err(BvhError::IndexOutOfRange { triangle, vertex, vertices: positions.len() });
                }
                Some(position) if !position.is_finite() => return Err(BvhError::NotFinite { vertex }),
                Some(_) => {}
            }
        }
    }
    Ok(Aabb::EMPTY)
}

fn depth(nodes: &[Node]) -> usize {
    let mut depths = vec![1; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        if !node.is_leaf() {
            depths[node.first as usize] = depths[i] + 1;
            depths[node.first as usize + 1] = depths[i] + 1;
        }
    }
    depths.into_iter().max().unwrap_or(0)
}
