//! Signed distance to a mesh, sampled on a grid and interpolated by a cubic spline.

mod exact_distance;
mod flat_triangle;
mod grid;
mod interpolant;
mod lanes;
mod layers;
mod leaf_block;
mod lipschitz;
mod mesh_samples;
mod oriented_box;
mod packet;
mod packet_search;
mod patches;
mod preparation;
mod real;
mod row_crossings;
mod sampling;
mod signs;
mod smooth_distance;
mod spline;

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::{Aabb, BvhError, Cancelled, Distance, DistanceBlock, Monitor, PointBlock, TriMesh};

pub use grid::Grid;
use interpolant::Interpolant;
use mesh_samples::MeshSamples;
pub use smooth_distance::SmoothDistance;

/// Padding of a distance grid around the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Padding {
    /// Enough that the interpolant is reliable up to this distance outside the surface, model
    /// units. Use the support of a tool.
    Reach(f64),
    /// At least this length on every side, model units.
    Length(f64),
    /// This many cells on every side.
    Cells(usize),
}

/// Options for sampling a [`DistanceField`].
///
/// ```
/// use isochore_mesh::{DistanceFieldOptions, Padding};
///
/// let options = DistanceFieldOptions { resolution: 32, padding: Padding::Reach(0.5), ..Default::default() };
/// assert_eq!(options.band, f64::INFINITY);
/// assert_eq!(options.memory_limit, 4 << 30);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceFieldOptions {
    /// Cells along the longest side of the mesh, without padding; at least 4.
    pub resolution: usize,
    /// Padding around the mesh.
    pub padding: Padding,
    /// Half width of the band around the surface in which distances are computed, model units.
    /// Nodes farther away, inside or outside, are set to this distance at almost no cost. Infinity
    /// computes all distances.
    pub band: f64,
    /// Upper limit on the bytes of the grid during construction, 16 per node. The size is estimated
    /// and checked before any allocation. The hierarchy of the mesh takes about 180 bytes per
    /// triangle in addition until the field is complete.
    pub memory_limit: u64,
}

impl Default for DistanceFieldOptions {
    /// 64 cells with a padding of 2 cells, at most 4 GiB, and an infinite band.
    fn default() -> Self {
        Self { resolution: 64, padding: Padding::Cells(2), band: f64::INFINITY, memory_limit: 4 << 30 }
    }
}

/// Errors when sampling a distance field.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DistanceFieldError {
    /// The mesh has no triangles, an index out of range or a coordinate that is not finite.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// The grid is too coarse to represent a shape.
    #[error(
        "a resolution of {resolution} cells is too low: at least {least} are needed on the longest side of the mesh"
    )]
    Resolution {
        /// Requested cells.
        resolution: usize,
        /// Smallest accepted number of cells.
        least: usize,
    },
    /// The reach or padding is negative or not finite.
    #[error("the padding of a distance field must be zero or a positive length, not {length}")]
    Padding {
        /// The offending value, model units.
        length: f64,
    },
    /// The band is zero, negative or NaN.
    #[error("the band of a distance field must be wider than zero, not {width}")]
    Band {
        /// The offending value, model units.
        width: f64,
    },
    /// All vertices coincide, or the extent of the mesh overflows.
    #[error("a distance grid needs a mesh with a positive, finite extent, not {extent}")]
    Extent {
        /// Longest side of the bounding box, model units.
        extent: f64,
    },
    /// The support of a tool is not a positive, finite length.
    #[error("the support must be a positive length, not {length}")]
    Support {
        /// The offending value, model units.
        length: f64,
    },
    /// The grid would exceed the memory limit.
    #[error(
        "a distance grid of {} × {} × {} samples takes {bytes} bytes to build, more than the limit of {limit}: \
         lower the resolution or the reach", .dims[0], .dims[1], .dims[2]
    )]
    Memory {
        /// Nodes along x, y and z.
        dims: [usize; 3],
        /// Estimated bytes.
        bytes: u64,
        /// [`DistanceFieldOptions::memory_limit`].
        limit: u64,
    },
    /// The triangles of a closed mesh face inward, so its volume is negative.
    #[error("the mesh is inside out: it encloses the volume {volume}; turn its triangles around")]
    InsideOut {
        /// The negative volume, cubic model units.
        volume: f64,
    },
    /// The inside of an open mesh extends to the border of the grid, because its winding numbers do
    /// not drop below one half within the reach.
    #[error("the mesh is open and its inside is unbounded: node {node:?} at the border of the grid counts as inside")]
    Unbounded {
        /// Coordinates of the offending node, model units.
        node: [f64; 3],
    },
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Signed distances to a mesh on a regular grid, interpolated by a tricubic B-spline.
///
/// The spline is twice continuously differentiable. Its gradient is the gradient of the spline
/// itself, not a separately interpolated quantity, so fields built from the two stay
/// divergence-free. The spline smooths edges and medial surfaces over about two cells. Outside the
/// cells that have all their neighbors, the value is infinite and the gradient zero.
///
/// A point is inside if its winding number exceeds one half. For an open mesh this closes each hole
/// with a soft boundary: across it the sign changes although the distance is not zero.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, DistanceField, DistanceFieldOptions, NoProgress, Padding, primitives};
///
/// let sphere = primitives::icosphere(1.0, 4);
/// let options = DistanceFieldOptions { resolution: 24, padding: Padding::Reach(0.5), ..Default::default() };
/// let field = DistanceField::new(&sphere, &options, &NoProgress)?;
/// let (distance, gradient) = field.sample(DVec3::new(0.0, 0.0, 1.25));
/// assert!((distance - 0.25).abs() < 0.01);
/// assert!((gradient - DVec3::Z).length() < 0.05);
/// # Ok::<(), isochore_mesh::DistanceFieldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DistanceField {
    sampled: MeshSamples,
    interpolant: Interpolant,
    reach: f64,
}

