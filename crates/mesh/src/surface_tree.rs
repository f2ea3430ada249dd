//! A bounding volume hierarchy over the triangles of a surface that moves and is edited. An update
//! recomputes only the boxes on the paths from changed triangles to the root.

mod overlap;
mod query;
#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

pub use query::SurfaceHit;

use crate::{Aabb, Bvh, BvhError};

/// Triangles per leaf of a new tree. With a larger value queries test more triangles in vain; a
/// smaller one spends memory and time on boxes.
const LEAF_TRIANGLES: u32 = 8;

/// Triangles at which a leaf is split in two. A value below twice [`LEAF_TRIANGLES`] would split
/// leaves that have hardly grown.
const FULL_LEAF: u32 = 16;

/// Minimum number of leaves whose boxes one task computes. A larger value leaves threads idle; a
/// smaller one spends time on scheduling.
const LEAVES_PER_TASK: usize = 256;

const NONE: u32 = u32::MAX;

/// A bounding volume hierarchy over triangles, identified by index. The caller passes functions
/// that return their geometry, or nothing for removed triangles.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{SurfaceTree, primitives};
///
/// let ball = primitives::icosphere(1.0, 3);
/// let tree = SurfaceTree::new(&ball.positions, &ball.triangles)?;
/// let corners = |triangle: u32| Some(ball.corners(triangle as usize));
/// let hit = tree.cast_ray(3.0 * DVec3::Z, DVec3::NEG_Z, &corners).unwrap();
/// assert!((hit.distance - 2.0).abs() < 0.02);
/// let nearest = tree.closest_point(3.0 * DVec3::X, &corners).unwrap();
/// assert!((nearest.point.x - 1.0).abs() < 0.02);
/// # Ok::<(), isochore_mesh::BvhError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SurfaceTree {
    nodes: Vec<Node>,
    /// For each triangle its leaf; [`NONE`] for a removed one.
    leaf_of: Vec<u32>,
    /// For each triangle the next one in its leaf.
    following: Vec<u32>,
    /// Whether a node is on the list `due` of those whose box must be recomputed.
    is_due: Vec<bool>,
    due: Vec<u32>,
}

/// A node. Children are adjacent and come after their parents.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    parent: u32,
    /// First of the two children, or [`NONE`] for a leaf.
    child: u32,
    /// First triangle of a leaf.
    first: u32,
    /// Triangles of a leaf.
    count: u32,
}

