//! The field of a ring that moves along its axis.
//!
//! ```text
//! V = ∇θ × ∇(g(d/R) (R₀² − ρ²)/2)
//! ```
//!
//! θ is the angle about the axis, ρ the distance from it, d the distance from the torus of major radius R₀, R the support and g
//! the profile. ∇θ has one value everywhere off the axis although θ has not, so the ring needs no cut. As curl(g A) with
//! A = −(R₀² − ρ²)/2 ∇θ, whose curl is the axis' direction, the core moves as one body.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.4, where the ring is the sum of two
//! strips.

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::{Field, FieldBlock, MovingField, NO_CORE, Pose, Profile, WeightedPotential};

/// A solid ring with a support around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingShape {
    /// Middle of the ring, model units.
    pub center: DVec3,
    /// Direction across the ring's plane, of any length but zero.
    pub axis: DVec3,
    /// Radius of the circle in the middle of the tube, model units.
    pub major: f64,
    /// Radius of the tube, model units.
    pub minor: f64,
    /// How far the field reaches beyond the tube, model units; short of the axis.
    pub support: f64,
    /// How the field fades over the support.
    pub profile: Profile,
}

/// A ring on its way along its axis, from time 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    shape: RingShape,
    distance: f64,
}

/// Why there is no such ring.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RingError {
    /// A length that must be positive is not.
    #[error("the {what} must be a positive length, not {value}")]
    NotPositive {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The field would reach the axis, where the angle has no gradient.
    #[error(
        "minor radius and support, {} together, reach the axis of the ring, which is {major} away; give less of them",
        .minor + .support
    )]
    ReachesAxis {
        /// The major radius.
        major: f64,
        /// The minor radius.
        minor: f64,
        /// The support.
        support: f64,
    },
    /// The profile has a kink on the surface, across which a ring would be torn.
    #[error("the profile `{0}` is for tools that move rigidly; choose another")]
    Profile(Profile),
    /// The axis has no direction.
    #[error("the axis must have a length")]
    ZeroAxis,
    /// A number is infinite or not a number.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
}

impl Ring {
    /// The way of the ring by `distance`, model units, along its axis; backwards where that is negative.
    ///
    /// # Errors
    /// [`RingError`].
    pub fn new(shape: RingShape, distance: f64) -> Result<Self, RingError> {
        let RingShape { center, axis, major, minor, support, profile } = shape;
        for (what, value) in [("major radius", major), ("minor radius", minor), ("support", support)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RingError::NotPositive { what, value });
            }
        }
        for (what, is_finite) in
            [("the center", center.is_finite()), ("the axis", axis.is_finite()), ("the distance", distance.is_finite())]
        {
            if !is_finite {
                return Err(RingError::NotFinite(what));
            }
        }
        // Scaled first, so that neither tiny nor huge axes leave the range in which squares are representable.
        let axis = (axis / axis.abs().max_element()).try_normalize().ok_or(RingError::ZeroAxis)?;
        if minor + support >= major {
            return Err(RingError::ReachesAxis { major, minor, support });
        }
        if profile == Profile::Thesis {
            return Err(RingError::Profile(profile));
        }
        Ok(Self { shape: RingShape { axis, ..shape }, distance })
    }

    /// The ring at time 0; its axis is a unit vector.
    pub fn shape(&self) -> &RingShape {
        &self.shape
    }

    fn center_at(&self, time: f64) -> DVec3 {
        self.shape.center + self.distance * time * self.shape.axis
    }
}

impl MovingField for Ring {
    fn at(&self, time: f64) -> Box<dyn Field> {
        let shape = RingShape { center: self.center_at(time), ..self.shape };
        Box::new(PlacedRing { shape, speed: self.distance, bounds: bounds(&shape) })
    }

    fn approach_speed(&self) -> f64 {
        self.distance.abs()
    }

    fn core_speed(&self) -> f64 {
        self.distance.abs()
    }

    fn feature_size(&self) -> f64 {
        self.shape.support.min(self.shape.minor)
    }
}

/// Box of the support.
fn bounds(shape: &RingShape) -> Aabb {
    // A circle about the unit axis a spans √(1 − a²) of its radius along each coordinate.
    let spans = (DVec3::ONE - shape.axis * shape.axis).max(DVec3::ZERO);
    let span = DVec3::new(spans.x.sqrt(), spans.y.sqrt(), spans.z.sqrt()) * shape.major;
    Aabb { min: shape.center - span, max: shape.center + span }.expanded(shape.minor + shape.support)
}

/// A ring where it is at one instant, and how fast it moves.
#[derive(Debug, Clone, Copy)]
struct PlacedRing {
    shape: RingShape,
    speed: f64,
    bounds: Aabb,
}

impl Field for PlacedRing {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        let RingShape { center, axis, major, minor, support, profile } = self.shape;
        for lane in 0..LANES {
            let offset = points.get(lane) - center;
            let height = axis.dot(offset);
            let arm = offset - height * axis;
            let radius = arm.length();
            let off_circle = radius - major;
            let from_circle = (off_circle * off_circle + height * height).sqrt();
            let distance = from_circle - minor;
            if distance >= support {
                out.set_outside(lane, distance - support);
                continue;
            }
            let (weight, slope) = profile.evaluate(distance / support);
            // In the very middle of the tube the distance has no gradient, and is given none.
            let inverse = if from_circle > 0.0 { 1.0 / from_circle } else { 0.0 };
            let gradient = slope / support * inverse * (off_circle / radius * arm + height * axis);
            let angle_gradient = axis.cross(arm) / (radius * radius);
            let potential = -0.5 * (major - radius) * (major + radius) * angle_gradient;
            let core = if weight == 1.0 && gradient == DVec3::ZERO { 0 } else { NO_CORE };
            let (potential, curl) = (self.speed * potential, self.speed * axis);
            out.set_inside(lane, WeightedPotential { weight, gradient, potential, curl }, core);
        }
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn core_pose(&self, _core: u32) -> Pose {
        Pose::at(self.shape.center)
    }
}

#[cfg(test)]
pub(crate) mod tests;
