//! The stroke of a region that moves.

#[cfg(test)]
mod tests;

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{AxisError, Move, MoveError};
use crate::fields::{Pose, Region, rotation_from_vector, tool::gauge::Gauge};

/// The longest turn between two keys, in radians: less than half a turn, beyond which the way would be another.
const LONGEST_TURN: f64 = TAU / 3.0;

/// Keys of a rotation at most, which are as many turns of 120°. More is a mistake; a turn beyond is refused for its steps.
const MOST_PARTS: f64 = 1e5;

/// How a region moves, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RegionMotion {
    /// By this vector.
    Translation(DVec3),
    /// About the line through `origin` along `axis`, of any length.
    Rotation {
        /// A point of the axis.
        origin: DVec3,
        /// Direction of the axis.
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
    /// The stroke in which the region moves.
    ///
    /// A half-space that turns is faster the farther one looks: then the time step is measured by the points of `reference`, a
    /// box in the world that holds what is deformed. Elsewhere it plays no part.
    ///
    /// # Errors
    /// [`RegionMotionError`]: a zero axis, an origin or angle that is not finite, or an error of [`Move::new`].
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
