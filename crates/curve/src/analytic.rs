//! Curves given by formulas: the helix, knots, and closures.

use std::f64::consts::{FRAC_PI_4, TAU};
use std::fmt;

use glam::DVec3;

use crate::{Curve, CurveJet};

/// A trigonometric polynomial in three coordinates: a sum of `cosine` cos(f u) + `sine` sin(f u).
///
/// All knots of this module have this form, because products of sines and cosines are sums of them.
#[derive(Debug, Clone, PartialEq)]
pub struct TrigonometricCurve {
    terms: Vec<TrigonometricTerm>,
    drift: DVec3,
    domain: (f64, f64),
    closed: bool,
}

/// One frequency of a [`TrigonometricCurve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrigonometricTerm {
    /// Frequency f, radians per unit of the parameter.
    pub frequency: f64,
    /// Coefficient of the cosine.
    pub cosine: DVec3,
    /// Coefficient of the sine.
    pub sine: DVec3,
}

impl TrigonometricCurve {
    /// Creates the curve Σ cosine cos(f u) + sine sin(f u) + `drift` u over `domain`.
    pub fn new(terms: Vec<TrigonometricTerm>, drift: DVec3, domain: (f64, f64), closed: bool) -> Self {
        Self { terms, drift, domain, closed }
    }

    /// The terms, one per frequency.
    pub fn terms(&self) -> &[TrigonometricTerm] {
        &self.terms
    }

    /// The helix (radius cos u, radius sin u, rise u) over `domain`. `rise` is the height gained
    /// per radian.
    pub fn helix(radius: f64, rise: f64, domain: (f64, f64)) -> Self {
        Self::new(vec![term(1.0, [radius, 0.0, 0.0], [0.0, radius, 0.0])], DVec3::new(0.0, 0.0, rise), domain, false)
    }

    /// The torus knot of Wang et al. 2008, equation (16), over one closed turn [0, 2π].
    pub fn torus_knot() -> Self {
        // (0.6 + 0.3 cos 7u)(cos 2u, sin 2u), 0.3 sin 7u
        Self::new(
            vec![
                term(2.0, [0.6, 0.0, 0.0], [0.0, 0.6, 0.0]),
                term(9.0, [0.15, 0.0, 0.0], [0.0, 0.15, 0.0]),
                term(5.0, [0.15, 0.0, 0.0], [0.0, -0.15, 0.0]),
                term(7.0, [0.0; 3], [0.0, 0.0, 0.3]),
            ],
            DVec3::ZERO,
            (0.0, TAU),
            true,
        )
    }

