//! Pythagorean-hodograph cubics: cubic curves with polynomial speed, a rational Frenet frame, and a
//! rotation-minimizing frame in closed form.
//!
//! Source: C. Mäurer, B. Jüttler, Rational approximation of rotation minimizing frames using
//! Pythagorean-hodograph cubics, 1999, section 3. Symbols of the paper: L₁, L₂, L₃ are `lengths`, θ
//! is the angle between neighboring sides of the control polygon, and Ω is the angle from the
//! Frenet frame to the rotation-minimizing frame.
//!
//! Deviations: the paper does not specify the sign of ψ; this module uses that of −det(Δb₁, Δb₂,
//! Δb₃). Equation (30) mixes a definite integral with an antiderivative; this module evaluates the
//! difference in a form without cancellation.

use glam::DVec3;

use crate::frame::{FrameError, orthogonal_reference};
use crate::{Curve, CurveJet, Frame, perpendicular, reflect_twice};

mod hermite;
mod rational_rotation;
mod spline;

pub use hermite::{HermiteError, PhCubicError};
pub use rational_rotation::RationalRotation;
pub use spline::{PhSpline, PhSplineError};

/// Largest ratio of height to length of the control polygon of a straight cubic. Larger: the
/// constant frame of such a cubic visibly leaves the normal plane. Smaller: rounding, amplified by
/// one over the square of this, determines the rotation of the Frenet frame.
const STRAIGHT: f64 = 1e-5;

/// Largest such ratio for which exact frames use double reflection. Its error is the fifth power of
/// the ratio divided by several hundred. Larger: this error becomes visible. Smaller: the rounding
/// of the Frenet frame becomes visible.
const NEARLY_STRAIGHT: f64 = 1e-3;

/// A Pythagorean-hodograph cubic over [0, 1].
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Curve, PhCubic, length};
///
/// let [start, end] = [DVec3::ZERO, DVec3::new(1.0, 0.2, 0.1)];
/// let cubic = PhCubic::hermite(start, end, DVec3::new(1.0, 0.5, 0.0), DVec3::new(1.0, -0.3, 0.4))?;
/// assert!(cubic.position(1.0).distance(end) < 1e-15);
/// // The arc length has a closed form.
/// assert!((cubic.length() - length(&cubic)).abs() < 1e-14);
/// # Ok::<(), isochore_curve::PhCubicError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhCubic {
    start: DVec3,
    /// Sides of the control polygon. Stored instead of its corners, because the rounding of
    /// positions would perturb short sides.
    sides: [DVec3; 3],
    /// Lengths of the three sides of the control polygon.
    lengths: [f64; 3],
    /// Middle coefficient of the speed: L₂ cos θ.
    middle: f64,
    /// L₂ sin θ, zero for a straight line.
    height: f64,
    /// sgn · √(L₁L₃ − L₂²), zero for a planar curve, with the sign of dΩ/dv.
    twist: f64,
}

impl PhCubic {
    /// Creates a cubic from a control polygon that satisfies the two conditions (17).
    pub(crate) fn from_sides(start: DVec3, sides: [DVec3; 3]) -> Self {
        let [first, second, third] = sides;
        let lengths = [first.length(), second.length(), third.length()];
        let middle = second.dot(first) / lengths[0];
        // Both angles of the polygon are θ. Use the one between the first two sides.
        let height = second.cross(first).length() / lengths[0];
        // det = ±2 L₂² sin²θ √(L₁L₃ − L₂²). Obtain the root from the determinant, because the
        // difference L₁L₃ − L₂² cancels on flat curves.
        let determinant = first.dot(second.cross(third));
        let is_straight = height <= STRAIGHT * lengths.iter().sum::<f64>();
        let twist = if is_straight { 0.0 } else { -determinant / (2.0 * height * height) };
        Self { start, sides, lengths, middle, height, twist }
    }

    /// The control points.
    pub fn control_points(&self) -> [DVec3; 4] {
        let [first, second, third] = self.sides;
        let (b1, b2) = (self.start + first, self.start + first + second);
        [self.start, b1, b2, b2 + third]
    }

    /// The sides of the control polygon.
    pub fn sides(&self) -> [DVec3; 3] {
        self.sides
    }

    /// Coefficients of the speed in the Bernstein basis of degree two (equation 18).
    pub fn speed_coefficients(&self) -> [f64; 3] {
        [3.0 * self.lengths[0], 3.0 * self.middle, 3.0 * self.lengths[2]]
    }

    /// Speed |x′| at `v`.
    pub fn speed(&self, v: f64) -> f64 {
        let [a, b, c] = self.speed_coefficients();
        (1.0 - v) * ((1.0 - v) * a + 2.0 * v * b) + v * v * c
    }

