//! The twist, by its exact flow.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, equation 12.5 with unit
//! rate. A point keeps its height along the axis, so its angular velocity is constant and its path is
//! a rotation.

use glam::DVec3;
use isochore_mesh::Aabb;

use super::axis::{Axis, AxisError};
use crate::fields::swirl_field::{SwirlField, SwirlLaw};

/// A rotation of each plane across an axis, by an angle proportional to the height of the plane.
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
///
/// use glam::DVec3;
/// use isochore_field::{Stroke, Twist};
///
/// let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, FRAC_PI_2)?);
/// let mut points = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 1.0)];
/// twist.advect(&mut points);
/// assert_eq!(points[0], DVec3::X);
/// assert!(points[1].distance(DVec3::new(0.0, 1.0, 1.0)) < 1e-15);
/// # Ok::<(), isochore_field::AxisError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    axis: Axis,
    radians_per_unit: f64,
}

impl Twist {
    /// The twist about the line through `origin` along `axis`, of any nonzero length. A point x turns,
    /// right-handed, by `radians_per_unit` · a·(x − origin), where a is the unit vector along `axis`.
    ///
    /// # Errors
    /// [`AxisError::Zero`] if `axis` is zero, [`AxisError::NotFinite`] if an argument is not finite.
    pub fn new(origin: DVec3, axis: DVec3, radians_per_unit: f64) -> Result<Self, AxisError> {
        if !radians_per_unit.is_finite() {
            return Err(AxisError::NotFinite("the rate of the twist"));
        }
        Ok(Self { axis: Axis::new(origin, axis)?, radians_per_unit })
    }

    pub(super) fn advect_chunk(&self, points: &mut [DVec3]) -> u64 {
        for point in points.iter_mut() {
            let height = self.axis.direction.dot(*point - self.axis.origin);
            *point = self.axis.rotated(*point, self.radians_per_unit * height);
        }
        points.len() as u64
    }

    /// The field whose flow this is, for points in a box.
    pub(super) fn field(&self, bounds: Aabb) -> SwirlField {
        let Axis { origin, direction } = self.axis;
        SwirlField { origin, direction, law: SwirlLaw::Height, rate: self.radians_per_unit, bounds }
    }

    pub(super) fn truncated(&self, fraction: f64) -> Self {
        Self { radians_per_unit: fraction * self.radians_per_unit, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    const AXIS: DVec3 = DVec3::new(1.0, 2.0, 2.0);
    const POINT: DVec3 = DVec3::new(0.3, -0.4, 0.5);

    fn twisted(radians_per_unit: f64) -> DVec3 {
        let mut points = [POINT];
        Twist::new(DVec3::ZERO, AXIS, radians_per_unit).unwrap().advect_chunk(&mut points);
        points[0]
    }

    #[test]
    fn golden_flow() {
        // Equation 12.5 as printed turns at −4 L per unit of time; the first value is after half a unit. The
        // second is a quarter turn per unit of length.
        let raw = DVec3::new(0.090228213243689, -0.382773373565182, 0.587659266943338);
        let unit = DVec3::new(0.446962184598840, -0.373957009710995, 0.400475917411575);
        assert!(twisted(-2.0).distance(raw) < 1e-14);
        assert!(twisted(FRAC_PI_2).distance(unit) < 1e-14);
    }

    #[test]
    fn points_on_the_neutral_plane_keep_their_bits() {
        let mut points = [DVec3::new(0.1, 0.7, 0.3)];
        Twist::new(DVec3::new(0.0, 0.0, 0.3), DVec3::Z, 1.0).unwrap().advect_chunk(&mut points);
        assert_eq!(points[0], DVec3::new(0.1, 0.7, 0.3));
    }

    #[test]
    fn rejects_invalid_axes() {
        assert_eq!(Twist::new(DVec3::ZERO, DVec3::ZERO, 1.0), Err(AxisError::Zero));
        assert_eq!(Twist::new(DVec3::ZERO, DVec3::NAN, 1.0), Err(AxisError::NotFinite("the axis")));
        assert!(Twist::new(DVec3::ZERO, DVec3::new(0.0, 1e-300, 0.0), 1.0).is_ok());
    }
}
