//! The criteria of refinement.

use isochore_mesh::Aabb;
use rayon::prelude::*;

use crate::deform::{curved_triangle::edge_lengths, tessellation::Tessellation};

/// When to split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefineOptions {
    /// Share of the mesh's volume at which the estimated facet error may stand. Open meshes have no volume and ignore it.
    pub volume: f64,
    /// Distance from an edge's image to the image of its midpoint that splits it, as a share of the longest side of the mesh's
    /// bounding box.
    pub deviation: f64,
    /// Length of an edge's image, in model units, that splits it; by default one and a half times the longest edge at rest.
    pub max_edge: Option<f64>,
    /// No split goes beyond this number of triangles.
    pub max_triangles: usize,
}

impl Default for RefineOptions {
    fn default() -> Self {
        Self { volume: 1e-4, deviation: 1e-3, max_edge: None, max_triangles: 2_000_000 }
    }
}

/// The criteria in model units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Criteria {
    volume: f64,
    pub(super) deviation: f64,
    pub(super) max_edge: f64,
    /// Length in the base of edges that are not split any more.
    pub(super) shortest: f64,
    max_triangles: usize,
}

/// An edge of the base of this share of the deviation allowed, whose image still deviates, is torn by a jump of the velocity: on
/// the medial axis of a concave tool, or of a thin one whose profile acts inside. Larger stops before strong but smooth
/// stretching is followed; smaller spends ever more triangles along the tear.
const TORN: f64 = 0.25;

impl Criteria {
    /// The facet error at which refinement ends, cubic model units.
    pub(crate) fn volume(&self) -> f64 {
        self.volume
    }

    /// The same criteria with another facet error allowed.
    pub(crate) fn with_volume(self, volume: f64) -> Self {
        Self { volume, ..self }
    }

    /// The same criteria with no more than `max_triangles`.
    pub(crate) fn with_max_triangles(self, max_triangles: usize) -> Self {
        Self { max_triangles: self.max_triangles.min(max_triangles), ..self }
    }

    /// No split goes beyond this number of triangles.
    pub(crate) fn max_triangles(&self) -> usize {
        self.max_triangles
    }

    /// The criteria for a mesh with the `image` it now has; `volume` is that of the closed mesh at rest, none of an open one.
    pub(crate) fn new(options: &RefineOptions, mesh: &Tessellation, volume: Option<f64>) -> Self {
        let deviation = options.deviation * Aabb::of(mesh.rest.iter().copied()).size().max_element();
        let longest_of = |index: usize| edge_lengths(&mesh.image_of(index)).into_iter().fold(0.0, f64::max);
        let longest = || (0..mesh.triangles.len()).into_par_iter().map(longest_of).reduce(|| 0.0, f64::max);
        Self {
            volume: volume.map_or(f64::INFINITY, |volume| options.volume * volume.abs()),
            deviation,
            shortest: TORN * deviation,
            max_edge: options.max_edge.unwrap_or_else(|| 1.5 * longest()),
            max_triangles: options.max_triangles,
        }
    }
}
