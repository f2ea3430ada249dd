//! Mirror planes.

use glam::DVec3;

use super::MaskError;

/// A plane that fields are made symmetric about: nothing flows through it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MirrorPlane {
    point: DVec3,
    normal: DVec3,
}

impl MirrorPlane {
    /// The plane through `point` across `normal`, of any length but zero.
    ///
    /// # Errors
    /// [`MaskError::NotFinite`], [`MaskError::ZeroNormal`].
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self, MaskError> {
        if !(point.is_finite() && normal.is_finite()) {
            return Err(MaskError::NotFinite("the point and the normal of a mirror plane"));
        }
        // Scaled first, so that neither tiny nor huge normals leave the range in which squares are representable.
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

    /// Signed distance of a point, positive on the side that the normal points to.
    pub(crate) fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }

    /// The mirror image of a point.
    pub(crate) fn reflect_point(&self, point: DVec3) -> DVec3 {
        point - 2.0 * self.distance(point) * self.normal
    }

    /// The mirror image of a velocity or a gradient. That of a vector potential is the negative: a curl turns the sign.
    pub(crate) fn reflect_vector(&self, vector: DVec3) -> DVec3 {
        vector - 2.0 * self.normal.dot(vector) * self.normal
    }
}
