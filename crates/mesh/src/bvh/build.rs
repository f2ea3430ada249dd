//! Construction of the nodes: groups of triangles along a space-filling curve, clustered by
//! `obvhs`.

use std::mem::take;
use std::ops::Range;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, SortPrecision};
use rayon::prelude::*;

use super::Node;
use crate::huge_pages::in_huge_pages;
use crate::morton_order::{MortonKey, along_morton_curve};

/// Neighbors along the curve, on each side, with which a cluster is compared. Larger: slower.
/// Smaller: boxes overlap more.
const NEIGHBORS: usize = 6;

/// Initial rounds of clustering that compare with only one neighbor, while there are most clusters.
const QUICK_ROUNDS: usize = 2;

/// Maximum number of triangles per task. Larger: worse load balance. Smaller: more scheduling.
const TASK: usize = 1 << 13;

/// Groups of adjacent triangles along the curve.
pub(super) struct Groups {
    /// All triangles in the order of the curve.
    keys: Vec<MortonKey>,
    /// One node per group.
    leaves: Vec<Bvh2Node>,
}

impl Groups {
    /// Forms groups of up to `at_most` triangles that are adjacent on the curve.
    pub(super) fn new(positions: &[DVec3], triangles: &[[u32; 3]], at_most: u32) -> Self {
        let points: Vec<[f32; 3]> = positions.par_iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
        let keys = along_morton_curve(&points, triangles);
        let mut pieces = Vec::new();
        cut_down(&keys, 0..keys.len(), TASK, |piece| pieces.push(piece));
        let leaves: Vec<Vec<Bvh2Node>> = (pieces.into_par_iter())
            .map(|piece| {
                let mut leaves = Vec::with_capacity(piece.len() / 2);
                cut_down(&keys, piece, at_most as usize, |leaf| {
                    let aabb = outward_box(&keys[leaf.clone()], &points, triangles);
                    leaves.push(Bvh2Node::new(aabb, leaf.len() as u32, leaf.start as u32));
                });
                leaves
            })
            .collect();
        Self { keys, leaves: leaves.concat() }
    }

    /// Clusters the groups on a single thread. Returns the nodes in preorder with adjacent
    /// children, and the groups in the order of the leaves.
    pub(super) fn clustered(&mut self) -> (Vec<Node>, Vec<Range<u32>>) {
        let bounds = self.leaves.iter().fold(Aabb::empty(), |bounds, leaf| bounds.union(leaf.aabb()));
        // The convenience functions of `obvhs` read the clock, which WebAssembly does not have.
        let mut builder = PlocBuilder::new();
        builder.current_nodes = take(&mut self.leaves);
        let mut tree = Bvh2::default();
        builder.build_ploc_from_leaves::<NEIGHBORS, false>(&mut tree, bounds, SortPrecision::U64, QUICK_ROUNDS);
        in_preorder(&tree.nodes)
    }

    /// Returns the triangles of these groups in order.
    pub(super) fn order(&self, groups: &[Range<u32>]) -> Vec<u32> {
        let pieces: Vec<Vec<u32>> = (groups.par_chunks(TASK))
            .map(|groups| {
                let keys = groups.iter().flat_map(|group| &self.keys[group.start as usize..group.end as usize]);
                keys.map(|key| key.triangle).collect()
            })
            .collect();
        pieces.concat()
    }
}

/// Splits a piece of the curve into pieces of at most `at_most` triangles, at the boundaries of the
/// largest cells first.
fn cut_down(keys: &[MortonKey], piece: Range<usize>, at_most: usize, mut visit: impl FnMut(Range<usize>)) {
    let mut pending = vec![piece];
    while let Some(Range { start, end }) = pending.pop() {
        if end - start <= at_most {
            visit(start..end);
        } else {
            let middle = cut(&keys[start..end]) + start;
            pending.extend([middle..end, start..middle]);
        }
    }
}

/// Returns the first index at which the highest differing bit of the cell numbers changes; the
/// midpoint if all numbers are equal.
fn cut(keys: &[MortonKey]) -> usize {
    let (first, last) = (keys[0].cell, keys[keys.len() - 1].cell);
    let middle = match (first ^ last).checked_ilog2() {
        Some(bit) => keys.partition_point(|key| key.cell >> bit == first >> bit),
        None => keys.len() / 2,
    };
    // Numbers within a refined cell are unrelated to those around it.
    middle.clamp(1, keys.len() - 1)
}

/// Smallest box that contains these triangles before their corners were rounded to nearest.
fn outward_box(keys: &[MortonKey], points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Aabb {
    let mut aabb = Aabb::empty();
    for key in keys {
        for vertex in triangles[key.triangle as usize] {
            aabb.extend(Vec3A::from_array(points[vertex as usize]));
        }
    }
    let (min, max) = (aabb.min, aabb.max);
    aabb.min = Vec3A::new(min.x.next_down(), min.y.next_down(), min.z.next_down());
    aabb.max = Vec3A::new(max.x.next_up(), max.y.next_up(), max.z.next_up());
    aabb
}

/// Converts a clustering, which has the root first and children after their parents, to nodes in
/// preorder. A node becomes a leaf if it has few enough triangles. Also returns the groups in the
/// same order.
fn in_preorder(tree: &[Bvh2Node]) -> (Vec<Node>, Vec<Range<u32>>) {
    // Count the triangles below each node, from the last node to the root.
    let mut below: Vec<u32> = tree.iter().map(|node| node.prim_count).collect();
    for (index, node) in tree.iter().enumerate().rev() {
        if !node.is_leaf() {
            below[index] = below[node.first_index as usize] + below[node.first_index as usize + 1];
        }
    }
    let node = |source: u32| {
        let aabb = tree[source as usize].aabb();
        Node { min: aabb.min.to_array(), max: aabb.max.to_array(), first: 0, count: below[source as usize] }
    };
    let mut groups = in_huge_pages(Vec::with_capacity(tree.len() / 2 + 1));
    let mut slot = 0;
    let mut nodes = in_huge_pages(Vec::with_capacity(tree.len()));
    nodes.push(node(0));
    let mut pending = vec![(0, 0)];
    let mut leaf = Vec::new();
    while let Some((source, target)) = pending.pop() {
        let children = tree[source as usize].first_index;
        if nodes[target].is_leaf() {
            nodes[target].first = slot;
            slot += nodes[target].count;
            // A leaf collects all groups below it, which may be spread over several nodes of the
            // clustering.
            leaf.push(source);
            while let Some(part) = leaf.pop() {
                let Bvh2Node { first_index: first, prim_count: count, .. } = tree[part as usize];
                if count > 0 {
                    groups.push(first..first + count);
                } else {
                    leaf.extend([first + 1, first]);
                }
            }
        } else {
            let first = nodes.len();
            nodes[target].first = first as u32;
            nodes.extend([node(children), node(children + 1)]);
            pending.extend([(children + 1, first + 1), (children, first)]);
        }
    }
    (nodes, groups)
}
