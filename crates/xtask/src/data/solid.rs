//! Solids as signed distance functions: negative inside, positive outside, in model units.
//!
//! Distances are exact for the sphere, the box, the frustum and the extrusion. For the others and after smooth blends the
//! zero set is exact and the values near it are right to first order, which is all that meshing needs.

use glam::{DVec2, DVec3};

/// The union of two solids, blended with fillets where both surfaces are nearer than `width`.
///
/// Cubic blend: twice continuously differentiable, never above the smaller distance, and equal to it where
/// the distances differ by more than `width`.
pub(crate) fn union(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - overlap * overlap * overlap * width / 6.0
}

/// The intersection of two solids, its edges rounded over `width`.
pub(crate) fn intersection(a: f64, b: f64, width: f64) -> f64 {
    -union(-a, -b, width)
}

/// The solid `a` without the solid `b`, edges rounded over `width`.
pub(crate) fn difference(a: f64, b: f64, width: f64) -> f64 {
    intersection(a, -b, width)
}

/// The smooth union of many.
pub(crate) fn union_of(distances: impl IntoIterator<Item = f64>, width: f64) -> f64 {
    distances.into_iter().reduce(|a, b| union(a, b, width)).unwrap_or(f64::INFINITY)
}

/// A ball.
pub(crate) fn sphere(point: DVec3, center: DVec3, radius: f64) -> f64 {
    point.distance(center) - radius
}

/// An ellipsoid with its axes along the coordinates.
pub(crate) fn ellipsoid(point: DVec3, center: DVec3, radii: DVec3) -> f64 {
    let local = point - center;
    let scaled = (local / radii).length();
    let slope = (local / (radii * radii)).length();
    if slope == 0.0 { -radii.min_element() } else { scaled * (scaled - 1.0) / slope }
}

/// A limb: a ball whose radius goes from one value to the other as it moves along a segment.
pub(crate) fn limb(point: DVec3, [from, to]: [DVec3; 2], [start, end]: [f64; 2]) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(from + share * along) - (start + share * (end - start))
}

/// Limbs joined end to end by fillets; each joint is a center and a radius.
pub(crate) fn chain(point: DVec3, joints: &[(DVec3, f64)], width: f64) -> f64 {
    union_of(joints.windows(2).map(|pair| limb(point, [pair[0].0, pair[1].0], [pair[0].1, pair[1].1])), width)
}

/// A box whose edges are rounded with `rounding`; `half_extents` are those of the rounded box.
pub(crate) fn rounded_box(point: DVec3, center: DVec3, half_extents: DVec3, rounding: f64) -> f64 {
    let beyond = (point - center).abs() - (half_extents - rounding);
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0) - rounding
}

/// A polygon in the plane, corners in either order.
pub(crate) fn polygon(point: DVec2, corners: &[DVec2]) -> f64 {
    let mut nearest = f64::INFINITY;
    let mut inside = false;
    for (i, &to) in corners.iter().enumerate() {
        let from = corners[(i + corners.len() - 1) % corners.len()];
        let (along, local) = (to - from, point - from);
        let share = (local.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        nearest = nearest.min(local.distance(share * along));
        let crosses = (from.y > point.y) != (to.y > point.y);
        if crosses && point.x < from.x + (point.y - from.y) / along.y * along.x {
            inside = !inside;
        }
    }
    if inside { -nearest } else { nearest }
}

/// A flat shape given by its distance in the plane, extruded by `half_height` to both sides of `height`, edges rounded.
pub(crate) fn extruded(flat: f64, height: f64, half_height: f64, rounding: f64) -> f64 {
    let beyond = DVec2::new(flat + rounding, height.abs() - half_height + rounding);
    beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0) - rounding
}

/// A truncated cone about the z axis, from radius and height `bottom` to `top`, edges rounded.
pub(crate) fn frustum(point: DVec3, bottom: DVec2, top: DVec2, rounding: f64) -> f64 {
    let inward = DVec2::splat(rounding);
    let low = bottom - inward * DVec2::new(1.0, -1.0);
    let high = top - inward;
    let flat = DVec2::new(point.x, point.y).length();
    let corners = [DVec2::new(-low.x, low.y), low, high, DVec2::new(-high.x, high.y)];
    polygon(DVec2::new(flat, point.z), &corners) - rounding
}

/// Rises smoothly from zero at `from` to one at `to`, with zero slope at both ends.
pub(crate) fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_union_only_adds_and_only_near_both() {
        assert_eq!(union(0.3, 0.5, 0.1), 0.3);
        assert_eq!(union(0.3, 0.3, 0.12), 0.3 - 0.12 / 6.0);
        assert_eq!(difference(-1.0, 2.0, 0.1), -1.0);
        assert_eq!(difference(-1.0, -0.5, 0.1), 0.5);
    }

    #[test]
    fn exact_distances_are_exact() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(polygon(DVec2::new(0.5, 0.25), &square), -0.25);
        assert_eq!(polygon(DVec2::new(4.0, 5.0), &square), 5.0);
        assert_eq!(rounded_box(DVec3::new(4.0, 5.0, 0.0), DVec3::ZERO, DVec3::ONE, 0.0), 5.0);
        // Half a unit beyond a flat side, where rounding changes nothing.
        let cylinder = frustum(DVec3::new(1.5, 0.0, 0.5), DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0), 0.1);
        assert!((cylinder - 0.5).abs() < 1e-15);
    }
}
