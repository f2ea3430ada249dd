//! Poses of tools.

use glam::DVec3;
use isochore_field as field;

use crate::recipe::{Key, RecipeError, rotation::quaternion};

impl Key {
    /// The pose as a rotation and a translation, world from tool.
    ///
    /// # Errors
    /// [`RecipeError`] with the key `at` or `rotate`, if a number is not finite or the axis is zero.
    pub fn pose(&self) -> Result<field::Pose, RecipeError> {
        self.validate()?;
        Ok(field::Pose { rotation: quaternion(self.rotate), translation: DVec3::from_array(self.at) })
    }
}
