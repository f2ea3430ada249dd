use glam::DVec3;
use multiversion::multiversion;

use super::{ShapeError, inverse_or_zero, positive};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// A ball centered at the origin.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, Sphere};
///
/// let sphere = Sphere::new(2.0)?;
/// assert_eq!(sphere.sample(DVec3::Z * 5.0), (3.0, DVec3::Z));
/// assert!(Sphere::new(-1.0).is_err());
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    radius: f64,
}

impl Sphere {
    /// A ball of the given radius, model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`] if the radius is not positive and finite.
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self { radius: positive("sphere", "radius", radius)? })
    }

    /// Radius, model units.
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Distance for Sphere {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        sample(self, points, out);
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::splat(-self.radius), max: DVec3::splat(self.radius) }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}

/// [`Distance::sample_into`], compiled for several register widths.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn sample(shape: &Sphere, points: &PointBlock, out: &mut DistanceBlock) {
    for i in 0..LANES {
        let (x, y, z) = (points.x[i], points.y[i], points.z[i]);
        let length = (x * x + y * y + z * z).sqrt();
        let inverse = inverse_or_zero(length);
        out.value[i] = length - shape.radius;
        out.gradient.x[i] = x * inverse;
        out.gradient.y[i] = y * inverse;
        out.gradient.z[i] = z * inverse;
    }
}
