//! Biquadratic rational approximation of the rotation from the Frenet frame to the
//! rotation-minimizing frame.
//!
//! Source: Mäurer and Jüttler 1999, section 3.4, equations (34) to (41). W ≈ tan(Ω/2). The values
//! and derivatives of Ω are exact at both ends. One free parameter λ minimizes the squared error of
//! the angular velocity.

use super::PhCubic;
use crate::quadrature::gauss_points;

/// Panels of the ten-point rule for the squared error I. Larger: for rotations below half a turn, I
/// changes by less than its rounding error. Smaller: λ loses digits.
const PANELS: usize = 8;

/// Largest number of Newton steps for λ. The clipped iteration takes 5 to 11 steps on the examples
/// of the paper.
const STEPS: usize = 60;

/// Initial distance of λ from its bound, in units of λ + 2 at the bound. Larger: above one, the
/// iteration starts outside the basin of the minimum. Smaller: more steps.
const START: f64 = 0.1;

/// A biquadratic rational function W = γ/β. Twice its arctangent approximates the rotation Ω of a
/// [`PhCubic`] from its Frenet frame to a rotation-minimizing frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RationalRotation {
    /// Bernstein coefficients of the numerator γ.
    pub numerator: [f64; 3],
    /// Bernstein coefficients of the denominator β, all positive.
    pub denominator: [f64; 3],
    /// Optimal value of the free parameter λ.
    pub lambda: f64,
    /// Ω₀: the angle at v = 0, radians.
    pub initial_angle: f64,
    /// ∫ (dΩ_approximate/dv − dΩ/dv)² dv over [0, 1]: the minimum of equation (40).
    pub squared_error: f64,
}

impl RationalRotation {
    /// No rotation: the result is the Frenet frame.
    pub const FRENET: Self =
        Self { numerator: [0.0; 3], denominator: [1.0; 3], lambda: 0.0, initial_angle: 0.0, squared_error: 0.0 };

    /// Computes the best approximation for `cubic` with Ω symmetric about zero. W then has no pole,
    /// because Ω stays in (−π, π). To obtain a given initial angle, rotate the cross-section by a
    /// constant angle.
    pub fn symmetric(cubic: &PhCubic) -> Self {
        Self::with_initial_angle(cubic, -0.5 * cubic.rotation_to(1.0)).unwrap_or(Self::FRENET)
    }

    /// Computes the best approximation with Ω(0) = `initial_angle`. Returns `None` if Ω reaches ±π,
    /// because W then has a pole.
    pub fn with_initial_angle(cubic: &PhCubic, initial_angle: f64) -> Option<Self> {
        let whole = cubic.rotation_to(1.0);
        if !(initial_angle.abs() < std::f64::consts::PI && (initial_angle + whole).abs() < std::f64::consts::PI) {
            return None;
        }
        if whole == 0.0 {
            // The curve is planar: W is constant, and (37) would be 0/0.
            let w = libm::tan(0.5 * initial_angle);
            return Some(Self { numerator: [w; 3], initial_angle, ..Self::FRENET });
        }
        let start = libm::tan(0.5 * initial_angle);
        let end = libm::tan(0.5 * (initial_angle + whole));
        let family = Family {
            start,
            end,
            start_slope: 0.5 * (1.0 + start * start) * cubic.rotation_rate(0.0),
            end_slope: 0.5 * (1.0 + end * end) * cubic.rotation_rate(1.0),
        };
        let points: Vec<(f64, f64, f64)> =
            gauss_points(0.0, 1.0, PANELS).into_iter().map(|(v, weight)| (v, weight, cubic.rotation_rate(v))).collect();
        let lambda = family.best_lambda(&points);
        let (numerator, denominator) = family.member(lambda);
        let squared_error = family.squared_error(lambda, &points).value;
        Some(Self { numerator, denominator, lambda, initial_angle, squared_error })
    }

    /// Approximate angle Ω at `v`, radians.
    pub fn angle(&self, v: f64) -> f64 {
        2.0 * libm::atan2(bernstein(self.numerator, v), bernstein(self.denominator, v))
    }
}

/// The interpolants (36), (37) of the end data, a family with parameter λ.
#[derive(Debug, Clone, Copy)]
struct Family {
    start: f64,
    end: f64,
    start_slope: f64,
    end_slope: f64,
}

