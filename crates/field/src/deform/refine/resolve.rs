//! Refinement before a stroke: no field slips through between the vertices.

use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use super::{
    criteria::Criteria,
    refinement::{MAX_ROUNDS, Refinement},
};
use crate::{
    deform::{
        curved_triangle::edge_lengths,
        tessellation::{ChosenEdges, Tessellation},
    },
    flow::Stroke,
};

/// Splits triangles in the way of `stroke`, before it acts, until its field cannot slip through between their vertices.
pub(crate) fn resolve_field(
    mesh: &mut Tessellation,
    past: &[Stroke],
    stroke: &Stroke,
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let reach = stroke.reach();
    let near = mesh.triangles_in(reach);
    split_long_edges(mesh, near, past, criteria, monitor, |mesh, triangles| {
        let long_edges = |&index: &u32| {
            let corners = mesh.image_of(index as usize);
            if !Aabb::of(corners).overlaps(reach) {
                return [None; 3];
            }
            let center = (corners[0] + corners[1] + corners[2]) / 3.0;
            let radius = corners.iter().map(|corner| corner.distance(center)).fold(0.0, f64::max);
            let allowed = stroke.feature_size_near(center, radius);
            let is_long = edge_lengths(&corners).map(|length| length > allowed);
            let is_met = is_long.contains(&true) && stroke.may_touch(center, radius);
            std::array::from_fn(|side| (is_met && is_long[side]).then_some(3 * index + side as u32))
        };
        triangles.par_iter().flat_map_iter(long_edges).flatten_iter().collect()
    })
}

/// Splits `triangles` until none has an edge that `long_edges` finds too long. It is asked for them, then for those that each
/// round has made, and answers with half-edges.
pub(crate) fn split_long_edges(
    mesh: &mut Tessellation,
    mut triangles: Vec<u32>,
    strokes: &[Stroke],
    criteria: &Criteria,
    monitor: &dyn Monitor,
    mut long_edges: impl FnMut(&Tessellation, &[u32]) -> Vec<u32>,
) -> Result<Refinement, Cancelled> {
    let mut refinement = Refinement::default();
    for _ in 0..MAX_ROUNDS {
        monitor.check("refine", 0.0)?;
        let mut chosen = ChosenEdges::default();
        long_edges(mesh, &triangles).into_iter().for_each(|half_edge| chosen.choose(mesh, half_edge));
        match refinement.split(mesh, strokes, chosen, criteria, monitor)? {
            Some(made) => triangles = made,
            None => break,
        }
    }
    Ok(refinement)
}
