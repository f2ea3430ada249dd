//! Data for the search for nearest triangles, prepared from a hierarchy.

use rayon::prelude::*;

use super::flat_triangle::FlatTriangle;
use super::leaf_block::{LEAF_BLOCK, OutputSlice, SubtreeSummary, prepare};
use super::oriented_box::{COORDINATE_ROUNDING, OrientedBox, PackedBox};
use crate::Bvh;
use crate::bvh::Node;
use crate::huge_pages::in_huge_pages;

/// Boxes and triangles in the order of the hierarchy.
#[derive(Debug)]
pub(super) struct Preparation {
    pub(super) boxes: Vec<PackedBox>,
    pub(super) triangles: Vec<FlatTriangle>,
    /// Square of the length of the longest edge in the unit frame.
    pub(super) longest2: f64,
}

/// Maximum number of triangles per task. Larger: worse load balance. Smaller: more work is left for
/// the final sequential pass.
const TASK: u32 = 1 << 13;

/// Maximum number of triangles in a cluster. The boxes of larger parts enclose boxes of clusters,
/// and the boxes of clusters enclose those of leaf blocks. This is nearly as tight as enclosing all
/// corners, and much faster. Larger: slower. Smaller: looser boxes of large parts.
const CLUSTER: u32 = 256;

/// A part of the hierarchy.
#[derive(Debug, Clone, Copy)]
struct Piece {
    summary: SubtreeSummary,
    /// Start of the boxes of its leaf blocks or clusters in the list of such boxes.
    obbs_from: usize,
}

/// A subtree that is prepared by one task.
#[derive(Debug)]
struct Task<'a> {
    root: usize,
    out: OutputSlice<'a>,
}

impl Preparation {
    /// Prepares a search for points whose coordinates are not larger than `largest`.
    pub(super) fn new(bvh: &Bvh, largest: f64) -> Self {
        let nodes = bvh.nodes();
        let rounding = COORDINATE_ROUNDING * (largest + 1.0);
        let mut triangles: Vec<FlatTriangle> = in_huge_pages(bytemuck::zeroed_vec(bvh.triangles().len()));
        let mut boxes: Vec<PackedBox> = in_huge_pages(bytemuck::zeroed_vec(nodes.len()));

        let mut roots = Vec::new();
        fold(nodes, 0, TASK, |root, _: Option<[(); 2]>| {
            if nodes[root].count <= TASK {
                roots.push(root);
            }
        });
        let (mut triangles_left, mut boxes_left) = (&mut triangles[..], &mut boxes[..]);
        let mut tasks = Vec::with_capacity(roots.len());
        for &root in roots.iter().rev() {
            // The triangles and boxes below a root follow those below all earlier roots.
            let first_slot = triangles_left.len() - nodes[root].count as usize;
            let first_box = if nodes[root].is_leaf() { boxes_left.len() } else { nodes[root].first as usize };
            let (before, triangles) = triangles_left.split_at_mut(first_slot);
            triangles_left = before;
            let (before, boxes) = boxes_left.split_at_mut(first_box);
            boxes_left = before;
            tasks.push(Task {
                root,
                out: OutputSlice { first_slot: first_slot as u32, triangles, first_box, boxes, rounding },
            });
        }
        tasks.reverse();
        let done: Vec<(SubtreeSummary, Vec<OrientedBox>)> = tasks.into_par_iter().map(|task| task.run(bvh)).collect();

        let (mut clusters, mut next) = (Vec::new(), 0);
        let whole = fold(nodes, 0, TASK, |node, parts: Option<[Piece; 2]>| match parts {
            None => {
                let (summary, obbs) = &done[next];
                next += 1;
                clusters.extend_from_slice(obbs);
                Piece { summary: *summary, obbs_from: clusters.len() - obbs.len() }
            }
            Some([left, right]) => {
                let first = nodes[node].first as usize;
                boxes[first] = left.summary.obb.packed(rounding, &nodes[first]);
                boxes[first + 1] = right.summary.obb.packed(rounding, &nodes[first + 1]);
                let obbs_from = left.obbs_from;
                Piece {
                    summary: SubtreeSummary::join(&left.summary, &right.summary, &clusters[obbs_from..]),
                    obbs_from,
                }
            }
        });
        boxes[0] = whole.summary.obb.packed(rounding, &nodes[0]);
        Self { boxes, triangles, longest2: whole.summary.longest2 }
    }
}

