//! Exact intersection tests for two triangles, based on adaptive predicates (J. Shewchuk, *Adaptive
//! Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997).

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use robust::{Coord, Coord3D};

use crate::Aabb;

/// A triangle and its bounding box.
#[derive(Debug, Clone, Copy)]
pub(super) struct ExactTriangle {
    corners: [DVec3; 3],
    aabb: Aabb,
}

/// Binary exponent of the largest coordinate, small enough that no product overflows. The value is
/// not critical: coordinates much larger than the mesh leave it no significant digits.
const LARGEST_EXPONENT: i32 = 100;

/// Multiplies `positions` by a power of two, which is exact. The factor is `scale`, or smaller if
/// the positions used by the triangles would become too large.
pub(super) fn scaled(positions: &[DVec3], triangles: &[[u32; 3]], scale: f64) -> Vec<DVec3> {
    let used = triangles.iter().flatten().map(|&vertex| positions[vertex as usize]);
    let scale = bounded_scale(used, scale);
    positions.par_iter().map(|&position| position * scale).collect()
}

/// Returns `scale`, or a smaller power of two if it would make one of `points` too large.
pub(super) fn bounded_scale(points: impl IntoIterator<Item = DVec3>, scale: f64) -> f64 {
    let largest = points.into_iter().fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    scale.min(libm::ldexp(1.0, LARGEST_EXPONENT - libm::frexp(largest).1))
}

impl ExactTriangle {
    /// Creates a triangle. Its coordinates must be small enough that no product of them overflows.
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        Self { corners, aabb: Aabb::of(corners) }
    }

    /// Whether the triangles intersect beyond their common vertices and edges.
    pub(super) fn intersects(&self, other: &Self) -> bool {
        let apart = self.aabb.min.cmpgt(other.aabb.max) | other.aabb.min.cmpgt(self.aabb.max);
        if apart.any() || projection(&self.corners).is_none() || projection(&other.corners).is_none() {
            return false;
        }
        let (mut shared, mut count) = ([(0, 0); 3], 0);
        for i in 0..3 {
            for j in 0..3 {
                if self.corners[i] == other.corners[j] {
                    shared[count] = (i, j);
                    count += 1;
                }
            }
        }
        match count {
            0 => intersect(&self.corners, &other.corners),
            1 => {
                let (i, j) = shared[0];
                let opposite = |t: &[DVec3; 3], k: usize| [t[(k + 1) % 3], t[(k + 2) % 3]];
                // If they meet anywhere else, extend the segment from the common vertex to that
                // point until it leaves one of the triangles. It can leave only through the
                // opposite edge.
                segment_meets_triangle(opposite(&self.corners, i), &other.corners)
                    || segment_meets_triangle(opposite(&other.corners, j), &self.corners)
            }
            2 => {
                // The corners off the common edge; the indices of a triangle sum to 3.
                let apexes = [3 - shared[0].0 - shared[1].0, 3 - shared[0].1 - shared[1].1];
                let [a, b] = [self.corners[shared[0].0], self.corners[shared[1].0]];
                folds_over(a, b, self.corners[apexes[0]], other.corners[apexes[1]])
            }
            _ => true,
        }
    }
}

/// Whether triangles without common vertices intersect.
fn intersect(first: &[DVec3; 3], second: &[DVec3; 3]) -> bool {
    // Most neighbors are on one side of the other's plane.
    let sides = |triangle: &[DVec3; 3], points: &[DVec3; 3]| points.map(|point| side(triangle, point));
    let on_one_side = |sides: [f64; 3]| sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0);
    if on_one_side(sides(first, second)) || on_one_side(sides(second, first)) {
        return false;
    }
    // If they meet, an edge of one meets the other. If one is inside the other in one plane, all of
    // its edges do.
    let edges = |t: &[DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    edges(first).into_iter().any(|edge| segment_meets_triangle(edge, second))
        || edges(second).into_iter().any(|edge| segment_meets_triangle(edge, first))
}

