//! Fields of the twist and the bend, for masked strokes. Unmasked ones have exact flows.
//!
//! ```text
//! twist: P = −½ Ω ρ² a,    V = Ω a×X,   Ω = rate · L,   L = a·X
//! bend:  P = −¼ rate s² a, V = Ω a×X,   Ω = rate · s,   s = |X|²
//! ```
//!
//! X is the position relative to the origin, a the unit direction of the axis and ρ the distance
//! from the axis. For a twist, Ω may be any function of the height L. For a bend, P = −F(s) a has
//! the curl V = 2F′(s) a×X.

use std::sync::Arc;

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::{
    Field, FieldBlock, MirrorPlane, MovingField, NO_CORE, WeightedPotential, mask::mirrored_field::MirroredField,
};

/// The symmetric mean of a motion and its mirror images counts as zero if its speed is below this
/// fraction of the speed of the motion. Larger: rejects weak motions. Smaller: rounding passes for
/// a motion.
const UNDONE: f64 = 1e-9;

/// Quantity that the angular velocity of a swirl is proportional to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SwirlLaw {
    /// Height along the axis: a twist.
    Height,
    /// Squared distance from the origin: a bend.
    SquaredDistance,
}

/// A rotation of all space about an axis whose angular velocity varies with position. The field
/// does not change with time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SwirlField {
    /// Point of the axis at which the angular velocity is zero.
    pub(crate) origin: DVec3,
    /// Unit direction of the axis.
    pub(crate) direction: DVec3,
    pub(crate) law: SwirlLaw,
    /// Angular velocity, radians per unit of time, where the quantity of the law is one.
    pub(crate) rate: f64,
    /// Box of the points to advect, in which the speed is bounded. Over all space it has no bound.
    pub(crate) bounds: Aabb,
}

impl SwirlField {
    /// Largest distance from the axis and largest angular velocity in the box. Both are largest at
    /// corners.
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

    /// Whether the symmetric mean of this field and its mirror images vanishes at all points of a
    /// grid in the box.
    pub(crate) fn is_undone_by(&self, mirrors: &[MirrorPlane]) -> bool {
        if mirrors.is_empty() || self.core_speed() == 0.0 {
            return false;
        }
        let field = MirroredField::new(Arc::new(*self), mirrors).at(0.0);
        let least = UNDONE * self.core_speed();
        let grid = |index: usize| [index % 4, index / 4 % 4, index / 16].map(|step| step as f64 / 3.0);
        let grid_point = |index| self.bounds.min + self.bounds.size() * DVec3::from_array(grid(index));
        (0..64).all(|index| field.velocity(grid_point(index)).length() <= least)
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

    /// The longest distance from the axis. It limits the rotation in a time step to the allowed
    /// fraction of travel, in radians.
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
