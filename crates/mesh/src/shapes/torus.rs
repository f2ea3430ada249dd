use glam::{DVec3, dvec3};
use multiversion::multiversion;

use super::{ShapeError, inverse_or_zero, positive};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// All points within the minor radius of a circle about the z axis.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, Torus};
///
/// let torus = Torus::new(2.0, 0.5)?;
/// assert_eq!(torus.sample(DVec3::X * 2.0).0, -0.5);
/// assert!(Torus::new(1.0, 1.0).is_err());
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torus {
    major: f64,
    minor: f64,
}

impl Torus {
    /// A torus around the circle of radius `major` in the plane z = 0, with a tube of radius
    /// `minor`. Model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`] if a radius is not positive and finite;
    /// [`ShapeError::TorusCrossesItself`] unless `minor < major`.
    pub fn new(major: f64, minor: f64) -> Result<Self, ShapeError> {
        let torus =
            Self { major: positive("torus", "major radius", major)?, minor: positive("torus", "minor radius", minor)? };
        if minor < major { Ok(torus) } else { Err(ShapeError::TorusCrossesItself { major, minor }) }
    }

    /// Radius of the center circle of the tube, model units.
    pub fn major(&self) -> f64 {
        self.major
    }

    /// Radius of the tube, model units.
    pub fn minor(&self) -> f64 {
        self.minor
    }
}

impl Distance for Torus {
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        sample(self, points, out);
    }

    fn bounds(&self) -> Aabb {
        let reach = self.major + self.minor;
        let corner = dvec3(reach, reach, self.minor);
        Aabb { min: -corner, max: corner }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}

/// [`Distance::sample_into`], compiled for several register widths.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn sample(shape: &Torus, points: &PointBlock, out: &mut DistanceBlock) {
    for i in 0..LANES {
        let (x, y, z) = (points.x[i], points.y[i], points.z[i]);
        // If the squares overflow, clamp to a finite number, so that no product below is ∞ · 0.
        let radius = (x * x + y * y).sqrt().min(f64::MAX);
        let off_circle = radius - shape.major;
        let length = (off_circle * off_circle + z * z).sqrt();
        // On the axis all points of the circle are equally near, so the distance has no gradient.
        let inverse = if radius > 0.0 { inverse_or_zero(length) } else { 0.0 };
        let (radial, outward) = (off_circle * inverse, inverse_or_zero(radius));
        out.value[i] = length - shape.minor;
        out.gradient.x[i] = x * outward * radial;
        out.gradient.y[i] = y * outward * radial;
        out.gradient.z[i] = z * inverse;
    }
}
