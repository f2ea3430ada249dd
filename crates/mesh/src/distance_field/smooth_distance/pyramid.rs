//! A grid with every second node, and the interpolation back.
//!
//! A Gaussian copy whose standard deviation is at least two cells of the coarser grid is
//! interpolated by polynomials of degree five with an error of 1e-4 of the deviation at most.

use rayon::prelude::*;

use super::super::layers::rows_across_layers;
use super::lines::extend;
use crate::huge_pages::in_huge_pages;
use crate::{Cancelled, Monitor};

/// Every second value along each axis, from the first on, and the size of the coarser grid.
pub(super) fn halved(values: &[f32], [nx, ny, nz]: [usize; 3]) -> (Vec<f32>, [usize; 3]) {
    let dims = [nx, ny, nz].map(|nodes| nodes.div_ceil(2));
    let rows = (0..nz).step_by(2).flat_map(|k| (0..ny).step_by(2).map(move |j| (k * ny + j) * nx));
    let values = rows.flat_map(|row| values[row..][..nx].iter().step_by(2).copied());
    (values.collect(), dims)
}

/// Interpolates `values` on a coarser grid of size `coarse` to the grid of size `fine` that it was
/// [halved] from.
pub(super) fn doubled(
    values: &[f32],
    coarse: [usize; 3],
    fine: [usize; 3],
    monitor: &dyn Monitor,
) -> Result<Vec<f32>, Cancelled> {
    let [nx, ny, nz] = fine;
    let (few, many) = (coarse[0] * coarse[1], nx * ny);
    let mut layers = vec![0.0; many * coarse[2]];
    layers.par_chunks_mut(many).zip(values.par_chunks(few)).try_for_each_init(
        Default::default,
        |(extended, rows): &mut (Vec<f32>, Vec<f32>), (layer, values)| {
            rows.clear();
            rows.resize(nx * coarse[1], 0.0);
            for (row, values) in rows.chunks_mut(nx).zip(values.chunks(coarse[0])) {
                double(values, 1, extended, row);
            }
            double(rows, nx, extended, layer);
            monitor.check_cancelled()
        },
    )?;
    let mut doubled = in_huge_pages(vec![0.0; many * nz]);
    rows_across_layers(&mut doubled, fine).into_par_iter().enumerate().try_for_each_init(
        Default::default,
        |(extended, [lines, doubled]): &mut (Vec<f32>, [Vec<f32>; 2]), (j, rows)| {
            lines.clear();
            (0..coarse[2]).for_each(|k| lines.extend_from_slice(&layers[k * many + j * nx..][..nx]));
            doubled.resize(nx * nz, 0.0);
            double(lines, nx, extended, doubled);
            rows.into_iter().zip(doubled.chunks(nx)).for_each(|(row, doubled)| row.copy_from_slice(doubled));
            monitor.check_cancelled()
        },
    )?;
    Ok(doubled)
}

/// Weights, from the inside out, of the six nodes around the middle of a cell: Lagrange's polynomial
/// of degree five.
const MIDDLE: [f32; 3] = [150.0 / 256.0, -25.0 / 256.0, 3.0 / 256.0];

/// Interpolates interleaved lines: every second value of `out` is a value of `lines`, and the others
/// are between two. `extended` is scratch memory.
fn double(lines: &[f32], width: usize, extended: &mut Vec<f32>, out: &mut [f32]) {
    extend(lines, width, 2, 3, extended);
    for (place, out) in out.chunks_mut(width).enumerate() {
        let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(|node| &extended[(place / 2 + node) * width..][..width]);
        if place % 2 == 0 {
            out.copy_from_slice(c);
        } else {
            for (i, out) in out.iter_mut().enumerate() {
                *out = MIDDLE[0] * (c[i] + d[i]) + MIDDLE[1] * (b[i] + e[i]) + MIDDLE[2] * (a[i] + f[i]);
            }
        }
    }
}
