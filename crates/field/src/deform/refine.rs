//! Refinement: splits the base of the flow until its flat triangles stand for the curved image well enough.
//!
//! Three things split an edge: the image of its midpoint lies far from the middle of its ends; its image is long; or its
//! triangle holds so much of the volume between flat and curved that the whole would miss the volume asked for.

mod criteria;
mod refinement;
mod resolve;
mod untangle;

use isochore_mesh::{Cancelled, Monitor};
use rayon::prelude::*;

pub(crate) use criteria::Criteria;
pub use criteria::RefineOptions;
pub(crate) use refinement::Refinement;
pub(crate) use resolve::{resolve_field, split_long_edges};
pub(crate) use untangle::untangle;

use super::{
    curved_triangle::edge_lengths,
    tessellation::{ChosenEdges, FacetError, Tessellation},
};
use crate::flow::Stroke;
use refinement::MAX_ROUNDS;

/// A round aims at this share of the volume error allowed, so that what it leaves, being re-estimated on finer triangles, does
/// not call for one more round that splits a handful. Larger takes more rounds; smaller splits more than asked.
const AIM: f64 = 0.5;

/// No round tries to leave less than this share of the error it found: splitting everything leaves a quarter of it, and the
/// last triangles before that bring next to nothing.
const LEAST_LEFT: f64 = 1.0 / 3.0;

/// Edges of a triangle that is split for its volume, whose midpoint lies this share of the largest off its plane, are split.
/// Larger splits one edge a triangle and makes slivers; smaller splits flat directions of cylinders.
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

/// Estimates the facet error of the image under `strokes`, the last of which has just acted, and splits nothing.
pub(crate) fn estimate_facet_error(
    mesh: &mut Tessellation,
    strokes: &[Stroke],
    monitor: &dyn Monitor,
) -> Result<FacetError, Cancelled> {
    monitor.check("refine", 0.0)?;
    mesh.estimate_facet_error(strokes, monitor)
}

/// Splits until the image under `strokes`, the last of which has just acted, meets the criteria.
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
        if refinement.split(mesh, strokes, chosen, criteria, monitor)?.is_none() {
            if refinement.is_limited {
                mesh.put_back(&estimate.changed);
            }
            break;
        }
    }
    Ok(refined)
}

/// Of the triangles that have `changed` the edges that deviate or are too long, and of all the edges of those that hold too much
/// of the facet error.
fn edges_to_split(mesh: &mut Tessellation, criteria: &Criteria, estimate: &FacetError) -> ChosenEdges {
    let mut chosen = ChosenEdges::default();
    for &index in &estimate.changed {
        let Some(curved) = mesh.curved(index as usize) else { continue };
        let (deviations, lengths) = (curved.deviations(), curved.lengths());
        let base_lengths = edge_lengths(&mesh.base_of(index as usize));
        for edge in 0..3 {
            let is_wanted = deviations[edge].length() > criteria.deviation || lengths[edge] > criteria.max_edge;
            if is_wanted && base_lengths[edge] > criteria.shortest {
                chosen.choose(mesh, 3 * index + edge as u32);
            }
        }
    }
    for index in triangles_to_split(mesh.gains(), estimate.volume, criteria.volume()) {
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

/// The fewest triangles, by their share of the facet error, whose split should bring it well below what is `allowed`.
fn triangles_to_split(gains: &[f64], facet_error: f64, allowed: f64) -> Vec<usize> {
    if facet_error.abs() <= allowed {
        return Vec::new();
    }
    let goal = (AIM * allowed).max(LEAST_LEFT * facet_error.abs());
    let mut order: Vec<usize> = (0..gains.len()).filter(|&index| gains[index] != 0.0).collect();
    order.par_sort_unstable_by(|&a, &b| gains[b].abs().total_cmp(&gains[a].abs()).then(a.cmp(&b)));
    let mut left = facet_error;
    let enough = order.iter().position(|&index| {
        left -= gains[index];
        left.abs() <= goal
    });
    order.truncate(enough.map_or(order.len(), |last| last + 1));
    order
}
