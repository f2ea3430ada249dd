//! The objects that a recipe's plain data describe.

use glam::{DQuat, DVec3};

/// The rotation by an angle in degrees about an axis of any length, `[x, y, z, degrees]`.
pub(crate) fn rotation(rotate: [f64; 4]) -> DQuat {
    let [x, y, z, degrees] = rotate;
    let half = 0.5 * degrees.to_radians();
    let axis = DVec3::new(x, y, z).normalize_or_zero() * libm::sin(half);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half))
}
