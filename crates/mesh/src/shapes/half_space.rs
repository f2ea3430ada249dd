use glam::DVec3;

use super::ShapeError;
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// Everything behind a plane: the only shape without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    point: DVec3,
    normal: DVec3,
}

impl HalfSpace {
    /// What lies behind the plane through `point`, on the side that `normal`, of any length, points away from. Model units.
    ///
    /// # Errors
    /// [`ShapeError::NoDirection`]; [`ShapeError::NotFinite`].
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self, ShapeError> {
        if !point.is_finite() {
            return Err(ShapeError::NotFinite { shape: "half-space", what: "point" });
        }
        let normal = normal.try_normalize().ok_or(ShapeError::NoDirection { shape: "half-space", what: "normal" })?;
        Ok(Self { point, normal })
    }

    /// Unit vector away from it.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }
}

impl Distance for HalfSpace {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        for i in 0..LANES {
            let offset = points.get(i) - self.point;
            out.value[i] = offset.dot(self.normal);
            out.gradient.set(i, self.normal);
        }
    }

    /// Everything: the plane has no end.
    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
    }

    /// The point of the plane that it was made from, since its volume has no centroid.
    fn centroid(&self) -> DVec3 {
        self.point
    }
}
