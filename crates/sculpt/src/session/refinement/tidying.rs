//! Collapses and flips where the image becomes the next base.
//!
//! They change the surface, so anywhere else they would fold the base. Every edit is refused that
//! folds the surface or makes triangles cross.

use std::ops::AddAssign;

use glam::DVec3;
use isochore_mesh::{Aabb, NONE, triangles_intersect};
use rayon::prelude::*;

use super::pass::Pass;
use crate::session::surface::Surface;

/// Largest distance by which an edit moves the surface, as a fraction of the allowed deviation.
/// Larger wears off detail in strokes that pass a place many times; smaller leaves slivers.
const WEAR: f64 = 0.25;

/// Cosine of the angle between the normals of two neighbors, beyond which an edit must not fold them
/// any farther. Larger refuses edits at sharp edges; smaller lets several edits together fold the
/// surface onto itself, which no later split removes.
const FOLDED: f64 = 0.0;

/// Cosine of the same angle, beyond which an edit must leave no neighbors. Larger leaves slivers at the
/// rims of thin sheets; smaller lets their two sides touch.
const CLOSED: f64 = -0.95;

/// Smallest [`shape`] of a triangle that an edit may make: an angle of 0.2°. Larger leaves slivers beside
/// those that cannot be removed; smaller lets rounding decide to which side a triangle faces.
pub(super) const LEAST_SHAPE: f64 = 1e-3;

/// A collapse may make triangles worse that are at least this good: an angle of about 15°. Larger refuses
/// collapses where all triangles are good; smaller makes slivers.
pub(super) const GOOD_SHAPE: f64 = 0.06;

/// Triangles that one task searches. Larger leaves threads idle; smaller spends time on scheduling.
const CHUNK: usize = 512;

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
    /// Collapses squeezed and superfluous edges of `triangles`, and flips edges of those that are badly
    /// shaped.
    pub(in crate::session) fn tidy(&mut self, triangles: &[u32]) -> Tidied {
        let surface = &mut *self.surface;
        surface.triangle_marks.clear();
        surface.triangle_marks.resize(surface.corners.items().len());
        surface.triangle_marks.extend(triangles.iter().copied());
        let mut tidied = self.collapse(triangles);
        if self.options.flip {
            tidied += self.flip(triangles);
        }
        tidied
    }

    /// The edges of those of `triangles` that exist, in ascending order, if one of their half-edges
    /// passes `filter`.
    pub(super) fn edges_among(&self, triangles: &[u32], filter: impl Fn(u32) -> bool + Sync) -> Vec<[u32; 2]> {
        let topology = &self.surface.topology;
        let search = |chunk: &[u32]| -> Vec<[u32; 2]> {
            let alive = chunk.iter().filter(|&&triangle| topology.triangles()[triangle as usize].is_alive());
            let edges = alive.flat_map(|&triangle| (3 * triangle..).zip(self.surface.edges_of(triangle)));
            edges.filter(|&(half_edge, _)| filter(half_edge)).map(|(_, ends)| ends).collect()
        };
        let mut edges: Vec<[u32; 2]> = triangles.par_chunks(CHUNK).flat_map_iter(search).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Largest distance by which an edit may move the surface.
    pub(super) fn wear(&self) -> f64 {
        WEAR * self.limits.deviation
    }

    /// Whether triangles that would replace the triangles `old` fold the surface farther than those
    /// do, measured by the normals of each two triangles that share an edge.
    pub(super) fn would_fold(&self, new: &[[DVec3; 3]], old: &[u32]) -> bool {
        let surface = &*self.surface;
        let records = surface.topology.triangles();
        let mut rim: Vec<u32> = old.iter().flat_map(|&triangle| records[triangle as usize].twins).collect();
        rim.retain(|&twin| twin != NONE && !old.contains(&(twin / 3)));
        let rim: Vec<[DVec3; 3]> = rim.into_iter().filter_map(|twin| surface.corners_of(twin / 3)).collect();
        let after = sharpest(new, &rim);
        let before =
            || -> Vec<[DVec3; 3]> { old.iter().filter_map(|&triangle| surface.corners_of(triangle)).collect() };
        after < FOLDED && (after < CLOSED || after < sharpest(&before(), &rim))
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

impl Surface {
    /// Those of `triangles` with a small angle.
    pub(in crate::session) fn badly_shaped(&self, triangles: &[u32]) -> Vec<u32> {
        let is_bad = |&&triangle: &&u32| self.corners_of(triangle).is_some_and(|corners| shape(corners) < GOOD_SHAPE);
        triangles.iter().filter(is_bad).copied().collect()
    }
}

/// Smallest cosine between the normals of two triangles that share an edge, one of them of `own` and
/// the other of `own` or `rim`.
fn sharpest(own: &[[DVec3; 3]], rim: &[[DVec3; 3]]) -> f64 {
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
    let shares_edge =
        |one: &[DVec3; 3], other: &[DVec3; 3]| one.iter().filter(|corner| other.contains(corner)).count() == 2;
    let mut least = 1.0_f64;
    for (index, one) in own.iter().enumerate() {
        for other in own[..index].iter().chain(rim).filter(|other| shares_edge(one, other)) {
            least = least.min(normal(*one).dot(normal(*other)));
        }
    }
    least
}

/// Area of a triangle over the sum of its squared sides: largest if they are equal, zero if it is
/// flat, NaN for a point (R. Bank, *PLTMG*, 1998, section 2.2, up to a factor).
pub(super) fn shape([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    0.5 * (b - a).cross(c - a).length() / sides
}
