//! Poses of tools.

use glam::DVec3;
use isochore_field as field;

use crate::recipe::{Key, NumberProblem, RecipeError, rotation::quaternion};

impl Key {
    /// The pose as a rotation and a translation, world from tool.
    ///
    /// # Errors
    /// [`RecipeError`] with the key `at` or `rotate`, if a number is not finite or the axis is
    /// zero.
    ///
    /// ```
    /// use isochore_sculpt::recipe::Key;
    ///
    /// let key = Key { at: [0.0, 0.0, 1.0], rotate: [0.0, 0.0, 1.0, 90.0] };
    /// let image = key.pose()?.transform([1.0, 0.0, 0.0].into());
    /// assert!(image.distance([0.0, 1.0, 1.0].into()) < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose(&self) -> Result<field::Pose, RecipeError<NumberProblem>> {
        self.validate()?;
        Ok(field::Pose { rotation: quaternion(self.rotate), translation: DVec3::from_array(self.at) })
    }
}
