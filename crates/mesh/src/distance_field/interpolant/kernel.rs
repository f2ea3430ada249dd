//! Value and gradient of a tricubic B-spline at 16 points abreast.

use super::columns::Columns;
use crate::distance_field::{
    Grid,
    real::Real,
    spline::{weight_derivatives, weights},
};
use crate::{DistanceBlock, LANES, PointBlock};

/// Coefficients on a grid, and where it lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice<'a> {
    pub(super) frame: &'a Frame,
    pub(super) coefficients: &'a [f32],
}

/// Where a grid lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    origin: [f64; 3],
    cells_per_length: f64,
    dims: [u32; 3],
    /// Along each axis the last cell that has all its neighbors; the first is number one.
    last_cell: [f64; 3],
}

impl Frame {
    /// None where no cell has all its neighbors.
    pub(super) fn new(grid: &Grid) -> Option<Self> {
        // Grids have no more nodes than a `u32` can tell.
        grid.dims.iter().all(|&nodes| nodes >= 4).then(|| Self {
            origin: grid.origin.to_array(),
            cells_per_length: 1.0 / grid.cell,
            dims: grid.dims.map(|nodes| nodes as u32),
            last_cell: grid.dims.map(|nodes| nodes as f64 - 3.0),
        })
    }
}

/// Where points lie among the cells that have all their neighbors.
struct Place<T> {
    /// The first of the 4³ coefficients around each point.
    starts: [u32; LANES],
    /// The parts of the cell passed along x, y and z; not between zero and one where the point lies in no such cell.
    passed: [[T; LANES]; 3],
}

impl Lattice<'_> {
    /// Samples at `points`; infinite with no gradient beyond the cells that have all their neighbors.
    ///
    /// The sums run over differences to one coefficient of the stencil, so that rounding is relative to what the spline changes by
    /// over a few cells, not to its value.
    ///
    /// # Safety
    /// The machine must have what `C` asks for.
    #[inline(always)]
    #[expect(unsafe_code, reason = "the rows are loaded without checks of their range")]
    pub(super) unsafe fn sample<T: Real, C: Columns>(&self, points: &PointBlock, out: &mut DistanceBlock) {
        let [row, rows, layers] = self.frame.dims.map(|nodes| nodes as usize);
        let layer = row * rows;
        // `Place::of` keeps every stencil inside the lattice.
        assert!(self.coefficients.len() == layer * layers);
        let Place { starts, passed } = Place::<T>::of(self.frame, points);

        let mut weight = [[[T::ZERO; LANES]; 4]; 3];
        let mut slope = [[[T::ZERO; LANES]; 4]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (weights, slopes) = (weights(passed[axis][lane]), weight_derivatives(passed[axis][lane]));
                for i in 0..4 {
                    weight[axis][i][lane] = weights[i];
                    slope[axis][i][lane] = slopes[i];
                }
            }
        }

        let mut reference = [0.0; LANES];
        let [mut value, mut along_x, mut along_y, mut along_z] = [[T::ZERO; LANES]; 4];
        for k in 0..4 {
            let [mut plane, mut plane_along_x, mut plane_along_y] = [[T::ZERO; LANES]; 3];
            for j in 0..4 {
                let mut columns = [[0.0; LANES]; 4];
                // SAFETY: rows j and layers k below 4 belong to the stencil; the caller sees to the machine.
                unsafe { C::load(self.coefficients, &starts, k * layer + j * row, &mut columns) };
                if (j, k) == (0, 0) {
                    reference = columns[1];
                }
                for lane in 0..LANES {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|i| T::of_single(columns[i][lane]));
                    // Weights sum to one, and their derivatives to zero: the second needs no product.
                    let (a, c, d) = (a - b, c - b, d - b);
                    let dot = |w: &[[T; LANES]; 4]| a * w[0][lane] + (c * w[2][lane] + d * w[3][lane]);
                    let line = b - T::of_single(reference[lane]) + dot(&weight[0]);
                    let line_along_x = dot(&slope[0]);
                    plane[lane] += weight[1][j][lane] * line;
                    plane_along_x[lane] += weight[1][j][lane] * line_along_x;
                    plane_along_y[lane] += slope[1][j][lane] * line;
                }
            }
            for lane in 0..LANES {
                value[lane] += weight[2][k][lane] * plane[lane];
                along_x[lane] += weight[2][k][lane] * plane_along_x[lane];
                along_y[lane] += weight[2][k][lane] * plane_along_y[lane];
                along_z[lane] += slope[2][k][lane] * plane[lane];
            }
        }

        for lane in 0..LANES {
            let is_within = |part: T| part >= T::ZERO && part <= T::of(1.0);
            let is_inside = is_within(passed[0][lane]) & is_within(passed[1][lane]) & is_within(passed[2][lane]);
            let scale = |slope: T| if is_inside { slope.to_f64() * self.frame.cells_per_length } else { 0.0 };
            let sum = f64::from(reference[lane]) + value[lane].to_f64();
            out.value[lane] = if is_inside { sum } else { f64::INFINITY };
            out.gradient.x[lane] = scale(along_x[lane]);
            out.gradient.y[lane] = scale(along_y[lane]);
            out.gradient.z[lane] = scale(along_z[lane]);
        }
    }
}

impl<T: Real> Place<T> {
    #[inline(always)]
    #[expect(unsafe_code, reason = "a cast without checks")]
    fn of(frame: &Frame, points: &PointBlock) -> Self {
        let mut place = Self { starts: [0; LANES], passed: [[T::ZERO; LANES]; 3] };
        let mut stride = 1;
        for (axis, coordinates) in [&points.x, &points.y, &points.z].into_iter().enumerate() {
            let (origin, last_cell) = (frame.origin[axis], frame.last_cell[axis]);
            for lane in 0..LANES {
                let local = (coordinates[lane] - origin) * frame.cells_per_length;
                // The upper end belongs to the last cell. What is not a number goes to the first one.
                let bounded = if local > 1.0 { local } else { 1.0 };
                let bounded = if bounded < last_cell { bounded } else { last_cell };
                // SAFETY: at least one, and no more than there are nodes in a row. A checked cast is no vector code.
                let cell: i32 = unsafe { bounded.to_int_unchecked() };
                place.passed[axis][lane] = T::of(local - f64::from(cell));
                place.starts[lane] += (cell as u32 - 1) * stride;
            }
            stride *= frame.dims[axis];
        }
        place
    }
}
