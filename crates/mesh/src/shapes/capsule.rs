use glam::{DVec3, dvec3};
use multiversion::multiversion;

use super::{ShapeError, inverse_or_zero, positive};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// All points within a radius of a segment on the z axis.
///
/// ```
/// use glam::dvec3;
/// use isochore_mesh::{Capsule, Distance};
///
/// let capsule = Capsule::new(0.5, 1.0)?;
/// assert_eq!(capsule.sample(dvec3(2.0, 0.0, 0.5)).0, 1.5);
/// assert_eq!(capsule.bounds().max, dvec3(0.5, 0.5, 1.5));
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    radius: f64,
    half_length: f64,
}

impl Capsule {
    /// A capsule around the segment from z = −`half_length` to z = `half_length`. Its caps extend
    /// the length by `radius` at both ends. Model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`] if a length is not positive and finite.
    pub fn new(radius: f64, half_length: f64) -> Result<Self, ShapeError> {
        Ok(Self {
            radius: positive("capsule", "radius", radius)?,
            half_length: positive("capsule", "half length", half_length)?,
        })
    }

    /// Radius, model units.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Half the length of the segment, model units.
    pub fn half_length(&self) -> f64 {
        self.half_length
    }
}

impl Distance for Capsule {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        sample(self, points, out);
    }

    fn bounds(&self) -> Aabb {
        let corner = dvec3(self.radius, self.radius, self.half_length + self.radius);
        Aabb { min: -corner, max: corner }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}

/// [`Distance::sample_into`], compiled for several register widths.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn sample(shape: &Capsule, points: &PointBlock, out: &mut DistanceBlock) {
    for i in 0..LANES {
        let (x, y) = (points.x[i], points.y[i]);
        let z = points.z[i] - points.z[i].clamp(-shape.half_length, shape.half_length);
        let length = (x * x + y * y + z * z).sqrt();
        let inverse = inverse_or_zero(length);
        out.value[i] = length - shape.radius;
        out.gradient.x[i] = x * inverse;
        out.gradient.y[i] = y * inverse;
        out.gradient.z[i] = z * inverse;
    }
}
