//! G¹ Hermite interpolation by Pythagorean-hodograph cubics.
//!
//! Source: Mäurer and Jüttler 1999, table 1. Correction: the printed absolute values |λ₁| and |λ₂|
//! are valid only for λ₁ > 0 > λ₂. With signed values, the quadratic equation is valid for all
//! data. Differences of nearly equal tangents are computed first, so that short arcs keep their
//! digits.

use glam::DVec3;

use super::PhCubic;
use crate::spline::COORDINATE_LIMIT;

/// Errors when interpolating end points and tangents.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PhCubicError {
    /// A coordinate is NaN, infinite or beyond 1e50.
    #[error("an end point or tangent has a coordinate that is NaN, infinite or beyond 1e50")]
    NotFinite,
    /// The end points coincide.
    #[error("the end points coincide")]
    RepeatedPoint,
    /// A tangent is zero.
    #[error("an end tangent is zero")]
    ZeroTangent,
    /// The quadratic equation for the control polygon has no real root.
    #[error("no Pythagorean-hodograph cubic has these ends: the discriminant {discriminant} is negative")]
    NoRealRoot {
        /// Discriminant of the equation, model units squared.
        discriminant: f64,
    },
    /// Every cubic with these ends has a reversed end tangent.
    #[error("every Pythagorean-hodograph cubic with these ends has a reversed tangent")]
    WrongDirection,
    /// The tangents are parallel to each other but not to the chord, which requires an inflection.
    #[error(
        "parallel tangents that are not parallel to the chord require an inflection, and a Pythagorean-hodograph cubic \
         does not have one"
    )]
    ParallelTangents,
}

/// Error when interpolating samples: a segment without a solution.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("segment {segment}: {reason}")]
pub struct HermiteError {
    /// The segment, counted from zero.
    pub segment: usize,
    /// Reason of the failure.
    pub reason: PhCubicError,
}

/// Largest difference of parallel tangents. Larger: flat arcs are treated as lines. Smaller:
/// rounding of the tangents counts as a difference.
const PARALLEL: f64 = 1e-14;

/// Largest sine of the angle between the chord and parallel tangents of a line. Larger: slight
/// S-shapes become lines. Smaller: lines with rounded coordinates are rejected.
const ALONG: f64 = 1e-12;

impl PhCubic {
    /// Interpolates two end points and the directions of their tangents. If two solutions follow
    /// both tangents, returns the one with the shorter control polygon.
    ///
    /// Most data with strong turning have no solution. Sufficiently dense samples of a smooth curve
    /// without inflections have one, with an error of fourth order.
    ///
    /// # Errors
    /// - [`PhCubicError::NotFinite`], [`PhCubicError::RepeatedPoint`] or
    ///   [`PhCubicError::ZeroTangent`] if the input is invalid.
    /// - [`PhCubicError::NoRealRoot`], [`PhCubicError::WrongDirection`] or
    ///   [`PhCubicError::ParallelTangents`] if the data have no solution.
    pub fn hermite(start: DVec3, end: DVec3, start_tangent: DVec3, end_tangent: DVec3) -> Result<Self, PhCubicError> {
        for vector in [start, end, start_tangent, end_tangent] {
            if !(vector.is_finite() && vector.abs().max_element() <= COORDINATE_LIMIT) {
                return Err(PhCubicError::NotFinite);
            }
        }
        let chord = end - start;
        if chord.length_squared() == 0.0 {
            return Err(PhCubicError::RepeatedPoint);
        }
        let t0 = start_tangent.try_normalize().ok_or(PhCubicError::ZeroTangent)?;
        let t1 = end_tangent.try_normalize().ok_or(PhCubicError::ZeroTangent)?;
        let cubic = |[first, last]: [f64; 2]| {
            let (departure, arrival) = (t0 * first, t1 * last);
            Self::from_sides(start, [departure, chord - departure - arrival, arrival])
        };
        outer_lengths(chord, t0, t1)?
            .into_iter()
            .filter(|&[first, last]| first > 0.0 && last > 0.0 && first.is_finite() && last.is_finite())
            .map(cubic)
            .min_by(|a, b| a.polygon_length().total_cmp(&b.polygon_length()))
            .ok_or(PhCubicError::WrongDirection)
    }
}

/// Candidates for the lengths (L₁, L₃) of the outer sides of the control polygon, signed along the
/// tangents.
fn outer_lengths(chord: DVec3, t0: DVec3, t1: DVec3) -> Result<[[f64; 2]; 2], PhCubicError> {
    let sum = t0 + t1;
    // Sum and difference of unit vectors are orthogonal. Orthogonalizing again removes the rounding
    // of their lengths, which on short arcs exceeds the component of the difference along the
    // curve.
    let difference = (t1 - t0) - sum * ((t1 - t0).dot(sum) / sum.length_squared().max(f64::MIN_POSITIVE));
    // 1 − c and 1 + c for c = t₀ · t₁, without cancellation.
    let minus = 0.5 * difference.length_squared();
    let plus = 0.5 * sum.length_squared();
    if difference.length() < PARALLEL {
        let third = chord.length() / 3.0;
        return if t0.cross(chord).length() <= ALONG * chord.length() {
            let signed = libm::copysign(third, chord.dot(t0));
            Ok([[signed; 2]; 2])
        } else {
            Err(PhCubicError::ParallelTangents)
        };
    }
    if sum.length() < PARALLEL {
        // A planar turn by half a circle, for which the general equation degenerates. L₁ − L₃ is
        // the component of the chord along t₀, and L₁L₃ is the square of the component across it.
        let along = chord.dot(t0);
        let root = libm::hypot(along, 2.0 * chord.reject_from_normalized(t0).length());
        let first = 0.5 * (along + root);
        return Ok([[first, first - along]; 2]);
    }
    let quotient = chord.dot(difference) / minus;
    let lambda = (chord.dot(t1) - quotient) / plus;
    let mu = (chord.dot(t0) + quotient) / plus; // −λ₂
    let normal = t0.cross(t1);
    let gap = chord.dot(normal) / normal.length();
    // (1 + 2c) X² + (λ₁ − λ₂) X + λ₁λ₂ + 2N²/(1 − c) = 0, with L₁ = λ₁ − X and L₃ = −λ₂ − X.
    let quadratic = 2.0 * plus - 1.0;
    let linear = lambda + mu;
    let constant = 2.0 * gap * gap / minus - lambda * mu;
    let discriminant = linear * linear - 4.0 * quadratic * constant;
    if discriminant.is_nan() || discriminant < 0.0 {
        return Err(PhCubicError::NoRealRoot { discriminant });
    }
    let half = -0.5 * (linear + libm::copysign(discriminant.sqrt(), linear));
    Ok([half / quadratic, constant / half].map(|x| [lambda - x, mu - x]))
}
