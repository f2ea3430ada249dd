//! The Jacobian determinant of the flow map. For the exact flow of a divergence-free field it is one.
//!
//! The determinant comes from central differences of the discrete map that advects the vertices, with
//! its time step, rigid cores and sleeping points. The variational equation would need second
//! derivatives of every distance, and would describe another discrete map.
//!
//! Let ℓ be the length over which the field changes, and h = [`DIFFERENCE`] · ℓ. The truncation error
//! is h² times the third derivatives of the map, about 1e-8 of the stretch over ℓ. The rounding error
//! is about 1e-16 |x|/h. At a jump of the velocity the derivative does not exist, and the result is
//! meaningless.

use glam::{DMat3, DVec3};
use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use super::{Stroke, advection::advect};

/// Half the distance between differenced points, as a fraction of the length over which the field
/// changes. A larger value shows truncation; a smaller value shows rounding.
const DIFFERENCE: f64 = 1e-4;

/// Most vertices that are tested for a touch by the stroke. A larger value costs time; a smaller value
/// misses small tools.
const CANDIDATES: usize = 8192;

/// Most vertices at which the determinant is computed. Each costs the advection of six points. A larger
/// value costs time; a smaller value misses the worst vertex.
const SAMPLES: usize = 128;

/// The smallest and the largest Jacobian determinant of a flow map.
///
/// ```
/// use glam::DVec3;
/// use isochore_field::{DeformOptions, JacobianRange, Stroke, Twist, deform};
/// use isochore_mesh::{NoProgress, primitives};
///
/// let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::Z, 1.0)?);
/// let options = DeformOptions { refine: None, lock: false };
/// let receipt = deform(&primitives::icosphere(1.0, 2), &[twist], &options, &NoProgress)?.receipt;
/// let JacobianRange { min, max } = receipt.strokes[0].jacobian.unwrap();
/// assert!(min > 1.0 - 1e-6 && max < 1.0 + 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JacobianRange {
    /// The smallest determinant; zero or negative if the map folds.
    pub min: f64,
    /// The largest determinant.
    pub max: f64,
}

impl JacobianRange {
    /// Largest deviation from one.
    pub(crate) fn deviation(&self) -> f64 {
        (1.0 - self.min).max(self.max - 1.0)
    }

    /// The range of the flow map of `stroke` over some of the points that it moves, or `None` if it moves
    /// none.
    pub(crate) fn of(stroke: &Stroke, points: &[DVec3], monitor: &dyn Monitor) -> Result<Option<Self>, Cancelled> {
        let size = Aabb::of(points.iter().copied()).size().max_element();
        let candidates = evenly(points, CANDIDATES).collect::<Vec<_>>();
        let touched: Vec<DVec3> = candidates.into_par_iter().filter(|point| stroke.may_touch(*point, 0.0)).collect();
        let centers: Vec<DVec3> = evenly(&touched, SAMPLES).collect();
        let lengths: Vec<f64> =
            centers.iter().map(|&center| DIFFERENCE * stroke.feature_size_near(center, 0.0).min(size)).collect();

        let mut advected: Vec<DVec3> = centers.clone();
        for (&center, &length) in centers.iter().zip(&lengths) {
            advected.extend(DVec3::AXES.iter().flat_map(|&axis| [center + length * axis, center - length * axis]));
        }
        advect(&mut advected, std::slice::from_ref(stroke), monitor)?;
        let (images, sides) = advected.split_at(centers.len());
        let moved = (0..centers.len()).filter(|&index| images[index] != centers[index]);
        let determinants = moved.map(|index| {
            let column =
                |axis: usize| (sides[6 * index + 2 * axis] - sides[6 * index + 2 * axis + 1]) / (2.0 * lengths[index]);
            DMat3::from_cols(column(0), column(1), column(2)).determinant()
        });
        Ok(determinants.filter(|determinant| determinant.is_finite()).fold(None, |range: Option<Self>, value| {
            let Self { min, max } = range.unwrap_or(Self { min: value, max: value });
            Some(Self { min: min.min(value), max: max.max(value) })
        }))
    }
}

/// At most `count` of the points, evenly spaced in their order.
fn evenly(points: &[DVec3], count: usize) -> impl Iterator<Item = DVec3> {
    points.iter().copied().step_by(points.len().div_ceil(count).max(1))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use isochore_mesh::{NoProgress, Sphere, primitives};

    use super::*;
    use crate::{
        fields::{Pose, Profile, Tool},
        flow::{Move, Twist},
    };

    fn press(step: f64) -> Stroke {
        let tool = Tool::new(Arc::new(Sphere::new(0.4).unwrap()), 0.3, Profile::Septic).unwrap();
        let keys = vec![Pose::at(DVec3::new(0.1, 0.0, 1.6)), Pose::at(DVec3::new(0.0, 0.1, 1.1))];
        Stroke::Move(Move::new(Arc::new(tool), keys, step).unwrap())
    }

    fn range(stroke: &Stroke) -> JacobianRange {
        JacobianRange::of(stroke, &primitives::icosphere(1.0, 5).positions, &NoProgress).unwrap().unwrap()
    }

    #[test]
    fn determinant_of_an_exact_flow_is_one() {
        let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5), 1.5).unwrap());
        // h = 2e-4 of the size, squared, times the third power of the rate, over six.
        assert!(range(&twist).deviation() < 1e-7, "{:?}", range(&twist));
    }

    #[test]
    fn determinant_converges_to_one_with_order_four() {
        let [coarse, fine] = [0.25, 0.125].map(|step| range(&press(step)).deviation());
        // Half the step leaves a sixteenth in the limit of short steps. These steps leave a little more.
        assert!(coarse > 1e-4 && fine < coarse / 8.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn no_determinant_without_moved_points() {
        let points = [DVec3::splat(9.0)];
        assert_eq!(JacobianRange::of(&press(0.125), &points, &NoProgress), Ok(None));
        assert_eq!(JacobianRange::of(&press(0.125), &[], &NoProgress), Ok(None));
    }
}
