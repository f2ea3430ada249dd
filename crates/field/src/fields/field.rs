//! The interface of all divergence-free fields.
//!
//! ```text
//! V = curl(s A) = s curl A + ∇s × A
//! ```
//!
//! s is the weight, A the vector potential of the full motion. [`FieldBlock`] holds s A, V and s
//! for a block of points. Every stroke uses a [`MovingField`], except the unmasked twist and bend,
//! which have exact flows.

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

/// A divergence-free velocity field at one instant, in world coordinates: the curl of a vector
/// potential.
///
/// The result for a point has the same bits in every lane, independent of the other lanes.
///
/// # Examples
/// A uniform current as a field of one's own:
///
/// ```
/// use glam::DVec3;
/// use isochore_field::{Field, FieldBlock, NO_CORE, WeightedPotential};
/// use isochore_mesh::{Aabb, LANES, PointBlock};
///
/// #[derive(Debug)]
/// struct Current(DVec3);
///
/// impl Field for Current {
///     fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
///         for lane in 0..LANES {
///             // curl(½ v × x) = v
///             let potential = 0.5 * self.0.cross(points.get(lane));
///             let (weight, gradient) = (1.0, DVec3::ZERO);
///             let product = WeightedPotential { weight, gradient, potential, curl: self.0 };
///             out.set_inside(lane, product, NO_CORE);
///         }
///     }
///
///     fn bounds(&self) -> Aabb {
///         Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
///     }
/// }
///
/// assert_eq!(Current(DVec3::X).velocity(DVec3::new(0.3, -2.0, 1.0)), DVec3::X);
/// ```
pub trait Field: Debug + Send + Sync {
    /// Evaluates the field at `points`, given in world coordinates, and overwrites `out`.
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock);

    /// Box outside which the field is zero; infinite if the field acts everywhere.
    fn bounds(&self) -> Aabb;

    /// Boxes whose union contains the support, one for each separate part. All lie within
    /// [`bounds`](Self::bounds).
    fn parts(&self) -> Vec<Aabb> {
        vec![self.bounds()]
    }

    /// Pose (world from body) of the rigid body with the index `core`, as reported in
    /// [`FieldBlock::core`].
    fn core_pose(&self, _core: u32) -> Pose {
        Pose::IDENTITY
    }

    /// Velocity at one point.
    fn velocity(&self, point: DVec3) -> DVec3 {
        let mut block = FieldBlock::ZERO;
        self.evaluate_into(&PointBlock::splat(point), &mut block);
        block.velocity.get(0)
    }
}

/// A [`Field`] that changes over a stroke, whose time runs from 0 to 1.
///
/// Velocities are per unit of this time. The field must depend smoothly on time; where a motion
/// changes abruptly, a new stroke or leg of a stroke begins. For a field that does not change, use
/// [`SteadyField`](crate::SteadyField).
pub trait MovingField: Any + Debug + Send + Sync {
    /// The field at `time`.
    fn at(&self, time: f64) -> Box<dyn Field>;

    /// Upper bound, over all times, on the speed at which the support approaches a point at rest,
    /// model units per unit of time.
    fn approach_speed(&self) -> f64;

    /// Upper bound, over all times, on the speed in the core, where the weight is one. The time
    /// step is chosen from it.
    fn core_speed(&self) -> f64;

    /// Length over which the field varies, model units.
    fn feature_size(&self) -> f64;

    /// Length over which the field varies within a ball. Surface edges longer than this can miss
    /// detail of the field. Infinite if the field has no detail in the ball.
    fn feature_size_near(&self, _center: DVec3, _radius: f64) -> f64 {
        self.feature_size()
    }
}

/// Values of a field at the points of a block.
#[derive(Debug, Clone, Copy)]
pub struct FieldBlock {
    /// Vector potential s A.
    pub potential: PointBlock,
    /// Velocity, the curl of the potential.
    pub velocity: PointBlock,
    /// Weight s, the fraction of the full motion: one in the core, zero beyond the support.
    pub weight: ScalarBlock,
    /// Positive if the point is beyond the support: a lower bound on its distance from the support,
    /// model units. The velocity is then exactly zero.
    pub clearance: [f64; LANES],
    /// Index, for [`Field::core_pose`], of the rigid body whose motion is exactly the velocity at
    /// the point and in a neighborhood of it, or [`NO_CORE`].
    pub core: [u32; LANES],
}

/// The velocity is not that of one known rigid body.
pub const NO_CORE: u32 = u32::MAX;

impl FieldBlock {
    /// A block without field and with unknown distance from the support.
    pub const ZERO: Self = Self {
        potential: PointBlock::ZERO,
        velocity: PointBlock::ZERO,
        weight: ScalarBlock::ZERO,
        clearance: [0.0; LANES],
        core: [NO_CORE; LANES],
    };

    /// Multiplies the potential P by the function f = `factor` and updates velocity and weight:
    /// curl(f P) = f curl P + ∇f × P.
    pub fn scale(&mut self, factor: &ScalarBlock) {
        for lane in 0..LANES {
            let (value, gradient) = (factor.value[lane], factor.gradient.get(lane));
            let weight_gradient = self.weight.gradient.get(lane) * value + gradient * self.weight.value[lane];
            self.velocity
                .set(lane, curl_of_product(value, gradient, self.potential.get(lane), self.velocity.get(lane)));
            self.potential.set(lane, value * self.potential.get(lane));
            self.weight.value[lane] *= value;
            self.weight.gradient.set(lane, weight_gradient);
            if value != 1.0 || gradient != DVec3::ZERO {
                self.core[lane] = NO_CORE;
            }
        }
    }

    /// Sets one lane to a point within the support. `core` is the index of the rigid body whose
    /// motion is exactly the velocity at the point and in a neighborhood of it, or [`NO_CORE`].
    #[inline]
    pub fn set_inside(&mut self, lane: usize, product: WeightedPotential, core: u32) {
        self.set_product(lane, product);
        self.clearance[lane] = 0.0;
        self.core[lane] = core;
    }

    /// Sets one lane to a point beyond the support, at least `clearance` away from it.
    #[inline]
    pub fn set_outside(&mut self, lane: usize, clearance: f64) {
        self.set_product(lane, WeightedPotential::ZERO);
        // A point on the edge has clearance zero, but zero would mark it as inside.
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

/// A vector potential s A at one point, given by its two factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPotential {
    /// Weight s, the fraction of the full motion.
    pub weight: f64,
    /// Gradient of s.
    pub gradient: DVec3,
    /// Vector potential A of the full motion.
    pub potential: DVec3,
    /// Curl of A, the velocity of the full motion.
    pub curl: DVec3,
}

impl WeightedPotential {
    const ZERO: Self = Self { weight: 0.0, gradient: DVec3::ZERO, potential: DVec3::ZERO, curl: DVec3::ZERO };
}

/// Kernel of all fields: curl(s A) = s curl A + ∇s × A.
#[inline(always)]
pub(crate) fn curl_of_product(weight: f64, gradient: DVec3, potential: DVec3, curl: DVec3) -> DVec3 {
    weight * curl + gradient.cross(potential)
}