    /// Exact arc length, model units.
    pub fn length(&self) -> f64 {
        self.lengths[0] + self.middle + self.lengths[2]
    }

    /// Length of the control polygon, model units.
    pub fn polygon_length(&self) -> f64 {
        self.lengths.iter().sum()
    }

    /// Curvature at `v` (equation 18), per model unit.
    pub fn curvature(&self, v: f64) -> f64 {
        let speed = self.speed(v);
        6.0 * self.height / (speed * speed)
    }

    /// Torsion at `v` (equation 18), per model unit.
    pub fn torsion(&self, v: f64) -> f64 {
        let speed = self.speed(v);
        -6.0 * self.twist / (speed * speed)
    }

    /// Returns true if the curve is straight up to 1e-5 of its length. Its Frenet frame is then
    /// undefined.
    pub fn is_straight(&self) -> bool {
        self.height <= STRAIGHT * self.polygon_length()
    }

    /// Constant k of equation (33), in [0, 1): 2k is the factor of the arctangent in Ω. Zero for
    /// planar curves.
    pub fn rotation_factor(&self) -> f64 {
        if self.is_straight() { 0.0 } else { self.twist.abs() / libm::hypot(self.twist, self.height) }
    }

    /// Ω(v) − Ω(0), radians: rotation of a rotation-minimizing frame relative to the Frenet frame
    /// (equation 30).
    pub fn rotation_to(&self, v: f64) -> f64 {
        if self.is_straight() {
            return 0.0;
        }
        let a = libm::hypot(self.twist, self.height);
        let b = self.lengths[0] - self.middle;
        2.0 * self.twist / a * libm::atan2(a * v, self.lengths[0] - b * v)
    }

    /// dΩ/dv = −τ |x′|.
    pub fn rotation_rate(&self, v: f64) -> f64 {
        6.0 * self.twist / self.speed(v)
    }

    /// Frenet frame at `v`. A straight line has no Frenet frame; the result is then a frame that
    /// does not rotate.
    pub fn frenet_frame(&self, v: f64) -> Frame {
        let jet = self.jet(v);
        let tangent = jet.tangent();
        let normal = if self.is_straight() { None } else { jet.normal() };
        let normal = normal.unwrap_or_else(|| perpendicular(self.jet(0.0).tangent()));
        Frame::new(normal.reject_from_normalized(tangent).normalize(), tangent)
    }

    /// Exact rotation-minimizing frames at ascending parameters. The reference vector at v = 0 is
    /// the component of `reference` normal to the tangent.
    ///
    /// # Errors
    /// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first
    /// tangent.
    pub fn exact_frames(&self, parameters: &[f64], reference: DVec3) -> Result<Vec<Frame>, FrameError> {
        if self.height <= NEARLY_STRAIGHT * self.polygon_length() {
            let start = self.jet(0.0);
            let reference = orthogonal_reference(reference, start.tangent())?;
            let frame = |v: f64| {
                let jet = self.jet(v);
                let chord = jet.position - start.position;
                let r = reflect_twice(chord, start.tangent(), jet.tangent(), reference).unwrap_or(reference);
                Frame::new(r, jet.tangent())
            };
            return Ok(parameters.iter().map(|&v| frame(v)).collect());
        }
        let start = self.frenet_frame(0.0);
        let angle = start.angle_to(orthogonal_reference(reference, start.t)?);
        Ok(parameters.iter().map(|&v| self.frenet_frame(v).turned(angle + self.rotation_to(v))).collect())
    }

    /// Splits the curve at `v` into two Pythagorean-hodograph cubics.
    pub fn split(&self, v: f64) -> (Self, Self) {
        let [first, second, third] = self.sides;
        let (a, b) = (first.lerp(second, v), second.lerp(third, v));
        let middle = a.lerp(b, v);
        let left = [first * v, a * v, middle * v];
        let right = [middle * (1.0 - v), b * (1.0 - v), third * (1.0 - v)];
        (Self::from_sides(self.start, left), Self::from_sides(self.position(v), right))
    }
}

impl Curve for PhCubic {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }

    fn jet(&self, v: f64) -> CurveJet {
        let [d1, d2, d3] = self.sides;
        let [b0, b1, b2, b3] = self.control_points();
        let u = 1.0 - v;
        CurveJet {
            position: u * u * (u * b0 + 3.0 * v * b1) + v * v * (3.0 * u * b2 + v * b3),
            first: 3.0 * (u * (u * d1 + 2.0 * v * d2) + v * v * d3),
            second: 6.0 * (u * (d2 - d1) + v * (d3 - d2)),
            third: 6.0 * (d3 - 2.0 * d2 + d1),
        }
    }
}
