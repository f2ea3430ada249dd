//! An axis, and rotations about it by an angle that varies from point to point.

use glam::DVec3;

/// Errors of [`Twist::new`](crate::Twist::new) and [`Bend::new`](crate::Bend::new).
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AxisError {
    /// The axis has no direction.
    #[error("the axis must be nonzero")]
    Zero,
    /// The named quantity is infinite or NaN.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
}

/// An axis through a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
}

impl Axis {
    /// The axis through `origin` along `direction`, of any nonzero length.
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Result<Self, AxisError> {
        if !origin.is_finite() {
            return Err(AxisError::NotFinite("the origin"));
        }
        if !direction.is_finite() {
            return Err(AxisError::NotFinite("the axis"));
        }
        // Scaled first, so that the squares of tiny and huge components are representable.
        let largest = direction.abs().max_element();
        if largest == 0.0 {
            return Err(AxisError::Zero);
        }
        Ok(Self { origin, direction: (direction / largest).normalize() })
    }

    /// `point` rotated by `angle` radians, right-handed. An angle of zero keeps the bits.
    pub(super) fn rotated(&self, point: DVec3, angle: f64) -> DVec3 {
        if angle == 0.0 {
            return point;
        }
        let arm = (point - self.origin).reject_from_normalized(self.direction);
        // 1 − cos as 2 sin² of the half angle avoids cancellation at small angles.
        let half_sine = libm::sin(0.5 * angle);
        point - 2.0 * half_sine * half_sine * arm + libm::sin(angle) * self.direction.cross(arm)
    }
}
