//! An upper bound on the slope of a tricubic B-spline.
//!
//! A polynomial in Bézier form is in the convex hull of its control values. The control values of
//! its derivative along an axis are three times the differences of its own along that axis. With
//! all three derivatives raised to the same degree, the gradient has control *vectors*, and it is
//! not longer than the longest of them. Halving a cell reduces the slack to a quarter.
//!
//! All cells are bounded in `f32`, several of a row at once. Then those that may be steepest are
//! halved and bounded in `f64`.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use multiversion::multiversion;
use rayon::prelude::*;

use super::Grid;
use super::real::Real;
use crate::extremes::{max, min};
use crate::huge_pages::in_huge_pages;
use crate::{Cancelled, Monitor};

/// Covers the rounding of the arithmetic in `f64`.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Bound on the rounding error of the length of a gradient in `f32` lanes, relative to the largest
/// difference between two coefficients of the cell.
///
/// Let u = 2⁻²⁴. A control value is off by 13u: the difference from the base, and three conversions
/// of 4u each. A slope is off by six times that plus 7u, and the length by √3 times as much.
/// Smaller: the steepest cell could be missed. Larger: more cells are halved.
const SLOPE_ROUNDING: f32 = 160.0 / (1 << 24) as f32;

/// Cells of a row that are bounded at once.
const LANES: usize = 16;

/// Control values of `N` cells, indexed by z, y and x.
type Control<T, const N: usize> = [[[[T; N]; 4]; 4]; 4];

/// Upper bound on the length of the gradient in all cells that have all neighbors and in which the
/// spline may be positive.
pub(super) fn lipschitz(grid: &Grid, coefficients: &[f32], monitor: &dyn Monitor) -> Result<f64, Cancelled> {
    let [nx, ny, nz] = grid.dims;
    if nx < 4 || ny < 4 || nz < 4 {
        return Ok(0.0);
    }
    let layer = nx * ny;
    let mut bounds = in_huge_pages(vec![0.0; layer * (nz - 3)]);
    // The largest bound found so far, as bits; bits of positive numbers are ordered like the
    // numbers. The timing of threads decides which cells are skipped, but a skipped cell never
    // exceeds the final maximum.
    let known = AtomicU64::new(0);
    let refine = |cell: usize| {
        known.fetch_max(halved_bound(&coefficients[cell..], nx, layer).to_bits(), Relaxed);
    };
    bounds.par_chunks_mut(layer).enumerate().try_for_each(|(k, bounds)| {
        let steepest = bound_layer(&coefficients[k * layer..], nx, bounds);
        refine(k * layer + steepest);
        monitor.check_cancelled()
    })?;
    bounds.par_iter().enumerate().for_each(|(cell, &bound)| {
        if f64::from(bound) > f64::from_bits(known.load(Relaxed)) {
            refine(cell);
        }
    });
    Ok(f64::from_bits(known.into_inner()).sqrt() / grid.cell * ROUNDING)
}

/// Sets squared bounds on the gradient in the cells of a layer; zero where the spline is not
/// positive. `coefficients` begins with the first coefficient of the layer. Returns the cell with
/// the largest bound.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn bound_layer(coefficients: &[f32], nx: usize, bounds: &mut [f32]) -> usize {
    let layer = bounds.len();
    let (mut steepest, mut greatest) = (0, 0.0);
    for row in (0..layer - 3 * nx).step_by(nx) {
        for first in (0..nx - 3).step_by(LANES) {
            let count = (nx - first).min(LANES + 3);
            let line = |number: usize| &coefficients[row + number / 4 * layer + number % 4 * nx + first..][..count];
            let found = if count == LANES + 3 {
                bound_cells(&std::array::from_fn(|number| line(number).first_chunk().expect("as many")), greatest)
            } else {
                // Repeat the last coefficient past the end of the row.
                let ended: [[f32; LANES + 3]; 16] =
                    std::array::from_fn(|number| std::array::from_fn(|i| line(number)[i.min(count - 1)]));
                bound_cells(&ended.each_ref(), greatest)
            };
            let cells = count - 3;
            bounds[row + first..][..cells].copy_from_slice(&found[..cells]);
            let largest = found.iter().fold(0.0, |largest, &bound| max(largest, bound));
            if largest > greatest {
                let cell = found[..cells].iter().position(|&bound| bound == largest);
                cell.inspect(|cell| (steepest, greatest) = (row + first + cell, largest));
            }
        }
    }
    steepest
}

