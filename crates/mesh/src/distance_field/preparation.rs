//! What the search for nearest triangles needs, made of a hierarchy.

use rayon::prelude::*;

use super::flat_triangle::FlatTriangle;
use super::grain::{GRAIN, Grain, Place, prepare};
use super::oriented_box::{COORDINATE_ROUNDING, OrientedBox, Shell};
use crate::Bvh;
use crate::bvh::Node;
use crate::huge_pages::in_huge_pages;

/// Boxes and triangles in the order of the hierarchy.
#[derive(Debug)]
pub(super) struct Preparation {
    pub(super) boxes: Vec<OrientedBox>,
    pub(super) triangles: Vec<FlatTriangle>,
    /// Square of the length of the longest edge in the unit frame.
    pub(super) longest2: f64,
}

/// Triangles that one task prepares at most. Larger balances worse; smaller leaves more to be done in the end.
const TASK: u32 = 1 << 13;

/// Triangles in a lump at most: boxes of larger pieces hold those of the lumps in them, boxes of lumps those of grains, which is
/// nearly as tight as around all corners, and far faster. Larger: slower. Smaller: looser boxes of large pieces.
const LUMP: u32 = 256;

/// A part of the hierarchy.
#[derive(Debug, Clone, Copy)]
struct Piece {
    grain: Grain,
    /// Where the shells begin of the grains that make it up, or of the lumps.
    shells_from: usize,
}

/// A subtree that is prepared on its own.
#[derive(Debug)]
struct Task<'a> {
    root: usize,
    place: Place<'a>,
}

impl Preparation {
    /// For points whose coordinates are not larger than `largest`.
    pub(super) fn new(bvh: &Bvh, largest: f64) -> Self {
        let nodes = bvh.nodes();
        let rounding = COORDINATE_ROUNDING * (largest + 1.0);
        let mut triangles: Vec<FlatTriangle> = in_huge_pages(bytemuck::zeroed_vec(bvh.triangles().len()));
        let mut boxes: Vec<OrientedBox> = in_huge_pages(bytemuck::zeroed_vec(nodes.len()));

        let mut roots = Vec::new();
        fold(nodes, 0, TASK, |root, _: Option<[(); 2]>| {
            if nodes[root].count <= TASK {
                roots.push(root);
            }
        });
        let (mut triangles_left, mut boxes_left) = (&mut triangles[..], &mut boxes[..]);
        let mut tasks = Vec::with_capacity(roots.len());
        for &root in roots.iter().rev() {
            // What is below a root comes behind what is below those before it.
            let first_slot = triangles_left.len() - nodes[root].count as usize;
            let first_box = if nodes[root].is_leaf() { boxes_left.len() } else { nodes[root].first as usize };
            let (before, triangles) = triangles_left.split_at_mut(first_slot);
            triangles_left = before;
            let (before, boxes) = boxes_left.split_at_mut(first_box);
            boxes_left = before;
            tasks.push(Task {
                root,
                place: Place { first_slot: first_slot as u32, triangles, first_box, boxes, rounding },
            });
        }
        tasks.reverse();
        let done: Vec<(Grain, Vec<Shell>)> = tasks.into_par_iter().map(|task| task.run(bvh)).collect();

        let (mut lumps, mut next) = (Vec::new(), 0);
        let whole = fold(nodes, 0, TASK, |node, parts: Option<[Piece; 2]>| match parts {
            None => {
                let (grain, shells) = &done[next];
                next += 1;
                lumps.extend_from_slice(shells);
                Piece { grain: *grain, shells_from: lumps.len() - shells.len() }
            }
            Some([left, right]) => {
                let first = nodes[node].first as usize;
                boxes[first] = left.grain.shell.rounded(rounding, &nodes[first]);
                boxes[first + 1] = right.grain.shell.rounded(rounding, &nodes[first + 1]);
                let shells_from = left.shells_from;
                Piece { grain: Grain::join(&left.grain, &right.grain, &lumps[shells_from..]), shells_from }
            }
        });
        boxes[0] = whole.grain.shell.rounded(rounding, &nodes[0]);
        Self { boxes, triangles, longest2: whole.grain.longest2 }
    }
}

impl Task<'_> {
    /// Prepares all below the root. What comes of the root itself, and the shells of the lumps in it.
    fn run(mut self, bvh: &Bvh) -> (Grain, Vec<Shell>) {
        let nodes = bvh.nodes();
        let (mut grains, mut lumps) = (Vec::new(), Vec::new());
        let mut slot = self.place.first_slot;
        let whole = fold(nodes, self.root, GRAIN, |node, parts: Option<[Piece; 2]>| match parts {
            None => {
                let grain = prepare(bvh, node, slot, &mut self.place);
                slot += nodes[node].count;
                grains.push(grain.shell);
                Piece { grain, shells_from: grains.len() - 1 }
            }
            Some([left, right]) => {
                let first = nodes[node].first as usize;
                let mut shells_from = left.shells_from;
                for (child, piece) in [(first, &left), (first + 1, &right)] {
                    self.place.boxes[child - self.place.first_box] =
                        piece.grain.shell.rounded(self.place.rounding, &nodes[child]);
                }
                if nodes[node].count <= LUMP {
                    return Piece {
                        grain: Grain::join(&left.grain, &right.grain, &grains[shells_from..]),
                        shells_from,
                    };
                }
                // Lumps end here.
                let are_lumps = [first, first + 1].map(|child| nodes[child].count <= LUMP);
                shells_from = match are_lumps {
                    [true, true] => lumps.len(),
                    [true, false] => right.shells_from,
                    [false, _] => left.shells_from,
                };
                for (piece, is_lump) in [(&right, are_lumps[1]), (&left, are_lumps[0])] {
                    if is_lump {
                        grains.truncate(piece.shells_from);
                        lumps.push(piece.grain.shell);
                    }
                }
                Piece { grain: Grain::join(&left.grain, &right.grain, &lumps[shells_from..]), shells_from }
            }
        });
        if nodes[self.root].count <= LUMP {
            lumps.push(whole.grain.shell);
        }
        (whole.grain, lumps)
    }
}

/// Walks through a subtree from its ends up, in the order of its triangles: calls `visit` for the largest parts of at most `size`
/// triangles, and for every node above with what came of its children. What comes of the root.
fn fold<T>(nodes: &[Node], root: usize, size: u32, mut visit: impl FnMut(usize, Option<[T; 2]>) -> T) -> T {
    let is_end = |node: usize| nodes[node].is_leaf() || nodes[node].count <= size;
    // A stack of its own: hierarchies of equal triangles are as deep as they have nodes.
    let mut pending: Vec<(usize, Option<T>)> = Vec::new();
    let mut node = root;
    loop {
        // Down to the first end.
        while !is_end(node) {
            pending.push((node, None));
            node = nodes[node].first as usize;
        }
        let mut done = visit(node, None);
        // Up as long as both children are done.
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