/// Whether two triangles with the edge `ab` are in one plane and on the same side of the edge.
fn folds_over(a: DVec3, b: DVec3, first: DVec3, second: DVec3) -> bool {
    if side(&[a, b, first], second) != 0.0 {
        return false;
    }
    let Some(dropped) = projection(&[a, b, first]) else { return false };
    let side_of_edge = |apex: DVec3| turn(flat(a, dropped), flat(b, dropped), flat(apex, dropped));
    let (first, second) = (side_of_edge(first), side_of_edge(second));
    (first > 0.0 && second > 0.0) || (first < 0.0 && second < 0.0)
}

/// Whether a segment intersects a triangle with positive area, including its border.
fn segment_meets_triangle([p, q]: [DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let (at_p, at_q) = (side(triangle, p), side(triangle, q));
    if (at_p > 0.0 && at_q > 0.0) || (at_p < 0.0 && at_q < 0.0) {
        return false;
    }
    let [a, b, c] = *triangle;
    if at_p == 0.0 && at_q == 0.0 {
        return projection(triangle).is_some_and(|dropped| {
            flat_segment_meets_triangle([p, q].map(|v| flat(v, dropped)), triangle.map(|v| flat(v, dropped)))
        });
    }
    // The line crosses the plane between p and q. It is inside the triangle if it passes all edges
    // on the same side.
    let passes = [side(&[p, q, a], b), side(&[p, q, b], c), side(&[p, q, c], a)];
    passes.iter().all(|&pass| pass >= 0.0) || passes.iter().all(|&pass| pass <= 0.0)
}

/// [`segment_meets_triangle`] within a plane.
fn flat_segment_meets_triangle([p, q]: [DVec2; 2], [a, b, c]: [DVec2; 3]) -> bool {
    let holds = |point: DVec2| {
        let turns = [turn(a, b, point), turn(b, c, point), turn(c, a, point)];
        turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
    };
    holds(p) || holds(q) || [[a, b], [b, c], [c, a]].into_iter().any(|edge| segments_meet([p, q], edge))
}

/// Whether two segments in the plane intersect.
fn segments_meet([p, q]: [DVec2; 2], [a, b]: [DVec2; 2]) -> bool {
    let (at_a, at_b) = (turn(p, q, a), turn(p, q, b));
    let (at_p, at_q) = (turn(a, b, p), turn(a, b, q));
    if at_a == 0.0 && at_b == 0.0 && at_p == 0.0 && at_q == 0.0 {
        // The segments are on one line, so compare their boxes.
        let overlap = p.min(q).cmple(a.max(b)) & a.min(b).cmple(p.max(q));
        return overlap.all();
    }
    let separates = |one: f64, other: f64| (one > 0.0 && other > 0.0) || (one < 0.0 && other < 0.0);
    !separates(at_a, at_b) && !separates(at_p, at_q)
}

/// An axis along which the projection of the triangle has positive area; `None` if it has no area.
fn projection(corners: &[DVec3; 3]) -> Option<usize> {
    (0..3).find(|&dropped| {
        let [a, b, c] = corners.map(|corner| flat(corner, dropped));
        turn(a, b, c) != 0.0
    })
}

/// The point without its coordinate along the axis `dropped`.
fn flat(point: DVec3, dropped: usize) -> DVec2 {
    DVec2::new(point[(dropped + 1) % 3], point[(dropped + 2) % 3])
}

/// Side of the triangle's plane on which a point is, as a sign; zero if it is exactly on the plane.
fn side(&[a, b, c]: &[DVec3; 3], point: DVec3) -> f64 {
    let coordinates = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(point))
}

/// Direction of the turn from `ab` to `c`, positive to the left; zero if they are exactly on a
/// line.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coordinates = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(coordinates(a), coordinates(b), coordinates(c))
}
