//! A hierarchy of boxes that is searched against itself.
//!
//! Triangles are put in the order of a space-filling curve (G. Morton, *A Computer Oriented Geodetic Data Base and a New
//! Technique in File Sequencing*, 1966), and every eight that follow each other share a box, as do every eight of those, and so
//! on. So nodes need no pointers, and one box is held against eight at once.

use glam::DVec3;
use rayon::prelude::*;

use crate::bvh::UnitFrame;
use crate::extremes::{greater, lesser};
use crate::morton_order::along_morton_curve;

/// Boxes that share a box of the next level.
pub(super) const WIDTH: usize = 8;

/// Eight boxes; those that are not there overlap nothing.
///
/// Corners are rounded to the nearest number, which keeps the order of coordinates: boxes that are apart once rounded are apart.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Boxes {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
}

/// One box.
#[derive(Debug, Clone, Copy)]
struct OneBox {
    min: [f32; 3],
    max: [f32; 3],
}

/// The hierarchy.
#[derive(Debug)]
pub(super) struct BoxTree {
    /// The triangle at each place along the curve.
    pub(super) order: Vec<u32>,
    /// Boxes of the triangles, eight by eight, then the boxes around those, up to a level of one.
    levels: Vec<Vec<Boxes>>,
}

/// Two nodes of one level whose boxes overlap, the first not behind the second; they may be one and the same.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodePair {
    level: u32,
    nodes: [u32; 2],
}

impl BoxTree {
    /// The hierarchy of the triangles over these finite points; there is at least one.
    pub(super) fn new(points: &[DVec3], triangles: &[[u32; 3]], frame: &UnitFrame) -> Self {
        let rounded: Vec<[f32; 3]> = points
            .par_iter()
            .map(|&point| {
                let point = frame.inward(point);
                [point.x as f32, point.y as f32, point.z as f32]
            })
            .collect();
        let box_of = |triangle: u32| {
            let [a, b, c] = triangles[triangle as usize];
            OneBox::of([rounded[a as usize], rounded[b as usize], rounded[c as usize]])
        };
        let order =
            along_morton_curve(&rounded, triangles).into_iter().map(|placed| placed.triangle).collect::<Vec<_>>();
        let first =
            order.par_chunks(WIDTH).map(|eight| Boxes::of(eight.iter().map(|&triangle| box_of(triangle)))).collect();
        let mut levels: Vec<Vec<Boxes>> = vec![first];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            levels.push(below.par_chunks(WIDTH).map(|eight| Boxes::of(eight.iter().map(Boxes::union))).collect());
        }
        Self { order, levels }
    }

    /// Pairs of nodes that hold all pairs of triangles whose boxes overlap: at least `wanted`, if there are as many.
    pub(super) fn node_pairs(&self, wanted: usize) -> Vec<NodePair> {
        let mut pairs = vec![NodePair { level: self.levels.len() as u32 - 1, nodes: [0, 0] }];
        while pairs.len() < wanted && pairs[0].level > 0 {
            let finer = |pair: NodePair| {
                let mut below = Vec::new();
                self.descend(pair, |nodes| below.push(NodePair { level: pair.level - 1, nodes }));
                below
            };
            pairs = pairs.into_iter().flat_map(finer).collect();
            if pairs.is_empty() {
                break;
            }
        }
        pairs
    }

    /// Takes pairs of nodes from the `stack` and lists the places of the pairs of triangles below them whose boxes overlap, until
    /// there are `wanted` or a few more. False when there were none left.
    #[inline(always)]
    pub(super) fn overlapping_places(
        &self,
        wanted: usize,
        stack: &mut Vec<NodePair>,
        places: &mut Vec<[u32; 2]>,
    ) -> bool {
        while let Some(pair) = stack.pop() {
            match pair.level.checked_sub(1) {
                None => self.descend(pair, |found| places.push(found)),
                Some(level) => self.descend(pair, |nodes| stack.push(NodePair { level, nodes })),
            }
            if places.len() >= wanted {
                break;
            }
        }
        !places.is_empty()
    }

    /// Calls `found` for the pairs of children of two nodes whose boxes overlap.
    #[inline(always)]
    fn descend(&self, NodePair { level, nodes: [a, b] }: NodePair, mut found: impl FnMut([u32; 2])) {
        let boxes = &self.levels[level as usize];
        let (first, second) = (&boxes[a as usize], &boxes[b as usize]);
        let [first_number, second_number] = [WIDTH as u32 * a, WIDTH as u32 * b];
        if a == b {
            for one in 0..WIDTH as u32 {
                // A triangle makes no pair with itself, a node does.
                let later = ALL << (8 * one) << (if level == 0 { 8 } else { 0 });
                let mut hits = second.overlaps(&first.get(one)) & later;
                while hits != 0 {
                    found([first_number + one, second_number + hits.trailing_zeros() / 8]);
                    hits &= hits - 1;
                }
            }
            return;
        }
        let above = &self.levels[level as usize + 1];
        let around = |node: u32| above[node as usize / WIDTH].get(node % WIDTH as u32);
        let mut ones = first.overlaps(&around(b));
        let others = second.overlaps(&around(a));
        while ones != 0 {
            let one = ones.trailing_zeros() / 8;
            ones &= ones - 1;
            let mut hits = second.overlaps(&first.get(one)) & others;
            while hits != 0 {
                found([first_number + one, second_number + hits.trailing_zeros() / 8]);
                hits &= hits - 1;
            }
        }
    }
}

