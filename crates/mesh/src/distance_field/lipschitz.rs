//! A bound on the slope of a tricubic B-spline.
//!
//! In Bézier form a polynomial lies within the range of its control values, and the control values of its derivative along an axis
//! are three times the differences of its own along that axis. Halving a cell halves the slack.

use rayon::prelude::*;

use super::Grid;

/// Times that a cell is halved along all axes. More: slower, for a bound a few percent lower.
const HALVINGS: usize = 2;

/// Covers the rounding of the arithmetic below, a few parts in 2²⁴ where it is `f32`.
const ROUNDING: f64 = 1.0 + 1e-5;

/// Control values of a cell, [z][y][x].
type Control = [[[f64; 4]; 4]; 4];

/// Upper bound on the length of the gradient in all cells that have all neighbors and where the spline may be positive.
pub(super) fn lipschitz(grid: &Grid, coefficients: &[f32]) -> f64 {
    let [nx, ny, nz] = grid.dims;
    let steepest = (1..nz.saturating_sub(2))
        .into_par_iter()
        .map(|k| {
            let mut steepest = 0.0;
            for j in 1..ny.saturating_sub(2) {
                for i in 1..nx.saturating_sub(2) {
                    let corner = ((k - 1) * ny + j - 1) * nx + i - 1;
                    let rough = rough_bound(coefficients, corner, nx, nx * ny);
                    if f64::from(rough) * ROUNDING > steepest {
                        let control = bezier(coefficients, corner, nx, nx * ny);
                        steepest = refined_bound(&control, HALVINGS, steepest);
                    }
                }
            }
            steepest
        })
        .reduce(|| 0.0, f64::max);
    steepest.sqrt() / grid.cell * ROUNDING
}

/// Squared bound from the differences of the B-spline coefficients themselves, of which the derivative is a convex combination;
/// zero where all are negative. Cheap, and close where the field is smooth.
fn rough_bound(coefficients: &[f32], corner: usize, row: usize, layer: usize) -> f32 {
    let (mut largest, mut steepest) = (f32::NEG_INFINITY, [0.0_f32; 3]);
    let greater = |a: f32, b: f32| if a > b { a } else { b };
    for k in 0..4 {
        for j in 0..4 {
            let start = corner + k * layer + j * row;
            let line = &coefficients[start..start + 4];
            let above = &coefficients[start + row * usize::from(j < 3)..][..4];
            let behind = &coefficients[start + layer * usize::from(k < 3)..][..4];
            for i in 0..4 {
                largest = greater(largest, line[i]);
                steepest[0] = greater(steepest[0], (line[(i + 1).min(3)] - line[i]).abs());
                steepest[1] = greater(steepest[1], (above[i] - line[i]).abs());
                steepest[2] = greater(steepest[2], (behind[i] - line[i]).abs());
            }
        }
    }
    if largest > 0.0 { steepest.iter().map(|slope| slope * slope).sum() } else { 0.0 }
}

/// The greater of `known` and the squared bound in a cell with these control values.
fn refined_bound(control: &Control, halvings: usize, known: f64) -> f64 {
    // The part is 2^(halvings done) times shorter than the cell, and so are the differences of its control values.
    let parts_along = f64::from(1 << (HALVINGS - halvings));
    let bound = bound(control) * parts_along * parts_along;
    if bound <= known {
        known
    } else if halvings == 0 {
        bound
    } else {
        let parts = [0, 1].map(|z| [0, 1].map(|y| [0, 1].map(|x| half(&half(&half(control, 0, x), 1, y), 2, z))));
        parts.iter().flatten().flatten().fold(known, |known, part| refined_bound(part, halvings - 1, known))
    }
}

/// Squared bound from differences of control values; zero where all are negative.
fn bound(control: &Control) -> f64 {
    let mut steepest = [0.0_f64; 3];
    for (k, j, i) in indices() {
        let here = control[k][j][i];
        let next = [control[k][j][(i + 1).min(3)], control[k][(j + 1).min(3)][i], control[(k + 1).min(3)][j][i]];
        for axis in 0..3 {
            steepest[axis] = steepest[axis].max((next[axis] - here).abs());
        }
    }
    let is_outside = indices().any(|(k, j, i)| control[k][j][i] > 0.0);
    if is_outside { 9.0 * steepest.iter().map(|slope| slope * slope).sum::<f64>() } else { 0.0 }
}

/// The Bézier form of a cell.
fn bezier(coefficients: &[f32], corner: usize, row: usize, layer: usize) -> Control {
    let mut control = [[[0.0; 4]; 4]; 4];
    for (k, j, i) in indices() {
        control[k][j][i] = f64::from(coefficients[corner + k * layer + j * row + i]);
    }
    (0..3).fold(control, |control, axis| {
        along(&control, axis, |[a, b, c, d]| {
            [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
        })
    })
}

/// The lower (0) or upper (1) half of a cell along an axis, by de Casteljau's construction.
fn half(control: &Control, axis: usize, upper: usize) -> Control {
    along(control, axis, |[a, b, c, d]| {
        let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
        let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
        let middle = 0.5 * (abc + bcd);
        if upper == 0 { [a, ab, abc, middle] } else { [middle, bcd, cd, d] }
    })
}

/// Applies `map` to all lines of control values along an axis: 0 for x.
fn along(control: &Control, axis: usize, map: impl Fn([f64; 4]) -> [f64; 4]) -> Control {
    let mut result = *control;
    for u in 0..4 {
        for v in 0..4 {
            let at = |w: usize| [(u, v, w), (u, w, v), (w, u, v)][axis];
            let line = map([0, 1, 2, 3].map(|w| {
                let (k, j, i) = at(w);
                control[k][j][i]
            }));
            for (w, value) in line.into_iter().enumerate() {
                let (k, j, i) = at(w);
                result[k][j][i] = value;
            }
        }
    }
    result
}

fn indices() -> impl Iterator<Item = (usize, usize, usize)> {
    (0..64).map(|n| (n / 16, n / 4 % 4, n % 4))
}
