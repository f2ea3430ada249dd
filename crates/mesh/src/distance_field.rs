//! The signed distance of a mesh, sampled on a grid and interpolated by a cubic spline.

mod exact_distance;
mod flat_triangle;
mod grain;
mod grid;
mod interpolant;
mod lipschitz;
mod oriented_box;
mod packet;
mod patches;
mod preparation;
mod real;
mod row_crossings;
mod sampling;
mod signs;
mod spline;
mod vector;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec3;

use crate::bvh::{Clustering, checked_bounds};
use crate::mesh_distance::{open_edges, surface_centroid};
use crate::{Aabb, Bvh, BvhError, Cancelled, Distance, DistanceBlock, Monitor, PointBlock, TriMesh};

pub use grid::Grid;
use interpolant::Interpolant;
use packet::PacketSearch;

/// How far a grid reaches beyond the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Padding {
    /// So far that the interpolant can be trusted up to this distance outside the surface, model units: the support of a tool.
    Reach(f64),
    /// At least this length on every side, model units.
    Length(f64),
    /// This many cells on every side.
    Cells(usize),
}

/// What to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceFieldOptions {
    /// Cells on the longest side of the mesh, padding not counted; at least 4.
    pub resolution: usize,
    /// What to add around the mesh.
    pub padding: Padding,
    /// Distances are told apart up to this far from the surface, model units; nodes farther away, inside or outside, have this
    /// distance, and cost nearly nothing. Infinite for all.
    pub band: f64,
    /// Bytes that the grid may take at most while it is built, estimated before any is taken: 16 a node. The hierarchy of the mesh
    /// takes about 180 bytes a triangle besides, until the field is built.
    pub memory_limit: u64,
}

impl Default for DistanceFieldOptions {
    /// 64 cells, padded by 2, in at most 4 GiB, without end of the band.
    fn default() -> Self {
        Self { resolution: 64, padding: Padding::Cells(2), band: f64::INFINITY, memory_limit: 4 << 30 }
    }
}

/// Why there is no distance field.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DistanceFieldError {
    /// The mesh cannot be searched.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// The grid is too coarse to say anything.
    #[error(
        "a resolution of {resolution} cells is too low: at least {least} are needed on the longest side of the mesh"
    )]
    Resolution {
        /// Cells asked for.
        resolution: usize,
        /// Fewest that are accepted.
        least: usize,
    },
    /// The reach or padding is negative or not finite.
    #[error("a distance field can be padded by zero or a positive length, not by {length}")]
    Padding {
        /// The offending value, model units.
        length: f64,
    },
    /// The band has no width.
    #[error("a band of distances is wider than zero, not {width}")]
    Band {
        /// The offending value, model units.
        width: f64,
    },
    /// All vertices coincide, or lie so far apart that their distance overflows.
    #[error("a mesh with an extent of {extent} has no distance grid")]
    Extent {
        /// Longest side of the bounding box, model units.
        extent: f64,
    },
    /// The grid would not fit into the memory it may take.
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
    /// The triangles of a closed mesh face inward.
    #[error("the mesh is inside out: it encloses the volume {volume}; turn its triangles around")]
    InsideOut {
        /// The negative volume, cubic model units.
        volume: f64,
    },
    /// The winding numbers of an open mesh do not fall off to outside where the reach ends.
    #[error("the mesh is open and its inside has no end: node {node:?} at the border of the grid counts as inside")]
    Unbounded {
        /// Coordinates of the offending node, model units.
        node: [f64; 3],
    },
    /// The monitor stopped the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Signed distances to a mesh on a regular grid, and the tricubic B-spline through them.
///
/// The spline is twice continuously differentiable, and its gradient is that of the spline itself, never interpolated on its own:
/// fields made of both stay divergence-free. It smooths edges and medial surfaces over about two cells. Beyond the cells that have
/// all their neighbors the value is infinite and the gradient zero.
///
/// Of a closed mesh, that is inside which its winding number exceeds one half; of an open one likewise, which puts a soft end
/// to the inside across each hole: there the sign changes away from the surface, where the distance is not zero.
#[derive(Debug, Clone)]
pub struct DistanceField {
    grid: Grid,
    samples: Vec<f32>,
    sample_error: f64,
    interpolant: Interpolant,
    surface: Aabb,
    centroid: DVec3,
    reach: f64,
    is_closed: bool,
}

