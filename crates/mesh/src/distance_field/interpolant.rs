mod bounds;
mod columns;
mod kernel;

#[cfg(test)]
mod tests;

use multiversion::{multiversion, target::match_target};
use rayon::prelude::*;

use super::Grid;
use super::lipschitz::lipschitz;
use super::spline::coefficients;
use crate::{Cancelled, DistanceBlock, Monitor, PointBlock};
use kernel::{GridGeometry, Lattice};

/// The cubic spline through the samples of a grid.
#[derive(Debug, Clone)]
pub(super) struct Interpolant {
    /// `None` if no cell has all its neighbors.
    geometry: Option<GridGeometry>,
    coefficients: Vec<f32>,
    lipschitz: f64,
    /// Upper bound on the difference between two coefficients of a stencil.
    spread: f64,
}

/// Bound on the rounding error of values in `f32` lanes, relative to the spread of the coefficients
/// around the point.
///
/// Rounding by u = 2⁻²⁴ moves the four weights along an axis by 17u in total. Each of three sums of
/// products adds 5u or 4u; the first sum is over rounded differences. The total is
/// `3 · 17u + 5u + 4u + 4u`, and a little for second-order terms. Smaller: points could be woken too
/// late. Larger: they are woken needlessly early.
const VALUE_ROUNDING: f64 = 65.0 / (1 << 24) as f64;

impl Interpolant {
    pub(super) fn new(grid: &Grid, samples: &[f32], monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        monitor.check("spline", 0.0)?;
        let coefficients = coefficients(samples, grid.dims, monitor)?;
        monitor.check("spline", 0.5)?;
        let lipschitz = lipschitz(grid, &coefficients, monitor)?;
        let spread = f64::from(largest_difference(&coefficients, grid.dims)) * STENCIL_STEPS;
        Ok(Self { geometry: GridGeometry::new(grid), coefficients, lipschitz, spread })
    }

    pub(super) fn lipschitz(&self) -> f64 {
        self.lipschitz
    }

    /// Computes values and gradients in double precision.
    pub(super) fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        match self.lattice() {
            Some(lattice) => sample_double(&lattice, points, out),
            None => *out = DistanceBlock::FAR,
        }
    }

    /// Upper bound on the difference between values of `sample_single_into` and `sample_into`.
    pub(super) fn single_error(&self) -> f64 {
        VALUE_ROUNDING * self.spread
    }

    /// Computes values and gradients in `f32` lanes.
    pub(super) fn sample_single_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        match self.lattice() {
            Some(lattice) => sample_single(&lattice, points, out),
            None => *out = DistanceBlock::FAR,
        }
    }

    #[inline]
    fn lattice(&self) -> Option<Lattice<'_>> {
        self.geometry.as_ref().map(|geometry| Lattice { geometry, coefficients: &self.coefficients })
    }
}

/// Steps along the axes from one corner of a stencil to the opposite one.
const STENCIL_STEPS: f64 = 9.0;

/// Returns the largest difference between coefficients that are neighbors along an axis.
fn largest_difference(coefficients: &[f32], [nx, ny, _]: [usize; 3]) -> f32 {
    let largest = |one: &[f32], other: &[f32]| {
        one.iter()
            .zip(other)
            .fold(0.0, |largest: f32, (a, b)| if (a - b).abs() > largest { (a - b).abs() } else { largest })
    };
    let rows = coefficients.par_chunks(nx).enumerate().map(|(row, here)| {
        let along_y = if (row + 1) % ny == 0 { here } else { &coefficients[(row + 1) * nx..] };
        let along_z = coefficients.get((row + ny) * nx..).unwrap_or_default();
        largest(here, &here[1..]).max(largest(here, along_y)).max(largest(here, along_z))
    });
    rows.reduce(|| 0.0, f32::max)
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
#[expect(unsafe_code, reason = "rows are loaded by instructions of the target")]
fn sample_single(lattice: &Lattice<'_>, points: &PointBlock, out: &mut DistanceBlock) {
    // SAFETY: the machine has the target's features.
    unsafe {
        match_target! {
            "x86_64+avx512f" => lattice.sample::<f32, columns::Avx512>(points, out),
            "x86_64+avx2" => lattice.sample::<f32, columns::Avx>(points, out),
            "x86_64" => lattice.sample::<f32, columns::Sse>(points, out),
            _ => lattice.sample::<f32, columns::Plain>(points, out),
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
#[expect(unsafe_code, reason = "rows are loaded by instructions of the target")]
fn sample_double(lattice: &Lattice<'_>, points: &PointBlock, out: &mut DistanceBlock) {
    // SAFETY: the machine has the target's features.
    unsafe {
        match_target! {
            "x86_64+avx512f" => lattice.sample::<f64, columns::Avx512>(points, out),
            "x86_64+avx2" => lattice.sample::<f64, columns::Avx>(points, out),
            "x86_64" => lattice.sample::<f64, columns::Sse>(points, out),
            _ => lattice.sample::<f64, columns::Plain>(points, out),
        }
    }
}
