//! Strokes: the motions that deform, each the exact or integrated flow of a divergence-free field.

mod bend;
mod field_stroke;
mod movement;
mod reach;
mod rotation;
mod stamp;
mod twist;

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::Aabb;

pub use bend::Bend;
pub use field_stroke::FieldStroke;
pub use movement::Move;
pub use stamp::Stamp;
pub use twist::Twist;

use crate::{Mask, RingError, StripError, swirl_field::SwirlField};

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
    /// [`StrokeError`]: a way of too many steps, a motion that its own mirror image takes back, a stamp.
    pub fn masked(&self, mask: &Arc<Mask>, bounds: Aabb, step: f64) -> Result<Self, StrokeError> {
        if mask.is_empty() {
            return Ok(self.clone());
        }
        let swirl = |field: SwirlField| {
            if field.is_undone_by(mask.mirrors()) {
                return Err(StrokeError::UndoneByMirror);
            }
            FieldStroke::new(vec![Arc::new(field)], step)
        };
        let fields = match self {
            Self::Move(stroke) => FieldStroke::new(stroke.fields(), stroke.step())?,
            Self::Field(stroke) => stroke.clone(),
            Self::Twist(stroke) => swirl(stroke.field(bounds))?,
            Self::Bend(stroke) => swirl(stroke.field(bounds))?,
            Self::Stamp(_) => return Err(StrokeError::StampMasked),
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

/// Why a stroke cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StrokeError {
    /// A path needs two poses at least.
    #[error("the path needs at least two keys, not {0}")]
    TooFewKeys(usize),
    /// Two keys half a turn apart.
    #[error("keys {key} and {} are exactly 180° apart, so that the way to turn is open; put a key between them", .key + 1)]
    HalfTurn {
        /// Index of the first of the two, from 0.
        key: usize,
    },
    /// The step is not a positive fraction.
    #[error("the step must be a positive fraction, not {0}")]
    Step(f64),
    /// The longest edge of a footprint is not a positive length.
    #[error("the relief must be a positive length, not {0}")]
    Relief(f64),
    /// The path is so long for its step that it would not end.
    #[error("the way from key {key} takes {steps:.0} steps; at most {} are allowed", movement::MAX_STEPS)]
    TooManySteps {
        /// Index of the key at the start of the way, from 0.
        key: usize,
        /// Steps it would take.
        steps: f64,
    },
    /// The axis has no direction.
    #[error("the axis must have a length")]
    ZeroAxis,
    /// A twist or a bend whose mirror image turns the other way.
    #[error(
        "the mirror image of the motion undoes it; only an axis across the plane goes with a bend, and none with a twist"
    )]
    UndoneByMirror,
    /// A stamp is no flow that a mask could hold back.
    #[error("a stamp has no field that a mask could hold back; leave out the mask, or move the tool instead")]
    StampMasked,
    /// A number is infinite or not a number.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
    /// The stroke's strip cannot be.
    #[error(transparent)]
    Strip(#[from] StripError),
    /// The stroke's ring cannot be.
    #[error(transparent)]
    Ring(#[from] RingError),
}
