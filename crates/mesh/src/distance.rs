//! The signed distance interface.

use std::fmt::Debug;

use glam::DVec3;

use crate::{Aabb, DistanceBlock, PointBlock};

/// A signed distance function and its analytic gradient.
///
/// The gradient is that of the function that is evaluated, not of an idealized distance. A point
/// yields the same bits in every lane, regardless of the points in the other lanes.
///
/// ```
/// use glam::DVec3;
/// use isochore_mesh::{Distance, Torus};
///
/// let torus = Torus::new(2.0, 0.5)?;
/// let (distance, gradient) = torus.sample(DVec3::new(3.0, 0.0, 0.0));
/// assert_eq!(distance, 0.5);
/// assert_eq!(gradient, DVec3::X);
/// # Ok::<(), isochore_mesh::ShapeError>(())
/// ```
pub trait Distance: Debug + Send + Sync {
    /// Writes distances and gradients at `points` to `out`.
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock);

    /// Like [`sample_into`](Self::sample_into), but implementations may compute in single precision
    /// for speed. Meant for flows, which sample many points.
    fn sample_single_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.sample_into(points, out);
    }

    /// Upper bound on the difference between the values of
    /// [`sample_single_into`](Self::sample_single_into) and [`sample_into`](Self::sample_into),
    /// model units.
    fn single_error(&self) -> f64 {
        0.0
    }

    /// Bounding box of the surface, the zero set of the distance.
    fn bounds(&self) -> Aabb;

    /// Box that contains all points whose value is below `distance`, a positive length in model
    /// units.
    fn bounds_within(&self, distance: f64) -> Aabb {
        self.bounds().expanded(distance)
    }

    /// Centroid of the volume inside the surface.
    fn centroid(&self) -> DVec3;

    /// Distance outside the surface up to which values are reliable, model units. Beyond it they
    /// may be infinite. Infinite for closed forms.
    fn reach(&self) -> f64 {
        f64::INFINITY
    }

    /// Upper bound on the length of the gradient outside the surface: 1 for exact distances, more
    /// for an interpolant.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// Size of the finest detail of the surface, model units; anything smaller takes on the shape
    /// of the surface. By default an eighth of the shortest extent. For a sampled distance it is
    /// the spacing of the samples.
    fn detail(&self) -> f64 {
        0.125 * self.bounds().size().min_element()
    }

    /// Returns the distance and the gradient at one point.
    fn sample(&self, point: DVec3) -> (f64, DVec3) {
        let mut out = DistanceBlock::FAR;
        self.sample_into(&PointBlock::splat(point), &mut out);
        (out.value[0], out.gradient.get(0))
    }
}
