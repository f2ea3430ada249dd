use glam::DVec3;

use super::Grid;
use super::lipschitz::lipschitz;
use super::spline::{coefficients, weight_derivatives, weights};
use crate::{DistanceBlock, LANES, PointBlock};

/// The cubic spline through the samples of a grid.
#[derive(Debug, Clone)]
pub(super) struct Interpolant {
    origin: DVec3,
    cell: f64,
    dims: [usize; 3],
    coefficients: Vec<f32>,
    lipschitz: f64,
}

impl Interpolant {
    pub(super) fn new(grid: &Grid, samples: &[f32]) -> Self {
        let coefficients = coefficients(samples, grid.dims);
        let lipschitz = lipschitz(grid, &coefficients);
        Self { origin: grid.origin, cell: grid.cell, dims: grid.dims, coefficients, lipschitz }
    }

    pub(super) fn lipschitz(&self) -> f64 {
        self.lipschitz
    }

    pub(super) fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        *out = DistanceBlock::FAR;
        for lane in 0..LANES {
            if let Some((value, gradient)) = self.sample(points.get(lane)) {
                out.value[lane] = value;
                out.gradient.set(lane, gradient);
            }
        }
    }

    /// Value and gradient; none in cells that lack neighbors, and outside the grid.
    #[inline]
    fn sample(&self, point: DVec3) -> Option<(f64, DVec3)> {
        let [nx, ny, nz] = self.dims;
        let local = ((point - self.origin) / self.cell).to_array();
        let mut base = [0; 3];
        let mut weight = [[0.0; 4]; 3];
        let mut slope = [[0.0; 4]; 3];
        for axis in 0..3 {
            let (x, nodes) = (local[axis], self.dims[axis]);
            if !(x >= 1.0 && x <= nodes as f64 - 2.0) {
                return None;
            }
            // The upper end belongs to the last cell that has all neighbors.
            let cell = (x as usize).min(nodes - 3);
            let t = x - cell as f64;
            base[axis] = cell - 1;
            weight[axis] = weights(t);
            slope[axis] = weight_derivatives(t);
        }
        let [mut value, mut along_y, mut along_z] = [[0.0; 4]; 3];
        for k in 0..4 {
            for j in 0..4 {
                let start = ((base[2] + k) * ny + base[1] + j) * nx + base[0];
                let row = &self.coefficients[start..start + 4];
                let straight = weight[1][j] * weight[2][k];
                let across_y = slope[1][j] * weight[2][k];
                let across_z = weight[1][j] * slope[2][k];
                for i in 0..4 {
                    let coefficient = f64::from(row[i]);
                    value[i] += straight * coefficient;
                    along_y[i] += across_y * coefficient;
                    along_z[i] += across_z * coefficient;
                }
            }
        }
        debug_assert!(base[2] + 4 <= nz);
        let dot = |a: &[f64; 4], b: &[f64; 4]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        let gradient = DVec3::new(dot(&value, &slope[0]), dot(&along_y, &weight[0]), dot(&along_z, &weight[0]));
        Some((dot(&value, &weight[0]), gradient / self.cell))
    }
}