/// The least significant bit of every byte: all of eight boxes.
const ALL: u64 = 0x0101_0101_0101_0101;

impl Boxes {
    /// Up to eight boxes.
    fn of(boxes: impl Iterator<Item = OneBox>) -> Self {
        let mut eight = Self { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };
        for (lane, one) in boxes.enumerate() {
            for axis in 0..3 {
                eight.min[axis][lane] = one.min[axis];
                eight.max[axis][lane] = one.max[axis];
            }
        }
        eight
    }

    #[inline(always)]
    fn get(&self, lane: u32) -> OneBox {
        let (min, max, lane) = (&self.min, &self.max, lane as usize);
        OneBox { min: [min[0][lane], min[1][lane], min[2][lane]], max: [max[0][lane], max[1][lane], max[2][lane]] }
    }

    /// The box around all eight.
    fn union(&self) -> OneBox {
        let smallest = |numbers: &[f32; WIDTH]| numbers.iter().copied().fold(f32::INFINITY, lesser);
        let largest = |numbers: &[f32; WIDTH]| numbers.iter().copied().fold(f32::NEG_INFINITY, greater);
        OneBox {
            min: [smallest(&self.min[0]), smallest(&self.min[1]), smallest(&self.min[2])],
            max: [largest(&self.max[0]), largest(&self.max[1]), largest(&self.max[2])],
        }
    }

    /// Which of the eight overlap `one`: the least significant bit of a byte each.
    #[inline(always)]
    fn overlaps(&self, one: &OneBox) -> u64 {
        let mut hits = [0_u8; WIDTH];
        for lane in 0..WIDTH {
            let is_hit = (self.min[0][lane] <= one.max[0])
                & (self.min[1][lane] <= one.max[1])
                & (self.min[2][lane] <= one.max[2])
                & (one.min[0] <= self.max[0][lane])
                & (one.min[1] <= self.max[1][lane])
                & (one.min[2] <= self.max[2][lane]);
            hits[lane] = u8::from(is_hit);
        }
        u64::from_le_bytes(hits)
    }
}

impl OneBox {
    fn of([a, b, c]: [[f32; 3]; 3]) -> Self {
        let point = |point| Self { min: point, max: point };
        point(a).union(point(b)).union(point(c))
    }

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self {
            min: [lesser(a.min[0], b.min[0]), lesser(a.min[1], b.min[1]), lesser(a.min[2], b.min[2])],
            max: [greater(a.max[0], b.max[0]), greater(a.max[1], b.max[1]), greater(a.max[2], b.max[2])],
        }
    }
}