impl SurfaceTree {
    /// The tree over `triangles`, which may be empty.
    ///
    /// # Errors
    /// [`BvhError`] for an index out of range or a coordinate that is not finite.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, BvhError> {
        let mut tree = Self {
            nodes: vec![Node { bounds: Aabb::EMPTY, parent: NONE, child: NONE, first: NONE, count: 0 }],
            leaf_of: vec![NONE; triangles.len()],
            following: vec![NONE; triangles.len()],
            is_due: Vec::new(),
            due: Vec::new(),
        };
        if !triangles.is_empty() {
            tree.copy(&Bvh::new(positions, triangles)?);
        }
        tree.is_due = vec![false; tree.nodes.len()];
        let bounds = |triangle: u32| Aabb::of(triangles[triangle as usize].map(|vertex| positions[vertex as usize]));
        for node in (0..tree.nodes.len()).rev() {
            tree.nodes[node].bounds = tree.tight_bounds(node, &bounds);
        }
        Ok(tree)
    }

    /// Copies the upper nodes of `bvh`, down to nodes that are small enough for leaves.
    fn copy(&mut self, bvh: &Bvh) {
        let source = bvh.nodes();
        let mut rest = bvh.order().iter();
        let mut pending = vec![(0, 0)];
        while let Some((from, to)) = pending.pop() {
            let count = source[from].count;
            if count <= LEAF_TRIANGLES {
                rest.by_ref().take(count as usize).for_each(|&triangle| self.link(triangle, to as u32));
            } else {
                let (children, child) = (source[from].first as usize, self.add_children(to as u32) as usize);
                pending.extend([(children + 1, child + 1), (children, child)]);
            }
        }
    }

    fn add_children(&mut self, parent: u32) -> u32 {
        let child = self.nodes.len() as u32;
        let leaf = Node { bounds: Aabb::EMPTY, parent, child: NONE, first: NONE, count: 0 };
        self.nodes.extend([leaf; 2]);
        self.nodes[parent as usize].child = child;
        child
    }

    fn link(&mut self, triangle: u32, leaf: u32) {
        let node = &mut self.nodes[leaf as usize];
        self.following[triangle as usize] = node.first;
        self.leaf_of[triangle as usize] = leaf;
        node.first = triangle;
        node.count += 1;
    }

    fn unlink(&mut self, triangle: u32) {
        let leaf = self.leaf_of[triangle as usize];
        let after = self.following[triangle as usize];
        let before = self.of_leaf(leaf).find(|&other| self.following[other as usize] == triangle);
        match before {
            Some(before) => self.following[before as usize] = after,
            None => self.nodes[leaf as usize].first = after,
        }
        self.nodes[leaf as usize].count -= 1;
        self.leaf_of[triangle as usize] = NONE;
    }

    fn of_leaf(&self, leaf: u32) -> impl Iterator<Item = u32> + '_ {
        let some = |triangle: u32| (triangle != NONE).then_some(triangle);
        std::iter::successors(some(self.nodes[leaf as usize].first), move |&triangle| {
            some(self.following[triangle as usize])
        })
    }

    /// Number of triangles, including removed ones.
    pub fn len(&self) -> usize {
        self.leaf_of.len()
    }

    /// Whether the tree is empty.
    pub fn is_empty(&self) -> bool {
        self.leaf_of.is_empty()
    }

    /// Reserves capacity for `additional` more triangles.
    pub fn reserve(&mut self, additional: usize) {
        self.leaf_of.reserve(additional);
        self.following.reserve(additional);
        // A leaf of FULL_LEAF triangles is split into halves, which adds two nodes.
        let nodes = 2 * additional.div_ceil(FULL_LEAF as usize / 2);
        self.nodes.reserve(nodes);
        self.is_due.reserve(nodes);
    }

    /// Inserts a triangle into the leaf of a neighbor, or into one found by descending.
    fn insert(&mut self, triangle: u32, neighbors: [u32; 3], bounds: &impl Fn(u32) -> Aabb) {
        let leaf_of = |&neighbor: &u32| self.leaf_of.get(neighbor as usize).copied().filter(|&leaf| leaf != NONE);
        let leaf = neighbors.iter().find_map(leaf_of).unwrap_or_else(|| self.descend(triangle, bounds));
        self.link(triangle, leaf);
        self.make_due(leaf);
        if self.nodes[leaf as usize].count >= FULL_LEAF {
            self.split_leaf(leaf, bounds);
        }
    }

    /// The leaf that fits a triangle best.
    fn descend(&mut self, triangle: u32, bounds: &impl Fn(u32) -> Aabb) -> u32 {
        let bounds = bounds(triangle);
        let center = bounds.center();
        let mut node = 0;
        loop {
            // Boxes grow immediately, so that the search for the next triangle uses them.
            let grown = &mut self.nodes[node as usize].bounds;
            *grown = grown.union(bounds);
            if self.nodes[node as usize].child == NONE {
                return node;
            }
            let child = self.nodes[node as usize].child;
            // Descend into the box that is nearer, or else whose center is nearer.
            let cost = |index: u32| {
                let bounds = self.nodes[index as usize].bounds;
                let off = bounds.center().distance_squared(center);
                (bounds.distance(center), if off.is_finite() { off } else { f64::INFINITY })
            };
            node = if cost(child + 1) < cost(child) { child + 1 } else { child };
        }
    }

    /// Splits a leaf into two, at the median along the longest side of the box of the centers.
    fn split_leaf(&mut self, leaf: u32, bounds: &impl Fn(u32) -> Aabb) {
        let (removed, present): (Vec<_>, Vec<_>) =
            self.of_leaf(leaf).map(|triangle| (bounds(triangle), triangle)).partition(|&(bounds, _)| is_empty(bounds));
        removed.into_iter().for_each(|(_, triangle)| self.leaf_of[triangle as usize] = NONE);
        let mut triangles: Vec<(DVec3, u32)> =
            present.into_iter().map(|(bounds, triangle)| (bounds.center(), triangle)).collect();
        let size = Aabb::of(triangles.iter().map(|&(center, _)| center)).size();
        let axis = size.max_position();
        triangles.sort_unstable_by(|a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
        let child = self.add_children(leaf);
        self.is_due.resize(self.nodes.len(), false);
        let node = &mut self.nodes[leaf as usize];
        (node.first, node.count) = (NONE, 0);
        let half = triangles.len() / 2;
        for (rank, (_, triangle)) in triangles.into_iter().enumerate() {
            self.link(triangle, child + u32::from(rank >= half));
        }
        for node in [child, child + 1] {
            self.nodes[node as usize].bounds = self.tight_bounds(node as usize, bounds);
        }
    }

    fn make_due(&mut self, leaf: u32) {
        let mut node = leaf;
        while node != NONE && !self.is_due[node as usize] {
            self.is_due[node as usize] = true;
            self.due.push(node);
            node = self.nodes[node as usize].parent;
        }
    }

    /// Sets the number of triangles to `count`, and updates the triangles `changed` that were
    /// moved, removed or restored. `changed` need not include new triangles.
    ///
    /// `bounds` returns the box of a triangle, which is empty for a removed one. `near` returns
    /// candidates for its neighbors, or `None` for a removed triangle. A triangle with a neighbor
    /// in the tree is inserted without a search; candidates out of range are ignored.
    pub fn update(
        &mut self,
        count: usize,
        changed: &[u32],
        bounds: &(impl Fn(u32) -> Aabb + Sync),
        near: &impl Fn(u32) -> Option<[u32; 3]>,
    ) {
        let known = self.leaf_of.len().min(count);
        for triangle in count..self.leaf_of.len() {
            let leaf = self.leaf_of[triangle];
            if leaf != NONE {
                self.make_due(leaf);
                self.unlink(triangle as u32);
            }
        }
        self.leaf_of.resize(count, NONE);
        self.following.resize(count, NONE);
        let changed = changed.iter().copied().filter(|&triangle| (triangle as usize) < known);
        for triangle in changed.chain(known as u32..count as u32) {
            match self.leaf_of[triangle as usize] {
                NONE => near(triangle).into_iter().for_each(|neighbors| self.insert(triangle, neighbors, bounds)),
                leaf => self.make_due(leaf),
            }
        }
        let mut due = std::mem::take(&mut self.due);
        let (leaves, mut branches): (Vec<u32>, Vec<u32>) =
            due.drain(..).partition(|&node| self.nodes[node as usize].child == NONE);
        self.due = due;
        let boxes = leaves.par_iter().with_min_len(LEAVES_PER_TASK);
        let boxes: Vec<(Aabb, bool)> = boxes.map(|&leaf| self.leaf_bounds(leaf, bounds)).collect();
        for (&leaf, (tight, has_removed)) in leaves.iter().zip(boxes) {
            self.is_due[leaf as usize] = false;
            self.nodes[leaf as usize].bounds = tight;
            if has_removed {
                let removed: Vec<u32> = self.of_leaf(leaf).filter(|&triangle| is_empty(bounds(triangle))).collect();
                removed.into_iter().for_each(|triangle| self.unlink(triangle));
            }
        }
        // In descending order, because children come after their parents.
        branches.sort_unstable_by(|a, b| b.cmp(a));
        for node in branches {
            self.is_due[node as usize] = false;
            self.nodes[node as usize].bounds = self.tight_bounds(node as usize, bounds);
        }
    }

    /// The box around the triangles of a leaf, and whether any of them is removed.
    fn leaf_bounds(&self, leaf: u32, bounds: &impl Fn(u32) -> Aabb) -> (Aabb, bool) {
        self.of_leaf(leaf).map(bounds).fold((Aabb::EMPTY, false), |(around, has_removed), bounds| {
            (around.union(bounds), has_removed || is_empty(bounds))
        })
    }

    fn tight_bounds(&self, node: usize, bounds: &impl Fn(u32) -> Aabb) -> Aabb {
        match self.nodes[node].child {
            NONE => self.leaf_bounds(node as u32, bounds).0,
            child => self.nodes[child as usize].bounds.union(self.nodes[child as usize + 1].bounds),
        }
    }
}

/// Whether a box is empty.
fn is_empty(bounds: Aabb) -> bool {
    bounds.min.x > bounds.max.x
}
