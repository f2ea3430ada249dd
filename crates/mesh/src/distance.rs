//! What a signed distance is, whatever it is computed from.

use std::fmt::Debug;

use glam::DVec3;

use crate::{Aabb, DistanceBlock, PointBlock};

/// A signed distance function with the analytic gradient of the very function that gives its values.
///
/// The same point gives the same bits in every lane and whatever the other lanes hold.
pub trait Distance: Debug + Send + Sync {
    /// Distances and gradients at `points`, into `out`.
    fn sample_into(&self, points: &PointBlock, out: &mut DistanceBlock);

    /// [`sample_into`](Self::sample_into), perhaps in single precision and then faster: for flows, whose points are many.
    fn sample_single_into(&self, points: &PointBlock, out: &mut DistanceBlock) {
        self.sample_into(points, out);
    }

    /// No value of [`sample_single_into`](Self::sample_single_into) is farther from that of [`sample_into`](Self::sample_into)
    /// than this, model units.
    fn single_error(&self) -> f64 {
        0.0
    }

    /// Box that holds the surface, where the distance is zero.
    fn bounds(&self) -> Aabb;

    /// Centroid of the volume inside the surface.
    fn centroid(&self) -> DVec3;

    /// The values can be trusted up to this far outside the surface; beyond, they may be infinite. Infinite for closed forms.
    fn reach(&self) -> f64 {
        f64::INFINITY
    }

    /// Upper bound on the length of the gradient outside the surface. One for exact distances; more for an interpolant.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// Length below which the surface shows nothing, model units: what is this fine takes on its shape. By default an eighth of
    /// the shortest extent; where the distance is sampled, the distance between samples.
    fn detail(&self) -> f64 {
        0.125 * self.bounds().size().min_element()
    }

    /// Distance and gradient at one point.
    fn sample(&self, point: DVec3) -> (f64, DVec3) {
        let mut out = DistanceBlock::FAR;
        self.sample_into(&PointBlock::splat(point), &mut out);
        (out.value[0], out.gradient.get(0))
    }
}
