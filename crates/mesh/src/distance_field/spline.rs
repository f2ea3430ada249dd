//! Prefiltered tricubic B-splines: from samples to coefficients, and from coefficients to value and
//! gradient.
//!
//! A recursive filter turns samples into the coefficients of the interpolating cubic B-spline, with
//! one pass forward and one backward along each axis (M. Unser, A. Aldroubi, M. Eden, *B-Spline
//! Signal Processing: Part II*, 1993). Samples are mirrored at both ends without repeating the end
//! itself.

use rayon::prelude::*;

use super::layers::rows_across_layers;
use super::real::Real;
use crate::huge_pages::in_huge_pages;
use crate::{Cancelled, Monitor};

/// The pole z of the cubic spline filter, √3 − 2.
const POLE: f64 = -0.267_949_192_431_122_7;

/// Gain of the filter along one axis, (1 − z)(1 − 1/z) = 6.
const GAIN: f64 = 6.0;

/// Terms of the mirrored sum that starts the forward pass. |z|^28 < 1e-16, so more change nothing.
const START_TERMS: usize = 28;

/// Rows along x that are filtered side by side, because each value of a row depends on the one
/// before.
const ROWS: usize = 8;

/// Computes the coefficients of the spline through `samples` (x fastest).
pub(super) fn coefficients(samples: &[f32], dims: [usize; 3], monitor: &dyn Monitor) -> Result<Vec<f32>, Cancelled> {
    let [nx, ny, nz] = dims;
    let layer = nx * ny;
    let mut work = in_huge_pages(vec![0.0; samples.len()]);
    work.par_chunks_mut(layer).zip(samples.par_chunks(layer)).try_for_each(|(work, samples)| {
        let mut rows = vec![0.0; ROWS * nx];
        for (work, samples) in work.chunks_mut(ROWS * nx).zip(samples.chunks(ROWS * nx)) {
            for (row, samples) in samples.chunks(nx).enumerate() {
                rows[row..].iter_mut().step_by(ROWS).zip(samples).for_each(|(to, &from)| *to = f64::from(from));
            }
            filter(&mut rows, ROWS);
            for (row, work) in work.chunks_mut(nx).enumerate() {
                work.iter_mut().zip(rows[row..].iter().step_by(ROWS)).for_each(|(to, &from)| *to = from);
            }
        }
        filter(work, nx);
        monitor.check_cancelled()
    })?;
    monitor.check("spline", 0.25)?;
    // Along z the lines cross all layers. Each task takes those of one row along x, copied out and
    // back.
    let mut coefficients = in_huge_pages(vec![0.0; samples.len()]);
    rows_across_layers(&mut coefficients, dims).into_par_iter().enumerate().for_each_init(
        Vec::new,
        |lines, (j, rows)| {
            lines.clear();
            (0..nz).for_each(|k| lines.extend_from_slice(&work[k * layer + j * nx..][..nx]));
            filter(lines, nx);
            for (out, line) in rows.into_iter().zip(lines.chunks(nx)) {
                out.iter_mut().zip(line).for_each(|(out, &value)| *out = value as f32);
            }
        },
    );
    Ok(coefficients)
}

