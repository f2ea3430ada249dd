//! The footprint: flat splits that make the surface fine enough for what is pressed into it.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor};

use super::{Leg, contact::sample};
use crate::deform::{
    curved_triangle::edge_lengths,
    refine::{Criteria, Refinement, split_long_edges},
    tessellation::Tessellation,
};

/// Wherever the tool drags the surface along its walls, edges grow long with it. Up to this many times the relief they are left
/// alone: vertices put there would go with the wall's least bumps, and past each other. Larger leaves deep walls coarse.
const WALL: f64 = 12.0;

/// Splits triangles of the frozen mesh where the tool touches them at the end of the leg, down to the relief, and where its
/// support reaches around a contact. Edges of the relief are measured across the way of the tool. New vertices are the middles
/// of edges, so that no volume changes.
pub(super) fn resolve(
    mesh: &mut Tessellation,
    leg: &Leg<'_>,
    rim_edge: f64,
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let mut evaluations = 0;
    let all = (0..mesh.triangles.len() as u32).collect();
    let mut refinement = split_long_edges(mesh, all, &[], criteria, monitor, |mesh, triangles| {
        let (long_edges, count) = long_edges(mesh, triangles, leg, rim_edge.max(leg.relief));
        evaluations += count;
        long_edges
    })?;
    refinement.evaluations += evaluations;
    Ok(refinement)
}

/// The half-edges at some triangles that are too long, and the number of evaluations.
fn long_edges(mesh: &Tessellation, triangles: &[u32], leg: &Leg<'_>, rim_edge: f64) -> (Vec<u32>, u64) {
    let distance = leg.tool.distance();
    let bounds = leg.tool.support_bounds();
    let mut long_edges = Vec::new();
    let mut near = Vec::new();
    for &index in triangles {
        let corners = mesh.image_of(index as usize);
        let longest = edge_lengths(&corners).into_iter().fold(0.0, f64::max);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        // No corner is farther from the center of mass than two thirds of the longest edge.
        if longest > leg.relief && bounds.distance(leg.end.to_local(center)) <= 2.0 / 3.0 * longest {
            near.push((index, center, corners));
        }
    }
    let centers: Vec<DVec3> = near.iter().map(|(_, center, _)| *center).collect();
    let (distances, _) = sample(leg.tool, &leg.end, &centers);
    for ((index, center, corners), known) in near.iter().zip(distances) {
        let radius = corners.iter().map(|corner| corner.distance(*center)).fold(0.0, f64::max);
        // Where the distance is not known, that from the box is a lower bound.
        let beyond = || distance.bounds().distance(leg.end.to_local(*center));
        let clearance = if known.is_finite() { known / distance.lipschitz() } else { beyond() } - radius;
        let mut is_long = [false; 3];
        if clearance <= 0.0 {
            // Zero where the tool stands still: then all of an edge counts.
            let way = (leg.end.to_world(leg.start.to_local(*center)) - *center).normalize_or_zero();
            let across = corners.map(|corner| corner - corner.dot(way) * way);
            is_long = edge_lengths(&across).map(|length| length > leg.relief);
        }
        let most = if clearance <= 0.0 { WALL * leg.relief } else { rim_edge };
        if clearance <= leg.tool.support() {
            for (is_long, length) in is_long.iter_mut().zip(edge_lengths(corners)) {
                *is_long |= length > most;
            }
        }
        long_edges.extend((3 * index..).zip(is_long).filter(|(_, is_long)| *is_long).map(|(half_edge, _)| half_edge));
    }
    (long_edges, centers.len() as u64)
}
