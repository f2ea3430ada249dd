//! Signed distances to a mesh at the nodes of a grid.

use std::sync::Arc;

use glam::DVec3;

use super::packet_search::PacketSearch;
use super::{DistanceFieldError, DistanceFieldOptions, Grid, sampling, signs};
use crate::bvh::{Clustering, checked_bounds};
use crate::mesh_distance::{open_edges, surface_centroid};
use crate::{Aabb, Bvh, Monitor, TriMesh};

/// Samples of a distance, and the properties of the mesh that do not depend on the interpolation.
#[derive(Debug, Clone)]
pub(super) struct MeshSamples {
    pub(super) grid: Grid,
    /// Signed distances in [z, y, x] order (x fastest), model units.
    pub(super) samples: Vec<f32>,
    /// Upper bound on the error of a sample, model units.
    pub(super) sample_error: f64,
    /// Bounding box of the mesh.
    pub(super) surface: Aabb,
    pub(super) centroid: DVec3,
    pub(super) is_closed: bool,
}

/// Grid nodes per triangle above which a finer hierarchy pays off. Larger: slower searches of fine
/// grids. Smaller: longer preparation for coarse grids.
const NODES_PER_TRIANGLE: usize = 4;

/// Bytes per node during construction: sample, coefficient, and an `f64` copy between the filters.
const BYTES_PER_NODE: u64 = 4 + 4 + 8;

impl MeshSamples {
    /// Samples the distance to `mesh`. The errors are those of
    /// [`DistanceField::new`](super::DistanceField::new), except for its check of the border.
    pub(super) fn new(
        mesh: &TriMesh,
        options: &DistanceFieldOptions,
        monitor: &dyn Monitor,
    ) -> Result<Self, DistanceFieldError> {
        monitor.check("hierarchy", 0.0)?;
        let surface = checked_bounds(&mesh.positions, &mesh.triangles)?;
        let grid = checked_grid(surface, options)?;
        let is_fine = grid.len() / NODES_PER_TRIANGLE > mesh.triangles.len();
        let clustering = if is_fine { Clustering::Fine } else { Clustering::Coarse };
        let (bvh, (open_edges, volume_and_centroid)) =
            // The hierarchy is clustered on one thread. The other threads meanwhile find open edges
            // and volume.
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
        Ok(Self { grid, samples, sample_error, surface, centroid, is_closed })
    }
}

/// Lays out the grid, and checks the options and the memory that the grid takes.
fn checked_grid(surface: Aabb, options: &DistanceFieldOptions) -> Result<Grid, DistanceFieldError> {
    let grid = Grid::around(surface, options.resolution, options.padding)?;
    if options.band.is_nan() || options.band <= 0.0 {
        return Err(DistanceFieldError::Band { width: options.band });
    }
    let bytes = (grid.len() as u64).saturating_mul(BYTES_PER_NODE);
    if bytes > options.memory_limit || grid.len() > u32::MAX as usize {
        return Err(DistanceFieldError::Memory { dims: grid.dims, bytes, limit: options.memory_limit });
    }
    Ok(grid)
}
