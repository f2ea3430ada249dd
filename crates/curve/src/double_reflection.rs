//! The double reflection step.
//!
//! Source: W. Wang, B. Jüttler, D. Zheng, Y. Liu, Computation of rotation minimizing frames, ACM
//! Transactions on Graphics 27(1), 2008, table I. Symbols of the paper: v₁ = `chord`, t_i =
//! `start`, t_{i+1} = `end`, r_i = `r`.

use glam::DVec3;

/// Smallest squared length of a chord, which is then 1e-150 long. Smaller: squares are subnormal
/// and lose digits in the division. Larger: short chords of tiny models are rejected.
const SHORTEST_SQUARED_CHORD: f64 = 1e-300;

/// Smallest squared length of the vector of the second reflection. It is at most 4, and near 4 for
/// well sampled curves. Larger: usable coarse samples are rejected (8 samples of the torus knot
/// reach 0.9). Smaller: a reversed tangent is accepted, and rounding makes the frame jump, because
/// the limit depends on the direction from which this vector approaches zero.
pub(crate) const SMALLEST_SECOND_REFLECTION: f64 = 0.04;

/// Moves `r` from the normal plane of the unit tangent `start` to that of `end`: one reflection
/// along `chord`, and a second one that maps the reflected `start` to `end`. Returns `None` if the
/// reflections are not determined.
///
/// The result is exact for curves on a sphere or plane. For other curves, its error is of fifth
/// order in the length of the step. The step commutes with inversions, and the step of the reversed
/// segment is its inverse.
///
/// Only the direction of `chord` matters. The length of `r` is arbitrary and preserved.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::reflect_twice;
///
/// // A quarter of a circle in the xy-plane: the inward normal stays the inward normal.
/// let r = reflect_twice(DVec3::new(-1.0, 1.0, 0.0), DVec3::Y, -DVec3::X, -DVec3::X);
/// assert!(r.is_some_and(|r| r.distance(-DVec3::Y) < 1e-15));
/// assert_eq!(reflect_twice(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z), None);
/// ```
#[inline]
pub fn reflect_twice(chord: DVec3, start: DVec3, end: DVec3, r: DVec3) -> Option<DVec3> {
    let first = chord.dot(chord);
    let factor = 2.0 / first;
    let reflected_tangent = start - chord * (factor * chord.dot(start));
    let difference = end - reflected_tangent;
    let second = difference.dot(difference);
    // Also false for NaN.
    if !(first >= SHORTEST_SQUARED_CHORD && second >= SMALLEST_SECOND_REFLECTION) {
        return None;
    }
    let reflected = r - chord * (factor * chord.dot(r));
    Some(reflected - difference * (2.0 / second * difference.dot(reflected)))
}

/// A rotation by an angle about an axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisAngle {
    /// Unit axis.
    pub axis: DVec3,
    /// Angle in radians, right-handed about the axis, in [0, 2π).
    pub angle: f64,
}

impl AxisAngle {
    /// The rotation that [`reflect_twice`] applies. Returns `None` if [`reflect_twice`] does.
    ///
    /// Use it to obtain the motion itself, and use the reflections to move frames. On straight
    /// parts the axis is rounding error; if the angle is zero, it is `end`.
    ///
    /// Source: Wang et al. 2008, section 4.5, where γ is misprinted: γ⁻² = |Δx|² |Δt|² + 4 (Δx ·
    /// t₀)(Δx · t₁).
    pub fn of_double_reflection(chord: DVec3, start: DVec3, end: DVec3) -> Option<Self> {
        let unit = chord.try_normalize()?;
        let difference = end - (start - unit * (2.0 * unit.dot(start)));
        let second = difference.length_squared();
        if second < SMALLEST_SECOND_REFLECTION {
            return None;
        }
        // unit × difference = unit × (end − start). The second form does not cancel.
        let axis = unit.cross(end - start);
        let angle = 2.0 * libm::atan2(axis.length(), unit.dot(difference));
        Some(Self { axis: axis.try_normalize().unwrap_or(end), angle })
    }

