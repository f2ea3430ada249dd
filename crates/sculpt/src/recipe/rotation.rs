//! Rotations as recipes write them: an axis of any length and an angle in degrees.

use glam::{DQuat, DVec3};

/// No rotation. The axis is arbitrary.
pub(super) fn no_rotation() -> [f64; 4] {
    [0.0, 0.0, 1.0, 0.0]
}

pub(super) fn is_no_rotation(rotate: &[f64; 4]) -> bool {
    *rotate == no_rotation()
}

/// The right-handed rotation `[x, y, z, degrees]` as a unit quaternion.
pub(crate) fn quaternion(rotate: [f64; 4]) -> DQuat {
    let [x, y, z, degrees] = rotate;
    let half = 0.5 * degrees.to_radians();
    let axis = DVec3::new(x, y, z).normalize_or_zero() * libm::sin(half);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half))
}
