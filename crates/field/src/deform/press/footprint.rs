//! The footprint: flat splits that resolve the relief of a stamp before it is pressed.

use glam::DVec3;
use isochore_mesh::{Cancelled, Monitor};

use super::{contact::sample, step_motion::StepMotion};
use crate::deform::{
    curved_triangle::edge_lengths,
    refine::{Criteria, Refinement, split_long_edges},
    tessellation::Tessellation,
};

/// Longest edge on the walls of a stamp, in units of the relief. A tool drags the surface along its walls
/// and stretches the edges there. A larger value leaves deep walls coarse; a smaller value inserts
/// vertices that follow the smallest bumps of the wall and pass each other.
const WALL: f64 = 12.0;

/// Splits triangles of the frozen mesh before a step: those that the tool touches at the end of the step,
/// down to the relief, and those within its support, down to `rim_edge`. Edges at the contact are
/// measured across the motion of the tool. New vertices are midpoints of edges, so no volume changes.
pub(super) fn resolve(
    mesh: &mut Tessellation,
    motion: &StepMotion<'_>,
    rim_edge: f64,
    criteria: &Criteria,
    monitor: &dyn Monitor,
) -> Result<Refinement, Cancelled> {
    let mut evaluations = 0;
    let all = (0..mesh.triangles.len() as u32).collect();
    let mut refinement = split_long_edges(mesh, all, &[], criteria, monitor, |mesh, triangles| {
        let (long_edges, count) = long_edges(mesh, triangles, motion, rim_edge.max(motion.relief));
        evaluations += count;
        long_edges
    })?;
    refinement.evaluations += evaluations;
    Ok(refinement)
}

/// The half-edges of `triangles` that are too long, and the number of evaluations of the distance.
fn long_edges(mesh: &Tessellation, triangles: &[u32], motion: &StepMotion<'_>, rim_edge: f64) -> (Vec<u32>, u64) {
    let distance = motion.tool.distance();
    let bounds = motion.tool.support_bounds();
    let mut long_edges = Vec::new();
    let mut near = Vec::new();
    for &index in triangles {
        let corners = mesh.image_of(index as usize);
        let longest = edge_lengths(&corners).into_iter().fold(0.0, f64::max);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        // No corner is farther from the centroid than two thirds of the longest edge.
        if longest > motion.relief && bounds.distance(motion.end.to_local(center)) <= 2.0 / 3.0 * longest {
            near.push((index, center, corners));
        }
    }
    let centers: Vec<DVec3> = near.iter().map(|(_, center, _)| *center).collect();
    let (distances, _) = sample(motion.tool, &motion.end, &centers);
    for ((index, center, corners), known) in near.iter().zip(distances) {
        let radius = corners.iter().map(|corner| corner.distance(*center)).fold(0.0, f64::max);
        // Beyond the samples of a grid, the distance from its box is a lower bound.
        let beyond = || distance.bounds().distance(motion.end.to_local(*center));
        let clearance = if known.is_finite() { known / distance.lipschitz() } else { beyond() } - radius;
        let mut is_long = [false; 3];
        if clearance <= 0.0 {
            // Zero if the tool does not move at this point: then the full length of an edge counts.
            let direction = (motion.end.to_world(motion.start.to_local(*center)) - *center).normalize_or_zero();
            let across = corners.map(|corner| corner - corner.dot(direction) * direction);
            is_long = edge_lengths(&across).map(|length| length > motion.relief);
        }
        let longest = if clearance <= 0.0 { WALL * motion.relief } else { rim_edge };
        if clearance <= motion.tool.support() {
            for (is_long, length) in is_long.iter_mut().zip(edge_lengths(corners)) {
                *is_long |= length > longest;
            }
        }
        long_edges.extend((3 * index..).zip(is_long).filter(|(_, is_long)| *is_long).map(|(half_edge, _)| half_edge));
    }
    (long_edges, centers.len() as u64)
}
