use glam::DVec3;
use multiversion::multiversion;

use super::{ShapeError, inverse_or_zero, positive, sign_or_zero};
use crate::{Aabb, Distance, DistanceBlock, LANES, PointBlock};

/// An axis-aligned box whose edges and corners are rounded by a rolling ball.
///
/// ```
/// use glam::{DVec3, dvec3};
/// use isochore_mesh::{Distance, RoundedBox};
///
/// let rounded = RoundedBox::new(dvec3(2.0, 1.0, 1.0), 0.25)?;
/// assert_eq!(rounded.sample(DVec3::X * 3.0).0, 1.0);
/// assert!(rounded.sample(dvec3(2.0, 1.0, 1.0)).0 > 0.0); // The corner is rounded off.
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundedBox {
    half_extents: DVec3,
    rounding: f64,
}

impl RoundedBox {
    /// A box from −`half_extents` to `half_extents`. Rounding removes material inside these
    /// extents: the faces keep their positions, and edges get the radius `rounding`. Zero keeps
    /// edges sharp. Model units.
    ///
    /// # Errors
    /// [`ShapeError::NotPositive`] if a half extent is not positive and finite;
    /// [`ShapeError::Rounding`] if `rounding` is negative or larger than the smallest half extent.
    pub fn new(half_extents: DVec3, rounding: f64) -> Result<Self, ShapeError> {
        for extent in half_extents.to_array() {
            positive("box", "half extents", extent)?;
        }
        let limit = half_extents.min_element();
        if !(0.0..=limit).contains(&rounding) {
            return Err(ShapeError::Rounding { rounding, limit });
        }
        Ok(Self { half_extents, rounding })
    }

    /// Half edge lengths of the box before rounding, model units.
    pub fn half_extents(&self) -> DVec3 {
        self.half_extents
    }

    /// Radius of the edges, model units.
    pub fn rounding(&self) -> f64 {
        self.rounding
    }
}

impl Distance for RoundedBox {
    /// The distance to the inner box traced by the ball's center, minus the ball's radius.
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        sample(self, points, out);
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: -self.half_extents, max: self.half_extents }
    }

    fn centroid(&self) -> DVec3 {
        DVec3::ZERO
    }
}

/// [`Distance::sample_into`], compiled for several register widths.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "aarch64+neon"))]
fn sample(shape: &RoundedBox, points: &PointBlock, out: &mut DistanceBlock) {
    let core = shape.half_extents - shape.rounding;
    for i in 0..LANES {
        let (x, y, z) = (points.x[i], points.y[i], points.z[i]);
        let (qx, qy, qz) = (x.abs() - core.x, y.abs() - core.y, z.abs() - core.z);
        let (ox, oy, oz) = (qx.max(0.0), qy.max(0.0), qz.max(0.0));
        let outside = (ox * ox + oy * oy + oz * oz).sqrt();
        let nearest = qx.max(qy).max(qz);
        out.value[i] = outside + nearest.min(0.0) - shape.rounding;

        let inverse = inverse_or_zero(outside);
        // Inside the core, the nearest face alone determines the direction. If two faces are
        // equally near, the gradient is zero.
        let ties = f64::from(qx == nearest) + f64::from(qy == nearest) + f64::from(qz == nearest);
        let face = if outside == 0.0 && ties == 1.0 { 1.0 } else { 0.0 };
        let along = |q: f64, o: f64| o * inverse + if q == nearest { face } else { 0.0 };
        out.gradient.x[i] = sign_or_zero(x) * along(qx, ox);
        out.gradient.y[i] = sign_or_zero(y) * along(qy, oy);
        out.gradient.z[i] = sign_or_zero(z) * along(qz, oz);
    }
}
