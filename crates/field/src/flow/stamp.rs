//! A tool that presses its shape into a surface.

use std::sync::Arc;

use super::{Move, MoveError};
use crate::fields::{Pose, Tool};

/// Errors of [`Stamp::new`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StampError {
    /// The longest edge at the contact is not a positive length.
    #[error("the relief must be a positive length, not {0}")]
    Relief(f64),
    /// The keys are not a valid path.
    #[error(transparent)]
    Move(#[from] MoveError),
}

/// A tool that moves through a list of poses and dents the surface that it touches.
///
/// The tool moves the touched vertices exactly, so the surface takes on its relief. The displaced volume
/// is raised around the contact, within the support of the tool. A stamp is not a flow of points: it
/// needs a surface that encloses a volume. The profile of the tool is not used.
///
/// ```
/// use std::sync::Arc;
///
/// use glam::DVec3;
/// use isochore_field::{DeformOptions, Pose, Profile, Stamp, Stroke, Tool, deform};
/// use isochore_mesh::{NoProgress, Sphere, primitives};
///
/// let coin = Tool::new(Arc::new(Sphere::new(0.4)?), 0.3, Profile::Quintic)?;
/// let keys = vec![Pose::at(DVec3::Z * 1.5), Pose::at(DVec3::Z * 1.35)];
/// let stamp = Stroke::Stamp(Stamp::new(Arc::new(coin), keys, 0.25, Some(0.1))?);
///
/// let ball = primitives::icosphere(1.0, 3);
/// let options = DeformOptions { refine: None, lock: false };
/// let receipt = deform(&ball, &[stamp], &options, &NoProgress)?.receipt;
/// assert!(receipt.strokes[0].volume_change.unwrap().abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Stamp {
    path: Move,
    relief: f64,
}

impl Stamp {
    /// A stamp by `tool`, which moves through `keys` (world from tool) with a constant body twist between
    /// neighbors.
    ///
    /// `step` bounds the travel of the tool's fastest surface point in one step, as a fraction of the
    /// [feature size](Tool::feature_size). `relief` is the longest edge, in model units, that
    /// refinement leaves at the contact. An eighth of the wavelength of the relief shows it well. The
    /// default is the [detail](isochore_mesh::Distance::detail) of the tool's distance.
    ///
    /// # Errors
    /// [`StampError::Relief`] if `relief` is not a positive length, [`StampError::Move`] as for
    /// [`Move::new`].
    pub fn new(tool: Arc<Tool>, keys: Vec<Pose>, step: f64, relief: Option<f64>) -> Result<Self, StampError> {
        let relief = relief.unwrap_or_else(|| tool.distance().detail());
        if !(relief > 0.0 && relief.is_finite()) {
            return Err(StampError::Relief(relief));
        }
        Ok(Self { path: Move::new(tool, keys, step)?, relief })
    }

    /// The path of the tool.
    pub fn path(&self) -> &Move {
        &self.path
    }

    /// Longest edge that refinement leaves at the contact, model units.
    pub fn relief(&self) -> f64 {
        self.relief
    }

    pub(crate) fn truncated(&self, fraction: f64) -> Self {
        Self { path: self.path.truncated(fraction), ..*self }
    }
}