    /// The cinquefoil knot of Zheng's thesis, equation (7.9), over [0, 10π].
    ///
    /// Correction: the printed denominator 2a² + 1 should be 2k + 1 with k = 2.
    pub fn cinquefoil() -> Self {
        // (cos t (2 − cos(2t/5)), sin t (2 − cos(2t/5)), −sin(2t/5))
        Self::new(
            vec![
                term(1.0, [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
                term(1.4, [-0.5, 0.0, 0.0], [0.0, -0.5, 0.0]),
                term(0.6, [-0.5, 0.0, 0.0], [0.0, -0.5, 0.0]),
                term(0.4, [0.0; 3], [0.0, 0.0, -1.0]),
            ],
            DVec3::ZERO,
            (0.0, 5.0 * TAU),
            true,
        )
    }

    /// The trefoil knot of Zheng's thesis, equation (7.10), over [0, 2π].
    pub fn trefoil() -> Self {
        Self::new(
            vec![
                term(1.0, [41.0, 36.0, 0.0], [-18.0, 27.0, 45.0]),
                term(2.0, [-83.0, -113.0, -30.0], [-83.0, 30.0, 113.0]),
                term(3.0, [-11.0, 11.0, -11.0], [27.0, -27.0, 27.0]),
            ],
            DVec3::ZERO,
            (0.0, TAU),
            true,
        )
    }

    /// The curve of Bartoň et al. 2009, equation (20), over [π/4, 2π].
    pub fn barton_example() -> Self {
        // (sin 2t cos t + sin t/4, sin 2t sin t + cos t/4, sin(4t)/2)
        Self::new(
            vec![
                term(3.0, [0.0, -0.5, 0.0], [0.5, 0.0, 0.0]),
                term(1.0, [0.0, 0.75, 0.0], [0.75, 0.0, 0.0]),
                term(4.0, [0.0; 3], [0.0, 0.0, 0.5]),
            ],
            DVec3::ZERO,
            (FRAC_PI_4, TAU),
            false,
        )
    }
}

fn term(frequency: f64, cosine: [f64; 3], sine: [f64; 3]) -> TrigonometricTerm {
    TrigonometricTerm { frequency, cosine: DVec3::from_array(cosine), sine: DVec3::from_array(sine) }
}

impl Curve for TrigonometricCurve {
    fn domain(&self) -> (f64, f64) {
        self.domain
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        let mut jet =
            CurveJet { position: self.drift * parameter, first: self.drift, second: DVec3::ZERO, third: DVec3::ZERO };
        for term in &self.terms {
            let (sin, cos) = libm::sincos(term.frequency * parameter);
            let value = term.cosine * cos + term.sine * sin;
            let slope = (term.sine * cos - term.cosine * sin) * term.frequency;
            let squared = term.frequency * term.frequency;
            jet.position += value;
            jet.first += slope;
            jet.second -= value * squared;
            jet.third -= slope * squared;
        }
        jet
    }

    fn is_closed(&self) -> bool {
        self.closed
    }
}

/// A curve given by a function from a parameter to a [`CurveJet`].
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Curve, CurveJet, FunctionCurve, length};
///
/// let parabola = |u: f64| CurveJet {
///     position: DVec3::new(u, u * u, 0.0),
///     first: DVec3::new(1.0, 2.0 * u, 0.0),
///     second: DVec3::new(0.0, 2.0, 0.0),
///     third: DVec3::ZERO,
/// };
/// let curve = FunctionCurve::new(parabola, (0.0, 1.0), false);
/// assert_eq!(curve.jet(0.0).curvature(), 2.0);
/// assert!((length(&curve) - 1.478_942_857_544_597_4).abs() < 1e-13);
/// ```
pub struct FunctionCurve<F> {
    function: F,
    domain: (f64, f64),
    closed: bool,
}

impl<F: Fn(f64) -> CurveJet + Send + Sync> FunctionCurve<F> {
    /// Creates the curve `function` over `domain`. The derivatives that it returns must match its
    /// positions.
    pub fn new(function: F, domain: (f64, f64), closed: bool) -> Self {
        Self { function, domain, closed }
    }
}

impl<F> fmt::Debug for FunctionCurve<F> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("FunctionCurve")
            .field("domain", &self.domain)
            .field("closed", &self.closed)
            .finish_non_exhaustive()
    }
}

impl<F: Fn(f64) -> CurveJet + Send + Sync> Curve for FunctionCurve<F> {
    fn domain(&self) -> (f64, f64) {
        self.domain
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        (self.function)(parameter)
    }

    fn is_closed(&self) -> bool {
        self.closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_match_the_printed_products() {
        for u in [0.0, 0.4, 1.9, 5.0] {
            let (s7, c7) = libm::sincos(7.0 * u);
            let (s2, c2) = libm::sincos(2.0 * u);
            let radius = 0.6 + 0.3 * c7;
            let knot = TrigonometricCurve::torus_knot().position(u);
            // Rounding of four terms of size one.
            assert!((knot - DVec3::new(radius * c2, radius * s2, 0.3 * s7)).length() < 1e-15);

            let (s, c) = libm::sincos(u);
            let (sk, ck) = libm::sincos(0.4 * u);
            let cinquefoil = TrigonometricCurve::cinquefoil().position(u);
            assert!((cinquefoil - DVec3::new(c * (2.0 - ck), s * (2.0 - ck), -sk)).length() < 4e-15);

            let example = TrigonometricCurve::barton_example().position(u);
            let expected = DVec3::new(s2 * c + 0.25 * s, s2 * s + 0.25 * c, 0.5 * libm::sin(4.0 * u));
            assert!((example - expected).length() < 2e-15);
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let step = 1e-5;
        for curve in [TrigonometricCurve::torus_knot(), TrigonometricCurve::helix(2.0, 0.3, (0.0, 6.0))] {
            let (before, at, after) = (curve.jet(1.0 - step), curve.jet(1.0), curve.jet(1.0 + step));
            // Error of central differences: step² f‴/6, with f‴ below 9³ · 9 for the highest
            // frequency, and rounding 1e-16/step.
            let bound = step * step * 6561.0 / 6.0;
            assert!(((after.position - before.position) / (2.0 * step) - at.first).length() < bound);
            assert!(((after.first - before.first) / (2.0 * step) - at.second).length() < bound);
            assert!(((after.second - before.second) / (2.0 * step) - at.third).length() < 9.0 * bound);
        }
    }

    #[test]
    fn helix_has_constant_curvature_and_torsion() {
        let jet = TrigonometricCurve::helix(2.0, 0.5, (0.0, 1.0)).jet(0.7);
        assert!((jet.curvature() - 2.0 / 4.25).abs() < 1e-15);
        assert!((jet.torsion() - 0.5 / 4.25).abs() < 1e-15);
    }
}
