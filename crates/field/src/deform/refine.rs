//! Refinement: splits the base of the flow until its flat triangles approximate the curved image.
//!
//! An edge is split for one of three reasons: its midpoint deviates from the mean of the images of
//! its ends; its image is too long; or its triangle contributes so much to the facet error that the
//! mesh would miss its volume.

mod criteria;
mod refinement;
mod resolve;

use isochore_mesh::{Cancelled, Monitor};
use rayon::prelude::*;

pub(crate) use criteria::Criteria;
pub use criteria::{Rebase, RefineOptions};
pub(crate) use refinement::{LongestEdge, Refinement};
pub(crate) use resolve::{resolve_field, split_long_edges};

use super::{
    curved_triangle::edge_lengths,
    tessellation::{ChosenEdges, FacetError, Tessellation},
};
use crate::flow::Stroke;
use refinement::MAX_ROUNDS;

/// A round aims at this fraction of the allowed facet error. The next round estimates the error again
/// on finer triangles, and the margin keeps it from splitting a few triangles more. A larger value
/// takes more rounds; a smaller value splits more than necessary.
const AIM: f64 = 0.5;

/// No round aims at less than this fraction of the error it found. To split all triangles leaves a
/// quarter of the error. A larger value takes more rounds; a smaller value splits triangles that
/// contribute almost nothing.
const LEAST_LEFT: f64 = 1.0 / 3.0;

/// A triangle that is split for its volume splits the edges whose midpoints are off its plane by at
/// least this fraction of the largest offset. A larger value splits one edge of each triangle and
/// makes slivers; a smaller value also splits the flat direction of cylinders.
const SIGNIFICANT: f64 = 0.5;

/// Result of the refinement after a stroke.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Refined {
    pub(crate) refinement: Refinement,
    /// Estimated signed volume that the flat triangles lack.
    pub(crate) facet_error: f64,
}

impl From<FacetError> for Refined {
    fn from(estimate: FacetError) -> Self {
        let refinement = Refinement { evaluations: estimate.evaluations, ..Refinement::default() };
        Self { refinement, facet_error: estimate.volume }
    }
}

/// Estimates the facet error of the image after the last of `strokes`, without splits.
pub(crate) fn estimate_facet_error(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    monitor: &dyn Monitor,
) -> Result<FacetError, Cancelled> {
    monitor.check("refine", 0.0)?;
    mesh.estimate_facet_error(strokes, monitor)
}

/// Splits until the image after the last of `strokes` meets the criteria.
pub(crate) fn refine(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refined, Cancelled> {
    let mut refined = Refined::default();
    let Refined { refinement, facet_error } = &mut refined;
    for round in 0..MAX_ROUNDS {
        monitor.check("refine", round as f64 / MAX_ROUNDS as f64)?;
        let estimate = mesh.estimate_facet_error(strokes, monitor)?;
        refinement.evaluations += estimate.evaluations;
        *facet_error = estimate.volume;
        let chosen = edges_to_split(mesh, criteria, &estimate);
        if refinement.split(mesh, strokes, chosen, criteria, LongestEdge::OfImage, monitor)?.is_none() {
            if refinement.is_limited {
                mesh.put_back(&estimate.changed);
            }
            break;
        }
    }
    Ok(refined)
}

/// The edges of changed triangles that deviate or are too long, and the curved edges of the triangles
/// that contribute most to the facet error.
fn edges_to_split(mesh: &mut Tessellation, criteria: &Criteria, estimate: &FacetError) -> ChosenEdges {
    let mut chosen = ChosenEdges::default();
    for &index in &estimate.changed {
        let Some(curved) = mesh.curved(index as usize) else { continue };
        let (deviations, lengths) = (curved.deviations(), curved.lengths());
        let base_lengths = edge_lengths(&mesh.base_of(index as usize));
        for edge in 0..3 {
            let is_coarse = deviations[edge].length() > criteria.deviation || lengths[edge] > criteria.max_edge;
            if is_coarse && base_lengths[edge] > criteria.shortest {
                chosen.choose(mesh, 3 * index + edge as u32);
            }
        }
    }
    let allowed = criteria.allowed_facet_error(mesh);
    for index in triangles_to_split(mesh.gains(), estimate.volume, allowed) {
        let Some(curved) = mesh.curved(index) else { continue };
        let normal = curved.normal();
        let heights = curved.deviations().map(|deviation| deviation.dot(normal).abs());
        let least = SIGNIFICANT * heights.into_iter().fold(0.0, f64::max);
        for edge in (0..3).filter(|&edge| heights[edge] >= least) {
            chosen.choose(mesh, (3 * index + edge) as u32);
        }
    }
    chosen
}

/// The fewest triangles whose split is expected to bring the facet error well below the `allowed` one.
fn triangles_to_split(gains: &[f64], facet_error: f64, allowed: f64) -> Vec<usize> {
    if facet_error.abs() <= allowed {
        return Vec::new();
    }
    let goal = (AIM * allowed).max(LEAST_LEFT * facet_error.abs());
    let mut order: Vec<usize> = (0..gains.len()).filter(|&index| gains[index] != 0.0).collect();
    order.par_sort_unstable_by(|&a, &b| gains[b].abs().total_cmp(&gains[a].abs()).then(a.cmp(&b)));
    let mut remaining = facet_error;
    let enough = order.iter().position(|&index| {
        remaining -= gains[index];
        remaining.abs() <= goal
    });
    order.truncate(enough.map_or(order.len(), |last| last + 1));
    order
}
