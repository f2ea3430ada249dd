//! The gauge of a rigid body's potential, in world coordinates.

use glam::{DMat3, DVec3};

use super::RigidMotion;

/// What the potential of a rigidly moving body's field is made of besides its share: the body's motion about a center.
///
/// Potentials about other centers have the same curl, so they are other gauges of the same motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RigidGauge {
    /// The point that the potential is about.
    pub(crate) center: DVec3,
    /// Velocity of the center.
    pub(crate) linear: DVec3,
    /// Angular velocity, radians per unit of time.
    pub(crate) angular: DVec3,
    /// Middle of the body's support.
    pub(crate) middle: DVec3,
    /// Half axes of an ellipsoid in place of the support.
    pub(crate) half_axes: DMat3,
    /// How far the field reaches beyond the body.
    pub(crate) support: f64,
}

impl RigidGauge {
    /// How far the support reaches from its middle along a unit vector.
    ///
    /// That of the ellipsoid, which changes smoothly as the body turns; a box' does not.
    pub(crate) fn extent_along(&self, direction: DVec3) -> f64 {
        (self.half_axes.transpose() * direction).length()
    }

    /// The gradient that the potential about `center` has more than that about the gauge's own.
    pub(crate) fn change(&self, center: DVec3, point: DVec3) -> DVec3 {
        let Self { linear, angular, .. } = *self;
        let here = RigidMotion { center: self.center, linear, angular };
        let there = RigidMotion { center, linear: linear + angular.cross(center - self.center), angular };
        there.potential(point).0 - here.potential(point).0
    }
}
