//! Strokes: the motions that deform, each the exact or integrated flow of a divergence-free field.

mod reach;
#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::Aabb;

use super::{
    AxisError, Bend, FieldStroke, FieldStrokeError, Move, MoveError, RegionMotionError, Stamp, StampError, Twist,
};
use crate::fields::{Mask, RingError, StripError, swirl_field::SwirlField};

/// One motion that deforms what it passes through.
#[derive(Debug, Clone)]
pub enum Stroke {
    /// A tool moves rigidly from pose to pose.
    Move(Move),
    /// Fields that change with time act one after the other.
    Field(FieldStroke),
    /// Planes across an axis turn about it, by an angle proportional to the distance along it.
    Twist(Twist),
    /// Spheres turn about an axis, by an angle proportional to the squared radius.
    Bend(Bend),
    /// A tool presses its shape into the surface.
    Stamp(Stamp),
}

impl Stroke {
    /// Carries `points` through the whole stroke and returns how many times the field was evaluated. A stamp is no flow and moves
    /// no point by itself.
    ///
    /// Each point's way depends on that point alone: the bits do not depend on its neighbors in the slice.
    pub(crate) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        match self {
            Self::Move(stroke) => stroke.advect_chunk(points),
            Self::Field(stroke) => stroke.advect_chunk(points),
            Self::Twist(stroke) => stroke.advect_chunk(points),
            Self::Bend(stroke) => stroke.advect_chunk(points),
            Self::Stamp(_) => 0,
        }
    }

    /// Whether the stroke may move a point of this ball; false is certain.
    pub fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        match self {
            Self::Move(stroke) => stroke.may_touch(center, radius),
            Self::Field(stroke) => stroke.may_touch(center, radius),
            Self::Twist(_) | Self::Bend(_) => true,
            Self::Stamp(_) => false,
        }
    }

    /// Length over which the field changes in a ball where it has one: surface coarser than this can miss it there.
    pub(crate) fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        match self {
            Self::Move(stroke) => stroke.tool().feature_size(),
            Self::Field(stroke) => stroke.feature_size_near(center, radius),
            Self::Twist(_) | Self::Bend(_) | Self::Stamp(_) => f64::INFINITY,
        }
    }

    /// The stroke with the fields held back by `mask`; integrated in steps where it had an exact flow.
    ///
    /// `bounds` is the box of what is to be carried. `step` is the travel in one step for twists and bends; the other strokes
    /// have their own.
    ///
    /// # Errors
    /// [`MaskedError`]: too many steps, a motion that its own mirror image undoes, or a stamp.
    pub fn masked(&self, mask: &Arc<Mask>, bounds: Aabb, step: f64) -> Result<Self, MaskedError> {
        if mask.is_empty() {
            return Ok(self.clone());
        }
        let swirl = |field: SwirlField| {
            if field.is_undone_by(mask.mirrors()) {
                return Err(MaskedError::UndoneByMirror);
            }
            Ok(FieldStroke::new(vec![Arc::new(field)], step)?)
        };
        let fields = match self {
            Self::Move(stroke) => FieldStroke::new(stroke.fields(), stroke.step())?,
            Self::Field(stroke) => stroke.clone(),
            Self::Twist(stroke) => swirl(stroke.field(bounds))?,
            Self::Bend(stroke) => swirl(stroke.field(bounds))?,
            Self::Stamp(_) => return Err(MaskedError::Stamp),
        };
        Ok(Self::Field(fields.masked(mask, bounds)?))
    }

    /// The stroke with half the time step; none where it takes no steps, or too many.
    pub(crate) fn with_half_step(&self) -> Option<Self> {
        match self {
            Self::Move(stroke) => stroke.with_half_step().ok().map(Self::Move),
            Self::Field(stroke) => stroke.with_half_step().ok().map(Self::Field),
            Self::Twist(_) | Self::Bend(_) | Self::Stamp(_) => None,
        }
    }

    /// The first part of the stroke, `fraction` of its time, from 0 to 1.
    pub fn truncated(&self, fraction: f64) -> Self {
        let fraction = fraction.clamp(0.0, 1.0);
        match self {
            Self::Move(stroke) => Self::Move(stroke.truncated(fraction)),
            Self::Field(stroke) => Self::Field(stroke.truncated(fraction)),
            Self::Twist(stroke) => Self::Twist(stroke.truncated(fraction)),
            Self::Bend(stroke) => Self::Bend(stroke.truncated(fraction)),
            Self::Stamp(stroke) => Self::Stamp(stroke.truncated(fraction)),
        }
    }
}

/// Errors of [`Stroke::masked`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MaskedError {
    /// A twist or a bend whose mirror image turns in the opposite direction.
    #[error(
        "the mirror image of the motion undoes it; only an axis across the plane goes with a bend, and none with a twist"
    )]
    UndoneByMirror,
    /// A stamp is not a flow, so a mask has nothing to scale.
    #[error("a stamp has no field that a mask could scale; remove the mask, or move the tool instead")]
    Stamp,
    /// The masked field takes too many steps.
    #[error(transparent)]
    Field(#[from] FieldStrokeError),
}

/// An error of any constructor of strokes, for callers that build several kinds.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StrokeError {
    /// See [`Move::new`].
    #[error(transparent)]
    Move(#[from] MoveError),
    /// See [`FieldStroke::new`].
    #[error(transparent)]
    Field(#[from] FieldStrokeError),
    /// See [`Twist::new`] and [`Bend::new`].
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// See [`Stamp::new`].
    #[error(transparent)]
    Stamp(#[from] StampError),
    /// See [`Region::stroke`](crate::Region::stroke).
    #[error(transparent)]
    Region(#[from] RegionMotionError),
    /// See [`Stroke::masked`].
    #[error(transparent)]
    Masked(#[from] MaskedError),
    /// See [`Strip::new`](crate::Strip::new).
    #[error(transparent)]
    Strip(#[from] StripError),
    /// See [`Ring::new`](crate::Ring::new).
    #[error(transparent)]
    Ring(#[from] RingError),
}
