//! Signed distances in closed form. Each shape is centered at the origin of its own frame.
//!
//! The values are exact Euclidean distances, inside and outside. If the distance has no gradient
//! (center, axis, medial surface), the gradient is zero. Everywhere else it has unit length.

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

/// Errors when constructing a shape.
///
/// ```
/// use isochore_mesh::Sphere;
///
/// let error = Sphere::new(0.0).unwrap_err();
/// assert_eq!(error.to_string(), "the radius of a sphere must be positive and finite, not 0");
/// ```
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
    /// The rounding of a box is negative, NaN or larger than the smallest half extent.
    #[error("the rounding of a box must be between 0 and its smallest half extent {limit}, not {rounding}")]
    Rounding {
        /// The offending value, model units.
        rounding: f64,
        /// The smallest half extent, model units.
        limit: f64,
    },
    /// A direction vector has length zero or is not finite.
    #[error("the {what} of a {shape} must be finite and not zero")]
    NoDirection {
        /// Name of the shape.
        shape: &'static str,
        /// Name of the vector.
        what: &'static str,
    },
    /// A coordinate is infinite or NaN.
    #[error("the {what} of a {shape} must be finite")]
    NotFinite {
        /// Name of the shape.
        shape: &'static str,
        /// Name of the point.
        what: &'static str,
    },
    /// The tube of a torus reaches its axis, so the torus would intersect itself.
    #[error("the minor radius {minor} of a torus must be smaller than its major radius {major}")]
    TorusCrossesItself {
        /// Radius of the circle, model units.
        major: f64,
        /// Radius of the tube, model units.
        minor: f64,
    },
    /// The radii of an ellipsoid differ so much that rounding would dominate its distances.
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

/// Returns `value` if it is positive and finite.
fn positive(shape: &'static str, length: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(ShapeError::NotPositive { shape, length, value }) }
}

/// 1 / `length`, or zero if the length is zero. The product with a vector of that length is a unit
/// vector or zero.
#[inline]
fn inverse_or_zero(length: f64) -> f64 {
    if length > 0.0 { 1.0 / length } else { 0.0 }
}

/// −1, 0 or 1. (`f64::signum` is ±1 for zeros, which would create a gradient on planes of
/// symmetry.)
#[inline]
fn sign_or_zero(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
