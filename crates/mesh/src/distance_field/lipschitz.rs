//! A bound on the slope of a tricubic B-spline.
//!
//! In Bézier form a polynomial lies in the convex hull of its control values, and the control values of its derivative along an axis
//! are three times the differences of its own along that axis. Raised to the same degree along all axes, the three derivatives have
//! control *vectors*, none of which the gradient can exceed in length. Halving a cell leaves a quarter of the slack.

//!
//! Few cells need that. Along an axis the control values of the derivative are means of the differences of the coefficients, so
//! that the greatest differences along the three axes bound the gradient too, for whole rows of cells at once.

use multiversion::multiversion;
use rayon::prelude::*;

use super::Grid;
use crate::extremes::greater;

/// Times that a cell is halved along all axes. More: slower, for a bound less than a percent lower.
const HALVINGS: usize = 1;

/// Covers the rounding of the arithmetic below.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Covers the rounding of differences of `f32` and of their squares. Smaller than 6 · 2⁻²⁴: the steepest cell could be missed.
const DIFFERENCE_ROUNDING: f32 = 1.0 + 1e-6;

/// Cells that are bounded at once.
const LANES: usize = 8;

/// Control values of `N` cells, [z][y][x].
type Control<const N: usize> = [[[[f64; N]; 4]; 4]; 4];

/// Upper bound on the length of the gradient in all cells that have all neighbors and where the spline may be positive.
pub(super) fn lipschitz(grid: &Grid, coefficients: &[f32]) -> f64 {
    let [nx, ny, nz] = grid.dims;
    if nx < 4 {
        return 0.0;
    }
    let row_starts = |layer: usize| (0..ny.saturating_sub(3)).map(move |row| (layer * ny + row) * nx);
    let layers = (0..nz.saturating_sub(3)).into_par_iter();

    // The steepest cell of each layer by the quick bound is nearly the steepest; then only its rivals need a look.
    let known = (layers.clone())
        .map_init(Differences::default, |differences, layer| {
            let mut steepest = (0.0, 0);
            for start in row_starts(layer) {
                row_bounds(&coefficients[start..], [nx, ny], differences);
                for (cell, &bound) in differences.bounds.iter().enumerate() {
                    if bound > steepest.0 {
                        steepest = (bound, start + cell);
                    }
                }
            }
            refined_bound(&bezier(coefficients, [steepest.1], nx, nx * ny), HALVINGS, 0.0)
        })
        .reduce(|| 0.0, f64::max);
    let steepest = layers
        .map_init(Differences::default, |differences, layer| {
            let mut rivals = Vec::new();
            for start in row_starts(layer) {
                row_bounds(&coefficients[start..], [nx, ny], differences);
                let bounds = differences.bounds.iter().enumerate();
                rivals.extend(bounds.filter(|&(_, &bound)| f64::from(bound) > known).map(|(cell, _)| start + cell));
            }
            (rivals.chunks(LANES)).fold(known, |known, cells| steepest_of(coefficients, cells, nx, nx * ny, known))
        })
        .reduce(|| 0.0, f64::max);
    steepest.sqrt() / grid.cell * ROUNDING
}

/// The greatest of `known` and the squared bounds of up to [`LANES`] cells.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn steepest_of(coefficients: &[f32], cells: &[usize], row: usize, layer: usize, known: f64) -> f64 {
    // Lanes without a cell repeat the last one.
    let corners: [usize; LANES] = std::array::from_fn(|lane| cells[lane.min(cells.len() - 1)]);
    let control = bezier(coefficients, corners, row, layer);
    let bounds = bounds(&control);
    let mut steepest = known;
    for lane in 0..LANES {
        if bounds[lane] > steepest {
            steepest = refined_bound(&one_of(&control, lane), HALVINGS, steepest);
        }
    }
    steepest
}

/// Greatest differences of neighboring coefficients, scratch for [`row_bounds`].
#[derive(Default)]
struct Differences {
    /// In a column of 4 × 4 coefficients: along x to the next column, along y, along z.
    columns: [Vec<f32>; 3],
    /// The greatest coefficient in a column.
    greatest: Vec<f32>,
    /// Squared bounds on the gradient of a row of cells; zero where the spline is not positive.
    bounds: Vec<f32>,
}

