//! The bend, by its exact flow.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, equation 12.6 with unit
//! rate. A point keeps its distance from the origin, so its angular velocity is constant and its path
//! is a rotation.

use glam::DVec3;
use isochore_mesh::Aabb;

use super::axis::{Axis, AxisError};
use crate::fields::swirl_field::{SwirlField, SwirlLaw};

/// A rotation of each sphere about an origin, by an angle proportional to its squared radius. It bends a
/// bar across the axis into an arm of a spiral.
///
/// ```
/// use std::f64::consts::PI;
///
/// use glam::DVec3;
/// use isochore_field::{Bend, Stroke};
///
/// let bend = Stroke::Bend(Bend::new(DVec3::ZERO, DVec3::Z, PI)?);
/// let mut points = [0.5 * DVec3::X, DVec3::X];
/// bend.advect(&mut points);
/// // A quarter of the squared radius turns by a quarter of the angle.
/// assert!(points[0].distance(DVec3::new(0.5, 0.5, 0.0) / 2.0_f64.sqrt()) < 1e-15);
/// assert!(points[1].distance(-DVec3::X) < 1e-15);
/// # Ok::<(), isochore_field::AxisError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    axis: Axis,
    radians_per_unit2: f64,
}

impl Bend {
    /// The bend about the line through `origin` along `axis`, of any nonzero length. A point x turns,
    /// right-handed, by `radians_per_unit2` · |x − origin|².
    ///
    /// # Errors
    /// [`AxisError::Zero`] if `axis` is zero, [`AxisError::NotFinite`] if an argument is not finite.
    pub fn new(origin: DVec3, axis: DVec3, radians_per_unit2: f64) -> Result<Self, AxisError> {
        if !radians_per_unit2.is_finite() {
            return Err(AxisError::NotFinite("the rate of the bend"));
        }
        Ok(Self { axis: Axis::new(origin, axis)?, radians_per_unit2 })
    }

    pub(super) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        for point in points.iter_mut() {
            let square = (*point - self.axis.origin).length_squared();
            *point = self.axis.rotated(*point, self.radians_per_unit2 * square);
        }
        points.len() as u64
    }

    /// The field whose flow this is, for points in a box.
    pub(super) fn field(&self, bounds: Aabb) -> SwirlField {
        let Axis { origin, direction } = self.axis;
        SwirlField { origin, direction, law: SwirlLaw::SquaredDistance, rate: self.radians_per_unit2, bounds }
    }

    pub(super) fn truncated(&self, fraction: f64) -> Self {
        Self { radians_per_unit2: fraction * self.radians_per_unit2, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_flow() {
        // Equation 12.6 as printed turns at −5|x|² per unit of time; this is half a unit.
        let mut points = [DVec3::new(0.3, -0.4, 0.5)];
        Bend::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 2.0), -2.5).unwrap().advect_chunk(&mut points);
        let golden = DVec3::new(-0.436756416361175, -0.081686472536101, 0.550064680716689);
        assert!(points[0].distance(golden) < 1e-14);
    }
}
