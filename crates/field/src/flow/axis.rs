//! Rotation about an axis by an angle that varies from point to point.

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
    /// The axis through `origin` along `direction`, of any length but zero.
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Result<Self, AxisError> {
        if !origin.is_finite() {
            return Err(AxisError::NotFinite("the origin"));
        }
        if !direction.is_finite() {
            return Err(AxisError::NotFinite("the axis"));
        }
        // Scaled first, so that neither tiny nor huge axes leave the range in which squares are representable.
        let largest = direction.abs().max_element();
        if largest == 0.0 {
            return Err(AxisError::Zero);
        }
        Ok(Self { origin, direction: (direction / largest).normalize() })
    }

    /// `point` turned by `angle` radians, right-handed. A point that does not turn keeps its bits.
    pub(super) fn rotated(&self, point: DVec3, angle: f64) -> DVec3 {
        if angle == 0.0 {
            return point;
        }
        let arm = (point - self.origin).reject_from_normalized(self.direction);
        // 1 − cos as 2 sin² of the half angle: no cancellation at small angles.
        let half_sine = libm::sin(0.5 * angle);
        point - 2.0 * half_sine * half_sine * arm + libm::sin(angle) * self.direction.cross(arm)
    }
}