/// Cells before the end of the band where the field is trusted no more. Larger: less reach. Smaller than 2: the smoothed kink at
/// the end of the band would count as distance.
const KINK_CELLS: f64 = 2.0;

/// Nodes of the grid for each triangle above which a better hierarchy is worth its time. Larger: slower searches of fine grids.
/// Smaller: longer preparations for coarse ones.
const NODES_A_TRIANGLE: usize = 4;

/// Bytes a node takes while the field is built: sample, coefficient, and a copy in `f64` between the filters.
const BYTES_PER_NODE: u64 = 4 + 4 + 8;

impl DistanceField {
    /// Samples the distance to `mesh`.
    ///
    /// # Errors
    /// See [`DistanceFieldError`].
    pub fn new(
        mesh: &TriMesh,
        options: &DistanceFieldOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self, DistanceFieldError> {
        monitor.check("hierarchy", 0.0)?;
        let surface = checked_bounds(&mesh.positions, &mesh.triangles)?;
        let grid = Grid::around(surface, options.resolution, options.padding)?;
        if options.band.is_nan() || options.band <= 0.0 {
            return Err(DistanceFieldError::Band { width: options.band });
        }
        let bytes = (grid.len() as u64).saturating_mul(BYTES_PER_NODE);
        if bytes > options.memory_limit || grid.len() > u32::MAX as usize {
            return Err(DistanceFieldError::Memory { dims: grid.dims, bytes, limit: options.memory_limit });
        }
        let is_worth_it = grid.len() / NODES_A_TRIANGLE > mesh.triangles.len();
        let clustering = if is_worth_it { Clustering::Fine } else { Clustering::Coarse };
        let (bvh, (open_edges, volume_and_centroid)) =
            Bvh::within(surface, &mesh.positions, &mesh.triangles, clustering, || {
                let open_edges = open_edges(&mesh.triangles, mesh.positions.len());
                let volume_and_centroid = open_edges.is_empty().then(|| mesh.volume_and_centroid(surface));
                (open_edges, volume_and_centroid)
            });
        let bvh = Arc::new(bvh);
        monitor.check("hierarchy", 0.5)?;
        let search = PacketSearch::new(&bvh, &grid);
        let is_closed = open_edges.is_empty();
        if let Some((volume, _)) = volume_and_centroid.filter(|&(volume, _)| volume < 0.0) {
            return Err(DistanceFieldError::InsideOut { volume });
        }
        let centroid = surface_centroid(mesh, surface, volume_and_centroid);

        let (mut samples, sample_error) = sampling::unsigned(&search, &bvh, &grid, options.band, monitor)?;
        monitor.check("signs", 0.0)?;
        signs::negate_inside(&mut samples, mesh, &open_edges, &bvh, &grid, monitor)?;
        // At the end of the band the distance has a kink, which the spline smooths as it does others.
        let reach_of_band = (options.band - KINK_CELLS * grid.cell).max(0.0);
        let reach = match options.padding {
            Padding::Reach(reach) => {
                let reach = reach.min(reach_of_band);
                check_border(&grid, &samples, reach)?;
                reach
            }
            Padding::Length(length) => (length - 2.0 * grid.cell).max(0.0).min(reach_of_band),
            Padding::Cells(cells) => (cells.saturating_sub(2) as f64 * grid.cell).min(reach_of_band),
        };
        let interpolant = Interpolant::new(&grid, &samples, monitor)?;
        Ok(Self { grid, samples, sample_error, interpolant, surface, centroid, reach, is_closed })
    }

    /// Where the samples lie.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Signed distances at the nodes, in [z, y, x] order: x fastest. Model units.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// No sample is farther from the exact distance than this, model units.
    pub fn sample_error(&self) -> f64 {
        self.sample_error
    }

    /// Whether each edge of the mesh is used as often in one direction as in the other. If not, its inside is a matter of degree.
    pub fn is_closed(&self) -> bool {
        self.is_closed
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
        self.surface
    }

    /// Centroid of the volume; of the area, if the mesh is open or encloses nothing.
    fn centroid(&self) -> DVec3 {
        self.centroid
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn lipschitz(&self) -> f64 {
        self.interpolant.lipschitz()
    }

    fn detail(&self) -> f64 {
        self.grid.cell
    }
}

/// At the border of the grid, beyond which the field is cut off, the distance must exceed the reach.
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
