//! A bound on the slope of a tricubic B-spline.
//!
//! In Bézier form a polynomial lies in the convex hull of its control values, and the control values of its derivative along an axis
//! are three times the differences of its own along that axis. Raised to the same degree along all axes, the three derivatives have
//! control *vectors*, none of which the gradient can exceed in length. Halving a cell leaves a quarter of the slack.

use rayon::prelude::*;

use super::Grid;

/// Times that a cell is halved along all axes. More: slower, for a bound less than a percent lower.
const HALVINGS: usize = 1;

/// Covers the rounding of the arithmetic below.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Cells side by side in a row that are bounded at once.
const LANES: usize = 8;

/// Control values of `N` cells, [z][y][x].
type Control<const N: usize> = [[[[f64; N]; 4]; 4]; 4];

/// Upper bound on the length of the gradient in all cells that have all neighbors and where the spline may be positive.
pub(super) fn lipschitz(grid: &Grid, coefficients: &[f32]) -> f64 {
    let [nx, ny, nz] = grid.dims;
    let steepest = (0..nz.saturating_sub(3))
        .into_par_iter()
        .map(|k| {
            let mut steepest = 0.0;
            for start in (0..ny.saturating_sub(3)).map(|j| (k * ny + j) * nx) {
                for cell in (0..nx.saturating_sub(3)).step_by(LANES) {
                    // Lanes that stick out repeat the last cell of the row.
                    let corners: [usize; LANES] = std::array::from_fn(|lane| start + (cell + lane).min(nx - 4));
                    let control = bezier(coefficients, corners, nx, nx * ny);
                    for (lane, bound) in bounds(&control).into_iter().enumerate() {
                        if bound > steepest {
                            steepest = refined_bound(&one_of(&control, lane), HALVINGS, steepest);
                        }
                    }
                }
            }
            steepest
        })
        .reduce(|| 0.0, f64::max);
    steepest.sqrt() / grid.cell * ROUNDING
}

/// The greater of `known` and the squared bound in a cell with these control values.
fn refined_bound(control: &Control<1>, halvings: usize, known: f64) -> f64 {
    // The part is 2^(halvings done) times shorter than the cell, and so are the differences of its control values.
    let parts_along = f64::from(1 << (HALVINGS - halvings));
    let [bound] = bounds(control).map(|bound| bound * parts_along * parts_along);
    if bound <= known {
        known
    } else if halvings == 0 {
        bound
    } else {
        (0..8).fold(known, |known, part| {
            let part = (0..3).fold(*control, |control, axis| half(&control, axis, part >> axis & 1));
            refined_bound(&part, halvings - 1, known)
        })
    }
}

/// For each lane the largest squared length of a control vector of the gradient; zero where all control values are negative.
fn bounds<const N: usize>(control: &Control<N>) -> [f64; N] {
    let mut squared = [[[[0.0; N]; 4]; 4]; 4];
    for axis in 0..3 {
        let slopes = along(control, axis, |[a, b, c, d]| {
            // Control values of degree two, raised to degree three.
            let (first, second, third) = (3.0 * (b - a), 3.0 * (c - b), 3.0 * (d - c));
            [first, (first + 2.0 * second) / 3.0, (2.0 * second + third) / 3.0, third]
        });
        for (sum, slope) in
            squared.as_flattened_mut().as_flattened_mut().iter_mut().zip(slopes.as_flattened().as_flattened())
        {
            for lane in 0..N {
                sum[lane] += slope[lane] * slope[lane];
            }
        }
    }
    let largest = |control: &Control<N>| {
        control.as_flattened().as_flattened().iter().fold([f64::NEG_INFINITY; N], |mut largest, values| {
            for lane in 0..N {
                largest[lane] = if values[lane] > largest[lane] { values[lane] } else { largest[lane] };
            }
            largest
        })
    };
    let (values, mut bounds) = (largest(control), largest(&squared));
    for lane in 0..N {
        bounds[lane] = if values[lane] > 0.0 { bounds[lane] } else { 0.0 };
    }
    bounds
}

/// The Bézier form of the cells whose first coefficients are at `corners`.
fn bezier<const N: usize>(coefficients: &[f32], corners: [usize; N], row: usize, layer: usize) -> Control<N> {
    let mut control = [[[[0.0; N]; 4]; 4]; 4];
    for (k, plane) in control.iter_mut().enumerate() {
        for (j, line) in plane.iter_mut().enumerate() {
            for (i, values) in line.iter_mut().enumerate() {
                *values = corners.map(|corner| f64::from(coefficients[corner + k * layer + j * row + i]));
            }
        }
    }
    (0..3).fold(control, |control, axis| {
        along(&control, axis, |[a, b, c, d]| {
            [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
        })
    })
}

/// The lower (0) or upper (1) half of a cell along an axis, by de Casteljau's construction.
fn half(control: &Control<1>, axis: usize, upper: usize) -> Control<1> {
    along(control, axis, |[a, b, c, d]| {
        let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
        let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
        let middle = 0.5 * (abc + bcd);
        if upper == 0 { [a, ab, abc, middle] } else { [middle, bcd, cd, d] }
    })
}

/// Applies `map` to all lines of control values along an axis: 0 for x.
#[inline]
fn along<const N: usize>(control: &Control<N>, axis: usize, map: impl Fn([f64; 4]) -> [f64; 4]) -> Control<N> {
    let mut result = [[[[0.0; N]; 4]; 4]; 4];
    for u in 0..4 {
        for v in 0..4 {
            let at = [0, 1, 2, 3].map(|w| [(u, v, w), (u, w, v), (w, u, v)][axis]);
            let line = at.map(|(k, j, i)| &control[k][j][i]);
            let mut mapped = [[0.0; N]; 4];
            for lane in 0..N {
                let values = map(line.map(|values| values[lane]));
                for w in 0..4 {
                    mapped[w][lane] = values[w];
                }
            }
            for ((k, j, i), values) in at.into_iter().zip(mapped) {
                result[k][j][i] = values;
            }
        }
    }
    result
}

fn one_of(control: &Control<LANES>, lane: usize) -> Control<1> {
    control.map(|plane| plane.map(|line| line.map(|values| [values[lane]])))
}