/// Squared bounds for the cells along 16 lines of coefficients, four lines for each of four layers.
/// Bounds that do not exceed `known` need not be tight.
#[inline(always)]
fn bound_cells(lines: &[&[f32; LANES + 3]; 16], known: f32) -> [f32; LANES] {
    // Minima and maxima of the columns, in two overlapping parts, each as long as a vector.
    let parts = [0, 3].map(|column| *from_column(lines[0], column));
    let (mut least, mut greatest) = (parts, parts);
    for line in &lines[1..] {
        for (part, column) in [0, 3].into_iter().enumerate() {
            let values = from_column(line, column);
            for i in 0..LANES {
                least[part][i] = min(least[part][i], values[i]);
                greatest[part][i] = max(greatest[part][i], values[i]);
            }
        }
    }
    let joined = |[first, last]: [[f32; LANES]; 2]| {
        let mut line = [0.0; LANES + 3];
        line[..LANES].copy_from_slice(&first);
        line[3..].copy_from_slice(&last);
        line
    };
    let (least, greatest) = (joined(least), joined(greatest));
    let [l0, l1, l2, l3] = [0, 1, 2, 3].map(|column| from_column(&least, column));
    let [g0, g1, g2, g3] = [0, 1, 2, 3].map(|column| from_column(&greatest, column));
    let (mut ranges, mut bounds) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        let least = min(min(l0[i], l1[i]), min(l2[i], l3[i]));
        let greatest = max(max(g0[i], g1[i]), max(g2[i], g3[i]));
        ranges[i] = if greatest > 0.0 { greatest - least } else { 0.0 };
        // The slope along an axis cannot exceed the range.
        bounds[i] = 3.0 * ranges[i] * ranges[i] * (1.0 + SLOPE_ROUNDING);
    }
    if bounds.iter().all(|&bound| bound <= known) {
        return bounds;
    }
    // Differences of similar numbers are exact or nearly so.
    let base = from_column(lines[5], 1);
    let mut control = [[[[0.0; LANES]; 4]; 4]; 4];
    for (control, line) in control.as_flattened_mut().iter_mut().zip(lines) {
        for (column, control) in control.iter_mut().enumerate() {
            let values = from_column(line, column);
            for i in 0..LANES {
                control[i] = values[i] - base[i];
            }
        }
    }
    let slopes = squared_slopes(&to_bezier(&control));
    for i in 0..LANES {
        let bound = slopes[i].sqrt() + SLOPE_ROUNDING * ranges[i];
        bounds[i] = if ranges[i] > 0.0 { bound * bound } else { 0.0 };
    }
    bounds
}

/// Returns the columns of a line from `column` on.
#[inline(always)]
fn from_column(line: &[f32; LANES + 3], column: usize) -> &[f32; LANES] {
    line[column..].first_chunk().expect("a column of the first cell")
}

