//! Collapses and flips at the end of a stroke.
//!
//! They change the surface, so during a stroke they would fold the base. At the end, the image
//! becomes the base of the next stroke. Every edit is refused that makes triangles cross.

use std::ops::AddAssign;

use glam::DVec3;
use isochore_mesh::{Aabb, triangles_intersect};

use super::pass::Pass;

/// Largest distance by which an edit moves the surface, as a fraction of the allowed deviation.
/// Larger wears off detail in strokes that pass a place many times; smaller leaves slivers.
const WEAR: f64 = 0.25;

/// Result of collapses and flips.
#[derive(Debug, Default)]
pub(in crate::session) struct Tidied {
    /// Edited triangles, removed ones included, in the order of the edits.
    pub(in crate::session) triangles: Vec<u32>,
    /// Volume that each edit adds.
    pub(in crate::session) volumes: Vec<f64>,
    pub(in crate::session) removed_vertices: usize,
    pub(in crate::session) flipped_edges: usize,
}

impl AddAssign for Tidied {
    fn add_assign(&mut self, other: Self) {
        self.triangles.extend(other.triangles);
        self.volumes.extend(other.volumes);
        self.removed_vertices += other.removed_vertices;
        self.flipped_edges += other.flipped_edges;
    }
}

impl Pass<'_> {
    /// Collapses squeezed and superfluous edges of `triangles`, and flips edges between badly shaped
    /// ones.
    pub(in crate::session) fn tidy(&mut self, triangles: &[u32]) -> Tidied {
        let mut tidied = self.collapse(triangles);
        if self.options.flip {
            tidied += self.flip(triangles);
        }
        tidied
    }

    /// The edges of those of `triangles` that exist, in ascending order.
    pub(super) fn edges_among(&self, triangles: &[u32]) -> Vec<[u32; 2]> {
        let records = self.surface.topology.triangles();
        let alive = triangles.iter().filter(|&&triangle| records[triangle as usize].is_alive());
        let mut edges: Vec<[u32; 2]> = alive.flat_map(|&triangle| self.surface.edges_of(triangle)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Largest distance by which an edit may move the surface.
    pub(super) fn wear(&self) -> f64 {
        WEAR * self.limits.deviation
    }

    /// Whether triangles that would replace the triangles `old` cross each other or any other.
    pub(super) fn would_cross(&self, new: &[[DVec3; 3]], old: &[u32]) -> bool {
        let surface = &*self.surface;
        let is_crossing = |one: &[DVec3; 3], other: &[DVec3; 3]| {
            Aabb::of(*one).overlaps(Aabb::of(*other)) && triangles_intersect(*one, *other)
        };
        if new.iter().enumerate().any(|(index, one)| new[..index].iter().any(|other| is_crossing(one, other))) {
            return true;
        }
        let mut crosses = false;
        surface.tree.visit_box(Aabb::of(new.iter().flatten().copied()), |other| {
            if !crosses && !old.contains(&other) {
                let corners = surface.corners_of(other);
                crosses = corners.is_some_and(|corners| new.iter().any(|one| is_crossing(one, &corners)));
            }
        });
        crosses
    }
}

/// Area of a triangle over the sum of its squared sides: largest if they are equal, zero if it is
/// flat, NaN for a point (R. Bank, *PLTMG*, 1998, section 2.2, up to a factor).
pub(super) fn shape([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    0.5 * (b - a).cross(c - a).length() / sides
}
