//! Checks of motions.

use glam::DQuat;

use super::{
    Check,
    number::{NumberCheck, all_finite, rotation},
};
use crate::recipe::{Key, error::RecipeError, problem::GeometryProblem, rotation::quaternion};

/// Angle in radians to half a turn within which the direction of rotation is ambiguous. A larger
/// value refuses clear motions; with a smaller one, rounding in the angle decides the direction in
/// which the tool rotates.
const HALF_TURN_TOLERANCE: f64 = 1e-9;

impl Key {
    /// Checks that the numbers are finite and the axis is nonzero.
    pub(crate) fn validate(&self) -> NumberCheck {
        all_finite("at", &self.at)?;
        rotation("rotate", &self.rotate)
    }
}

/// Checks the list `keys` of a stroke.
pub(super) fn motion(keys: &[Key]) -> Check {
    enough_keys(keys.len())?;
    let mut previous: Option<DQuat> = None;
    for (index, key) in keys.iter().enumerate() {
        key.validate().map_err(|error| error.inside(&index.to_string()).inside("keys"))?;
        let rotation = quaternion(key.rotate);
        if previous.is_some_and(|previous| is_half_turn(previous, rotation)) {
            return Err(RecipeError::new(&format!("keys.{index}.rotate"), GeometryProblem::HalfTurn));
        }
        previous = Some(rotation);
    }
    Ok(())
}

pub(super) fn enough_keys(count: usize) -> Result<(), RecipeError<GeometryProblem>> {
    if count >= 2 { Ok(()) } else { Err(RecipeError::new("keys", GeometryProblem::TooFewKeys(count))) }
}

/// Whether two rotations differ by half a turn.
pub(super) fn is_half_turn(before: DQuat, after: DQuat) -> bool {
    // The scalar part of the relative rotation is the cosine of half its angle. Near half a turn,
    // that cosine is half the angle that is missing.
    before.dot(after).abs() <= 0.5 * HALF_TURN_TOLERANCE
}
