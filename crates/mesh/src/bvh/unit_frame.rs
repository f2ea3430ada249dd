use glam::DVec3;

use crate::Aabb;

/// A frame in which a mesh fills the cube from −1 to 1: its center at the origin, its longest side between 1 and 2.
///
/// Only there may coordinates be rounded to `f32`: far from the origin of model space that would cost all precision. The scale
/// is a power of two, so that scaling is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnitFrame {
    center: DVec3,
    scale: f64,
}

impl UnitFrame {
    /// The frame around what these bounds hold.
    pub(crate) fn around(aabb: Aabb) -> Self {
        // Halves first: the sum and the difference of huge coordinates could overflow.
        let (min, max) = (0.5 * aabb.min, 0.5 * aabb.max);
        let half = (max - min).max_element();
        let scale = if half > 0.0 {
            // A smaller exponent than that of the smallest normal number would make the scale infinite.
            libm::ldexp(1.0, -libm::frexp(half).1.max(-1000))
        } else {
            1.0
        };
        Self { center: min + max, scale }
    }

    /// From model space into the frame.
    pub(crate) fn inward(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// From the frame into model space.
    pub(crate) fn outward(&self, point: DVec3) -> DVec3 {
        point / self.scale + self.center
    }

    /// A length in the frame over the same length in model space.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }
}
