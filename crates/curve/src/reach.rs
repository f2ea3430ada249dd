//! Reach of a curve: the distance within which each point has a unique nearest point on the curve.

use glam::DVec3;

use crate::Curve;

/// Reach of a curve, estimated from samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The smaller of the two radii, model units. Within this distance, the nearest point is
    /// unique.
    pub distance: f64,
    /// Smallest radius of curvature, model units.
    pub curvature_radius: f64,
    /// Smallest distance at which two separate parts of the curve are equally near, model units, by
    /// Federer's formula over pairs of samples.
    pub bottleneck_radius: f64,
}

/// Estimates the reach of `curve` from `samples` points (at least 8). The time is quadratic in
/// their number.
///
/// Federer's formula: the reach is the infimum over pairs of points a, b of |b − a|² / (2 d), where
/// d is the distance of b − a from the tangent line at a. The estimate from samples is an upper
/// bound, with an error of second order in their spacing. At the ends of an open curve, a half-line
/// replaces the tangent line. A straight line has infinite reach.
///
/// Source: H. Federer, Curvature measures, 1959, theorem 4.18.
///
/// # Examples
/// ```
/// use isochore_curve::{TrigonometricCurve, reach};
///
/// // A helix with loose turns is limited by its radius of curvature, (1 + 2²) / 1.
/// let helix = TrigonometricCurve::helix(1.0, 2.0, (0.0, 12.0));
/// assert!((reach(&helix, 200).curvature_radius - 5.0).abs() < 1e-12);
/// ```
pub fn reach(curve: &impl Curve, samples: usize) -> Reach {
    let samples = samples.max(8);
    let (first, last) = curve.domain();
    let steps = if curve.is_closed() { samples } else { samples - 1 };
    let jets: Vec<_> = (0..samples).map(|i| curve.jet(first + (last - first) * i as f64 / steps as f64)).collect();
    let curvature = jets.iter().map(|jet| jet.curvature()).fold(0.0, f64::max);
    let mut bottleneck = f64::INFINITY;
    for (i, jet) in jets.iter().enumerate() {
        let tangent = jet.tangent();
        let is_start = !curve.is_closed() && i == 0;
        let is_end = !curve.is_closed() && i + 1 == samples;
        for other in &jets {
            let chord = other.position - jet.position;
            let along = chord.dot(tangent);
            // At an end, the tangent cone is a half-line. The distance from its start applies to
            // points behind it.
            let is_behind = (is_start && along < 0.0) || (is_end && along > 0.0);
            let across = if is_behind { chord } else { chord - tangent * along };
            bottleneck = bottleneck.min(radius(chord, across));
        }
    }
    let curvature_radius = 1.0 / curvature;
    Reach { distance: curvature_radius.min(bottleneck), curvature_radius, bottleneck_radius: bottleneck }
}

/// |chord|² / (2 |across|). Infinite if the chord is parallel to the tangent up to rounding.
fn radius(chord: DVec3, across: DVec3) -> f64 {
    let (length, offset) = (chord.length(), across.length());
    // An offset below the rounding error of the chord is noise, so the pair is ignored.
    if offset <= 1e-14 * length { f64::INFINITY } else { length * (length / (2.0 * offset)) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{Bezier, TrigonometricCurve};

    #[test]
    fn reach_of_a_circle_is_its_radius() {
        let circle = TrigonometricCurve::new(
            TrigonometricCurve::helix(2.0, 0.0, (0.0, TAU)).terms().to_vec(),
            DVec3::ZERO,
            (0.0, TAU),
            true,
        );
        let reach = reach(&circle, 64);
        // The formula is exact for every chord of a circle.
        assert!((reach.distance - 2.0).abs() < 1e-12, "{reach:?}");
    }

    #[test]
    fn flat_helix_is_limited_by_its_neighboring_turns() {
        // The turns are 0.2 apart, so the reach is half of that, up to a term of second order in
        // 0.2.
        let helix = TrigonometricCurve::helix(1.0, 0.2 / TAU, (0.0, 3.0 * TAU));
        let reach = reach(&helix, 1200);
        assert!((reach.distance - 0.1).abs() < 1e-3, "{reach:?}");
        assert!((reach.curvature_radius - (1.0 + 0.04 / (TAU * TAU))).abs() < 1e-12);
    }

    #[test]
    fn reach_of_a_straight_line_is_infinite() {
        let line = Bezier::new(vec![DVec3::ZERO, DVec3::new(1.0, 0.3, 0.2)]);
        assert_eq!(reach(&line, 20).distance, f64::INFINITY);
    }

    #[test]
    fn ends_facing_each_other_limit_an_open_curve() {
        // An almost closed circle: half of the gap between its ends is less than the radius.
        let arc = TrigonometricCurve::helix(1.0, 0.0, (0.0, TAU - 0.5));
        let gap = 2.0 * libm::sin(0.25);
        let reach = reach(&arc, 400);
        assert!((reach.distance - 0.5 * gap).abs() < 1e-12, "{reach:?}");
    }
}