    /// Rotates `vector`.
    pub fn rotate(&self, vector: DVec3) -> DVec3 {
        let (sin, cos) = libm::sincos(self.angle);
        let half = libm::sin(0.5 * self.angle);
        // Rodrigues' formula with 1 − cos = 2 sin²(angle/2).
        vector * cos + self.axis.cross(vector) * sin + self.axis * (self.axis.dot(vector) * 2.0 * half * half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, TrigonometricCurve};

    #[test]
    fn axis_and_angle_give_the_same_motion() {
        let knot = TrigonometricCurve::torus_knot();
        for i in 0..40 {
            let (a, b) = (knot.jet(0.15 * f64::from(i)), knot.jet(0.15 * f64::from(i + 1)));
            let (chord, start, end) = (b.position - a.position, a.tangent(), b.tangent());
            let r = a.normal().unwrap();
            let motion = AxisAngle::of_double_reflection(chord, start, end).unwrap();
            // About twelve roundings of numbers of size one.
            assert!((motion.rotate(r) - reflect_twice(chord, start, end, r).unwrap()).length() < 3e-15);
            assert!((motion.rotate(start) - end).length() < 3e-15);
            assert!(motion.angle < std::f64::consts::PI);
        }
    }

    #[test]
    fn straight_steps_do_not_rotate() {
        assert_eq!(reflect_twice(DVec3::X * 3.0, DVec3::X, DVec3::X, DVec3::Y), Some(DVec3::Y));
        assert_eq!(AxisAngle::of_double_reflection(DVec3::X, DVec3::X, DVec3::X).unwrap().angle, 0.0);
    }

    #[test]
    fn undetermined_steps_have_no_result() {
        assert_eq!(reflect_twice(DVec3::ZERO, DVec3::X, DVec3::X, DVec3::Y), None, "no chord");
        assert_eq!(reflect_twice(DVec3::X, DVec3::X, -DVec3::X, DVec3::Y), None, "one tangent reversed");
        assert_eq!(reflect_twice(DVec3::X, DVec3::Y, DVec3::Y, DVec3::Z), None, "chord across both tangents");
        assert_eq!(reflect_twice(DVec3::NAN, DVec3::Y, DVec3::Y, DVec3::Z), None);
    }

    /// Theorem 4.4 with its sign: the exact frame is K h⁵/720 ahead of the step. On a helix, K = κ²
    /// τ³ with constant κ and τ.
    #[test]
    fn the_error_of_a_step_has_the_published_constant() {
        let (radius, rise) = (1.0, 0.5);
        let helix = TrigonometricCurve::helix(radius, rise, (0.0, 1.0));
        let speed = (radius * radius + rise * rise).sqrt();
        let ratio = |h: f64| {
            let (a, b) = (helix.jet(0.0), helix.jet(h / speed));
            let (kappa, tau) = (a.curvature(), a.torsion());
            let chord = b.position - a.position;
            let stepped = reflect_twice(chord, a.tangent(), b.tangent(), a.normal().unwrap()).unwrap();
            // Exact result: the Frenet normal rotated by −τ h about the tangent.
            let exact = crate::Frame::new(b.normal().unwrap(), b.tangent()).turned(-tau * h);
            -exact.angle_to(stepped) * 720.0 / (kappa * kappa * tau * tau * tau * h.powi(5))
        };
        // In higher precision the ratio at 0.05 is 1.0000238. The rounding of the angle, 1e-16,
        // changes it by 5e-6.
        assert!((ratio(0.05) - 1.0000238).abs() < 5e-6, "{}", ratio(0.05));
        // The next term is of second order, so longer steps determine it, to three digits.
        for h in [0.1, 0.2] {
            let term = (ratio(h) - 1.0) * (0.05 / h) * (0.05 / h);
            assert!((term - 2.38e-5).abs() < 1e-7, "{h}: {term:e}");
        }
    }
}