/// Squared bound in the cell that begins with the first of these coefficients: the maximum over its
/// eight octants. Zero where the spline is not positive.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn halved_bound(coefficients: &[f32], row: usize, layer: usize) -> f64 {
    let mut control = [[[[0.0; 8]; 4]; 4]; 4];
    for (number, control) in control.as_flattened_mut().iter_mut().enumerate() {
        let start = number / 4 * layer + number % 4 * row;
        for (control, &coefficient) in control.iter_mut().zip(&coefficients[start..start + 4]) {
            *control = [f64::from(coefficient); 8];
        }
    }
    let halves = half::<2>(&half::<1>(&half::<0>(&to_bezier(&control))));
    let mut greatest = [f64::NEG_INFINITY; 8];
    for values in halves.as_flattened().as_flattened() {
        for i in 0..8 {
            greatest[i] = max(greatest[i], values[i]);
        }
    }
    // An octant is half as long as the cell. Its control values differ by half as much, hence the
    // factor 2² = 4.
    let slopes = squared_slopes(&halves);
    (0..8).fold(0.0, |bound, i| if greatest[i] > 0.0 { max(bound, 4.0 * slopes[i]) } else { bound })
}

/// The largest squared length of a control vector of the gradient, for each lane.
#[inline(always)]
fn squared_slopes<T: Real, const N: usize>(control: &Control<T, N>) -> [T; N] {
    let [two, three, third] = [2.0, 3.0, 1.0 / 3.0].map(T::of);
    let slopes = |_, [a, b, c, d]: [T; 4]| {
        // Control values of degree two, raised to degree three.
        let (first, second, last) = (three * (b - a), three * (c - b), three * (d - c));
        [first, (first + two * second) * third, (two * second + last) * third, last]
    };
    let (x, y, z) =
        (along::<T, N, 0>(control, slopes), along::<T, N, 1>(control, slopes), along::<T, N, 2>(control, slopes));
    let mut largest = [T::ZERO; N];
    for k in 0..4 {
        for j in 0..4 {
            for i in 0..4 {
                let (x, y, z) = (&x[k][j][i], &y[k][j][i], &z[k][j][i]);
                for lane in 0..N {
                    let squared = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
                    largest[lane] = max(largest[lane], squared);
                }
            }
        }
    }
    largest
}

/// Converts B-spline coefficients of cells to Bézier form.
#[inline(always)]
fn to_bezier<T: Real, const N: usize>(control: &Control<T, N>) -> Control<T, N> {
    let [two, four, third, sixth] = [2.0, 4.0, 1.0 / 3.0, 1.0 / 6.0].map(T::of);
    let convert = |_, [a, b, c, d]: [T; 4]| {
        [(a + four * b + c) * sixth, (two * b + c) * third, (b + two * c) * third, (b + four * c + d) * sixth]
    };
    along::<T, N, 2>(&along::<T, N, 1>(&along::<T, N, 0>(control, convert), convert), convert)
}

/// Halves cells along an axis by de Casteljau's construction. A lane gets the upper half if its
/// number has the bit of the axis set, and the lower half otherwise.
#[inline(always)]
fn half<const AXIS: usize>(control: &Control<f64, 8>) -> Control<f64, 8> {
    along::<f64, 8, AXIS>(control, |lane, [a, b, c, d]| {
        let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
        let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
        let middle = 0.5 * (abc + bcd);
        if lane >> AXIS & 1 == 0 { [a, ab, abc, middle] } else { [middle, bcd, cd, d] }
    })
}

/// Applies `map` to all lines of control values along an axis (0 for x). Its first argument is the
/// lane.
#[inline(always)]
fn along<T: Real, const N: usize, const AXIS: usize>(
    control: &Control<T, N>,
    map: impl Fn(usize, [T; 4]) -> [T; 4],
) -> Control<T, N> {
    let mut result = [[[[T::ZERO; N]; 4]; 4]; 4];
    for u in 0..4 {
        for v in 0..4 {
            let at = |w: usize| match AXIS {
                0 => [u, v, w],
                1 => [u, w, v],
                _ => [w, u, v],
            };
            for lane in 0..N {
                let of = |w: usize| {
                    let [k, j, i] = at(w);
                    control[k][j][i][lane]
                };
                let mapped = map(lane, [of(0), of(1), of(2), of(3)]);
                for w in 0..4 {
                    let [k, j, i] = at(w);
                    result[k][j][i][lane] = mapped[w];
                }
            }
        }
    }
    result
}
