//! Gauge of a rigid body's potential, in world coordinates.

use glam::{DMat3, DVec3};

use super::RigidMotion;

/// Motion of a rigid body about the center of its vector potential, and the extent of its field.
///
/// Potentials about different centers have the same curl, so they are gauges of the same motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RigidGauge {
    /// Center of the potential.
    pub(crate) center: DVec3,
    /// Velocity of the center.
    pub(crate) linear: DVec3,
    /// Angular velocity, radians per unit of time.
    pub(crate) angular: DVec3,
    /// Center of the box of the support.
    pub(crate) middle: DVec3,
    /// Half axes of the ellipsoid that approximates the support.
    pub(crate) half_axes: DMat3,
    /// Distance that the field reaches beyond the body.
    pub(crate) support: f64,
}

impl RigidGauge {
    /// Extent of the ellipsoid from its center along a unit vector.
    ///
    /// Unlike the extent of a box, it changes smoothly as the body rotates.
    pub(crate) fn extent_along(&self, direction: DVec3) -> f64 {
        (self.half_axes.transpose() * direction).length()
    }

    /// Gradient field by which the potential about `center` exceeds that of the gauge.
    pub(crate) fn change(&self, center: DVec3, point: DVec3) -> DVec3 {
        let Self { linear, angular, .. } = *self;
        let current = RigidMotion { center: self.center, linear, angular };
        let changed = RigidMotion { center, linear: linear + angular.cross(center - self.center), angular };
        changed.potential(point).0 - current.potential(point).0
    }
}
