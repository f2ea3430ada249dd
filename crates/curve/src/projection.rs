//! The projection step, kept as a rival for comparison.

use glam::DVec3;

/// Carries `r` into the normal plane of the unit tangent `end`, by projection along `chord`. None where the chord is
/// normal to that tangent.
///
/// An error of third order a step. Unlike the others it is not an isometry of the normal plane, so its error depends on
/// `r`.
///
/// Source: F. Klok, Two moving coordinate frames for sweeping along a 3D trajectory, 1986.
pub fn project_along_chord(chord: DVec3, end: DVec3, r: DVec3) -> Option<DVec3> {
    let along = chord.dot(end);
    if along == 0.0 {
        return None;
    }
    (r - chord * (r.dot(end) / along)).try_normalize()
}