impl Task<'_> {
    /// Prepares all nodes below the root. Returns the summary of the root and the boxes of its
    /// clusters.
    fn run(mut self, bvh: &Bvh) -> (SubtreeSummary, Vec<OrientedBox>) {
        let nodes = bvh.nodes();
        let (mut blocks, mut clusters) = (Vec::new(), Vec::new());
        let mut slot = self.out.first_slot;
        let whole = fold(nodes, self.root, LEAF_BLOCK, |node, parts: Option<[Piece; 2]>| match parts {
            None => {
                let summary = prepare(bvh, node, slot, &mut self.out);
                slot += nodes[node].count;
                blocks.push(summary.obb);
                Piece { summary, obbs_from: blocks.len() - 1 }
            }
            Some([left, right]) => {
                let first = nodes[node].first as usize;
                let mut obbs_from = left.obbs_from;
                for (child, piece) in [(first, &left), (first + 1, &right)] {
                    self.out.boxes[child - self.out.first_box] =
                        piece.summary.obb.packed(self.out.rounding, &nodes[child]);
                }
                if nodes[node].count <= CLUSTER {
                    return Piece {
                        summary: SubtreeSummary::join(&left.summary, &right.summary, &blocks[obbs_from..]),
                        obbs_from,
                    };
                }
                // The node is larger than a cluster, so the children that are clusters become
                // final.
                let are_clusters = [first, first + 1].map(|child| nodes[child].count <= CLUSTER);
                obbs_from = match are_clusters {
                    [true, true] => clusters.len(),
                    [true, false] => right.obbs_from,
                    [false, _] => left.obbs_from,
                };
                for (piece, is_cluster) in [(&right, are_clusters[1]), (&left, are_clusters[0])] {
                    if is_cluster {
                        blocks.truncate(piece.obbs_from);
                        clusters.push(piece.summary.obb);
                    }
                }
                Piece {
                    summary: SubtreeSummary::join(&left.summary, &right.summary, &clusters[obbs_from..]),
                    obbs_from,
                }
            }
        });
        if nodes[self.root].count <= CLUSTER {
            clusters.push(whole.summary.obb);
        }
        (whole.summary, clusters)
    }
}

/// Traverses a subtree bottom-up in the order of its triangles. Calls `visit` for the largest parts
/// of at most `size` triangles, and for every node above them with the results of its children.
/// Returns the result of the root.
fn fold<T>(nodes: &[Node], root: usize, size: u32, mut visit: impl FnMut(usize, Option<[T; 2]>) -> T) -> T {
    let is_end = |node: usize| nodes[node].is_leaf() || nodes[node].count <= size;
    // An explicit stack, because hierarchies of equal triangles are as deep as they have nodes.
    let mut pending: Vec<(usize, Option<T>)> = Vec::new();
    let mut node = root;
    loop {
        // Descend to the first part that is small enough.
        while !is_end(node) {
            pending.push((node, None));
            node = nodes[node].first as usize;
        }
        let mut done = visit(node, None);
        // Ascend while both children are done.
        loop {
            match pending.pop() {
                None => return done,
                Some((parent, None)) => {
                    pending.push((parent, Some(done)));
                    node = nodes[parent].first as usize + 1;
                    break;
                }
                Some((parent, Some(left))) => done = visit(parent, Some([left, done])),
            }
        }
    }
}
