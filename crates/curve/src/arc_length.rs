//! Integrals along a curve (length, total curvature, total torsion) and parametrization by arc
//! length.

use crate::Curve;
use crate::quadrature::integrate;

/// Largest number of Newton steps of [`ArcLength::parameter_at`]. More have no effect, because
/// bisection alone needs 53. Fewer: cusps lose digits.
const STEPS: usize = 60;

/// Equal parts of each smooth piece in the table of an [`ArcLength`]. Larger: a longer table.
/// Smaller: more Newton steps.
const PARTS: usize = 16;

/// Table of arc lengths along a curve, for conversion between parameter and length.
///
/// # Examples
/// ```
/// use isochore_curve::{ArcLength, TrigonometricCurve};
///
/// let table = ArcLength::new(TrigonometricCurve::helix(3.0, 4.0, (0.0, 2.0)));
/// assert!((table.total() - 10.0).abs() < 1e-13, "the speed is 5");
/// assert!((table.parameter_at(5.0) - 1.0).abs() < 1e-14);
/// assert!((table.length_to(1.5) - 7.5).abs() < 1e-13);
/// ```
#[derive(Debug, Clone)]
pub struct ArcLength<C> {
    curve: C,
    parameters: Vec<f64>,
    lengths: Vec<f64>,
}

impl<C: Curve> ArcLength<C> {
    /// Builds the table for `curve`.
    pub fn new(curve: C) -> Self {
        let breaks = curve.breaks();
        let mut parameters = vec![breaks[0]];
        for pair in breaks.windows(2) {
            let width = (pair[1] - pair[0]) / PARTS as f64;
            parameters.extend((1..PARTS).map(|part| pair[0] + part as f64 * width));
            parameters.push(pair[1]);
        }
        let mut lengths = vec![0.0];
        for (i, pair) in parameters.windows(2).enumerate() {
            let part = integrate(&mut |u| curve.jet(u).speed(), pair[0], pair[1], 0.0);
            lengths.push(lengths[i] + part);
        }
        Self { curve, parameters, lengths }
    }

    /// The curve.
    pub fn curve(&self) -> &C {
        &self.curve
    }

