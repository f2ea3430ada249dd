//! Rigid poses and the constant body twists between them.
//!
//! A body twist (v, ω) moves a body along a screw: the pose after time t is P · exp(t (v, ω)).
//!
//! Source: R. M. Murray, Z. Li, S. S. Sastry, *A Mathematical Introduction to Robotic
//! Manipulation*, 1994, chapter 2 (exponential and logarithm of a screw motion).

use glam::{DMat3, DQuat, DVec3};
use isochore_mesh::Aabb;

/// A rigid placement: world = rotation · local + translation.
///
/// # Examples
/// ```
/// use std::f64::consts::FRAC_PI_2;
///
/// use glam::DVec3;
/// use isochore_field::{Pose, rotation_from_vector};
///
/// let start = Pose::IDENTITY;
/// let end = Pose { rotation: rotation_from_vector(DVec3::Z * FRAC_PI_2), translation: DVec3::X };
/// let twist = start.twist_to(&end).unwrap();
/// assert!((twist.angular.z - FRAC_PI_2).abs() < 1e-15);
///
/// let arrived = start.moved(&twist, 1.0);
/// assert!(arrived.transform(DVec3::X).distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-14);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// World from local, a unit quaternion.
    pub rotation: DQuat,
    /// World position of the local origin, model units.
    pub translation: DVec3,
}

/// A constant rigid velocity in body coordinates: the local point y moves relative to the world at
/// `linear + angular × y`.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::BodyTwist;
///
/// let twist = BodyTwist { linear: DVec3::X, angular: DVec3::Z };
/// assert_eq!(twist.velocity(DVec3::Y), DVec3::ZERO); // on the axis of the screw
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyTwist {
    /// Velocity of the local origin, in local axes, model units per unit of time.
    pub linear: DVec3,
    /// Angular velocity, in local axes, radians per unit of time.
    pub angular: DVec3,
}

/// Below this angle, radians, the closed forms of exponential and logarithm cancel, so series
/// replace them. Their omitted terms change the translation by at most the fraction angle⁶/30240,
/// 3e-17 at this angle. Larger: the truncation shows. Smaller: the cancellation shows.
const SMALL_ANGLE: f64 = 1e-2;

/// Two poses count as half a turn apart if the cosine of half their angle is below this; the screw
/// between them is then not unique. Larger: rejects angles just below 180°. Smaller: rounding
/// decides the direction.
const HALF_TURN: f64 = 1e-9;

impl Pose {
    /// The pose whose local coordinates are world coordinates.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// A pose without rotation.
    pub const fn at(translation: DVec3) -> Self {
        Self { rotation: DQuat::IDENTITY, translation }
    }

    /// World position of a local point.
    pub fn transform(&self, local: DVec3) -> DVec3 {
        self.rotation * local + self.translation
    }

    /// This pose after moving with the constant `twist` for `time`.
    pub fn moved(&self, twist: &BodyTwist, time: f64) -> Self {
        let step = twist.exponential(time);
        Self { rotation: (self.rotation * step.rotation).normalize(), translation: self.transform(step.translation) }
    }

    /// The twist that moves this pose to `end` in one unit of time, rotating by less than 180°.
    ///
    /// Returns `None` if the relative rotation is 180°, for which the screw is not unique.
    pub fn twist_to(&self, end: &Self) -> Option<BodyTwist> {
        let back = self.rotation.conjugate();
        let mut turn = back * end.rotation;
        // Of the two quaternions of this rotation, take the one with the angle below 180°.
        if turn.w < 0.0 {
            turn = -turn;
        }
        if turn.w < HALF_TURN {
            return None;
        }
        let axis_sine = DVec3::new(turn.x, turn.y, turn.z);
        let sine = axis_sine.length();
        // angle / sin(angle/2), which tends to 2.
        let scale = if sine > 0.0 { 2.0 * libm::atan2(sine, turn.w) / sine } else { 2.0 };
        let angular = axis_sine * scale;
        let shift = back * (end.translation - self.translation);
        let angle = angular.length();
        // Logarithm: v = p − ½ ω×p + c ω×(ω×p) with c = (1 − (θ/2) cot(θ/2))/θ², which tends to
        // 1/12.
        let square_term = if angle < SMALL_ANGLE {
            1.0 / 12.0 + angle * angle / 720.0
        } else {
            let half = 0.5 * angle;
            (1.0 - half * libm::cos(half) / libm::sin(half)) / (angle * angle)
        };
        let across = angular.cross(shift);
        Some(BodyTwist { linear: shift - 0.5 * across + square_term * angular.cross(across), angular })
    }
}

impl BodyTwist {
    /// Pose relative to the start after moving for `time`.
    fn exponential(&self, time: f64) -> Pose {
        let turn = self.angular * time;
        let shift = self.linear * time;
        let angle = turn.length();
        let square = angle * angle;
        let (first, second) = if angle < SMALL_ANGLE {
            (0.5 - square / 24.0 + square * square / 720.0, 1.0 / 6.0 - square / 120.0 + square * square / 5040.0)
        } else {
            ((1.0 - libm::cos(angle)) / square, (angle - libm::sin(angle)) / (square * angle))
        };
        let across = turn.cross(shift);
        Pose { rotation: rotation_from_vector(turn), translation: shift + first * across + second * turn.cross(across) }
    }