/// Quick bounds for all cells of the row whose first coefficient is the first of these.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn row_bounds(coefficients: &[f32], [nx, ny]: [usize; 2], differences: &mut Differences) {
    let Differences { columns: [along_x, along_y, along_z], greatest, bounds } = differences;
    for column in [&mut *along_x, along_y, along_z] {
        column.clear();
        column.resize(nx, 0.0);
    }
    greatest.clear();
    greatest.resize(nx, 0.0);
    let row = |j: usize, k: usize| &coefficients[(k * ny + j) * nx..][..nx];
    for (j, k) in (0..4).flat_map(|k| (0..4).map(move |j| (j, k))) {
        let here = row(j, k);
        for ((along_x, pair), (greatest, here)) in
            along_x.iter_mut().zip(here.windows(2)).zip(greatest.iter_mut().zip(here))
        {
            *along_x = greater(*along_x, (pair[1] - pair[0]).abs());
            *greatest = greater(*greatest, *here);
        }
        greatest[nx - 1] = greater(greatest[nx - 1], here[nx - 1]);
        if j < 3 {
            raise_by_difference(along_y, here, row(j + 1, k));
        }
        if k < 3 {
            raise_by_difference(along_z, here, row(j, k + 1));
        }
    }
    bounds.clear();
    bounds.extend((along_x.windows(4).zip(along_y.windows(4)).zip(along_z.windows(4)).zip(greatest.windows(4))).map(
        |(((x, y), z), greatest)| {
            let of_four = |values: &[f32]| greater(greater(values[0], values[1]), greater(values[2], values[3]));
            let x = greater(greater(x[0], x[1]), x[2]);
            let (y, z) = (of_four(y), of_four(z));
            let bound = (x * x + y * y + z * z) * DIFFERENCE_ROUNDING;
            if of_four(greatest) > 0.0 { bound } else { 0.0 }
        },
    ));
}

#[inline(always)]
fn raise_by_difference(greatest: &mut [f32], one: &[f32], other: &[f32]) {
    for ((greatest, one), other) in greatest.iter_mut().zip(one).zip(other) {
        *greatest = greater(*greatest, (other - one).abs());
    }
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
            let part = half::<2>(&half::<1>(&half::<0>(control, part & 1), part >> 1 & 1), part >> 2 & 1);
            refined_bound(&part, halvings - 1, known)
        })
    }
}

/// For each lane the largest squared length of a control vector of the gradient; zero where all control values are negative.
#[inline(always)]
fn bounds<const N: usize>(control: &Control<N>) -> [f64; N] {
    let slopes = |line: [f64; 4]| {
        let [a, b, c, d] = line;
        // Control values of degree two, raised to degree three.
        let (first, second, third) = (3.0 * (b - a), 3.0 * (c - b), 3.0 * (d - c));
        [first, (first + 2.0 * second) / 3.0, (2.0 * second + third) / 3.0, third]
    };
    let (x, y, z) = (along::<N, 0>(control, slopes), along::<N, 1>(control, slopes), along::<N, 2>(control, slopes));
    let (mut largest, mut bounds) = ([f64::NEG_INFINITY; N], [0.0; N]);
    for k in 0..4 {
        for j in 0..4 {
            for i in 0..4 {
                let (x, y, z, value) = (&x[k][j][i], &y[k][j][i], &z[k][j][i], &control[k][j][i]);
                for lane in 0..N {
                    let squared = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
                    bounds[lane] = if squared > bounds[lane] { squared } else { bounds[lane] };
                    largest[lane] = if value[lane] > largest[lane] { value[lane] } else { largest[lane] };
                }
            }
        }
    }
    for lane in 0..N {
        bounds[lane] = if largest[lane] > 0.0 { bounds[lane] } else { 0.0 };
    }
    bounds
}

/// The Bézier form of the cells whose first coefficients are at `corners`.
#[inline(always)]
fn bezier<const N: usize>(coefficients: &[f32], corners: [usize; N], row: usize, layer: usize) -> Control<N> {
    let mut control = [[[[0.0; N]; 4]; 4]; 4];
    for k in 0..4 {
        for j in 0..4 {
            for lane in 0..N {
                let start = corners[lane] + k * layer + j * row;
                let line = &coefficients[start..start + 4];
                for i in 0..4 {
                    control[k][j][i][lane] = f64::from(line[i]);
                }
            }
        }
    }
    let to_bezier = |[a, b, c, d]: [f64; 4]| {
        [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
    };
    along::<N, 2>(&along::<N, 1>(&along::<N, 0>(&control, to_bezier), to_bezier), to_bezier)
}

/// The lower (0) or upper (1) half of a cell along an axis, by de Casteljau's construction.
fn half<const AXIS: usize>(control: &Control<1>, upper: usize) -> Control<1> {
    along::<1, AXIS>(control, |[a, b, c, d]| {
        let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
        let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
        let middle = 0.5 * (abc + bcd);
        if upper == 0 { [a, ab, abc, middle] } else { [middle, bcd, cd, d] }
    })
}

/// Applies `map` to all lines of control values along an axis: 0 for x.
#[inline(always)]
fn along<const N: usize, const AXIS: usize>(control: &Control<N>, map: impl Fn([f64; 4]) -> [f64; 4]) -> Control<N> {
    let mut result = [[[[0.0; N]; 4]; 4]; 4];
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
                let mapped = map([of(0), of(1), of(2), of(3)]);
                for w in 0..4 {
                    let [k, j, i] = at(w);
                    result[k][j][i][lane] = mapped[w];
                }
            }
        }
    }
    result
}

fn one_of(control: &Control<LANES>, lane: usize) -> Control<1> {
    control.map(|plane| plane.map(|line| line.map(|values| [values[lane]])))
}
