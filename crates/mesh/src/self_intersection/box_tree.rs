//! A hierarchy of boxes that is searched against itself.
//!
//! Triangles are sorted along a space-filling curve (G. Morton, *A Computer Oriented Geodetic Data
//! Base and a New Technique in File Sequencing*, 1966). Every eight consecutive triangles have a
//! common box, and so do every eight consecutive boxes, level by level. So nodes need no pointers,
//! and one box is compared with eight at once.

use glam::DVec3;
use rayon::prelude::*;

use crate::bvh::UnitFrame;
use crate::extremes::{max, min};
use crate::morton_order::along_morton_curve;

/// Number of boxes per box of the next level.
pub(super) const WIDTH: usize = 8;

/// Eight boxes. Unused boxes overlap nothing.
///
/// Corners are rounded to the nearest number, which preserves the order of coordinates. So boxes
/// that are disjoint after rounding are disjoint.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Boxes {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
}

/// A single box.
#[derive(Debug, Clone, Copy)]
struct OneBox {
    min: [f32; 3],
    max: [f32; 3],
}

/// A hierarchy of boxes with eight children per node.
#[derive(Debug)]
pub(super) struct BoxTree {
    /// The triangle in each slot along the curve.
    pub(super) order: Vec<u32>,
    /// Boxes of the triangles in groups of eight, then the boxes around these, up to a level of
    /// one.
    levels: Vec<Vec<Boxes>>,
}

/// Two nodes of one level whose boxes overlap, in ascending order. Both may be the same node.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodePair {
    level: u32,
    nodes: [u32; 2],
}

impl BoxTree {
    /// Builds the hierarchy of at least one triangle over finite points.
    pub(super) fn new(points: &[DVec3], triangles: &[[u32; 3]], frame: &UnitFrame) -> Self {
        let rounded: Vec<[f32; 3]> = points
            .par_iter()
            .map(|&point| {
                let point = frame.to_unit(point);
                [point.x as f32, point.y as f32, point.z as f32]
            })
            .collect();
        let box_of = |triangle: u32| {
            let [a, b, c] = triangles[triangle as usize];
            OneBox::of([rounded[a as usize], rounded[b as usize], rounded[c as usize]])
        };
        let order = along_morton_curve(&rounded, triangles).into_iter().map(|key| key.triangle).collect::<Vec<_>>();
        let first =
            order.par_chunks(WIDTH).map(|eight| Boxes::of(eight.iter().map(|&triangle| box_of(triangle)))).collect();
        let mut levels: Vec<Vec<Boxes>> = vec![first];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            levels.push(below.par_chunks(WIDTH).map(|eight| Boxes::of(eight.iter().map(Boxes::union))).collect());
        }
        Self { order, levels }
    }

    /// Returns pairs of nodes that cover all pairs of triangles with overlapping boxes. Continues
    /// until there are `target` pairs, if there are as many.
    pub(super) fn node_pairs(&self, target: usize) -> Vec<NodePair> {
        let mut pairs = vec![NodePair { level: self.levels.len() as u32 - 1, nodes: [0, 0] }];
        while pairs.len() < target && pairs[0].level > 0 {
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

    /// Takes node pairs from the `stack` and appends the slots of triangle pairs below them whose
    /// boxes overlap, until there are `target` or a few more. Returns false if there are none.
    #[inline(always)]
    pub(super) fn overlapping_pairs(
        &self,
        target: usize,
        stack: &mut Vec<NodePair>,
        slots: &mut Vec<[u32; 2]>,
    ) -> bool {
        while let Some(pair) = stack.pop() {
            match pair.level.checked_sub(1) {
                None => self.descend(pair, |found| slots.push(found)),
                Some(level) => self.descend(pair, |nodes| stack.push(NodePair { level, nodes })),
            }
            if slots.len() >= target {
                break;
            }
        }
        !slots.is_empty()
    }

    /// Calls `found` for the pairs of children of two nodes whose boxes overlap.
    #[inline(always)]
    fn descend(&self, NodePair { level, nodes: [a, b] }: NodePair, mut found: impl FnMut([u32; 2])) {
        let boxes = &self.levels[level as usize];
        let (first, second) = (&boxes[a as usize], &boxes[b as usize]);
        let [first_number, second_number] = [WIDTH as u32 * a, WIDTH as u32 * b];
        if a == b {
            for one in 0..WIDTH as u32 {
                // A node forms a pair with itself, but a triangle does not.
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
        // Skip children of one node that do not overlap the box around the other.
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

/// The least significant bit of every byte, which selects all eight boxes.
const ALL: u64 = 0x0101_0101_0101_0101;

impl Boxes {
    /// Packs up to eight boxes.
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
        let smallest = |numbers: &[f32; WIDTH]| numbers.iter().copied().fold(f32::INFINITY, min);
        let largest = |numbers: &[f32; WIDTH]| numbers.iter().copied().fold(f32::NEG_INFINITY, max);
        OneBox {
            min: [smallest(&self.min[0]), smallest(&self.min[1]), smallest(&self.min[2])],
            max: [largest(&self.max[0]), largest(&self.max[1]), largest(&self.max[2])],
        }
    }

    /// Tests the eight boxes against `one`. The result is the least significant bit of each byte.
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
            min: [min(a.min[0], b.min[0]), min(a.min[1], b.min[1]), min(a.min[2], b.min[2])],
            max: [max(a.max[0], b.max[0]), max(a.max[1], b.max[1]), max(a.max[2], b.max[2])],
        }
    }
}
