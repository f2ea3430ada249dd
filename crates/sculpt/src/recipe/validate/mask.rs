//! Checks of masks.

use super::{
    Check,
    number::{all_finite, direction, fraction, not_negative, positive},
};
use crate::recipe::{Mask, VertexWeights, error::RecipeError, problem::CombinationProblem};

impl Mask {
    /// Checks everything that can be checked without the target. Keys of errors are relative to the
    /// mask.
    pub(crate) fn validate(&self) -> Check {
        for (index, pin) in self.pins.iter().enumerate() {
            let path = |name: &str| format!("pins.{index}.{name}");
            all_finite(&path("center"), &pin.center)?;
            not_negative(&path("radius"), pin.radius)?;
            positive(&path("support"), pin.support)?;
        }
        for (index, plane) in self.mirror.iter().enumerate() {
            let path = |name: &str| format!("mirror.{index}.{name}");
            all_finite(&path("point"), &plane.point)?;
            direction(&path("normal"), &plane.normal)?;
        }
        if let Some(VertexWeights::Values(weights)) = &self.vertices {
            for (index, &weight) in weights.iter().enumerate() {
                fraction(&format!("vertices.{index}"), weight)?;
            }
        }
        let Some(fade) = self.fade else { return Ok(()) };
        if self.vertices.is_none() {
            return Err(RecipeError::new("fade", CombinationProblem::FadeWithoutWeights));
        }
        Ok(positive("fade", fade)?)
    }
}
