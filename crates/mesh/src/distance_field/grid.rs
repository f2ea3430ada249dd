use glam::DVec3;

use super::{DistanceFieldError, Padding};
use crate::Aabb;

/// Nodes of a regular grid: node (i, j, k) lies at `origin + cell · (i, j, k)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Position of the first node, model units.
    pub origin: DVec3,
    /// Edge length of a cell, model units.
    pub cell: f64,
    /// Nodes along x, y and z.
    pub dims: [usize; 3],
}

/// Fewest cells on the longest side of the mesh. Fewer say nothing about a shape.
const LEAST_RESOLUTION: usize = 4;

impl Grid {
    /// A grid centered on `bounds`, with `resolution` cells on its longest side, and padding around it.
    pub(super) fn around(bounds: Aabb, resolution: usize, padding: Padding) -> Result<Self, DistanceFieldError> {
        if resolution < LEAST_RESOLUTION {
            return Err(DistanceFieldError::Resolution { resolution, least: LEAST_RESOLUTION });
        }
        let cell = bounds.size().max_element() / resolution as f64;
        if !(cell.is_normal() && bounds.center().is_finite()) {
            return Err(DistanceFieldError::Extent { extent: bounds.size().max_element() });
        }
        let (length, extra) = match padding {
            Padding::Reach(reach) => (reach, STENCIL_CELLS),
            Padding::Length(length) => (length, 0.0),
            Padding::Cells(cells) => (0.0, cells as f64),
        };
        if !(length >= 0.0 && length.is_finite()) {
            return Err(DistanceFieldError::Padding { length });
        }
        let padding_cells = (length / cell).ceil() + extra;
        let dims = (bounds.size() / cell).to_array().map(|cells| {
            // A whole number of cells that rounding made a little more is that whole number.
            (cells - ROUNDING_CELLS).ceil().max(0.0) + 2.0 * padding_cells + 1.0
        });
        let origin = bounds.center() - 0.5 * cell * (DVec3::from_array(dims) - 1.0);
        // A float to integer cast saturates; the memory limit sees to the rest.
        Ok(Self { origin, cell, dims: dims.map(|nodes| nodes as usize) })
    }

    /// Number of nodes; `usize::MAX` where that overflows.
    pub fn len(&self) -> usize {
        self.dims.iter().fold(1, |product: usize, &nodes| product.saturating_mul(nodes))
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of a node, model units.
    pub fn node(&self, i: usize, j: usize, k: usize) -> DVec3 {
        self.origin + self.cell * DVec3::new(i as f64, j as f64, k as f64)
    }

    /// Position of a node by its index in [z, y, x] order.
    pub fn node_at(&self, index: usize) -> DVec3 {
        let [nx, ny, _] = self.dims;
        self.node(index % nx, index / nx % ny, index / (nx * ny))
    }

    /// The box that the nodes span.
    pub fn bounds(&self) -> Aabb {
        let [nx, ny, nz] = self.dims;
        Aabb { min: self.origin, max: self.node(nx - 1, ny - 1, nz - 1) }
    }
}

/// Cells that the reach is padded by: one, because the outermost cells lack a neighbor that the cubic spline needs, and one more,
/// so that at the end of the reach a point has not yet left the cells that have all.
const STENCIL_CELLS: f64 = 2.0;

/// Part of a cell that a side of the mesh may exceed a whole number of cells by before it gets another. Larger: padding could be
/// short by it. Smaller than 1e-12: rounding would add a cell now and then.
const ROUNDING_CELLS: f64 = 1e-9;
