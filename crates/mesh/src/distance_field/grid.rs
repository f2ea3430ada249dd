use glam::DVec3;

use super::{DistanceFieldError, Padding};
use crate::Aabb;

/// Nodes of a regular grid. Node (i, j, k) is at `origin + cell · (i, j, k)`.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::Grid;
///
/// let grid = Grid { origin: DVec3::ZERO, cell: 0.5, dims: [3, 3, 5] };
/// assert_eq!(grid.len(), 45);
/// assert_eq!(grid.node(2, 0, 4), dvec3(1.0, 0.0, 2.0));
/// assert_eq!(grid.node_at(44), grid.bounds().max);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Position of the first node, model units.
    pub origin: DVec3,
    /// Edge length of a cell, model units.
    pub cell: f64,
    /// Nodes along x, y and z.
    pub dims: [usize; 3],
}

/// Smallest number of cells along the longest side of the mesh. Fewer cannot represent a shape.
const LEAST_RESOLUTION: usize = 4;

impl Grid {
    /// Creates a grid centered on `bounds`, with `resolution` cells along its longest side, plus
    /// padding.
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
            // If rounding made a whole number of cells slightly larger, it still counts as that
            // number.
            (cells - ROUNDING_CELLS).ceil().max(0.0) + 2.0 * padding_cells + 1.0
        });
        let origin = bounds.center() - 0.5 * cell * (DVec3::from_array(dims) - 1.0);
        // The cast from float to integer saturates. The memory limit rejects such grids.
        Ok(Self { origin, cell, dims: dims.map(|nodes| nodes as usize) })
    }

    /// Number of nodes; `usize::MAX` on overflow.
    pub fn len(&self) -> usize {
        self.dims.iter().fold(1, |product: usize, &nodes| product.saturating_mul(nodes))
    }

    /// Whether the grid has no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of a node, model units.
    pub fn node(&self, i: usize, j: usize, k: usize) -> DVec3 {
        self.origin + self.cell * DVec3::new(i as f64, j as f64, k as f64)
    }

    /// Position of a node, given by its index in [z, y, x] order.
    pub fn node_at(&self, index: usize) -> DVec3 {
        let [nx, ny, _] = self.dims;
        self.node(index % nx, index / nx % ny, index / (nx * ny))
    }

    /// The box spanned by the nodes.
    pub fn bounds(&self) -> Aabb {
        let [nx, ny, nz] = self.dims;
        Aabb { min: self.origin, max: self.node(nx - 1, ny - 1, nz - 1) }
    }
}

/// Cells added to the reach. One, because the outermost cells lack a neighbor that the cubic spline
/// needs. One more, so that a point at the end of the reach is still in a cell that has all
/// neighbors.
const STENCIL_CELLS: f64 = 2.0;

/// Fraction of a cell by which a side of the mesh may exceed a whole number of cells without
/// getting another cell. Larger: padding could be short by this fraction. Smaller than 1e-12:
/// rounding would sometimes add a cell.
const ROUNDING_CELLS: f64 = 1e-9;
