//! Bézier curves of arbitrary degree.

use glam::DVec3;

use crate::{Curve, CurveJet};

/// A polynomial curve over [0, 1] in Bernstein form.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Bezier, Curve};
///
/// let parabola = Bezier::new(vec![DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0), DVec3::new(2.0, 0.0, 0.0)]);
/// assert_eq!(parabola.degree(), 2);
/// assert_eq!(parabola.position(0.5), DVec3::new(1.0, 1.0, 0.0));
/// let (left, right) = parabola.split(0.5);
/// assert_eq!(left.position(1.0), right.position(0.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bezier {
    control_points: Vec<DVec3>,
}

impl Bezier {
    /// Creates a curve from its control points. Their number is one more than the degree.
    ///
    /// # Panics
    /// If `control_points` is empty.
    pub fn new(control_points: Vec<DVec3>) -> Self {
        assert!(!control_points.is_empty(), "a Bézier curve needs at least one control point");
        Self { control_points }
    }

    /// S-shaped curve of degree five that shows the instability of torsion. As `height` tends to
    /// zero, the curve becomes planar and its torsion at parameter ½ grows without bound.
    ///
    /// Source: Zheng's thesis, section 3.4.
    pub fn s_curve(height: f64) -> Self {
        Self::new(vec![
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::new(-1.0, 1.0, 0.0),
            DVec3::new(-1.0, 0.0, height),
            DVec3::new(1.0, 0.0, height),
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(-1.0, -1.0, 0.0),
        ])
    }

    /// The control points.
    pub fn control_points(&self) -> &[DVec3] {
        &self.control_points
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.control_points.len() - 1
    }

    /// Splits the curve at `parameter` into two curves over [0, 1] each.
    pub fn split(&self, parameter: f64) -> (Self, Self) {
        let mut points = self.control_points.clone();
        let mut left = vec![points[0]];
        let mut right = vec![points[points.len() - 1]];
        while points.len() > 1 {
            points = points.windows(2).map(|pair| pair[0].lerp(pair[1], parameter)).collect();
            left.push(points[0]);
            right.push(points[points.len() - 1]);
        }
        right.reverse();
        (Self::new(left), Self::new(right))
    }
}

impl Curve for Bezier {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        let mut points = self.control_points.clone();
        let degree = self.degree();
        let mut jet = CurveJet { position: DVec3::ZERO, first: DVec3::ZERO, second: DVec3::ZERO, third: DVec3::ZERO };
        // De Casteljau's algorithm. Differences within its last rows are the derivatives.
        for row in 0..=degree {
            let (n, left) = (degree as f64, degree - row);
            match left {
                3 => {
                    jet.third = (points[3] - 3.0 * points[2] + 3.0 * points[1] - points[0]) * n * (n - 1.0) * (n - 2.0)
                }
                2 => jet.second = (points[2] - 2.0 * points[1] + points[0]) * n * (n - 1.0),
                1 => jet.first = (points[1] - points[0]) * n,
                0 => jet.position = points[0],
                _ => {}
            }
            for i in 0..left {
                let next = points[i + 1];
                points[i] = points[i].lerp(next, parameter);
            }
        }
        jet
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn s_curve_has_the_published_values_at_its_midpoint() {
        // Zheng 3.4 with the sign of κ₂ corrected: κ₀ = 4h/5, τ₀ = −12/(5h) at t = 1/2.
        for height in [1.0, 0.1, 1e-4] {
            let jet = Bezier::s_curve(height).jet(0.5);
            assert!((jet.curvature() - 0.8 * height).abs() < 1e-14 * height);
            assert!((jet.torsion() + 2.4 / height).abs() < 1e-11 / height);
        }
    }

    #[test]
    fn derivatives_match_the_monomial_form() {
        let (t, jet) = (0.3, Bezier::s_curve(2.0).jet(0.3));
        let expected = 8.0 * t * t * t * t * t - 20.0 * t * t * t * t + 20.0 * t * t - 10.0 * t + 1.0;
        assert!((jet.position.x - expected).abs() < 1e-15);
        assert!((jet.first.x - (40.0 * t * t * t * t - 80.0 * t * t * t + 40.0 * t - 10.0)).abs() < 1e-14);
        assert!((jet.second.x - (160.0 * t * t * t - 240.0 * t * t + 40.0)).abs() < 1e-13);
        assert!((jet.third.x - (480.0 * t * t - 480.0 * t)).abs() < 1e-12);
    }

    #[test]
    fn parts_of_a_split_match_the_curve() {
        let whole = Bezier::s_curve(0.7);
        let (left, right) = whole.split(0.4);
        assert!((left.position(0.5) - whole.position(0.2)).length() < 1e-15);
        assert!((right.position(0.5) - whole.position(0.7)).length() < 1e-15);
    }

    #[test]
    fn low_degrees_have_zero_higher_derivatives() {
        let jet = Bezier::new(vec![DVec3::ZERO, DVec3::X]).jet(0.5);
        assert_eq!((jet.first, jet.second, jet.third), (DVec3::X, DVec3::ZERO, DVec3::ZERO));
        assert_eq!(Bezier::new(vec![DVec3::Y]).jet(0.5).first, DVec3::ZERO);
    }
}
