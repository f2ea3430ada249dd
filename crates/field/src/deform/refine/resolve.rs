//! Refinement before a stroke, so that the field does not pass between the vertices unnoticed.

use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use super::{
    criteria::Criteria,
    refinement::{LongestEdge, MAX_ROUNDS, Refinement},
};
use crate::{
    deform::{
        curved_triangle::edge_lengths,
        tessellation::{ChosenEdges, Tessellation},
    },
    flow::Stroke,
};

/// Splits the triangles that `stroke` may touch until their edges resolve its field. `past` are the
/// strokes that lead from the base to the image.
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
            let is_touched = is_long.contains(&true) && stroke.may_touch(center, radius);
            std::array::from_fn(|side| (is_touched && is_long[side]).then_some(3 * index + side as u32))
        };
        triangles.par_iter().flat_map_iter(long_edges).flatten_iter().collect()
    })
}

/// Splits `triangles` until `long_edges` returns no half-edges. Each round after the first passes the
/// triangles that the round before made.
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
        match refinement.split(mesh, strokes, chosen, criteria, LongestEdge::OfImage, monitor)? {
            Some(split) => triangles = split.parts,
            None => break,
        }
    }
    Ok(refinement)
}
