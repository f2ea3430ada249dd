//! Signed distances in closed form, each centered at the origin of its own frame.
//!
//! Inside and outside, the values are exact Euclidean distances. Where the distance has no gradient (center, axis, medial
//! surface) the gradient is zero; it has unit length everywhere else.

mod capsule;
mod ellipsoid;
mod half_space;
mod rounded_box;
mod sphere;
mod torus;

#[cfg(test)]
mod tests;

pub use capsule::Capsule;
pub use ellipsoid::Ellipsoid;
pub use half_space::HalfSpace;
pub use rounded_box::RoundedBox;
pub use sphere::Sphere;
pub use torus::Torus;

/// Why a shape cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A length that must be positive and finite is not.
    #[error("the {length} of a {shape} must be positive and finite, not {value}")]
    NotPositive {
        /// Name of the shape.
        shape: &'static str,
        /// Name of the length.
        length: &'static str,
        /// The offending value, model units.
        value: f64,
    },
    /// A box cannot be rounded by more than its smallest half extent, nor by less than nothing.
    #[error("the rounding of a box must lie between 0 and its smallest half extent {limit}, not {rounding}")]
    Rounding {
        /// The offending value, model units.
        rounding: f64,
        /// The smallest half extent, model units.
        limit: f64,
    },
    /// A direction of length zero, or of no length at all.
    #[error("the {what} of a {shape} must have a direction")]
    NoDirection {
        /// Name of the shape.
        shape: &'static str,
        /// Which vector.
        what: &'static str,
    },
    /// A coordinate is infinite or not a number.
    #[error("the {what} of a {shape} must be finite")]
    NotFinite {
        /// Name of the shape.
        shape: &'static str,
        /// Which point.
        what: &'static str,
    },
    /// A torus whose tube reaches its axis would cross itself.
    #[error("the minor radius {minor} of a torus must be smaller than its major radius {major}")]
    TorusCrossesItself {
        /// Radius of the circle, model units.
        major: f64,
        /// Radius of the tube, model units.
        minor: f64,
    },
    /// An ellipsoid so flat or thin that rounding would decide its distances.
    #[error(
        "the radii of an ellipsoid must not differ by more than a factor of {limit}, but one is {ratio} times another"
    )]
    TooAnisotropic {
        /// Largest radius over smallest.
        ratio: f64,
        /// Largest ratio that is accepted.
        limit: f64,
    },
}

/// Passes on `value` if it is positive and finite.
fn positive(shape: &'static str, length: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(ShapeError::NotPositive { shape, length, value }) }
}

/// 1 / `length`, or zero where the length is zero, so that a product with it is a unit vector or nothing.
#[inline]
fn inverse_or_zero(length: f64) -> f64 {
    if length > 0.0 { 1.0 / length } else { 0.0 }
}

/// −1, 0 or 1. (`f64::signum` gives ±1 for zeros, which would invent a gradient on planes of symmetry.)
#[inline]
fn sign_or_zero(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
