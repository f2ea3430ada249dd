//! The exact test for a single pair of triangles.

use glam::DVec3;

use super::exact_triangle::{ExactTriangle, bounded_scale};
use crate::Aabb;
use crate::bvh::UnitFrame;

/// Whether two triangles intersect beyond their common corners and edges: the exact test of
/// [`SelfIntersections`](super::SelfIntersections) for a single pair.
///
/// Corners at equal positions are common. Two triangles
///
/// - without a common corner intersect if they touch anywhere, even in a single point;
/// - with one common corner intersect if they touch anywhere else;
/// - with a common edge intersect if they are in one plane on the same side of the edge;
/// - with all corners in common always intersect.
///
/// A triangle without area, or with a coordinate that is not finite, intersects nothing.
///
/// ```
/// use glam::dvec3;
/// use isochore_mesh::triangles_intersect;
///
/// let flat = [dvec3(0.0, 0.0, 0.0), dvec3(2.0, 0.0, 0.0), dvec3(0.0, 2.0, 0.0)];
/// let piercing = [dvec3(0.5, 0.5, -1.0), dvec3(0.5, 0.5, 1.0), dvec3(3.0, 3.0, 0.0)];
/// assert!(triangles_intersect(flat, piercing));
///
/// // Neighbors in a mesh have a common edge.
/// let neighbor = [flat[1], flat[0], dvec3(0.5, -1.0, 0.3)];
/// assert!(!triangles_intersect(flat, neighbor));
/// ```
pub fn triangles_intersect(first: [DVec3; 3], second: [DVec3; 3]) -> bool {
    let bounds = [first, second].map(Aabb::of);
    let corners = || first.into_iter().chain(second);
    if !bounds[0].overlaps(bounds[1]) || !corners().all(DVec3::is_finite) {
        return false;
    }
    let frame = UnitFrame::around(bounds[0].union(bounds[1]));
    let scale = bounded_scale(corners(), frame.scale());
    let [first, second] = [first, second].map(|triangle| ExactTriangle::new(triangle.map(|corner| corner * scale)));
    first.intersects(&second)
}
