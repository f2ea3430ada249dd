//! Triangles in the order of a space-filling curve (G. Morton, *A Computer Oriented Geodetic Data Base and a New Technique in File
//! Sequencing*, 1966): those that follow each other lie near each other.

use rayon::prelude::*;
use rdst::{RadixKey, RadixSort};

use crate::extremes::{greater, lesser};

/// Triangles in the same cell of the curve's grid at most, before the cell gets a grid of its own. Larger leaves parts of the
/// mesh that are much finer than the rest in no order; smaller spends time on order that eight triangles a box cannot use.
const LARGEST_CELL: usize = 64;

/// Bits of a cell's number along each axis.
const BITS_PER_AXIS: u32 = 10;

/// A triangle with the number of its cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    /// The number along the curve, in the finest grid that was needed here.
    pub(crate) cell: u32,
    pub(crate) triangle: u32,
}

impl RadixKey for Placed {
    const LEVELS: usize = 4;

    fn get_level(&self, level: usize) -> u8 {
        (self.cell >> (8 * level)) as u8
    }
}

/// Triangles with corners at these `points`, in the order of the curve through their centroids.
pub(crate) fn along_morton_curve(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<Placed> {
    let mut placed: Vec<Placed> =
        (0..triangles.len() as u32).into_par_iter().map(|triangle| Placed { cell: 0, triangle }).collect();
    // Sums of three corners, which lie within three times the bounds of all points: those take less time than their own.
    let (min, max) = bounds(points.par_iter().copied());
    sort(&mut placed, [min, max].map(|corner| corner.map(|coordinate| 3.0 * coordinate)), &|triangle: u32| {
        let [a, b, c] = triangles[triangle as usize];
        let (a, b, c) = (points[a as usize], points[b as usize], points[c as usize]);
        [a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]]
    });
    placed
}

fn bounds(points: impl ParallelIterator<Item = [f32; 3]>) -> ([f32; 3], [f32; 3]) {
    let union = |(min, max): ([f32; 3], [f32; 3]), (a, b): ([f32; 3], [f32; 3])| {
        let min = [lesser(min[0], a[0]), lesser(min[1], a[1]), lesser(min[2], a[2])];
        (min, [greater(max[0], b[0]), greater(max[1], b[1]), greater(max[2], b[2])])
    };
    let empty = || ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    points.map(|point| (point, point)).reduce(empty, union)
}

/// Sorts by cells of a grid between two corners.
fn sort(placed: &mut [Placed], [min, max]: [[f32; 3]; 2], center: &(impl Fn(u32) -> [f32; 3] + Sync)) {
    let longest = [0, 1, 2].map(|axis| max[axis] - min[axis]).into_iter().fold(0.0, f32::max);
    let cells = ((1 << BITS_PER_AXIS) - 1) as f32;
    if !(longest > 0.0 && (cells / longest).is_finite()) {
        // All centers are in one place; no order is better than another.
        return;
    }
    let scale = cells / longest;
    placed.par_iter_mut().for_each(|placed| {
        let point = center(placed.triangle);
        let along = |axis: usize| spread(((point[axis] - min[axis]) * scale) as u32);
        placed.cell = along(0) | along(1) << 1 | along(2) << 2;
    });
    placed.radix_sort_unstable();
    for cell in placed.chunk_by_mut(|a, b| a.cell == b.cell).filter(|cell| cell.len() > LARGEST_CELL) {
        let (min, max) = bounds(cell.par_iter().map(|placed| center(placed.triangle)));
        sort(cell, [min, max], center);
    }
}

/// The ten lowest bits, two zeros between each and the next.
fn spread(mut bits: u32) -> u32 {
    bits = (bits | bits << 16) & 0x0300_00ff;
    bits = (bits | bits << 8) & 0x0300_f00f;
    bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}
