//! The fields of the twist and the bend, for strokes that are masked; unmasked ones have exact flows.
//!
//! ```text
//! twist: P = −½ Ω ρ² a,   V = Ω a×X,   Ω = rate · L,     L = a·X
//! bend:  P = −¼ rate s² a, V = Ω a×X,   Ω = rate · s,     s = |X|²
//! ```
//!
//! X is the position relative to the origin, a the axis' unit direction and ρ the distance from the axis. For a twist, Ω may be
//! any function of the height L; for a bend, P = −F(s) a has V = 2F′(s) a×X.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::{
    Field, FieldBlock, MirrorPlane, MovingField, NO_CORE, WeightedPotential, mask::mirrored_field::MirroredField,
};

/// What a motion and its mirror images leave of it counts as nothing below this share. Larger refuses weak motions; smaller lets
/// rounding pass for one.
const UNDONE: f64 = 1e-9;

/// What the angular velocity of a swirl is proportional to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SwirlLaw {
    /// The height along the axis: a twist.
    Height,
    /// The squared distance from the origin: a bend.
    SquaredDistance,
}

/// All of space turns about an axis, faster in some places than in others; the field does not change with time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SwirlField {
    /// A point of the axis, where the angular velocity is zero.
    pub(crate) origin: DVec3,
    /// Unit direction of the axis.
    pub(crate) direction: DVec3,
    pub(crate) law: SwirlLaw,
    /// Angular velocity where the law's measure is one.
    pub(crate) rate: f64,
    /// Box of what is to be carried, by which the speed is bounded: without a box it has no bound.
    pub(crate) bounds: Aabb,
}

impl SwirlField {
    /// Largest distance from the axis, and largest angular velocity, in the box: both are largest at corners.
    fn extremes(&self) -> (f64, f64) {
        let corners = self.bounds.corners().map(|corner| corner - self.origin);
        let arms = corners.map(|corner| corner.reject_from_normalized(self.direction).length());
        let measures = corners.map(|corner| match self.law {
            SwirlLaw::Height => self.direction.dot(corner).abs(),
            SwirlLaw::SquaredDistance => corner.length_squared(),
        });
        let largest = |values: [f64; 8]| values.into_iter().fold(0.0, f64::max);
        (largest(arms), self.rate.abs() * largest(measures))
    }

    /// Whether the symmetric mean of this and its mirror images stands still all over the box.
    pub(crate) fn is_undone_by(&self, mirrors: &[MirrorPlane]) -> bool {
        if mirrors.is_empty() || self.core_speed() == 0.0 {
            return false;
        }
        let field = MirroredField::new(Arc::new(*self), mirrors).at(0.0);
        let least = UNDONE * self.core_speed();
        let grid = |index: usize| [index % 4, index / 4 % 4, index / 16].map(|step| step as f64 / 3.0);
        let place = |index| self.bounds.min + self.bounds.size() * DVec3::from_array(grid(index));
        (0..64).all(|index| field.velocity(place(index)).length() <= least)
    }
}

impl MovingField for SwirlField {
    fn at(&self, _time: f64) -> Box<dyn Field> {
        Box::new(*self)
    }

    fn approach_speed(&self) -> f64 {
        0.0
    }

    fn core_speed(&self) -> f64 {
        let (arm, angular) = self.extremes();
        arm * angular
    }

    /// The longest arm, so that a step turns by no more than the fraction of it that bounds the travel, in radians.
    fn feature_size(&self) -> f64 {
        let (arm, _) = self.extremes();
        if arm > 0.0 { arm } else { f64::INFINITY }
    }

    fn feature_size_near(&self, _center: DVec3, _radius: f64) -> f64 {
        f64::INFINITY
    }
}

impl Field for SwirlField {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        for lane in 0..LANES {
            let arm = points.get(lane) - self.origin;
            let turn = self.direction.cross(arm);
            let (potential, angular) = match self.law {
                SwirlLaw::Height => {
                    let angular = self.rate * self.direction.dot(arm);
                    (-0.5 * angular * turn.length_squared(), angular)
                }
                SwirlLaw::SquaredDistance => {
                    let square = arm.length_squared();
                    (-0.25 * self.rate * square * square, self.rate * square)
                }
            };
            let (potential, curl) = (potential * self.direction, angular * turn);
            let product = WeightedPotential { weight: 1.0, gradient: DVec3::ZERO, potential, curl };
            out.set_inside(lane, product, NO_CORE);
        }
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
    }
}
