//! Triangles in the order of a space-filling curve, in which neighbors are close to each other.
//!
//! G. Morton, *A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing*, 1966.

use rayon::prelude::*;
use rdst::{RadixKey, RadixSort};

use crate::extremes::{max, min};

/// Maximum number of triangles in a cell before the cell gets a grid of its own. Larger: parts of
/// the mesh that are much finer than the rest stay unordered. Smaller: time is spent on an order
/// finer than boxes of eight triangles can use.
const LARGEST_CELL: usize = 64;

/// Bits of a cell number along each axis.
const BITS_PER_AXIS: u32 = 10;

/// A triangle with its cell number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MortonKey {
    /// The number along the curve, in the finest grid that contains the triangle.
    pub(crate) cell: u32,
    pub(crate) triangle: u32,
}

impl RadixKey for MortonKey {
    const LEVELS: usize = 4;

    fn get_level(&self, level: usize) -> u8 {
        (self.cell >> (8 * level)) as u8
    }
}

/// Returns the triangles over `points` in the order of the curve through their centroids.
pub(crate) fn along_morton_curve(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<MortonKey> {
    let mut keys: Vec<MortonKey> =
        (0..triangles.len() as u32).into_par_iter().map(|triangle| MortonKey { cell: 0, triangle }).collect();
    // Use sums of three corners instead of centroids. The sums are within three times the bounds of
    // the points, which are computed faster than the bounds of the sums.
    let (min, max) = bounds(points.par_iter().copied());
    sort(&mut keys, [min, max].map(|corner| corner.map(|coordinate| 3.0 * coordinate)), &|triangle: u32| {
        let [a, b, c] = triangles[triangle as usize];
        let (a, b, c) = (points[a as usize], points[b as usize], points[c as usize]);
        [a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]]
    });
    keys
}

fn bounds(points: impl ParallelIterator<Item = [f32; 3]>) -> ([f32; 3], [f32; 3]) {
    let union = |(low, high): ([f32; 3], [f32; 3]), (a, b): ([f32; 3], [f32; 3])| {
        let low = [min(low[0], a[0]), min(low[1], a[1]), min(low[2], a[2])];
        (low, [max(high[0], b[0]), max(high[1], b[1]), max(high[2], b[2])])
    };
    let empty = || ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    points.map(|point| (point, point)).reduce(empty, union)
}

/// Sorts by cells of a grid between two corners.
fn sort(keys: &mut [MortonKey], [min, max]: [[f32; 3]; 2], center: &(impl Fn(u32) -> [f32; 3] + Sync)) {
    let longest = [0, 1, 2].map(|axis| max[axis] - min[axis]).into_iter().fold(0.0, f32::max);
    let cells = ((1 << BITS_PER_AXIS) - 1) as f32;
    if !(longest > 0.0 && (cells / longest).is_finite()) {
        // All centers coincide, so every order is equally good.
        return;
    }
    let scale = cells / longest;
    keys.par_iter_mut().for_each(|key| {
        let point = center(key.triangle);
        let along = |axis: usize| spread(((point[axis] - min[axis]) * scale) as u32);
        key.cell = along(0) | along(1) << 1 | along(2) << 2;
    });
    keys.radix_sort_unstable();
    // Refine cells with too many triangles by a grid of their own.
    for cell in keys.chunk_by_mut(|a, b| a.cell == b.cell).filter(|cell| cell.len() > LARGEST_CELL) {
        let (min, max) = bounds(cell.par_iter().map(|key| center(key.triangle)));
        sort(cell, [min, max], center);
    }
}

/// Spreads the ten lowest bits, with two zeros between neighbors.
fn spread(mut bits: u32) -> u32 {
    bits = (bits | bits << 16) & 0x0300_00ff;
    bits = (bits | bits << 8) & 0x0300_f00f;
    bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}
