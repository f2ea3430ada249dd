//! The footprint: flat splits that make the surface fine enough for what is pressed into it.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor};

use super::{Leg, Pressed, contact::sample};
use crate::{
    facet_error::edge_lengths,
    refine::{Criteria, split_long_edges},
    tessellation::Tessellation,
};

/// Edges across the support, at least, where something is raised. Fewer make an angular rim; more cost triangles.
const EDGES_ACROSS_RIM: f64 = 8.0;

/// Splits triangles of the frozen mesh where the tool touches them at the end of the leg, down to the relief, and where its
/// support reaches around a contact. New vertices are the middles of edges, so that no volume changes.
pub(super) fn resolve(
    mesh: &mut Tessellation,
    leg: &Leg<'_>,
    criteria: &Criteria,
    pressed: &mut Pressed,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let rim_edge = if pressed.has_touched { leg.tool.support() / EDGES_ACROSS_RIM } else { f64::INFINITY };
    let mut evaluations = 0;
    let split = split_long_edges(mesh, &[], criteria, monitor, |mesh| {
        let (most, count) = longest_edges(mesh, leg, rim_edge.max(leg.relief));
        evaluations += count;
        most
    })?;
    pressed.refinement.add(&split);
    pressed.refinement.evaluations += evaluations;
    Ok(())
}

/// For each triangle the longest edge it may have, and the number of evaluations.
fn longest_edges(mesh: &Tessellation, leg: &Leg<'_>, rim_edge: f64) -> (Vec<f64>, u64) {
    let bounds = leg.tool.support_bounds();
    let mut longest = vec![f64::INFINITY; mesh.triangles.len()];
    let mut near = Vec::new();
    for index in 0..mesh.triangles.len() {
        let corners = mesh.image_of(index);
        let edge = edge_lengths(&corners).into_iter().fold(0.0, f64::max);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        // No corner is farther from the center of mass than two thirds of the longest edge.
        if edge > leg.relief && bounds.distance(leg.end.to_local(center)) <= 2.0 / 3.0 * edge {
            near.push((index, center, corners));
        }
    }
    let centers: Vec<DVec3> = near.iter().map(|(_, center, _)| *center).collect();
    let (distances, _) = sample(leg.tool, &leg.end, &centers);
    for ((index, center, corners), distance) in near.iter().zip(distances) {
        let radius = corners.iter().map(|corner| corner.distance(*center)).fold(0.0, f64::max);
        // Where the distance is not known, that from the box is a lower bound.
        let beyond = leg.tool.distance().bounds().distance(leg.end.to_local(*center));
        let clearance = if distance.is_finite() { distance / leg.tool.distance().lipschitz() } else { beyond } - radius;
        if clearance <= 0.0 {
            longest[*index] = leg.relief;
        } else if clearance <= leg.tool.support() {
            longest[*index] = rim_edge;
        }
    }
    (longest, centers.len() as u64)
}
