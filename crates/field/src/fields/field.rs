//! Divergence-free fields that change with time: what every stroke but the exact twist and bend is made of.

#[cfg(test)]
pub(crate) mod finite_differences;
#[cfg(test)]
pub(crate) mod flux;
#[cfg(test)]
mod identities;
mod scalar_block;

use std::{any::Any, fmt::Debug};

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::Pose;
pub use scalar_block::ScalarBlock;

/// A divergence-free velocity field at one instant, in world coordinates: the curl of a vector potential.
///
/// The same point gives the same bits in every lane and whatever the other lanes hold.
pub trait Field: Debug + Send + Sync {
    /// The field at `points`, into `out`.
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock);

    /// Box outside which the field is zero; infinite where it acts everywhere.
    fn bounds(&self) -> Aabb;

    /// Boxes outside all of which the field is zero, within [`bounds`](Self::bounds): one for each part that lies apart.
    fn parts(&self) -> Vec<Aabb> {
        vec![self.bounds()]
    }

    /// World from body for one of the rigid bodies that [`FieldBlock::core`] names.
    fn core_pose(&self, _core: u32) -> Pose {
        Pose::IDENTITY
    }

    /// The velocity at one point.
    fn velocity(&self, point: DVec3) -> DVec3 {
        let mut block = FieldBlock::ZERO;
        self.evaluate_into(&PointBlock::splat(point), &mut block);
        block.velocity.get(0)
    }
}

/// A [`Field`] that changes over a stroke, whose time runs from 0 to 1.
///
/// Velocities are per unit of this time. The field depends smoothly on time: where a motion changes abruptly, a new stroke or
/// leg of one begins.
pub trait MovingField: Any + Debug + Send + Sync {
    /// The field at `time`.
    fn at(&self, time: f64) -> Box<dyn Field>;

    /// Upper bound, over the whole time, on the speed at which the support comes closer to a point that rests.
    fn approach_speed(&self) -> f64;

    /// Upper bound, over the whole time, on the speed of the field where it carries fully: what the time step is measured by.
    fn core_speed(&self) -> f64;

    /// Length over which the field changes.
    fn feature_size(&self) -> f64;

    /// Length over which the field changes in a ball: surface coarser than this can miss it there. Infinite where it cannot.
    fn feature_size_near(&self, _center: DVec3, _radius: f64) -> f64 {
        self.feature_size()
    }
}

/// A field at the points of a block.
#[derive(Debug, Clone, Copy)]
pub struct FieldBlock {
    /// The vector potential, s A.
    pub potential: PointBlock,
    /// Its curl, the velocity.
    pub velocity: PointBlock,
    /// s, the share of the full motion: one in the core, zero beyond the support.
    pub weight: ScalarBlock,
    /// Above zero where the point is beyond the support: then a lower bound on the distance to it, and the velocity is exactly
    /// zero.
    pub clearance: [f64; LANES],
    /// The rigid body whose motion is exactly the velocity at the point and around, for [`Field::core_pose`], or [`NO_CORE`].
    pub core: [u32; LANES],
}

/// The velocity at this point is that of no rigid body, or of one that cannot be told.
pub const NO_CORE: u32 = u32::MAX;

impl FieldBlock {
    /// No field, and no knowledge of how far it is.
    pub const ZERO: Self = Self {
        potential: PointBlock::ZERO,
        velocity: PointBlock::ZERO,
        weight: ScalarBlock::ZERO,
        clearance: [0.0; LANES],
        core: [NO_CORE; LANES],
    };

    /// Multiplies the potential by `factor`, and lets velocity and share follow: curl(f P) = f curl P + ∇f × P.
    pub fn scale(&mut self, factor: &ScalarBlock) {
        for lane in 0..LANES {
            let (value, gradient) = (factor.value[lane], factor.gradient.get(lane));
            let share = self.weight.gradient.get(lane) * value + gradient * self.weight.value[lane];
            self.velocity
                .set(lane, curl_of_product(value, gradient, self.potential.get(lane), self.velocity.get(lane)));
            self.potential.set(lane, value * self.potential.get(lane));
            self.weight.value[lane] *= value;
            self.weight.gradient.set(lane, share);
            if value != 1.0 || gradient != DVec3::ZERO {
                self.core[lane] = NO_CORE;
            }
        }
    }

    /// Sets one lane to a point within the support. `core` is the rigid body whose motion is exactly the velocity at the point
    /// and around it, or [`NO_CORE`].
    #[inline]
    pub fn set_inside(&mut self, lane: usize, product: WeightedPotential, core: u32) {
        self.set_product(lane, product);
        self.clearance[lane] = 0.0;
        self.core[lane] = core;
    }

    /// Sets one lane to a point beyond the support by at least `clearance`.
    #[inline]
    pub fn set_outside(&mut self, lane: usize, clearance: f64) {
        self.set_product(lane, WeightedPotential::ZERO);
        // On the very edge the clearance is zero, and the field is too.
        self.clearance[lane] = clearance.max(f64::MIN_POSITIVE);
        self.core[lane] = NO_CORE;
    }

    #[inline]
    fn set_product(&mut self, lane: usize, product: WeightedPotential) {
        let WeightedPotential { weight, gradient, potential, curl } = product;
        self.potential.set(lane, weight * potential);
        self.velocity.set(lane, curl_of_product(weight, gradient, potential, curl));
        self.weight.value[lane] = weight;
        self.weight.gradient.set(lane, gradient);
    }
}

/// A vector potential s A at one point, by its two factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPotential {
    /// s, the fraction of the full motion.
    pub weight: f64,
    /// Gradient of s.
    pub gradient: DVec3,
    /// A, the potential of the full motion.
    pub potential: DVec3,
    /// Curl of A, the velocity of the full motion.
    pub curl: DVec3,
}

impl WeightedPotential {
    const ZERO: Self = Self { weight: 0.0, gradient: DVec3::ZERO, potential: DVec3::ZERO, curl: DVec3::ZERO };
}

/// The one kernel of all fields: curl(s A) = s curl A + ∇s × A.
#[inline(always)]
pub(crate) fn curl_of_product(share: f64, gradient: DVec3, potential: DVec3, curl: DVec3) -> DVec3 {
    share * curl + gradient.cross(potential)
}
