//! A bounding volume hierarchy over triangles, and the closest point on them.

mod closest_point;
mod unit_frame;

#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use crate::Aabb;
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

/// A node: an inner one has its children at `first` and `first + 1`, a leaf has `count` triangles from `first` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Smallest coordinates in the unit frame, rounded down.
    pub(crate) min: [f32; 3],
    /// Largest coordinates in the unit frame, rounded up.
    pub(crate) max: [f32; 3],
    pub(crate) first: u32,
    /// Zero for inner nodes.
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
    /// Corners in the unit frame, in leaf order.
    corners: Vec<[DVec3; 3]>,
}

impl Bvh {
    /// Builds the hierarchy. Zero-area triangles count as the segments or points that they are.
    ///
    /// # Errors
    /// See [`BvhError`].
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, BvhError> {
        Ok(Self::within(checked_bounds(positions, triangles)?, positions, triangles))
    }

    /// Builds the hierarchy of triangles that have these [`checked_bounds`].
    pub(crate) fn within(bounds: Aabb, positions: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let frame = UnitFrame::around(bounds);
        let local: Vec<_> = positions.par_iter().map(|&position| frame.inward(position)).collect();
        let boxes = outward_boxes(&local, triangles);

        // The portable builder: the convenience functions around it read the clock, which WebAssembly has not.
        let indices = (0..boxes.len() as u32).collect();
        let tree = PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, indices, SortPrecision::U64, 2);
        let (nodes, order) = with_larger_leaves(&tree);
        Self {
            bounds,
            frame,
            depth: depth(&nodes),
            nodes,
            corners: order.par_iter().map(|&i| triangles[i as usize].map(|vertex| local[vertex as usize])).collect(),
            triangles: order.par_iter().map(|&i| triangles[i as usize]).collect(),
            order,
        }
    }

    /// The point of the triangles nearest to `point`, and the feature it lies on. Of equally near ones, any, but always the same.
    pub fn closest_point(&self, point: DVec3) -> ClosestPoint {
        let local = self.frame.inward(point);
        let nearest = self.nearest(local, None);
        let corners = &self.corners[nearest.slot as usize];
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
            best = SquaredDistance { slot, squared: closest_on_triangle(point, &self.corners[slot as usize]).1 };
        }
        let mut stack = Vec::with_capacity(self.depth + 1);
        stack.push((0, self.nodes[0].squared_distance(point)));
        while let Some((index, squared)) = stack.pop() {
            if squared > best.squared * PRUNING_SLACK {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for slot in node.first..node.first + node.count {
                    let (_, squared) = closest_on_triangle(point, &self.corners[slot as usize]);
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

    /// Corners of the triangles in the unit frame, in leaf order.
    pub(crate) fn corners(&self) -> &[[DVec3; 3]] {
        &self.corners
    }
}

impl Node {
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
    let bounds_of = |(first, chunk): (usize, &[[u32; 3]])| {
        let mut bounds = Aabb::EMPTY;
        for (i, corners) in chunk.iter().enumerate() {
            for &vertex in corners {
                bounds = match positions.get(vertex as usize) {
                    None => {
                        let triangle = first * TRIANGLES_AT_ONCE + i;
                        return Err(BvhError::IndexOutOfRange { triangle, vertex, vertices: positions.len() });
                    }
                    Some(position) if !position.is_finite() => return Err(BvhError::NotFinite { vertex }),
                    Some(&position) => bounds.including(position),
                }
            }
        }
        Ok(bounds)
    };
    let parts: Vec<_> = triangles.par_chunks(TRIANGLES_AT_ONCE).enumerate().map(bounds_of).collect();
    // In order, so that the first error is the one that counts.
    parts.into_iter().try_fold(Aabb::EMPTY, |bounds, part| Ok(bounds.union(part?)))
}

/// The smallest boxes that hold each triangle, but for rounding the coordinates outward to `f32`.
fn outward_boxes(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<obvhs::aabb::Aabb> {
    // A little more than half a unit in the last place, so that rounding to nearest ends beyond; without a branch, which would be
    // foretold wrong every other time.
    let slack = |x: f64| x.abs() * f64::from(f32::EPSILON) + f64::from(f32::MIN_POSITIVE);
    let rounded: Vec<[[f32; 3]; 2]> = (positions.par_iter())
        .map(|p| [p.to_array().map(|x| (x - slack(x)) as f32), p.to_array().map(|x| (x + slack(x)) as f32)])
        .collect();
    let outward_box = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| rounded[vertex as usize].map(Vec3A::from_array));
        obvhs::aabb::Aabb::new(a[0].min(b[0]).min(c[0]), a[1].max(b[1]).max(c[1]))
    };
    triangles.par_iter().map(outward_box).collect()
}

/// The nodes of a new tree, which has one triangle a leaf, cut where [`LEAF_TRIANGLES`] remain: children behind their parents and beside each
/// other, and the triangles below any node beside each other in the order that comes with them.
fn with_larger_leaves(tree: &Bvh2) -> (Vec<Node>, Vec<u32>) {
    // Triangles below each node; children come after their parents.
    let mut below = vec![1_u32; tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        if !node.is_leaf() {
            below[i] = below[node.first_index as usize] + below[node.first_index as usize + 1];
        }
    }
    let node = |source: u32, first: u32, count: u32| {
        let aabb = tree.nodes[source as usize].aabb();
        Node { min: aabb.min.to_array(), max: aabb.max.to_array(), first, count }
    };
    let mut order = Vec::with_capacity(tree.primitive_indices.len());
    let mut nodes = Vec::with_capacity(tree.nodes.len());
    nodes.push(node(0, 0, 0));
    let mut pending = vec![(0, 0)];
    let mut leaf = Vec::new();
    while let Some((source, place)) = pending.pop() {
        if below[source as usize] <= LEAF_TRIANGLES {
            nodes[place] = node(source, order.len() as u32, below[source as usize]);
            leaf.push(source);
            while let Some(part) = leaf.pop() {
                let part = &tree.nodes[part as usize];
                if part.is_leaf() {
                    order.push(tree.primitive_indices[part.first_index as usize]);
                } else {
                    leaf.extend([part.first_index + 1, part.first_index]);
                }
            }
        } else {
            let (first, children) = (nodes.len(), tree.nodes[source as usize].first_index);
            nodes[place].first = first as u32;
            nodes.extend([node(children, 0, 0), node(children + 1, 0, 0)]);
            pending.extend([(children + 1, first + 1), (children, first)]);
        }
    }
    (nodes, order)
}

fn depth(nodes: &[Node]) -> usize {
    let mut depths = vec![1; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        if node.count == 0 {
            depths[node.first as usize] = depths[i] + 1;
            depths[node.first as usize + 1] = depths[i] + 1;
        }
    }
    depths.into_iter().max().unwrap_or(0)
}
