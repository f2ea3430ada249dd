//! The Jacobian determinant of the flow map, which is one everywhere for the exact flow of a divergence-free field.
//!
//! It is taken from central differences of the very map that carries the vertices, time step, rigid cores and sleeping
//! included, rather than from the variational equation: that would ask every field for second derivatives of its distance, and
//! tell of another discrete map than the one in use. At a distance h of [`DIFFERENCE`] times the length ℓ over which the field
//! changes, the two agree up to h² times the third derivatives of the map, about 1e-8 times what the map stretches over ℓ, and
//! to rounding, about 1e-16 |x|/h. Across a jump of the velocity no derivative exists, and the figure means nothing.

use glam::{DMat3, DVec3};
use isochore_mesh::{Aabb, Cancelled, Monitor};
use rayon::prelude::*;

use super::{Stroke, advection::advect};

/// Distance of the points whose difference is taken, as a share of the length over which the field changes. Larger: truncation
/// shows. Smaller: rounding does.
const DIFFERENCE: f64 = 1e-4;

/// Vertices that are asked whether a stroke may touch them, at most. More costs time; fewer misses small tools.
const CANDIDATES: usize = 8192;

/// Vertices at which the determinant is taken, at most, each at the cost of carrying six points.
const SAMPLES: usize = 128;

/// The least and the largest determinant found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JacobianRange {
    /// The least; zero or below where the map folds over.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl JacobianRange {
    /// How far the worst is from one.
    pub(crate) fn deviation(&self) -> f64 {
        (1.0 - self.min).max(self.max - 1.0)
    }

    /// The range of the flow map of `stroke` over some of those points that it moves; none where it moves none.
    pub(crate) fn of(stroke: &Stroke, points: &[DVec3], monitor: &dyn Monitor) -> Result<Option<Self>, Cancelled> {
        let size = Aabb::of(points.iter().copied()).size().max_element();
        let candidates = evenly(points, CANDIDATES).collect::<Vec<_>>();
        let touched: Vec<DVec3> = candidates.into_par_iter().filter(|point| stroke.may_touch(*point, 0.0)).collect();
        let centers: Vec<DVec3> = evenly(&touched, SAMPLES).collect();
        let lengths: Vec<f64> =
            centers.iter().map(|&center| DIFFERENCE * stroke.feature_size_near(center, 0.0).min(size)).collect();

        let mut carried: Vec<DVec3> = centers.clone();
        for (&center, &length) in centers.iter().zip(&lengths) {
            carried.extend(DVec3::AXES.iter().flat_map(|&axis| [center + length * axis, center - length * axis]));
        }
        advect(&mut carried, std::slice::from_ref(stroke), monitor)?;
        let (images, sides) = carried.split_at(centers.len());
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

/// At most `count` of the points, evenly spread over their order.
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
    fn exact_flows_have_a_determinant_of_one() {
        let twist = Stroke::Twist(Twist::new(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5), 1.5).unwrap());
        // h = 2e-4 of the size, squared, times the third power of the rate, over six.
        assert!(range(&twist).deviation() < 1e-7, "{:?}", range(&twist));
    }

    #[test]
    fn the_determinant_tends_to_one_with_order_four() {
        let [coarse, fine] = [0.25, 0.125].map(|step| range(&press(step)).deviation());
        // Half the step leaves a sixteenth; steps this long are a little off that, and 1e-6 is left by the differences.
        assert!(coarse > 1e-4 && fine < coarse / 8.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn nothing_moved_has_no_determinant() {
        let points = [DVec3::splat(9.0)];
        assert_eq!(JacobianRange::of(&press(0.125), &points, &NoProgress), Ok(None));
        assert_eq!(JacobianRange::of(&press(0.125), &[], &NoProgress), Ok(None));
    }
}
