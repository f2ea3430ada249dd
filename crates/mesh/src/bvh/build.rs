//! The nodes of a hierarchy: groups of triangles along a space-filling curve, and above them what `obvhs` clusters.

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
use crate::morton_order::{Placed, along_morton_curve};

/// Neighbors along the curve to each side that a cluster is compared with. Larger: slower. Smaller: boxes overlap more.
const NEIGHBORS: usize = 6;

/// Rounds of clustering that compare with only one neighbor, while there are most clusters.
const QUICK_ROUNDS: usize = 2;

/// Triangles whose leaves one task makes at most. Larger balances worse; smaller is more to hand out.
const TASK: usize = 1 << 13;

/// Groups of triangles along the curve.
pub(super) struct Groups {
    /// All triangles in the order of the curve.
    placed: Vec<Placed>,
    /// A node for each group.
    leaves: Vec<Bvh2Node>,
}

impl Groups {
    /// Groups of up to `at_most` triangles that follow each other.
    pub(super) fn new(positions: &[DVec3], triangles: &[[u32; 3]], at_most: u32) -> Self {
        let points: Vec<[f32; 3]> = positions.par_iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
        let placed = along_morton_curve(&points, triangles);
        let mut pieces = Vec::new();
        cut_down(&placed, 0..placed.len(), TASK, |piece| pieces.push(piece));
        let leaves: Vec<Vec<Bvh2Node>> = (pieces.into_par_iter())
            .map(|piece| {
                let mut leaves = Vec::with_capacity(piece.len() / 2);
                cut_down(&placed, piece, at_most as usize, |leaf| {
                    let aabb = outward_box(&placed[leaf.clone()], &points, triangles);
                    leaves.push(Bvh2Node::new(aabb, leaf.len() as u32, leaf.start as u32));
                });
                leaves
            })
            .collect();
        Self { placed, leaves: leaves.concat() }
    }

    /// The nodes over one triangle or more, in preorder with children beside each other, and the groups in the order of the leaves.
    /// One thread does all of it.
    pub(super) fn clustered(&mut self) -> (Vec<Node>, Vec<Range<u32>>) {
        let bounds = self.leaves.iter().fold(Aabb::empty(), |bounds, leaf| bounds.union(leaf.aabb()));
        // The convenience functions around this one read the clock, which WebAssembly has not.
        let mut builder = PlocBuilder::new();
        builder.current_nodes = take(&mut self.leaves);
        let mut tree = Bvh2::default();
        builder.build_ploc_from_leaves::<NEIGHBORS, false>(&mut tree, bounds, SortPrecision::U64, QUICK_ROUNDS);
        in_preorder(&tree.nodes)
    }

    /// The triangles of these groups.
    pub(super) fn order(&self, groups: &[Range<u32>]) -> Vec<u32> {
        let pieces: Vec<Vec<u32>> = (groups.par_chunks(TASK))
            .map(|groups| {
                let placed = groups.iter().flat_map(|group| &self.placed[group.start as usize..group.end as usize]);
                placed.map(|placed| placed.triangle).collect()
            })
            .collect();
        pieces.concat()
    }
}

/// Cuts a piece of the curve into pieces of at most so many triangles, at the boundaries of its largest cells first.
fn cut_down(placed: &[Placed], piece: Range<usize>, at_most: usize, mut visit: impl FnMut(Range<usize>)) {
    let mut pending = vec![piece];
    while let Some(Range { start, end }) = pending.pop() {
        if end - start <= at_most {
            visit(start..end);
        } else {
            let middle = cut(&placed[start..end]) + start;
            pending.extend([middle..end, start..middle]);
        }
    }
}

/// Where the first bit changes in which numbers of cells differ; in the middle where all are alike.
fn cut(placed: &[Placed]) -> usize {
    let (first, last) = (placed[0].cell, placed[placed.len() - 1].cell);
    let middle = match (first ^ last).checked_ilog2() {
        Some(bit) => placed.partition_point(|placed| placed.cell >> bit == first >> bit),
        None => placed.len() / 2,
    };
    // Numbers within a cell that has a grid of its own are in no relation to those around it.
    middle.clamp(1, placed.len() - 1)
}

/// The smallest box that holds these triangles as they were before their corners were rounded to nearest.
fn outward_box(placed: &[Placed], points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Aabb {
    let mut aabb = Aabb::empty();
    for placed in placed {
        for vertex in triangles[placed.triangle as usize] {
            aabb.extend(Vec3A::from_array(points[vertex as usize]));
        }
    }
    let (min, max) = (aabb.min, aabb.max);
    aabb.min = Vec3A::new(min.x.next_down(), min.y.next_down(), min.z.next_down());
    aabb.max = Vec3A::new(max.x.next_up(), max.y.next_up(), max.z.next_up());
    aabb
}

/// The nodes of a clustering, which has its root first and children behind their parents, cut where few enough triangles for a
/// leaf remain; and the groups below them in the same order.
fn in_preorder(tree: &[Bvh2Node]) -> (Vec<Node>, Vec<Range<u32>>) {
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
    while let Some((source, place)) = pending.pop() {
        let children = tree[source as usize].first_index;
        if nodes[place].is_leaf() {
            nodes[place].first = slot;
            slot += nodes[place].count;
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
            nodes[place].first = first as u32;
            nodes.extend([node(children), node(children + 1)]);
            pending.extend([(children + 1, first + 1), (children, first)]);
        }
    }
    (nodes, groups)
}
