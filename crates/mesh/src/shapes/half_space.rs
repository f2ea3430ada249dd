use glam::DVec3;

use super::ShapeError;
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// All points behind a plane; the only unbounded shape.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, HalfSpace};
///
/// let ground = HalfSpace::new(DVec3::ZERO, DVec3::Z)?;
/// assert_eq!(ground.sample(DVec3::new(4.0, 2.0, -3.0)), (-3.0, DVec3::Z));
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    point: DVec3,
    normal: DVec3,
}

impl HalfSpace {
    /// The half-space behind the plane through `point`. `normal` points away from it and may have
    /// any length. Model units.
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`] if `point` is not finite; [`ShapeError::NoDirection`] if `normal`
    /// is zero or not finite.
    pub fn new(point: DVec3, normal: DVec3) -> Result<Self, ShapeError> {
        if !point.is_finite() {
            return Err(ShapeError::NotFinite { shape: "half-space", what: "point" });
        }
        let normal = normal.try_normalize().ok_or(ShapeError::NoDirection { shape: "half-space", what: "normal" })?;
        Ok(Self { point, normal })
    }

    /// Unit normal of the plane, which points away from the half-space.
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

    /// All of space, because the plane is unbounded.
    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
    }

    /// The point passed to [`new`](HalfSpace::new), because an unbounded volume has no centroid.
    fn centroid(&self) -> DVec3 {
        self.point
    }
}
