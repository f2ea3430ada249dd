//! Mirror planes.

use glam::DVec3;

use super::MaskError;

/// A plane about which fields are made symmetric, so that nothing flows through it.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{Mask, MaskError, MirrorPlane};
///
/// let plane = |normal: DVec3| MirrorPlane::new(DVec3::ZERO, normal).unwrap();
/// assert!(Mask::new(Vec::new(), None, vec![plane(DVec3::X), plane(DVec3::Y)]).is_ok());
///
/// let slanted = Mask::new(Vec::new(), None, vec![plane(DVec3::X), plane(DVec3::ONE)]);
/// assert_eq!(slanted.unwrap_err(), MaskError::NotPerpendicular { first: 0, second: 1 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MirrorPlane {
    point: DVec3,
    normal: DVec3,
}

impl MirrorPlane {
    /// The plane through `point` with the given `normal`, of any nonzero length.
    ///
    /// # Errors
    /// [`MaskError::NotFinite`] if a coordinate is not finite, [`MaskError::ZeroNormal`] if the
    /// normal is zero.
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self, MaskError> {
        if !(point.is_finite() && normal.is_finite()) {
            return Err(MaskError::NotFinite("the point and the normal of a mirror plane"));
        }
        // Scaled first, so that the squares of tiny and huge normals neither underflow nor
        // overflow.
        let largest = normal.abs().max_element();
        if largest == 0.0 {
            return Err(MaskError::ZeroNormal);
        }
        Ok(Self { point, normal: (normal / largest).normalize() })
    }

    /// Unit normal.
    pub(crate) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Signed distance of a point, positive on the side of the normal.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }

    /// Mirror image of a point.
    pub(crate) fn reflect_point(&self, point: DVec3) -> DVec3 {
        point - 2.0 * self.distance(point) * self.normal
    }

    /// Mirror image of a velocity or a gradient. A vector potential is a pseudovector; its mirror
    /// image is the negative of this.
    pub(crate) fn reflect_vector(&self, vector: DVec3) -> DVec3 {
        vector - 2.0 * self.normal.dot(vector) * self.normal
    }
}
