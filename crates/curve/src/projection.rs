//! The projection step, for comparison.

use glam::DVec3;

/// Projects `r` along `chord` into the normal plane of the unit tangent `end`. Returns `None` if
/// the chord is normal to that tangent.
///
/// The error per step is of third order. Unlike the other steps, it is not an isometry of the
/// normal plane, so its error depends on `r`.
///
/// Source: F. Klok, Two moving coordinate frames for sweeping along a 3D trajectory, 1986.
pub fn project_along_chord(chord: DVec3, end: DVec3, r: DVec3) -> Option<DVec3> {
    let along = chord.dot(end);
    if along == 0.0 {
        return None;
    }
    (r - chord * (r.dot(end) / along)).try_normalize()
}
