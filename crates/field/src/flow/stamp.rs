//! A tool that presses its shape into a surface.

use std::sync::Arc;

use super::{Move, MoveError};
use crate::fields::{Pose, Tool};

/// Errors of [`Stamp::new`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StampError {
    /// The longest edge of a footprint is not a positive length.
    #[error("the relief must be a positive length, not {0}")]
    Relief(f64),
    /// The keys do not make a path.
    #[error(transparent)]
    Move(#[from] MoveError),
}

/// A tool's way through a list of poses, along which it dents whatever it touches.
///
/// What it touches it carries along exactly, so that the surface takes on its relief; what it displaces is raised around the
/// contact, within the tool's support. That is no flow of points: it needs a surface that encloses a volume. The tool's
/// profile plays no part.
#[derive(Debug, Clone)]
pub struct Stamp {
    way: Move,
    relief: f64,
}

impl Stamp {
    /// A stamp that `tool` makes on its way through `keys` (world from tool), with constant body twist between neighbors.
    ///
    /// `step` bounds the travel of the tool's fastest surface point in one step, as a fraction of the
    /// [feature size](Tool::feature_size). `relief` is the longest edge, in model units, that refinement leaves where the tool
    /// touches: an eighth of the relief's wavelength shows it well. By default it is the
    /// [detail](isochore_mesh::Distance::detail) of the tool's distance.
    ///
    /// # Errors
    /// As [`Move::new`], and [`StampError::Relief`].
    pub fn new(tool: Arc<Tool>, keys: Vec<Pose>, step: f64, relief: Option<f64>) -> Result<Self, StampError> {
        let relief = relief.unwrap_or_else(|| tool.distance().detail());
        if !(relief > 0.0 && relief.is_finite()) {
            return Err(StampError::Relief(relief));
        }
        Ok(Self { way: Move::new(tool, keys, step)?, relief })
    }

    /// Where the tool goes.
    pub fn way(&self) -> &Move {
        &self.way
    }

    /// Longest edge that refinement leaves where the tool touches, model units.
    pub fn relief(&self) -> f64 {
        self.relief
    }

    pub(super) fn truncated(&self, fraction: f64) -> Self {
        Self { way: self.way.truncated(fraction), ..*self }
    }
}
