//! Rigid motions about a center and the vector potentials of their velocities.
//!
//! ```text
//! A = ½ v×r + ⅓ (ω×r)×r,   curl A = v + ω×r
//! ```
//!
//! r is the position relative to the center, v the velocity of the center and ω the angular
//! velocity.

mod rigid_gauge;

use glam::DVec3;

pub(crate) use rigid_gauge::RigidGauge;

/// A rigid motion: `linear` is the velocity of `center`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidMotion {
    pub(crate) center: DVec3,
    pub(crate) linear: DVec3,
    pub(crate) angular: DVec3,
}

impl RigidMotion {
    /// Vector potential A = ½ v×r + ⅓ (ω×r)×r at `point`, and its curl v + ω×r.
    #[inline(always)]
    pub(crate) fn potential(&self, point: DVec3) -> (DVec3, DVec3) {
        let r = point - self.center;
        let turn = self.angular.cross(r);
        ((0.5 * self.linear + turn * (1.0 / 3.0)).cross(r), self.linear + turn)
    }

    /// The same motion with another center.
    pub(crate) fn about(&self, center: DVec3) -> Self {
        Self { center, linear: self.velocity(center), angular: self.angular }
    }

    /// Velocity v + ω×r of `point`.
    pub(crate) fn velocity(&self, point: DVec3) -> DVec3 {
        self.linear + self.angular.cross(point - self.center)
    }
}