/// Filters `width` interleaved lines at once. The samples of each line are `width` apart.
fn filter(lines: &mut [f64], width: usize) {
    let length = lines.len() / width;
    if length < 2 {
        return;
    }
    lines.iter_mut().for_each(|value| *value *= GAIN);

    // The first forward value is the sum of z^k s[k] over the mirrored line.
    let last = length - 1;
    let period = 2 * last;
    let mut start = vec![0.0; width];
    let mut power = 1.0;
    for term in 0..START_TERMS {
        let sample = term % period;
        let sample = if sample > last { period - sample } else { sample };
        for (sum, value) in start.iter_mut().zip(&lines[sample * width..]) {
            *sum += power * value;
        }
        power *= POLE;
    }
    lines[..width].copy_from_slice(&start);
    // Forward pass: c⁺[i] = s[i] + z c⁺[i − 1].
    for i in 1..length {
        let (before, here) = lines.split_at_mut(i * width);
        for (here, before) in here[..width].iter_mut().zip(&before[(i - 1) * width..]) {
            *here += POLE * before;
        }
    }
    // The mirror condition gives the last coefficient.
    let (before, end) = lines.split_at_mut(last * width);
    for (end, before) in end.iter_mut().zip(&before[(last - 1) * width..]) {
        *end = POLE / (POLE * POLE - 1.0) * (*end + POLE * before);
    }
    // Backward pass: c[i] = z (c[i + 1] − c⁺[i]).
    for i in (0..last).rev() {
        let (here, after) = lines.split_at_mut((i + 1) * width);
        for (here, after) in here[i * width..].iter_mut().zip(&after[..width]) {
            *here = POLE * (after - *here);
        }
    }
}

/// Weights of the four coefficients around `t`, the fraction of the cell from 0 to 1.
#[inline(always)]
pub(super) fn weights<T: Real>(t: T) -> [T; 4] {
    let [half, sixth, two_thirds] = [0.5, 1.0 / 6.0, 2.0 / 3.0].map(T::of);
    let s = T::of(1.0) - t;
    let first = s * s * s * sixth;
    let last = t * t * t * sixth;
    let second = two_thirds - half * t * t * (T::of(1.0) + s);
    // The weights sum to one even after rounding, so a constant is reproduced exactly.
    [first, second, T::of(1.0) - first - second - last, last]
}

/// Derivatives of [`weights`] with respect to `t`.
#[inline(always)]
pub(super) fn weight_derivatives<T: Real>(t: T) -> [T; 4] {
    let half = T::of(0.5);
    let s = T::of(1.0) - t;
    let first = -half * s * s;
    let last = half * t * t;
    let second = t * (T::of(1.5) * t - T::of(2.0));
    [first, second, -(first + second + last), last]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoProgress;

    fn samples(count: usize) -> Vec<f32> {
        // Numbers without structure: fractional parts of multiples of an irrational number.
        (1..=count).map(|i| (i as f32 * 0.618_034).fract() - 0.5).collect()
    }

    #[test]
    fn spline_interpolates_the_samples() {
        for dims in [[7, 6, 5], [2, 9, 3], [1, 1, 8], [40, 3, 2]] {
            let samples = samples(dims.iter().product());
            let coefficients = coefficients(&samples, dims, &NoProgress).unwrap();
            let [nx, ny, nz] = dims;
            // At a node the weights are 1/6, 4/6, 1/6 along each axis, mirrored at the ends.
            let at = |i: isize, nodes: usize| {
                if nodes == 1 {
                    0
                } else {
                    let i = i.unsigned_abs();
                    if i < nodes { i } else { 2 * nodes - 2 - i }
                }
            };
            for k in 0..nz as isize {
                for j in 0..ny as isize {
                    for i in 0..nx as isize {
                        let mut sum = 0.0;
                        for (dk, wk) in [(-1, 1.0), (0, 4.0), (1, 1.0)] {
                            for (dj, wj) in [(-1, 1.0), (0, 4.0), (1, 1.0)] {
                                for (di, wi) in [(-1, 1.0), (0, 4.0), (1, 1.0)] {
                                    let index = (at(k + dk, nz) * ny + at(j + dj, ny)) * nx + at(i + di, nx);
                                    sum += wk * wj * wi / 216.0 * f64::from(coefficients[index]);
                                }
                            }
                        }
                        let sample = f64::from(samples[(k as usize * ny + j as usize) * nx + i as usize]);
                        // Coefficients of up to about 0.5 · 3³ are rounded to f32: 27 · 2⁻²⁴ / 2 at most.
                        assert!((sum - sample).abs() < 1e-6, "{dims:?} at {i} {j} {k}: {sum} {sample}");
                    }
                }
            }
        }
    }
}
