//! The stroke of a moving region.

#[cfg(test)]
mod tests;

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{AxisError, Move, MoveError};
use crate::fields::{Pose, Region, rotation_from_vector, tool::gauge::Gauge};

/// Longest rotation between two keys, in radians. It must be less than half a turn, because a longer one
/// would turn in the opposite direction.
const LONGEST_TURN: f64 = TAU / 3.0;

/// Most parts of a rotation, of 120° each. A larger angle is a mistake; [`Move::new`] rejects it because of
/// its steps.
const MOST_PARTS: f64 = 1e5;

/// The motion of a region, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RegionMotion {
    /// Translation by this vector.
    Translation(DVec3),
    /// Rotation about the line through `origin` along `axis`.
    Rotation {
        /// A point of the axis.
        origin: DVec3,
        /// Direction of the axis, of any nonzero length.
        axis: DVec3,
        /// Radians, right-handed.
        angle: f64,
    },
}

/// Errors of [`Region::stroke`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegionMotionError {
    /// The axis is zero, or the rotation is not finite.
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// The keys do not make a stroke.
    #[error(transparent)]
    Move(#[from] MoveError),
}

impl Region {
    /// The stroke of the moving region.
    ///
    /// `step` is as in [`Move::new`]. The speed of a rotating half-space has no bound. Its time step
    /// depends on the speed in `reference`, a box in the world around the deformed mesh. Other regions
    /// do not use `reference`.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use glam::DVec3;
    /// use isochore_field::{Pose, Profile, Region, RegionMotion, Stroke};
    /// use isochore_mesh::{Aabb, Sphere};
    ///
    /// let ball = Region::new(Arc::new(Sphere::new(0.5)?), Pose::IDENTITY, 0.5, Profile::Quintic)?;
    /// let motion = RegionMotion::Translation(DVec3::X);
    /// let stroke = Stroke::Move(ball.stroke(motion, 0.1, Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE })?);
    /// let mut points = [DVec3::ZERO, DVec3::Y * 1.1];
    /// stroke.advect(&mut points);
    /// // The inside moves rigidly, and the outside does not move.
    /// assert_eq!(points, [DVec3::X, DVec3::Y * 1.1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RegionMotionError::Axis`] if the axis is zero or a number of the rotation is not finite, and
    /// [`RegionMotionError::Move`] as for [`Move::new`].
    pub fn stroke(self, motion: RegionMotion, step: f64, reference: Aabb) -> Result<Move, RegionMotionError> {
        let Self { tool, placement } = self;
        let tool = if tool.distance().bounds().size().is_finite() {
            tool
        } else {
            let back = placement.rotation.conjugate();
            let corners = reference.corners();
            tool.with_reference(Aabb::of(corners.map(|corner| back * (corner - placement.translation))))
        };
        match motion {
            RegionMotion::Translation(shift) => {
                let end = Pose { translation: placement.translation + shift, ..placement };
                Ok(Move::new(Arc::new(tool), vec![placement, end], step)?)
            }
            RegionMotion::Rotation { origin, axis, angle } => {
                let axis = axis.try_normalize().ok_or(AxisError::Zero)?;
                if !(origin.is_finite() && angle.is_finite()) {
                    return Err(AxisError::NotFinite("the rotation").into());
                }
                let back = placement.rotation.conjugate();
                let center = back * (origin - placement.translation);
                let tool = tool.with_gauge(center, Some(Gauge::of_product(back * axis)));
                let parts = (angle.abs() / LONGEST_TURN).ceil().clamp(1.0, MOST_PARTS);
                let key = |part: usize| {
                    let turn = rotation_from_vector(axis * (angle * (part as f64 / parts)));
                    let rotation = (turn * placement.rotation).normalize();
                    Pose { rotation, translation: origin + turn * (placement.translation - origin) }
                };
                Ok(Move::new(Arc::new(tool), (0..=parts as usize).map(key).collect(), step)?)
            }
        }
    }
}
