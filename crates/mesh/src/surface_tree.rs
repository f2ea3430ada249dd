//! A hierarchy of boxes over the triangles of a surface that moves and is edited: boxes are made anew along the ways from what
//! has changed to the root, and nowhere else.

mod query;
#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

pub use query::SurfaceHit;

use crate::{Aabb, Bvh, BvhError};

/// Triangles in a leaf when the tree is made. Larger looks at more triangles that are not in question; smaller spends memory
/// and time on boxes.
const LEAF_TRIANGLES: u32 = 8;

/// Triangles at which a leaf is cut in two. Less than twice [`LEAF_TRIANGLES`] would cut leaves that have hardly grown.
const FULL_LEAF: u32 = 16;

/// Leaves whose boxes one task makes at least. Larger leaves threads idle; smaller spends time on handing out tasks.
const LEAVES_PER_TASK: usize = 256;

const NONE: u32 = u32::MAX;

/// Boxes over triangles, which are told by number; where these are, a function tells, which gives nothing for those that are not
/// there.
#[derive(Debug, Clone)]
pub struct SurfaceTree {
    nodes: Vec<Node>,
    /// By triangle the leaf that holds it; [`NONE`] for one that is not there.
    leaf_of: Vec<u32>,
    /// By triangle the next one in its leaf.
    following: Vec<u32>,
    /// Whether a node is on the list of those to be made anew.
    is_due: Vec<bool>,
    due: Vec<u32>,
}

/// A box; children come behind their parents and beside each other.
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
    /// The tree over `triangles`. No triangles at all are a tree, too.
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

    /// Takes over the nodes of `bvh` down to where few enough triangles are left.
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

    /// Number of triangles, those included that are not there any more.
    pub fn len(&self) -> usize {
        self.leaf_of.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.leaf_of.is_empty()
    }

    /// Makes room for `additional` more triangles.
    pub fn reserve(&mut self, additional: usize) {
        self.leaf_of.reserve(additional);
        self.following.reserve(additional);
        // Leaves are cut when they hold FULL_LEAF triangles, into halves, and each cut makes two nodes.
        let nodes = 2 * additional.div_ceil(FULL_LEAF as usize / 2);
        self.nodes.reserve(nodes);
        self.is_due.reserve(nodes);
    }

    /// Takes in a triangle beside those of its neighbors that are there, or where a search finds its place.
    fn insert(&mut self, triangle: u32, neighbors: [u32; 3], bounds: &impl Fn(u32) -> Aabb) {
        let leaf_of = |&neighbor: &u32| self.leaf_of.get(neighbor as usize).copied().filter(|&leaf| leaf != NONE);
        let leaf = neighbors.iter().find_map(leaf_of).unwrap_or_else(|| self.descend(triangle, bounds));
        self.link(triangle, leaf);
        self.make_due(leaf);
        if self.nodes[leaf as usize].count >= FULL_LEAF {
            self.cut(leaf, bounds);
        }
    }

    /// The leaf that a triangle fits in best.
    fn descend(&mut self, triangle: u32, bounds: &impl Fn(u32) -> Aabb) -> u32 {
        let bounds = bounds(triangle);
        let center = bounds.center();
        let mut node = 0;
        loop {
            // Boxes grow at once, so that the next triangle finds its way by them.
            let grown = &mut self.nodes[node as usize].bounds;
            *grown = grown.union(bounds);
            if self.nodes[node as usize].child == NONE {
                return node;
            }
            let child = self.nodes[node as usize].child;
            // To the box that must grow least, or the one whose center is nearer.
            let cost = |index: u32| {
                let bounds = self.nodes[index as usize].bounds;
                let off = bounds.center().distance_squared(center);
                (bounds.distance(center), if off.is_finite() { off } else { f64::INFINITY })
            };
            node = if cost(child + 1) < cost(child) { child + 1 } else { child };
        }
    }

    /// Makes a leaf the parent of two, halved along the longest side of the box of the centers.
    fn cut(&mut self, leaf: u32, bounds: &impl Fn(u32) -> Aabb) {
        let (gone, there): (Vec<_>, Vec<_>) = self
            .of_leaf(leaf)
            .map(|triangle| (bounds(triangle), triangle))
            .partition(|&(bounds, _)| is_nothing(bounds));
        gone.into_iter().for_each(|(_, triangle)| self.leaf_of[triangle as usize] = NONE);
        let mut triangles: Vec<(DVec3, u32)> =
            there.into_iter().map(|(bounds, triangle)| (bounds.center(), triangle)).collect();
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

    /// Makes the number of triangles `count`, and follows those of the triangles `changed` that have moved, gone, or come back; those
    /// that are new need not be among them.
    ///
    /// `bounds` tells the box of a triangle, empty where it is not there, and `near` gives nothing then. Where it knows neighbors of one
    /// that is there, numbers out of range among them, its place is found without a search.
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
        for (&leaf, (tight, has_gone)) in leaves.iter().zip(boxes) {
            self.is_due[leaf as usize] = false;
            self.nodes[leaf as usize].bounds = tight;
            if has_gone {
                let gone: Vec<u32> = self.of_leaf(leaf).filter(|&triangle| is_nothing(bounds(triangle))).collect();
                gone.into_iter().for_each(|triangle| self.unlink(triangle));
            }
        }
        // Children come behind their parents.
        branches.sort_unstable_by(|a, b| b.cmp(a));
        for node in branches {
            self.is_due[node as usize] = false;
            self.nodes[node as usize].bounds = self.tight_bounds(node as usize, bounds);
        }
    }

    /// The box around the triangles of a leaf, and whether any of them is not there.
    fn leaf_bounds(&self, leaf: u32, bounds: &impl Fn(u32) -> Aabb) -> (Aabb, bool) {
        self.of_leaf(leaf).map(bounds).fold((Aabb::EMPTY, false), |(around, has_gone), bounds| {
            (around.union(bounds), has_gone || is_nothing(bounds))
        })
    }

    fn tight_bounds(&self, node: usize, bounds: &impl Fn(u32) -> Aabb) -> Aabb {
        match self.nodes[node].child {
            NONE => self.leaf_bounds(node as u32, bounds).0,
            child => self.nodes[child as usize].bounds.union(self.nodes[child as usize + 1].bounds),
        }
    }
}

/// Whether a box holds nothing.
fn is_nothing(bounds: Aabb) -> bool {
    bounds.min.x > bounds.max.x
}
