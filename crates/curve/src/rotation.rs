//! The smallest rotation between two tangents: a method for comparison, and the step between equal
//! points.

use glam::DVec3;

/// Smallest squared length of the sum of the tangents. Larger: sharp but determined turns are
/// rejected. Smaller: rounding determines the plane of rotation of nearly opposite tangents.
const SMALLEST_SQUARED_SUM: f64 = 1e-12;

/// Rotates `r` from the normal plane of the unit tangent `start` to that of `end`, by the smallest
/// rotation from one tangent to the other. Returns `None` if the tangents are opposite.
///
/// The error per step is of third order. Parallel tangents need no threshold, because the formula
/// uses 1/(1 + cos) instead of (1 − cos)/sin².
///
/// Source: J. Bloomenthal, Calculation of reference frames along a space curve, 1990.
pub fn rotate_minimally(start: DVec3, end: DVec3, r: DVec3) -> Option<DVec3> {
    // Also false for NaN.
    let is_determined = (start + end).length_squared() >= SMALLEST_SQUARED_SUM;
    if !is_determined {
        return None;
    }
    let axis = start.cross(end);
    let turned = axis.cross(r);
    Some(r + turned + axis.cross(turned) / (1.0 + start.dot(end)))
}
