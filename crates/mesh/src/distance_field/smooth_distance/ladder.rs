//! The ladder of Gaussian copies and their blend.

use rayon::prelude::*;

use super::gaussian::{CUT, gaussian};
use super::pyramid::{doubled, halved};
use crate::huge_pages::in_huge_pages;
use crate::{Cancelled, Monitor};

/// Largest distance a, as a fraction of the support. Larger: kinks near the surface of the tool
/// stay longer. Smaller: kinks at the end of the support stay sharp.
const WIDEST: f64 = 1.0 / 3.0;

/// Smallest distance a, in cells. Larger: kinks near the surface stay on coarse grids only, so a print
/// depends on the resolution. Smaller: samples at the surface change, and the shape with them.
const NARROWEST_CELLS: f64 = 1.0;

/// Width σ of a copy, in units of its distance a. Larger: the fingers of a hand merge into one
/// print. Smaller: kinks show as teeth.
const WIDTH: f64 = 0.4;

/// Variance of the hat function that interpolates linearly between samples, in squared cells. With
/// it, a copy is the Gaussian of the interpolated distance, which hardly depends on the grid. Larger:
/// the narrowest copies of a coarse grid are too wide. Smaller: they are too narrow, and kinks near
/// the surface are sharper than on a fine grid.
const HAT_VARIANCE: f64 = 1.0 / 6.0;

/// Width, in cells of a grid, from which every second node carries the copy. Larger: more time.
/// Smaller: the interpolation between the nodes shows, see [`pyramid`](super::pyramid).
const COARSENED: f64 = 2.0;

/// A Gaussian copy of the distance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Level {
    /// Distance a: the weight of the copy rises from 0 to 1 where the copy is between a and 2a.
    distance: f64,
    /// Standard deviation, in cells.
    sigma: f64,
}

/// The levels of a distance, from the smallest to the largest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ladder {
    levels: Vec<Level>,
    cell: f64,
}

impl Ladder {
    /// The levels for a support and a cell, both in model units. Empty if the cell is too large.
    pub(super) fn new(support: f64, cell: f64) -> Self {
        let halvings = std::iter::successors(Some(WIDEST * support), |distance| Some(0.5 * distance));
        let mut levels: Vec<Level> = halvings
            .take_while(|&distance| distance >= NARROWEST_CELLS * cell)
            .map(|distance| {
                let sigma = WIDTH * distance / cell;
                Level { distance, sigma: (sigma * sigma + HAT_VARIANCE).sqrt() }
            })
            .collect();
        levels.reverse();
        Self { levels, cell }
    }

    /// Distance from a node of the farthest sample that influences it, model units.
    pub(super) fn width(&self) -> f64 {
        self.levels.last().map_or(0.0, |level| CUT * level.sigma * self.cell)
    }

    /// The blend D of the copies of `samples` (x fastest).
    pub(super) fn smoothed(
        &self,
        samples: Vec<f32>,
        dims: [usize; 3],
        monitor: &dyn Monitor,
    ) -> Result<Vec<f32>, Cancelled> {
        // Twice the width from which the next copy needs only every second node.
        let narrow = self.levels.partition_point(|level| level.sigma < 2.0 * COARSENED);
        let (narrow, wide) = self.levels.split_at(narrow);
        let mut progress = Progress { monitor, levels: self.levels.len(), done: 0 };
        progress.next()?;
        let mut blend = in_huge_pages(samples.clone());
        let mut copy = Vec::new();
        for level in narrow {
            copy = gaussian(&samples, dims, level.sigma, monitor)?;
            mix(&mut blend, &copy, level.distance);
            progress.next()?;
        }
        drop(samples);
        // The copies of a pyramid: each is the Gaussian of the one before, at every second node.
        let mut dims = vec![dims];
        let mut sigma = narrow.last().map_or(0.0, |level| level.sigma);
        for level in wide {
            let coarse;
            (copy, coarse) = halved(&copy, dims[dims.len() - 1]);
            // Variances add up.
            let added = (level.sigma * level.sigma - sigma * sigma).sqrt() / (1_u64 << dims.len()) as f64;
            copy = gaussian(&copy, coarse, added, monitor)?;
            let mut full = copy.clone();
            let mut full_dims = coarse;
            for &finer in dims.iter().rev() {
                full = doubled(&full, full_dims, finer, monitor)?;
                full_dims = finer;
            }
            mix(&mut blend, &full, level.distance);
            dims.push(coarse);
            sigma = level.sigma;
            progress.next()?;
        }
        Ok(blend)
    }

    /// Like [`smoothed`](Self::smoothed), with all copies on the grid itself.
    #[cfg(test)]
    pub(super) fn smoothed_at_all_nodes(&self, samples: &[f32], dims: [usize; 3]) -> Vec<f32> {
        let mut blend = samples.to_vec();
        for level in &self.levels {
            let copy = gaussian(samples, dims, level.sigma, &crate::NoProgress).expect("nothing cancels");
            mix(&mut blend, &copy, level.distance);
        }
        blend
    }
}

/// Reports completed levels.
struct Progress<'a> {
    monitor: &'a dyn Monitor,
    levels: usize,
    done: usize,
}

impl Progress<'_> {
    fn next(&mut self) -> Result<(), Cancelled> {
        let done = self.done as f64 / self.levels.max(1) as f64;
        self.done += 1;
        self.monitor.check("smoothing", done)
    }
}

/// Moves each value of `blend` towards that of `copy`, all the way where the copy is at least twice
/// the `distance`.
fn mix(blend: &mut [f32], copy: &[f32], distance: f64) {
    blend.par_chunks_mut(MIXED).zip(copy.par_chunks(MIXED)).for_each(|(blend, copy)| {
        for (blend, &copy) in blend.iter_mut().zip(copy) {
            // In double precision, because a tiny distance has no reciprocal in single precision.
            let t = ((f64::from(copy) - distance) / distance).clamp(0.0, 1.0);
            *blend += (t * t * (3.0 - 2.0 * t)) as f32 * (copy - *blend);
        }
    });
}

/// Values per task of [`mix`]. Larger: threads wait for the last task. Smaller: more overhead.
const MIXED: usize = 1 << 16;