    /// Length of the whole curve, model units.
    pub fn total(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Entries of the table: ascending parameters over the whole domain, each with the length of
    /// the curve up to that parameter.
    pub fn table(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.parameters.iter().copied().zip(self.lengths.iter().copied())
    }

    /// Length from the start of the domain to `parameter`, which is clamped to the domain.
    pub fn length_to(&self, parameter: f64) -> f64 {
        let last = self.parameters.len() - 1;
        let parameter = parameter.clamp(self.parameters[0], self.parameters[last]);
        let part = self.parameters[1..last].partition_point(|&start| start <= parameter);
        let rest = integrate(&mut |u| self.curve.jet(u).speed(), self.parameters[part], parameter, self.total());
        self.lengths[part] + rest
    }

    /// Parameter at the given `length` from the start. The length is clamped to [0,
    /// [`total`](Self::total)].
    pub fn parameter_at(&self, length: f64) -> f64 {
        let length = length.clamp(0.0, self.total());
        let last = self.parameters.len() - 1;
        let part = self.lengths[1..last].partition_point(|&start| start <= length);
        let (mut low, mut high) = (self.parameters[part], self.parameters[part + 1]);
        let target = length - self.lengths[part];
        let whole = self.lengths[part + 1] - self.lengths[part];
        if whole == 0.0 {
            return low;
        }
        let (start, width) = (low, high - low);
        let mut parameter = low + width * (target / whole);
        for _ in 0..STEPS {
            let missing = target - integrate(&mut |u| self.curve.jet(u).speed(), start, parameter, self.total());
            if missing > 0.0 {
                low = parameter;
            } else {
                high = parameter;
            }
            let step = missing / self.curve.jet(parameter).speed();
            let next = parameter + step;
            if step.abs() <= 2.0 * f64::EPSILON * (parameter.abs() + width) {
                return parameter;
            }
            // Bisect if the step leaves the bracket, as it does near a cusp, where the speed is
            // zero.
            parameter = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        parameter
    }
}

/// Length of `curve`, model units.
pub fn length(curve: &impl Curve) -> f64 {
    along(curve, |u| curve.jet(u).speed())
}

/// ∫ κ ds over `curve`, radians.
pub fn total_curvature(curve: &impl Curve) -> f64 {
    along(curve, |u| {
        let jet = curve.jet(u);
        jet.curvature() * jet.speed()
    })
}

/// ∫ κ² ds over `curve`, per model unit.
pub fn total_squared_curvature(curve: &impl Curve) -> f64 {
    along(curve, |u| {
        let jet = curve.jet(u);
        let curvature = jet.curvature();
        curvature * curvature * jet.speed()
    })
}

/// ∫ τ ds over `curve`, radians. Meaningful only if the curvature is positive everywhere.
///
/// If the curvature is nearly zero at a point, the torsion has a peak that the quadrature cannot
/// resolve, and the result is inaccurate. The closing angle of rotation-minimizing frames does not
/// have this problem.
pub fn total_torsion(curve: &impl Curve) -> f64 {
    along(curve, |u| {
        let jet = curve.jet(u);
        jet.torsion() * jet.speed()
    })
}

/// Integral over the whole domain with respect to the parameter, piece by piece.
fn along(curve: &impl Curve, mut function: impl FnMut(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for pair in curve.breaks().windows(2) {
        let width = (pair[1] - pair[0]) / PARTS as f64;
        for part in 0..PARTS {
            let start = pair[0] + part as f64 * width;
            sum += integrate(&mut function, start, start + width, 0.0);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bezier, TrigonometricCurve};

    /// Reference values from 40-digit arithmetic. The bounds allow rounding in sums of about 20
    /// parts.
    #[test]
    fn knots_have_the_known_integrals() {
        let torus = TrigonometricCurve::torus_knot();
        assert!((length(&torus) - 15.373_656_772_985_95).abs() < 1e-13);
        assert!((total_curvature(&torus) - 42.177_641_250_329_24).abs() < 1e-12);
        assert!((total_squared_curvature(&torus) - 116.395_702_868_217_88).abs() < 1e-11);
        assert!((total_torsion(&torus) + 21.725_267_919_404_65).abs() < 1e-12);
        let cinquefoil = TrigonometricCurve::cinquefoil();
        assert!((length(&cinquefoil) - 64.255_378_156_594_83).abs() < 1e-12);
        assert!((total_curvature(&cinquefoil) - 31.030_350_327_327_53).abs() < 1e-12);
        assert!((total_squared_curvature(&cinquefoil) - 16.196_526_749_407_54).abs() < 1e-12);
        assert!((total_torsion(&cinquefoil) + 1.407_701_989_360_733_4).abs() < 1e-12);
    }

    /// Zheng 3.4: the torsion integral tends to −π, and the torsion has a peak as narrow as the
    /// height.
    #[test]
    fn s_curve_torsion_is_resolved_down_to_narrow_peaks() {
        for (height, exact) in [(1.0, -2.640_027_770_017_6), (0.1, -3.099_128_313_107_5), (0.01, -3.137_366_329_922)] {
            assert!((total_torsion(&Bezier::s_curve(height)) - exact).abs() < 2e-12, "height {height}");
        }
    }

    #[test]
    fn parameters_and_lengths_are_inverse() {
        let curve = TrigonometricCurve::torus_knot();
        let table = ArcLength::new(&curve);
        for i in 0..=20 {
            let expected = table.total() * f64::from(i) / 20.0;
            let found = table.length_to(table.parameter_at(expected));
            assert!((found - expected).abs() < 1e-13 * table.total(), "{found}, expected {expected}");
        }
        assert_eq!(table.parameter_at(-1.0), 0.0);
        assert!((table.parameter_at(1e9) - std::f64::consts::TAU).abs() < 1e-14);
    }

    #[test]
    fn a_constant_curve_has_length_zero() {
        let point = Bezier::new(vec![glam::DVec3::ONE; 4]);
        let table = ArcLength::new(&point);
        assert_eq!(table.total(), 0.0);
        assert!(table.parameter_at(1.0).is_finite());
    }
}
