//! Gaussian convolution of the values of a grid, one axis after the other.

use multiversion::multiversion;
use rayon::prelude::*;

use super::super::layers::rows_across_layers;
use super::lines::extend;
use crate::huge_pages::in_huge_pages;
use crate::{Cancelled, Monitor};

/// Half the length of the kernel, in standard deviations. Larger: more time. Smaller: the kernel
/// ends in a step, which leaves kinks.
pub(super) const CUT: f64 = 3.5;

/// Convolves `values` (x fastest) with a Gaussian of standard deviation `sigma`, in cells.
///
/// Beyond its ends, a line is continued by its first and last slope, so linear functions do not
/// change. Sums are in `f32`, from the center of the kernel outwards.
pub(super) fn gaussian(
    values: &[f32],
    dims: [usize; 3],
    sigma: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<f32>, Cancelled> {
    let weights = weights(sigma);
    let [nx, ny, _] = dims;
    let layer = nx * ny;
    let mut smooth = in_huge_pages(vec![0.0; values.len()]);
    let layers = smooth.par_chunks_mut(layer).zip(values.par_chunks(layer));
    layers.try_for_each_init(Vec::new, |extended, (smooth, values)| {
        for (smooth, row) in smooth.chunks_mut(nx).zip(values.chunks(nx)) {
            extend(row, 1, weights.len() - 1, weights.len() - 1, extended);
            convolve(extended, 1, &weights, smooth);
        }
        extend(smooth, nx, weights.len() - 1, weights.len() - 1, extended);
        convolve(extended, nx, &weights, smooth);
        monitor.check_cancelled()
    })?;
    if dims[2] < 2 {
        return Ok(smooth);
    }
    let groups = rows_across_layers(&mut smooth, dims).into_par_iter();
    groups.try_for_each_init(Default::default, |(lines, extended): &mut (Vec<f32>, Vec<f32>), rows| {
        lines.clear();
        rows.iter().for_each(|row| lines.extend_from_slice(row));
        extend(lines, nx, weights.len() - 1, weights.len() - 1, extended);
        convolve(extended, nx, &weights, lines);
        rows.into_iter().zip(lines.chunks(nx)).for_each(|(row, smooth)| row.copy_from_slice(smooth));
        monitor.check_cancelled()
    })?;
    Ok(smooth)
}

/// Weights of the kernel from its center to one end. With the other end they sum to one.
fn weights(sigma: f64) -> Vec<f32> {
    let radius = (CUT * sigma) as usize;
    let weight = |node: usize| libm::exp(-0.5 * (node as f64 / sigma) * (node as f64 / sigma));
    let sum = 1.0 + 2.0 * (1..=radius).map(weight).sum::<f64>();
    (0..=radius).map(|node| (weight(node) / sum) as f32).collect()
}

/// Sums that are computed together. Larger: they leave the cache of the core. Smaller: more
/// overhead.
const BLOCK: usize = 512;

/// Convolves interleaved lines with a symmetric kernel, given from its center to one end. `extended`
/// holds the lines with as many more values at both ends as the kernel has beside its center.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn convolve(extended: &[f32], width: usize, weights: &[f32], out: &mut [f32]) {
    let radius = weights.len() - 1;
    for (block, out) in out.chunks_mut(BLOCK).enumerate() {
        let center = block * BLOCK + radius * width;
        let shifted = |start: usize| &extended[start..start + out.len()];
        let mut sums = [0.0; BLOCK];
        for (sum, value) in sums.iter_mut().zip(shifted(center)) {
            *sum = weights[0] * value;
        }
        for (offset, weight) in weights.iter().enumerate().skip(1) {
            let (before, after) = (shifted(center - offset * width), shifted(center + offset * width));
            for ((sum, before), after) in sums.iter_mut().zip(before).zip(after) {
                *sum += weight * (before + after);
            }
        }
        out.copy_from_slice(&sums[..out.len()]);
    }
}