/// Width of the zone at the end of the band in which the field is not trusted, in cells. Larger:
/// shorter reach. Smaller than 2: the smoothed kink at the end of the band would count as distance.
const KINK_CELLS: f64 = 2.0;

impl DistanceField {
    /// Samples the distance to `mesh`.
    ///
    /// # Errors
    /// [`DistanceFieldError::Mesh`] if the mesh cannot be searched,
    /// [`DistanceFieldError::Resolution`], [`Padding`](DistanceFieldError::Padding),
    /// [`Band`](DistanceFieldError::Band), [`Extent`](DistanceFieldError::Extent) and
    /// [`Memory`](DistanceFieldError::Memory) for a grid that cannot be built,
    /// [`InsideOut`](DistanceFieldError::InsideOut) for a closed mesh of negative volume,
    /// [`Unbounded`](DistanceFieldError::Unbounded) for an open mesh that is inside at the border
    /// of the grid, and [`Cancelled`](DistanceFieldError::Cancelled).
    pub fn new(
        mesh: &TriMesh,
        options: &DistanceFieldOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self, DistanceFieldError> {
        let sampled = MeshSamples::new(mesh, options, monitor)?;
        let reach = reach(options, sampled.grid.cell);
        if matches!(options.padding, Padding::Reach(_)) {
            check_border(&sampled.grid, &sampled.samples, reach)?;
        }
        let interpolant = Interpolant::new(&sampled.grid, &sampled.samples, monitor)?;
        Ok(Self { sampled, interpolant, reach })
    }

    /// The grid of sample positions.
    pub fn grid(&self) -> &Grid {
        &self.sampled.grid
    }

    /// Signed distances at the nodes in [z, y, x] order (x fastest), model units.
    pub fn samples(&self) -> &[f32] {
        &self.sampled.samples
    }

    /// Upper bound on the error of a sample against the exact distance, model units.
    pub fn sample_error(&self) -> f64 {
        self.sampled.sample_error
    }

    /// Whether each edge of the mesh is used equally often in both directions. If not, the mesh is
    /// open and its inside is defined by the winding number alone.
    pub fn is_closed(&self) -> bool {
        self.sampled.is_closed
    }
}

impl Distance for DistanceField {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.interpolant.sample_into(points, out);
    }

    fn sample_single_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.interpolant.sample_single_into(points, out);
    }

    fn single_error(&self) -> f64 {
        self.interpolant.single_error()
    }

    fn bounds(&self) -> Aabb {
        self.sampled.surface
    }

    /// Centroid of the volume. Centroid of the area if the mesh is open or encloses no volume.
    fn centroid(&self) -> DVec3 {
        self.sampled.centroid
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn lipschitz(&self) -> f64 {
        self.interpolant.lipschitz()
    }

    fn detail(&self) -> f64 {
        self.sampled.grid.cell
    }
}

/// Distance outside the surface up to which the field is reliable: limited by the padding, less the
/// cells that the spline cannot cover, and by the band.
fn reach(options: &DistanceFieldOptions, cell: f64) -> f64 {
    // At the end of the band the distance has a kink, which the spline smooths like any other.
    let band_reach = (options.band - KINK_CELLS * cell).max(0.0);
    match options.padding {
        Padding::Reach(reach) => reach.min(band_reach),
        Padding::Length(length) => (length - 2.0 * cell).max(0.0).min(band_reach),
        Padding::Cells(cells) => (cells.saturating_sub(2) as f64 * cell).min(band_reach),
    }
}

/// Checks that the distance exceeds the reach at the border of the grid, beyond which the field is
/// cut off.
fn check_border(grid: &Grid, samples: &[f32], reach: f64) -> Result<(), DistanceFieldError> {
    let [nx, ny, nz] = grid.dims;
    let is_border = |&index: &usize| {
        let (i, j, k) = (index % nx, index / nx % ny, index / (nx * ny));
        i == 0 || j == 0 || k == 0 || i == nx - 1 || j == ny - 1 || k == nz - 1
    };
    match (0..samples.len()).filter(is_border).find(|&index| f64::from(samples[index]) < reach + grid.cell) {
        Some(index) => Err(DistanceFieldError::Unbounded { node: grid.node_at(index).to_array() }),
        None => Ok(()),
    }
}
