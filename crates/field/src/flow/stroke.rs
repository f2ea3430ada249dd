//! Strokes: motions that deform, each the exact or integrated flow of a divergence-free field.

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

/// One motion that deforms the material that it passes.
#[derive(Debug, Clone)]
pub enum Stroke {
    /// A tool that moves rigidly from pose to pose.
    Move(Move),
    /// A sequence of fields that change with time.
    Field(FieldStroke),
    /// A rotation of each plane across an axis, by an angle proportional to its height.
    Twist(Twist),
    /// A rotation of each sphere about an axis, by an angle proportional to its squared radius.
    Bend(Bend),
    /// A tool that presses its shape into a surface.
    Stamp(Stamp),
}

impl Stroke {
    /// Advects `points` through the whole stroke and returns the number of evaluations of the field. A
    /// stamp is not a flow and moves no points.
    ///
    /// The path of a point depends on that point alone, so its bits do not depend on the other points.
    pub(crate) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        match self {
            Self::Move(stroke) => stroke.advect_chunk(points),
            Self::Field(stroke) => stroke.advect_chunk(points),
            Self::Twist(stroke) => stroke.advect_chunk(points),
            Self::Bend(stroke) => stroke.advect_chunk(points),
            Self::Stamp(_) => 0,
        }
    }

    /// Whether the stroke may move a point of a ball. If it returns `false`, the stroke certainly moves
    /// none.
    pub fn may_touch(&self, center: DVec3, radius: f64) -> bool {
        match self {
            Self::Move(stroke) => stroke.may_touch(center, radius),
            Self::Field(stroke) => stroke.may_touch(center, radius),
            Self::Twist(_) | Self::Bend(_) => true,
            Self::Stamp(_) => false,
        }
    }

    /// Length over which the field changes in a ball. A surface with longer edges can miss the field.
    pub(crate) fn feature_size_near(&self, center: DVec3, radius: f64) -> f64 {
        match self {
            Self::Move(stroke) => stroke.tool().feature_size(),
            Self::Field(stroke) => stroke.feature_size_near(center, radius),
            Self::Twist(_) | Self::Bend(_) | Self::Stamp(_) => f64::INFINITY,
        }
    }

    /// The stroke with its fields multiplied by `mask`. A masked twist or bend is integrated in steps.
    ///
    /// `bounds` is the box of the points that will be advected. `step` bounds the travel in one step of
    /// a twist or bend, as in [`FieldStroke::new`]; other strokes keep their step.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use glam::DVec3;
    /// use isochore_field::{Mask, Pin, Stroke, Twist, advect_points};
    /// use isochore_mesh::{Aabb, NoProgress};
    ///
    /// let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0)?);
    /// let pin = Pin::new(DVec3::new(1.0, 0.0, 1.0), 0.1, 0.3)?;
    /// let mask = Arc::new(Mask::new(vec![pin], None, Vec::new())?);
    /// let bounds = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
    /// let masked = twist.masked(&mask, bounds, 0.1)?;
    ///
    /// let held = DVec3::new(1.0, 0.05, 1.0);
    /// let images = advect_points(&[held, -held], &[masked], &NoProgress)?;
    /// assert_eq!(images[0], held);
    /// assert_ne!(images[1], -held);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// - [`MaskedError::UndoneByMirror`] if the mirror images of a twist or bend cancel it.
    /// - [`MaskedError::Stamp`] for a stamp.
    /// - [`MaskedError::Field`] if the masked field takes too many steps.
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

    /// The stroke with half the time step, or `None` if it takes no steps or would take too many.
    pub(crate) fn with_half_step(&self) -> Option<Self> {
        match self {
            Self::Move(stroke) => stroke.with_half_step().ok().map(Self::Move),
            Self::Field(stroke) => stroke.with_half_step().ok().map(Self::Field),
            Self::Twist(_) | Self::Bend(_) | Self::Stamp(_) => None,
        }
    }

    /// The first part of the stroke. `fraction` is a fraction of its time, clamped to 0 to 1.
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
        "the mirror image of the motion undoes it; a twist cannot be mirrored, \
         and a bend only with its axis across the plane"
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
