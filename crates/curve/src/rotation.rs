//! The smallest rotation between two tangents: a rival, and the step where there is no chord.

use glam::DVec3;

/// Squared sum of the tangents at least. Larger: sharp but determined turns are refused. Smaller: nearly opposite
/// tangents choose their plane of rotation by rounding.
const SMALLEST_SQUARED_SUM: f64 = 1e-12;

/// Carries `r` from the normal plane of the unit tangent `start` to that of `end`, by the smallest rotation that takes
/// one to the other. None where the two are opposite.
///
/// An error of third order a step. No threshold is needed for parallel tangents: (1 − cos)/sin² is written 1/(1 + cos).
///
/// Source: J. Bloomenthal, Calculation of reference frames along a space curve, 1990.
pub fn rotate_minimally(start: DVec3, end: DVec3, r: DVec3) -> Option<DVec3> {
    // False for NaN too.
    let is_determined = (start + end).length_squared() >= SMALLEST_SQUARED_SUM;
    if !is_determined {
        return None;
    }
    let axis = start.cross(end);
    let turned = axis.cross(r);
    Some(r + turned + axis.cross(turned) / (1.0 + start.dot(end)))
}
