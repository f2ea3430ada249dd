//! Bounding volume hierarchy over triangles, and closest-point queries.

mod build;
mod closest_point;
mod unit_frame;

#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

use crate::Aabb;
use build::Groups;
pub use closest_point::{ClosestPoint, Feature, nearest_on_triangle};
pub(crate) use closest_point::{OnTriangle, SquaredDistance, closest_on_triangle};
pub(crate) use unit_frame::UnitFrame;

/// Maximum number of triangles in a leaf, which are tested together. Larger: more triangles are
/// tested. Smaller: more boxes are built and tested.
pub(crate) const LEAF_TRIANGLES: u32 = 6;

/// Relative slack of pruning. Boxes are rounded outward, so in exact arithmetic the distance to a
/// box is never too large. Computed in `f64` from coordinates of about unit size, it is off by less
/// than ten rounding errors, and so is the best squared distance that it is compared with. Larger:
/// needless visits. Smaller than 20 · 2⁻⁵³ = 2.3e-15: a nearest triangle could be missed.
const PRUNING_SLACK: f64 = 1.0 + 1e-14;

/// Triangles per parallel task when checking the input.
const TRIANGLES_AT_ONCE: usize = 1 << 14;

/// Granularity of the clustering that builds the hierarchy: triangles per group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clustering {
    /// Each triangle is a group. Best for many searches, which visit fewer nodes.
    Fine = 1,
    /// Groups as large as a leaf. Best for few searches, because clustering is several times
    /// faster.
    Coarse = LEAF_TRIANGLES as isize,
}

/// A node of the hierarchy. An inner node has the children `first` and `first + 1`. A leaf has the
/// `count` triangles from slot `first` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Smallest coordinates in the unit frame, rounded down.
    pub(crate) min: [f32; 3],
    /// Largest coordinates in the unit frame, rounded up.
    pub(crate) max: [f32; 3],
    pub(crate) first: u32,
    /// Number of triangles below the node. At most [`LEAF_TRIANGLES`] in a leaf, more in an inner
    /// node.
    pub(crate) count: u32,
}

/// Errors when building a hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BvhError {
    /// The mesh has no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// A vertex index is not smaller than the number of vertices.
    #[error("triangle {triangle} uses vertex {vertex}, but the mesh has only {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the offending triangle.
        triangle: usize,
        /// The invalid vertex index.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A vertex of a triangle has an infinite or NaN coordinate.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// Index of the offending vertex.
        vertex: u32,
    },
}

/// A bounding volume hierarchy over the triangles of a mesh. It is immutable and can be searched
/// from any number of threads.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::{Bvh, Feature};
///
/// let bvh = Bvh::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])?;
/// let closest = bvh.closest_point(dvec3(0.25, 0.25, 2.0));
/// assert_eq!(closest.distance, 2.0);
/// assert_eq!(closest.feature, Feature::Face);
/// # Ok::<(), isochore_mesh::BvhError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bvh {
    bounds: Aabb,
    frame: UnitFrame,
    nodes: Vec<Node>,
    /// Longest path from the root to a leaf, in nodes.
    depth: usize,
    /// Triangle indices of the mesh, in leaf order.
    order: Vec<u32>,
    /// Vertex indices, in leaf order.
    triangles: Vec<[u32; 3]>,
    /// Vertices in the unit frame.
    positions: Vec<DVec3>,
}

impl Bvh {
    /// Builds the hierarchy. Triangles without area are treated as segments or points.
    ///
    /// # Errors
    /// [`BvhError::Empty`] without triangles; [`BvhError::IndexOutOfRange`] or
    /// [`BvhError::NotFinite`] for the first triangle with an invalid vertex.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, BvhError> {
        let bounds = checked_bounds(positions, triangles)?;
        Ok(Self::within(bounds, positions, triangles, Clustering::Fine, || ()).0)
    }

    /// Builds the hierarchy of triangles with these [`checked_bounds`]. Clustering uses a single
    /// thread, so `meanwhile` runs in parallel with it.
    pub(crate) fn within<T: Send>(
        bounds: Aabb,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        clustering: Clustering,
        meanwhile: impl FnOnce() -> T + Send,
    ) -> (Self, T) {
        let frame = UnitFrame::around(bounds);
        let positions: Vec<DVec3> = positions.par_iter().map(|&position| frame.to_unit(position)).collect();
        let mut groups = Groups::new(&positions, triangles, clustering as u32);
        let ((nodes, in_order), done) = rayon::join(|| groups.clustered(), meanwhile);
        let (depth, order) = rayon::join(|| depth(&nodes), || groups.order(&in_order));
        let triangles = order.par_iter().map(|&triangle| triangles[triangle as usize]).collect();
        (Self { bounds, frame, depth, nodes, order, triangles, positions }, done)
    }

    /// Returns the point of the triangles that is nearest to `point`, and the feature that contains
    /// it. Of several equally near points, the choice is deterministic.
    pub fn closest_point(&self, point: DVec3) -> ClosestPoint {
        let local = self.frame.to_unit(point);
        let nearest = self.nearest(local, None);
        let corners = &self.corners(nearest.slot);
        let (on_triangle, _) = closest_on_triangle(local, corners);
        ClosestPoint {
            point: self.frame.from_unit(on_triangle.point),
            distance: nearest.squared.sqrt() / self.frame.scale(),
            triangle: self.order[nearest.slot as usize],
            feature: on_triangle.feature,
        }
    }

    /// Returns the triangle nearest to a point of the unit frame. A good `guess` (a slot in leaf
    /// order) saves time. It can only change the choice among equally near triangles.
    pub(crate) fn nearest(&self, point: DVec3, guess: Option<u32>) -> SquaredDistance {
        let mut best = SquaredDistance { slot: 0, squared: f64::INFINITY };
        if let Some(slot) = guess {
            best = SquaredDistance { slot, squared: closest_on_triangle(point, &self.corners(slot)).1 };
        }
        // Depth-first search, nearer child first, so that the bound becomes tight early.
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

    /// Nodes in preorder. The root is first. The two children of a node are adjacent, followed by
    /// all nodes below the first child, then by all nodes below the second. The triangles of leaves
    /// have the same order.
    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Stack capacity for a traversal that pushes both children of a node.
    pub(crate) fn stack_capacity(&self) -> usize {
        self.depth + 1
    }

    /// Index in the mesh of each triangle, in leaf order.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Vertex indices of the triangles, in leaf order.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Corners of a triangle in the unit frame, given by its slot in leaf order.
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

/// Returns the bounding box of all triangles, after checking their vertices.
///
/// # Errors
/// See [`Bvh::new`].
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
                // Adds zero for finite coordinates and NaN otherwise.
                offence += position * 0.0;
            }
        }
        if offence == DVec3::ZERO { Ok(bounds) } else { first_error(positions, chunk, number * TRIANGLES_AT_ONCE) }
    };
    let parts: Vec<_> = triangles.par_chunks(TRIANGLES_AT_ONCE).enumerate().map(bounds_of).collect();
    // Merge in order, so that the first error is reported.
    parts.into_iter().try_fold(Aabb::EMPTY, |bounds, part| Ok(bounds.union(part?)))
}

/// Returns the first error among triangles that are numbered from `first` on; empty bounds if
/// valid.
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