/// I(λ) of equation (40) with its first derivative, and the positive part of its second.
struct SquaredError {
    value: f64,
    slope: f64,
    curvature: f64,
}

impl Family {
    /// Numerator and denominator for λ, scaled to a positive denominator. If W decreases, all
    /// coefficients of the denominator (37) are negative.
    fn member(&self, lambda: f64) -> ([f64; 3], [f64; 3]) {
        let (w0, w1, s0, s1) = (self.start, self.end, self.start_slope, self.end_slope);
        let last = (w1 - w0) * (lambda + 2.0) - s0;
        let denominator = [s1, 0.5 * s1 * (lambda + 2.0), last];
        let numerator = [w0 * s1, 0.5 * s1 * (w0 * (lambda + 2.0) + s0), w1 * last];
        let sign = libm::copysign(1.0, s1);
        (numerator.map(|c| sign * c), denominator.map(|c| sign * c))
    }

    /// λ* of (38). Above it, W is monotonic and has no pole.
    fn lower_bound(&self) -> f64 {
        self.start_slope / (self.end - self.start) - 2.0
    }

    fn squared_error(&self, lambda: f64, points: &[(f64, f64, f64)]) -> SquaredError {
        let (numerator, denominator) = self.member(lambda);
        let sign = libm::copysign(1.0, self.end_slope);
        let (w0, w1, s1) = (self.start, self.end, sign * self.end_slope);
        let rise = sign * (w1 - w0);
        // The coefficients are linear in λ; these are their derivatives.
        let numerator_rate = [0.0, 0.5 * s1 * w0, w1 * rise];
        let denominator_rate = [0.0, 0.5 * s1, rise];
        let mut error = SquaredError { value: 0.0, slope: 0.0, curvature: 0.0 };
        for &(v, weight, rate) in points {
            let (g, dg) = (bernstein(numerator, v), slope(numerator, v));
            let (b, db) = (bernstein(denominator, v), slope(denominator, v));
            let (gl, dgl) = (bernstein(numerator_rate, v), slope(numerator_rate, v));
            let (bl, dbl) = (bernstein(denominator_rate, v), slope(denominator_rate, v));
            // dΩ/dv = 2W′/(1 + W²) = 2P/Q with P = γ′β − γβ′ and Q = γ² + β². The suffixes l and ll
            // denote the first and second derivatives with respect to λ.
            let (p, q) = (dg * b - g * db, g * g + b * b);
            let (pl, ql) = (dgl * b + dg * bl - gl * db - g * dbl, 2.0 * (g * gl + b * bl));
            let (pll, qll) = (2.0 * (dgl * bl - gl * dbl), 2.0 * (gl * gl + bl * bl));
            let value = 2.0 * p / q - rate;
            let first = 2.0 * (pl * q - p * ql) / (q * q);
            let second = 2.0 * (pll * q - p * qll - 2.0 * pl * ql) / (q * q) + 4.0 * p * ql * ql / (q * q * q);
            error.value += weight * value * value;
            error.slope += weight * 2.0 * value * first;
            error.curvature += weight * 2.0 * (first * first + value * second);
        }
        error
    }

    /// Minimizes the squared error by Newton's method. Each step at most halves the distance to the
    /// bound.
    fn best_lambda(&self, points: &[(f64, f64, f64)]) -> f64 {
        let bound = self.lower_bound();
        let mut above = START * (bound + 2.0);
        for _ in 0..STEPS {
            let error = self.squared_error(bound + above, points);
            if error.curvature.is_nan() || error.curvature <= 0.0 {
                // λ is beyond the inflection of I, and the minimum is closer to the bound.
                above *= 0.5;
                continue;
            }
            let step = -error.slope / error.curvature;
            let next = (above + step).max(0.5 * above);
            if (next - above).abs() <= 4.0 * f64::EPSILON * (bound.abs() + above) {
                return bound + next;
            }
            above = next;
        }
        bound + above
    }
}

/// Value of a quadratic polynomial in Bernstein form.
fn bernstein([a, b, c]: [f64; 3], v: f64) -> f64 {
    let u = 1.0 - v;
    u * (u * a + 2.0 * v * b) + v * v * c
}

/// Derivative of a quadratic polynomial in Bernstein form.
fn slope([a, b, c]: [f64; 3], v: f64) -> f64 {
    2.0 * ((1.0 - v) * (b - a) + v * (c - b))
}
