//! Field of a ring that moves along its axis.
//!
//! ```text
//! V = ∇θ × ∇(g(d/R) (R₀² − ρ²)/2)
//! ```
//!
//! θ is the angle about the axis, ρ the distance from the axis, d the distance from the torus of
//! major radius R₀, R the support and g the profile. θ is multivalued, but ∇θ has one value
//! everywhere off the axis, so the ring needs no cut. V equals curl(g A) with A = −(R₀² − ρ²)/2 ∇θ.
//! The curl of A is the direction of the axis, so the core moves as one body.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.4, where
//! the ring is the sum of two strips.

use glam::DVec3;
use isochore_mesh::{Aabb, LANES, PointBlock};

use crate::fields::{Field, FieldBlock, MovingField, NO_CORE, Pose, Profile, WeightedPotential};

/// A solid ring with a support around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingShape {
    /// Center of the ring, model units.
    pub center: DVec3,
    /// Normal of the plane of the ring; any nonzero length.
    pub axis: DVec3,
    /// Radius of the center line of the tube, model units.
    pub major: f64,
    /// Radius of the tube, model units.
    pub minor: f64,
    /// Distance that the field reaches beyond the tube, model units; must end before the axis.
    pub support: f64,
    /// Profile by which the field fades over the support.
    pub profile: Profile,
}

/// A ring that moves along its axis over the time from 0 to 1.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{MovingField, Profile, Ring, RingShape};
///
/// let (major, minor, support) = (1.0, 0.25, 0.3);
/// let (center, axis, profile) = (DVec3::ZERO, DVec3::Z, Profile::Quintic);
/// let ring = Ring::new(RingShape { center, axis, major, minor, support, profile }, 0.5)?;
///
/// let field = ring.at(0.0);
/// assert!(field.velocity(DVec3::X).distance(0.5 * DVec3::Z) < 1e-15); // inside the tube
/// assert_eq!(field.velocity(DVec3::ZERO), DVec3::ZERO); // on the axis
/// # Ok::<(), isochore_field::RingError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    shape: RingShape,
    distance: f64,
}

/// Errors when constructing a [`Ring`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RingError {
    /// A length is not positive and finite.
    #[error("the {what} must be a positive length, not {value}")]
    NotPositive {
        /// Name of the length.
        what: &'static str,
        /// Value given.
        value: f64,
    },
    /// The field would reach the axis, where the angle has no gradient.
    #[error(
        "minor radius and support, {} together, reach the axis of the ring, whose major radius is {major}; reduce one of them",
        .minor + .support
    )]
    ReachesAxis {
        /// Major radius.
        major: f64,
        /// Minor radius.
        minor: f64,
        /// Support.
        support: f64,
    },
    /// The profile has a kink on the surface, which would tear the material at the ring.
    #[error("the profile `{0}` has a kink on the surface, which a ring cannot have; choose another")]
    Profile(Profile),
    /// The axis is the zero vector.
    #[error("the axis must be nonzero")]
    ZeroAxis,
    /// A number is infinite or NaN.
    #[error("{0} must be finite")]
    NotFinite(&'static str),
}

impl Ring {
    /// A ring that moves by `distance`, model units, along its axis; a negative distance moves it
    /// backwards.
    ///
    /// # Errors
    /// - [`RingError::NotPositive`] if a radius or the support is not a positive length.
    /// - [`RingError::NotFinite`] if the center, the axis or the distance is not finite.
    /// - [`RingError::ZeroAxis`] if the axis is the zero vector.
    /// - [`RingError::ReachesAxis`] if minor radius and support together reach the major radius.
    /// - [`RingError::Profile`] for the profile with a kink, [`Profile::Thesis`].
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
        // Scaled first, so that the squares of tiny and huge axes neither underflow nor overflow.
        let axis = (axis / axis.abs().max_element()).try_normalize().ok_or(RingError::ZeroAxis)?;
        if minor + support >= major {
            return Err(RingError::ReachesAxis { major, minor, support });
        }
        if profile == Profile::Thesis {
            return Err(RingError::Profile(profile));
        }
        Ok(Self { shape: RingShape { axis, ..shape }, distance })
    }

    /// The ring at time 0, with a unit axis.
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
    // A circle about the unit axis a extends √(1 − a²) of its radius along each coordinate.
    let spans = (DVec3::ONE - shape.axis * shape.axis).max(DVec3::ZERO);
    let span = DVec3::new(spans.x.sqrt(), spans.y.sqrt(), spans.z.sqrt()) * shape.major;
    Aabb { min: shape.center - span, max: shape.center + span }.expanded(shape.minor + shape.support)
}

/// A ring at one instant, with its speed.
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
            // On the center line the distance has no gradient; zero is used.
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
