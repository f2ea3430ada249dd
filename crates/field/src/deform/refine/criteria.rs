//! The criteria of refinement.

use isochore_mesh::Aabb;
use rayon::prelude::*;

use crate::deform::{curved_triangle::edge_lengths, tessellation::Tessellation};

/// Criteria of refinement.
///
/// ```
/// use isochore_field::RefineOptions;
///
/// let options = RefineOptions { max_edge: Some(0.05), max_triangles: 200_000, ..RefineOptions::default() };
/// assert_eq!(options.volume, None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefineOptions {
    /// Largest change of the volume before the lock, as a fraction of the volume of the mesh: by flat
    /// triangles, which are split, and by the time step, which is halved. Ignored for open meshes. By
    /// default the facet error is limited by the displacement that the lock would need to correct it,
    /// a tenth of the allowed deviation in the mean over the moved surface, and by 4e-4. A larger value leaves
    /// more for the lock to correct; a smaller value splits more triangles.
    pub volume: Option<f64>,
    /// Largest distance from the midpoint of an edge's image to the image of its midpoint, as a fraction
    /// of the longest side of the bounding box of the mesh. A larger value leaves visible facets; a
    /// smaller value splits more triangles.
    pub deviation: f64,
    /// Longest image of an edge, in model units. The default is 1.5 times the longest edge at rest.
    pub max_edge: Option<f64>,
    /// Largest number of triangles. Refinement stops before it exceeds this limit.
    pub max_triangles: usize,
    /// When the result so far becomes the surface from which the next strokes start.
    pub rebase: Rebase,
}

/// When the flat triangles of the result so far become the surface from which the next strokes start.
///
/// Without rebases each vertex follows all strokes from the input mesh, which is exact, but every new vertex
/// costs the time of all strokes so far, and triangles that an earlier stroke needed stay. A rebase merges
/// those. Each rebase moves the surface by at most 1.25 times the allowed deviation;
/// [`Receipt::rebase_deviation`](crate::Receipt::rebase_deviation) adds up what was measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Rebase {
    /// Never.
    Never,
    /// When the number of vertices, multiplied by the number of strokes, passes 100,000, and from then on
    /// after each stroke.
    #[default]
    Auto,
    /// After this number of strokes, at least one.
    Every(usize),
}

/// Vertices times strokes at which [`Rebase::Auto`] rebases for the first time. A larger value keeps the
/// exact map for longer; a smaller value rebases works of a few strokes.
const BUDGET: usize = 100_000;

impl Rebase {
    /// Whether a rebase is due after a number of strokes since the last one, if there was one.
    pub(crate) fn is_due(self, vertices: usize, strokes: usize, has_rebased: bool) -> bool {
        match self {
            Self::Never => false,
            // Once the map is not exact, more triangles would only cost time.
            Self::Auto => has_rebased || vertices.saturating_mul(strokes) > BUDGET,
            Self::Every(count) => strokes >= count.max(1),
        }
    }
}

impl Default for RefineOptions {
    fn default() -> Self {
        Self { volume: None, deviation: 1e-3, max_edge: None, max_triangles: 2_000_000, rebase: Rebase::Auto }
    }
}

/// The allowed facet error.
#[derive(Debug, Clone, Copy)]
enum AllowedFacetError {
    /// Cubic model units.
    Volume(f64),
    /// Mean displacement over the moved surface that corrects it, model units, and the limit in cubic
    /// model units.
    Shift { shift: f64, limit: f64 },
}

/// Mean displacement by the lock, as a fraction of the allowed deviation, that is small enough by
/// default. A larger value lets the lock displace visibly; a smaller value splits triangles whose
/// facets nobody sees.
const SHIFT: f64 = 0.1;

/// Facet error, as a fraction of the volume, that is allowed by default even where the lock would correct
/// it by a small displacement, as on thin plates. A larger value lets the bare volume of thin parts
/// drift; a smaller value splits triangles whose facets nobody sees.
const LARGEST: f64 = 4e-4;

/// The criteria in model units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Criteria {
    facet_error: AllowedFacetError,
    pub(super) deviation: f64,
    pub(super) max_edge: f64,
    /// Edges of at most this length in the base are not split.
    pub(super) shortest: f64,
    max_triangles: usize,
    rebase: Rebase,
}

/// An edge that is shorter than this fraction of the allowed deviation and still deviates crosses a
/// jump of the velocity: on the medial axis of a concave tool, or of a thin tool whose profile acts
/// inside. A larger value stops before it has followed a strong, smooth stretch; a smaller value
/// spends ever more triangles along the jump.
const TORN: f64 = 0.25;

impl Criteria {
    /// The allowed facet error of the image, cubic model units.
    pub(crate) fn allowed_facet_error(&self, mesh: &mut Tessellation) -> f64 {
        match self.facet_error {
            AllowedFacetError::Volume(volume) => volume,
            AllowedFacetError::Shift { shift, limit } => limit.min(shift * mesh.moved_area()),
        }
    }

    /// The allowed change of the volume before the lock, cubic model units, if the caller asked for one.
    pub(crate) fn asked_volume(&self) -> Option<f64> {
        match self.facet_error {
            AllowedFacetError::Volume(volume) if volume.is_finite() => Some(volume),
            _ => None,
        }
    }

    /// The same criteria with a fraction of the allowed facet error.
    pub(crate) fn with_finer_facets(self, fraction: f64) -> Self {
        let facet_error = match self.facet_error {
            AllowedFacetError::Volume(volume) => AllowedFacetError::Volume(fraction * volume),
            AllowedFacetError::Shift { shift, limit } => {
                AllowedFacetError::Shift { shift: fraction * shift, limit: fraction * limit }
            }
        };
        Self { facet_error, ..self }
    }

    /// The same criteria with another limit on triangles.
    pub(crate) fn with_max_triangles(self, max_triangles: usize) -> Self {
        Self { max_triangles, ..self }
    }

    /// Largest deviation of the midpoint of an edge, model units.
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation
    }

    /// Longest image of an edge, model units.
    pub(crate) fn max_edge(&self) -> f64 {
        self.max_edge
    }

    /// When the image becomes the base.
    pub(crate) fn rebase(&self) -> Rebase {
        self.rebase
    }

    /// The largest number of triangles.
    pub(crate) fn max_triangles(&self) -> usize {
        self.max_triangles
    }

    /// The criteria for `mesh`. `volume` is its volume at rest, or `None` if it is open.
    pub(crate) fn new(options: &RefineOptions, mesh: &Tessellation, volume: Option<f64>) -> Self {
        let deviation = options.deviation * Aabb::of(mesh.rest.iter().copied()).size().max_element();
        let longest_of = |index: usize| edge_lengths(&mesh.image_of(index)).into_iter().fold(0.0, f64::max);
        let longest = || (0..mesh.triangles.len()).into_par_iter().map(longest_of).reduce(|| 0.0, f64::max);
        Self {
            facet_error: match (volume, options.volume) {
                (None, _) => AllowedFacetError::Volume(f64::INFINITY),
                (Some(volume), Some(fraction)) => AllowedFacetError::Volume(fraction * volume.abs()),
                (Some(volume), None) => {
                    AllowedFacetError::Shift { shift: SHIFT * deviation, limit: LARGEST * volume.abs() }
                }
            },
            deviation,
            shortest: TORN * deviation,
            max_edge: options.max_edge.unwrap_or_else(|| 1.5 * longest()),
            max_triangles: options.max_triangles,
            rebase: options.rebase,
        }
    }
}
