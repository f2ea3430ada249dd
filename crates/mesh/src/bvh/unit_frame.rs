use glam::DVec3;

use crate::Aabb;

/// A frame in which a mesh fills the cube from −1 to 1. The center of its bounding box is the
/// origin, and its longest side is between 1 and 2.
///
/// In this frame, coordinates may be rounded to `f32`. In model space, far from the origin, that
/// would lose all precision. The scale is a power of two, so scaling is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnitFrame {
    center: DVec3,
    scale: f64,
}

#[expect(clippy::wrong_self_convention, reason = "the frame is named first, then the conversion of a point")]
impl UnitFrame {
    /// The frame of a bounding box.
    pub(crate) fn around(aabb: Aabb) -> Self {
        // Half coordinates, because the sum or the difference of huge coordinates could overflow.
        let (min, max) = (0.5 * aabb.min, 0.5 * aabb.max);
        let half = (max - min).max_element();
        let scale = if half > 0.0 {
            // An exponent below that of the smallest normal number would make the scale infinite.
            libm::ldexp(1.0, -libm::frexp(half).1.max(-1000))
        } else {
            1.0
        };
        Self { center: min + max, scale }
    }

    /// Maps a point from model space to the unit frame.
    pub(crate) fn to_unit(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// Maps a point from the unit frame to model space.
    pub(crate) fn from_unit(&self, point: DVec3) -> DVec3 {
        point / self.scale + self.center
    }

    /// Factor from lengths in model space to lengths in the unit frame.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }
}