    /// Velocity of the local point `local`, in local axes.
    pub fn velocity(&self, local: DVec3) -> DVec3 {
        self.linear + self.angular.cross(local)
    }

    /// Upper bound on the speed of the points of a box, in local coordinates. The speed is a convex
    /// function, so it is largest at a corner.
    pub(crate) fn top_speed(&self, bounds: Aabb) -> f64 {
        if self.angular == DVec3::ZERO {
            return self.linear.length();
        }
        // Rotation has no speed bound on an infinite box.
        let speed = |corner: DVec3| if corner.is_finite() { self.velocity(corner).length() } else { f64::INFINITY };
        bounds.corners().into_iter().map(speed).fold(0.0, f64::max)
    }
}

/// Rotation by `turn.length()` radians about the direction of `turn`.
///
/// The trigonometry is that of `libm`, so that every platform computes the same bits.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::rotation_from_vector;
///
/// let quarter = rotation_from_vector(DVec3::Z * std::f64::consts::FRAC_PI_2);
/// assert!((quarter * DVec3::X).distance(DVec3::Y) < 1e-15);
/// ```
pub fn rotation_from_vector(turn: DVec3) -> DQuat {
    let half = 0.5 * turn.length();
    // sin(half)/(2 half), which tends to ½.
    let scale = if half > 0.0 { 0.5 * libm::sin(half) / half } else { 0.5 };
    let axis = turn * scale;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, libm::cos(half)).normalize()
}

/// Matrices of a pose, for transforming many points in both directions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement {
    world_from_local: DMat3,
    local_from_world: DMat3,
    translation: DVec3,
}

impl From<&Pose> for Placement {
    fn from(pose: &Pose) -> Self {
        let world_from_local = DMat3::from_quat(pose.rotation);
        Self { world_from_local, local_from_world: world_from_local.transpose(), translation: pose.translation }
    }
}

impl Placement {
    /// World coordinates of a local point.
    pub(crate) fn to_world(self, local: DVec3) -> DVec3 {
        self.world_from_local * local + self.translation
    }

    /// Expresses a vector given in local axes in world axes.
    pub(crate) fn turn_to_world(self, local: DVec3) -> DVec3 {
        self.world_from_local * local
    }

    /// Local coordinates of a world point.
    pub(crate) fn to_local(self, world: DVec3) -> DVec3 {
        self.local_from_world * (world - self.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(turn: [f64; 3], translation: [f64; 3]) -> Pose {
        Pose { rotation: rotation_from_vector(turn.into()), translation: translation.into() }
    }

    #[test]
    fn moving_by_the_twist_to_a_pose_reaches_it() {
        let start = pose([0.3, -0.2, 0.9], [1.0, 2.0, -0.5]);
        for turn in [[0.0; 3], [1e-9, 0.0, 0.0], [0.003, -0.004, 0.001], [0.0, 0.0, 3.1], [2.0, -1.0, 1.5]] {
            let end = Pose {
                rotation: start.rotation * rotation_from_vector(turn.into()),
                translation: DVec3::new(0.2, 3.0, 0.4),
            };
            let twist = start.twist_to(&end).unwrap();
            let arrived = start.moved(&twist, 1.0);
            // A few roundings of quantities near 3. Near half a turn the logarithm divides by
            // sin(half), which is still near 1.
            assert!(arrived.translation.distance(end.translation) < 2e-14, "{turn:?}");
            assert!(arrived.rotation.dot(end.rotation).abs() > 1.0 - 1e-15, "{turn:?}");
        }
    }

    #[test]
    fn half_a_turn_has_no_twist() {
        let end = pose([0.0, 0.0, std::f64::consts::PI], [1.0, 0.0, 0.0]);
        assert_eq!(Pose::IDENTITY.twist_to(&end), None);
    }

    #[test]
    fn the_velocity_is_the_derivative_of_the_motion() {
        let start = pose([0.1, 0.2, 0.3], [0.5, 0.0, 0.0]);
        let twist = BodyTwist { linear: DVec3::new(0.2, 0.1, -0.3), angular: DVec3::new(0.0, 1.2, 0.5) };
        let local = DVec3::new(0.3, -0.6, 0.2);
        let h = 1e-5;
        let ahead = start.moved(&twist, 0.4 + h).transform(local);
        let behind = start.moved(&twist, 0.4 - h).transform(local);
        let now = start.moved(&twist, 0.4);
        // Central difference: h²/6 of a third derivative near 2, and 1e-16/h of rounding.
        assert!(((ahead - behind) / (2.0 * h)).distance(now.rotation * twist.velocity(local)) < 1e-9);
    }

    #[test]
    fn placement_transforms_are_inverse() {
        let pose = pose([1.0, -2.0, 0.5], [3.0, 0.0, -1.0]);
        let placement = Placement::from(&pose);
        let point = DVec3::new(0.4, 5.0, -2.0);
        assert!(placement.to_local(placement.to_world(point)).distance(point) < 4e-15);
        assert!(placement.to_world(point).distance(pose.transform(point)) < 4e-15);
    }
}
