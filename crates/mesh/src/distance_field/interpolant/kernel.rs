//! Value and gradient of a tricubic B-spline for batches of 16 points.

use super::columns::Columns;
use crate::distance_field::{
    Grid,
    real::Real,
    spline::{weight_derivatives, weights},
};
use crate::{DistanceBlock, LANES, PointBlock};

/// The coefficients on a grid, and its geometry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice<'a> {
    pub(super) geometry: &'a GridGeometry,
    pub(super) coefficients: &'a [f32],
}

/// Position and dimensions of a grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct GridGeometry {
    origin: [f64; 3],
    cells_per_length: f64,
    dims: [u32; 3],
    /// The last cell along each axis that has all its neighbors. The first such cell is number one.
    last_cell: [f64; 3],
}

impl GridGeometry {
    /// Returns `None` if no cell has all its neighbors.
    pub(super) fn new(grid: &Grid) -> Option<Self> {
        // Grids have fewer than 2³² nodes.
        grid.dims.iter().all(|&nodes| nodes >= 4).then(|| Self {
            origin: grid.origin.to_array(),
            cells_per_length: 1.0 / grid.cell,
            dims: grid.dims.map(|nodes| nodes as u32),
            last_cell: grid.dims.map(|nodes| nodes as f64 - 3.0),
        })
    }
}

/// Stencils of points in the cells that have all their neighbors.
struct Stencils<T> {
    /// Index of the first of the 4³ coefficients around each point.
    starts: [u32; LANES],
    /// Fraction of the cell along x, y and z. Outside 0 to 1 if the point is not in such a cell.
    fraction: [[T; LANES]; 3],
}

impl Lattice<'_> {
    /// Samples at `points`. Outside the cells that have all their neighbors, the value is infinite
    /// and the gradient zero.
    ///
    /// The sums are over differences to one coefficient of the stencil. So rounding errors are
    /// relative to the change of the spline over a few cells, not to its value.
    ///
    /// # Safety
    /// The machine must have the features that `C` requires.
    #[inline(always)]
    #[expect(unsafe_code, reason = "rows are loaded without range checks")]
    pub(super) unsafe fn sample<T: Real, C: Columns>(&self, points: &PointBlock, out: &mut DistanceBlock) {
        let [row, rows, layers] = self.geometry.dims.map(|nodes| nodes as usize);
        let layer = row * rows;
        // `Stencils::of` keeps every stencil inside the lattice.
        assert!(self.coefficients.len() == layer * layers);
        let Stencils { starts, fraction } = Stencils::<T>::of(self.geometry, points);

        // Weights of the four coefficients along each axis, for the value and for the slope.
        let mut weight = [[[T::ZERO; LANES]; 4]; 3];
        let mut slope = [[[T::ZERO; LANES]; 4]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (weights, slopes) = (weights(fraction[axis][lane]), weight_derivatives(fraction[axis][lane]));
                for i in 0..4 {
                    weight[axis][i][lane] = weights[i];
                    slope[axis][i][lane] = slopes[i];
                }
            }
        }

        // Contract the stencil along x, then y, then z, with the derivatives beside the value.
        let mut reference = [0.0; LANES];
        let [mut value, mut along_x, mut along_y, mut along_z] = [[T::ZERO; LANES]; 4];
        for k in 0..4 {
            let [mut plane, mut plane_along_x, mut plane_along_y] = [[T::ZERO; LANES]; 3];
            for j in 0..4 {
                let mut columns = [[0.0; LANES]; 4];
                // SAFETY: rows j and layers k below 4 belong to the stencil. The caller ensures the
                // features.
                unsafe { C::load(self.coefficients, &starts, k * layer + j * row, &mut columns) };
                if (j, k) == (0, 0) {
                    reference = columns[1];
                }
                for lane in 0..LANES {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|i| T::of_single(columns[i][lane]));
                    // The weights sum to one, so b needs no product. The slopes sum to zero, so b
                    // drops out.
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

        // Points outside the lattice were computed with a clamped stencil; replace their results.
        for lane in 0..LANES {
            let is_within = |part: T| part >= T::ZERO && part <= T::of(1.0);
            let is_inside = is_within(fraction[0][lane]) & is_within(fraction[1][lane]) & is_within(fraction[2][lane]);
            let scale = |slope: T| if is_inside { slope.to_f64() * self.geometry.cells_per_length } else { 0.0 };
            let sum = f64::from(reference[lane]) + value[lane].to_f64();
            out.value[lane] = if is_inside { sum } else { f64::INFINITY };
            out.gradient.x[lane] = scale(along_x[lane]);
            out.gradient.y[lane] = scale(along_y[lane]);
            out.gradient.z[lane] = scale(along_z[lane]);
        }
    }
}

impl<T: Real> Stencils<T> {
    #[inline(always)]
    #[expect(unsafe_code, reason = "an unchecked cast, because a checked one is not vectorized")]
    fn of(geometry: &GridGeometry, points: &PointBlock) -> Self {
        let mut stencils = Self { starts: [0; LANES], fraction: [[T::ZERO; LANES]; 3] };
        let mut stride = 1;
        for (axis, coordinates) in [&points.x, &points.y, &points.z].into_iter().enumerate() {
            let (origin, last_cell) = (geometry.origin[axis], geometry.last_cell[axis]);
            for lane in 0..LANES {
                let local = (coordinates[lane] - origin) * geometry.cells_per_length;
                // The upper end belongs to the last cell. NaN goes to the first cell.
                let bounded = if local > 1.0 { local } else { 1.0 };
                let bounded = if bounded < last_cell { bounded } else { last_cell };
                // SAFETY: at least one, and less than the number of nodes in a row. A checked cast
                // is not vectorized.
                let cell: i32 = unsafe { bounded.to_int_unchecked() };
                stencils.fraction[axis][lane] = T::of(local - f64::from(cell));
                stencils.starts[lane] += (cell as u32 - 1) * stride;
            }
            stride *= geometry.dims[axis];
        }
        stencils
    }
}
