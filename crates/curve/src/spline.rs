//! The C² cubic spline through given points.

use glam::DVec3;

use crate::{Curve, CurveJet};

/// Parameter steps between the points of a [`CubicSpline`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parametrization {
    /// Square root of the chord: avoids loops and cusps between unevenly spaced points. The usual
    /// choice.
    #[default]
    Centripetal,
    /// The chord: closest to arc length, and most accurate for dense points.
    ChordLength,
}

/// Condition at the ends of an open [`CubicSpline`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EndCondition {
    /// The second derivative is zero: the least bending, with an error of second order near the
    /// ends.
    #[default]
    Natural,
    /// The first two pieces are one cubic, and so are the last two: fourth order up to the ends,
    /// for dense samples of a smooth curve. Three points give a parabola, two give a line.
    NotAKnot,
}

/// Errors when constructing a [`CubicSpline`].
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Too few points.
    #[error("a spline needs at least {needed} points, not {count}")]
    TooFewPoints {
        /// Number of points.
        count: usize,
        /// Required number: two for an open spline, three for a closed one.
        needed: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e50.
    #[error("point {index} has a coordinate that is NaN, infinite or beyond 1e50")]
    NotFinite {
        /// The point, counted from zero.
        index: usize,
    },
    /// Two neighbors coincide. On a closed spline, the last and first points are neighbors.
    #[error("points {index} and {next} coincide; remove one of them")]
    RepeatedPoint {
        /// The first of the two, counted from zero.
        index: usize,
        /// The other.
        next: usize,
    },
    /// The parameters are not an ascending list with one parameter per point.
    #[error("parameter {index} is missing, not finite, or not greater than the previous one")]
    Parameter {
        /// The parameter, counted from zero.
        index: usize,
    },
}

/// Largest coordinate. Larger: sixth powers of lengths, as in the torsion, overflow. Smaller: no
/// realistic data are rejected down to about 1e30.
pub(crate) const COORDINATE_LIMIT: f64 = 1e50;

/// A cubic spline with continuous second derivative through given points, open or closed.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{CubicSpline, Curve, Parametrization};
///
/// let square = [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y];
/// let spline = CubicSpline::closed(&square, Parametrization::Centripetal)?;
/// assert!(spline.is_closed());
/// assert!(spline.position(spline.knots()[2]).distance(-DVec3::X) < 1e-15);
/// # Ok::<(), isochore_curve::SplineError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CubicSpline {
    /// Parameters of the points. A closed spline has one more, at which it returns to the first
    /// point.
    knots: Vec<f64>,
    /// Coefficients of 1, w, w², w³ of each piece, with w = parameter − first knot of the piece.
    pieces: Vec<[DVec3; 4]>,
    closed: bool,
}

impl CubicSpline {
    /// Creates the open spline through `points`.
    ///
    /// # Errors
    /// - [`SplineError::TooFewPoints`] if there are fewer than two points.
    /// - [`SplineError::NotFinite`] if a coordinate is NaN, infinite or beyond 1e50.
    /// - [`SplineError::RepeatedPoint`] if two neighbors are equal.
    pub fn open(
        points: &[DVec3],
        parametrization: Parametrization,
        end_condition: EndCondition,
    ) -> Result<Self, SplineError> {
        let spacings = spacings(points, parametrization, false)?;
        Ok(Self::open_with(points, &spacings, end_condition))
    }

    /// Creates the open spline that passes through each of `points` at the given parameter. The
    /// domain is shifted to start at zero. Neighbors can coincide.
    ///
    /// Splines with the same parameters depend linearly on their points.
    ///
    /// # Errors
    /// - [`SplineError::TooFewPoints`] if there are fewer than two points.
    /// - [`SplineError::NotFinite`] if a coordinate is NaN, infinite or beyond 1e50.
    /// - [`SplineError::Parameter`] if a parameter is missing, not finite, or not greater than the
    ///   previous one.
    pub fn open_at(points: &[DVec3], parameters: &[f64], end_condition: EndCondition) -> Result<Self, SplineError> {
        check_points(points, 2)?;
        let ascends = |index: usize| {
            parameters.get(index).is_some_and(|p| p.is_finite() && (index == 0 || *p > parameters[index - 1]))
        };
        if let Some(index) = (0..points.len()).find(|&index| !ascends(index)) {
            return Err(SplineError::Parameter { index });
        }
        let spacings: Vec<f64> = parameters[..points.len()].windows(2).map(|pair| pair[1] - pair[0]).collect();
        Ok(Self::open_with(points, &spacings, end_condition))
    }

    fn open_with(points: &[DVec3], spacings: &[f64], end_condition: EndCondition) -> Self {
        let count = points.len();
        let slopes: Vec<DVec3> = (0..count - 1).map(|i| (points[i + 1] - points[i]) / spacings[i]).collect();
        // The unknowns are the second derivatives at the points. Rows 1 … count − 2 of the system
        // express the continuity of the first derivative.
        let mut seconds = vec![DVec3::ZERO; count];
        let inner = count - 2;
        if inner > 0 {
            let mut lower = vec![0.0; inner];
            let mut diagonal = vec![0.0; inner];
            let mut upper = vec![0.0; inner];
            let mut right: Vec<DVec3> = (0..inner).map(|i| 6.0 * (slopes[i + 1] - slopes[i])).collect();
            for i in 0..inner {
                lower[i] = spacings[i];
                diagonal[i] = 2.0 * (spacings[i] + spacings[i + 1]);
                upper[i] = spacings[i + 1];
            }
            let not_a_knot = end_condition == EndCondition::NotAKnot;
            if not_a_knot && inner == 1 {
                // The spline is a parabola: all second derivatives are equal.
                diagonal[0] += spacings[0] + spacings[1];
            } else if not_a_knot {
                // The third derivative is continuous at the second and the second-to-last point.
                // This gives the second derivatives at the ends, which are eliminated from the
                // first and last rows.
                let (first, second) = (spacings[0], spacings[1]);
                diagonal[0] += first * (first + second) / second;
                upper[0] -= first * first / second;
                let (last, before) = (spacings[inner], spacings[inner - 1]);
                diagonal[inner - 1] += last * (last + before) / before;
                lower[inner - 1] -= last * last / before;
            }
            solve_tridiagonal(&lower, &diagonal, &upper, &mut right);
            seconds[1..=inner].copy_from_slice(&right);
            if not_a_knot && inner == 1 {
                seconds[0] = seconds[1];
                seconds[2] = seconds[1];
            } else if not_a_knot {
                seconds[0] = seconds[1] + (seconds[1] - seconds[2]) * (spacings[0] / spacings[1]);
                seconds[count - 1] =
                    seconds[inner] + (seconds[inner] - seconds[inner - 1]) * (spacings[inner] / spacings[inner - 1]);
            }
        }
        Self::from_seconds(points, spacings, &slopes, &seconds, false)
    }

    /// Creates the closed spline through `points`. Do not repeat the first point at the end.
    ///
    /// # Errors
    /// - [`SplineError::TooFewPoints`] if there are fewer than three points.
    /// - [`SplineError::NotFinite`] if a coordinate is NaN, infinite or beyond 1e50.
    /// - [`SplineError::RepeatedPoint`] if two neighbors are equal.
    pub fn closed(points: &[DVec3], parametrization: Parametrization) -> Result<Self, SplineError> {
        let spacings = spacings(points, parametrization, true)?;
        let count = points.len();
        let slopes: Vec<DVec3> = (0..count).map(|i| (points[(i + 1) % count] - points[i]) / spacings[i]).collect();
        let seconds = solve_cyclic(&spacings, &slopes);
        Ok(Self::from_seconds(points, &spacings, &slopes, &seconds, true))
    }

    fn from_seconds(points: &[DVec3], spacings: &[f64], slopes: &[DVec3], seconds: &[DVec3], closed: bool) -> Self {
        let mut knots = vec![0.0];
        let mut pieces = Vec::with_capacity(spacings.len());
        for (i, &spacing) in spacings.iter().enumerate() {
            knots.push(knots[i] + spacing);
            let (start, end) = (seconds[i], seconds[(i + 1) % seconds.len()]);
            pieces.push([
                points[i],
                slopes[i] - (2.0 * start + end) * (spacing / 6.0),
                0.5 * start,
                (end - start) / (6.0 * spacing),
            ]);
        }
        Self { knots, pieces, closed }
    }

    /// Ascending parameters of the points, starting at zero. A closed spline has one more, at which
    /// it returns to the first point.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Bézier control points of each piece. Their convex hull contains the piece.
    pub fn control_points(&self) -> impl Iterator<Item = [DVec3; 4]> + '_ {
        self.knots.windows(2).zip(&self.pieces).map(|(knots, [a, b, c, d])| {
            let w = knots[1] - knots[0];
            let [b, c, d] = [*b * w, *c * (w * w), *d * (w * w * w)];
            [*a, *a + b / 3.0, *a + (2.0 * b + c) / 3.0, *a + b + c + d]
        })
    }

    /// Interpolates linearly between this spline and `other` at the same parameters: `fraction` 0
    /// gives this spline, 1 gives `other`. The result is the spline through the interpolated
    /// points.
    ///
    /// # Panics
    /// If the knots differ, or if only one spline is closed.
    pub fn blend(&self, other: &Self, fraction: f64) -> Self {
        assert!(self.knots == other.knots && self.closed == other.closed, "the splines must have the same knots");
        let blend = |(a, b): (&[DVec3; 4], &[DVec3; 4])| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * fraction);
        Self { pieces: self.pieces.iter().zip(&other.pieces).map(blend).collect(), ..self.clone() }
    }

    /// Piece and local parameter of a parameter. The parameter is clamped (open) or wrapped
    /// (closed) into the domain.
    fn locate(&self, parameter: f64) -> (usize, f64) {
        let end = self.knots[self.pieces.len()];
        let parameter = if !self.closed {
            parameter.clamp(0.0, end)
        } else if (0.0..=end).contains(&parameter) {
            parameter
        } else {
            parameter.rem_euclid(end)
        };
        let piece = self.knots[1..self.pieces.len()].partition_point(|&knot| knot <= parameter);
        (piece, parameter - self.knots[piece])
    }
}

impl Curve for CubicSpline {
    fn domain(&self) -> (f64, f64) {
        (0.0, self.knots[self.pieces.len()])
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        let (piece, w) = self.locate(parameter);
        let [a, b, c, d] = self.pieces[piece];
        CurveJet {
            position: a + (b + (c + d * w) * w) * w,
            first: b + (2.0 * c + 3.0 * d * w) * w,
            second: 2.0 * c + 6.0 * d * w,
            third: 6.0 * d,
        }
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn breaks(&self) -> Vec<f64> {
        self.knots.clone()
    }
}

/// Parameter steps between neighbors.
fn spacings(points: &[DVec3], parametrization: Parametrization, closed: bool) -> Result<Vec<f64>, SplineError> {
    check_points(points, if closed { 3 } else { 2 })?;
    let count = points.len();
    let segments = if closed { count } else { count - 1 };
    (0..segments)
        .map(|index| {
            let next = (index + 1) % count;
            let chord = points[index].distance(points[next]);
            if chord == 0.0 {
                return Err(SplineError::RepeatedPoint { index, next });
            }
            Ok(match parametrization {
                Parametrization::Centripetal => chord.sqrt(),
                Parametrization::ChordLength => chord,
            })
        })
        .collect()
}

fn check_points(points: &[DVec3], needed: usize) -> Result<(), SplineError> {
    let count = points.len();
    if count < needed {
        return Err(SplineError::TooFewPoints { count, needed });
    }
    // The comparison is false for NaN.
    match points.iter().position(|point| !(point.abs().max_element() <= COORDINATE_LIMIT && point.is_finite())) {
        Some(index) => Err(SplineError::NotFinite { index }),
        None => Ok(()),
    }
}

/// Solves a tridiagonal system in place by elimination without pivoting. This is stable because the
/// matrix is diagonally dominant.
fn solve_tridiagonal(lower: &[f64], diagonal: &[f64], upper: &[f64], right: &mut [DVec3]) {
    let count = diagonal.len();
    let mut pivots = diagonal.to_vec();
    for i in 1..count {
        let factor = lower[i] / pivots[i - 1];
        pivots[i] -= factor * upper[i - 1];
        let previous = right[i - 1];
        right[i] -= previous * factor;
    }
    right[count - 1] /= pivots[count - 1];
    for i in (0..count - 1).rev() {
        let next = right[i + 1];
        right[i] = (right[i] - next * upper[i]) / pivots[i];
    }
}

/// Second derivatives of the closed spline. Solves a cyclic tridiagonal system with the
/// Sherman–Morrison formula.
fn solve_cyclic(spacings: &[f64], slopes: &[DVec3]) -> Vec<DVec3> {
    let count = spacings.len();
    let before = |i: usize| (i + count - 1) % count;
    let lower: Vec<f64> = (0..count).map(|i| spacings[before(i)]).collect();
    let upper: Vec<f64> = spacings.to_vec();
    let mut diagonal: Vec<f64> = (0..count).map(|i| 2.0 * (spacings[before(i)] + spacings[i])).collect();
    let mut right: Vec<DVec3> = (0..count).map(|i| 6.0 * (slopes[i] - slopes[before(i)])).collect();
    // Both corner entries of the matrix equal `corner`. Write the matrix as tridiagonal + u vᵀ with
    // u = (gamma, 0, …, corner) and v = (1, 0, …, corner / gamma), which changes two diagonal
    // entries.
    let corner = spacings[count - 1];
    let gamma = -diagonal[0];
    diagonal[0] -= gamma;
    diagonal[count - 1] -= corner * corner / gamma;
    let mut correction = vec![DVec3::ZERO; count];
    correction[0] = DVec3::splat(gamma);
    correction[count - 1] = DVec3::splat(corner);
    solve_tridiagonal(&lower, &diagonal, &upper, &mut right);
    solve_tridiagonal(&lower, &diagonal, &upper, &mut correction);
    let ratio = corner / gamma;
    let denominator = 1.0 + correction[0].x + ratio * correction[count - 1].x;
    let factor = (right[0] + right[count - 1] * ratio) / denominator;
    right.iter().zip(&correction).map(|(&value, &column)| value - factor * column.x).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::TrigonometricCurve;

    fn helix_points(count: usize) -> (TrigonometricCurve, Vec<DVec3>) {
        let curve = TrigonometricCurve::helix(1.0, 0.4, (0.0, 5.0));
        let points = (0..count).map(|i| curve.position(5.0 * i as f64 / (count - 1) as f64)).collect();
        (curve, points)
    }

    #[test]
    fn passes_through_its_points_with_continuous_second_derivative() {
        let (_, points) = helix_points(9);
        for spline in [
            CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural).unwrap(),
            CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap(),
            CubicSpline::closed(&points, Parametrization::Centripetal).unwrap(),
        ] {
            for (i, &point) in points.iter().enumerate() {
                let knot = spline.knots()[i];
                assert!((spline.position(knot) - point).length() < 1e-14);
                if i > 0 && (spline.is_closed() || i + 1 < points.len()) {
                    let step = 1e-9;
                    let (before, after) = (spline.jet(knot - step), spline.jet(knot + step));
                    // The difference is the third derivative times 2e-9, and the third derivative
                    // is below 10.
                    assert!((before.first - after.first).length() < 1e-7);
                    assert!((before.second - after.second).length() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn closed_spline_joins_its_ends_smoothly() {
        let (_, points) = helix_points(7);
        let spline = CubicSpline::closed(&points, Parametrization::ChordLength).unwrap();
        let (first, last) = (spline.jet(0.0), spline.jet(spline.domain().1));
        assert!((first.position - last.position).length() < 1e-14);
        assert!((first.first - last.first).length() < 1e-13);
        assert!((first.second - last.second).length() < 1e-12);
        assert!((spline.position(-0.3) - spline.position(spline.domain().1 - 0.3)).length() < 1e-14, "wraps");
    }

    #[test]
    fn not_a_knot_and_periodic_splines_are_of_fourth_order() {
        let error = |count: usize| {
            let (curve, points) = helix_points(count);
            let spline = CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
            let scale = 5.0 / spline.domain().1;
            (0..500)
                .map(|i| f64::from(i) / 499.0 * spline.domain().1)
                .map(|u| (spline.position(u) - curve.position(u * scale)).length())
                .fold(0.0, f64::max)
        };
        let ratio = error(81) / error(41);
        assert!((0.055..0.075).contains(&ratio), "1/16 expected, got {ratio}");

        let knot = TrigonometricCurve::torus_knot();
        let radius_error = |count: usize| {
            let points: Vec<DVec3> = (0..count)
                .map(|i| libm::sincos(TAU * i as f64 / count as f64))
                .map(|(s, c)| DVec3::new(c, s, 0.0))
                .collect();
            let spline = CubicSpline::closed(&points, Parametrization::Centripetal).unwrap();
            (0..400)
                .map(|i| (spline.position(spline.domain().1 * f64::from(i) / 400.0).length() - 1.0).abs())
                .fold(0.0, f64::max)
        };
        assert!(knot.is_closed());
        let ratio = radius_error(32) / radius_error(16);
        assert!((0.05..0.07).contains(&ratio), "1/16 expected, got {ratio}");
    }

    #[test]
    fn cubics_are_reproduced_by_not_a_knot() {
        let points: Vec<DVec3> = [0.0, 1.0, 2.0, 3.0, 4.0].map(|t: f64| DVec3::new(t, 0.0, 0.0)).to_vec();
        let line = CubicSpline::open(&points, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
        assert!((line.position(1.7) - DVec3::new(1.7, 0.0, 0.0)).length() < 1e-15);
        let three = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 0.0, 0.0)];
        let parabola = CubicSpline::open(&three, Parametrization::ChordLength, EndCondition::NotAKnot).unwrap();
        assert!(parabola.jet(0.3).third.length() < 1e-15);
        assert!((parabola.jet(0.0).second - parabola.jet(2.0).second).length() < 1e-15);
        let two = CubicSpline::open(&three[..2], Parametrization::Centripetal, EndCondition::NotAKnot).unwrap();
        assert!((two.position(0.5 * two.domain().1) - DVec3::new(0.5, 0.5, 0.0)).length() < 1e-15);
    }

    #[test]
    fn splines_at_the_same_parameters_depend_linearly_on_their_points() {
        let (_, start) = helix_points(6);
        let end: Vec<DVec3> = start.iter().map(|p| DVec3::new(p.y, 2.0 * p.z, p.x * p.x)).collect();
        let parameters = [0.0, 0.4, 1.0, 1.3, 2.0, 2.6];
        let through = |points: &[DVec3]| CubicSpline::open_at(points, &parameters, EndCondition::Natural).unwrap();
        let between: Vec<DVec3> = start.iter().zip(&end).map(|(a, b)| a.lerp(*b, 0.3)).collect();
        let (blend, expected) = (through(&start).blend(&through(&end), 0.3), through(&between));
        for i in 0..=50 {
            let parameter = 2.6 * f64::from(i) / 50.0;
            // A few roundings of numbers of size one.
            assert!((blend.position(parameter) - expected.position(parameter)).length() < 1e-14);
        }
        let centripetal = CubicSpline::open(&start, Parametrization::Centripetal, EndCondition::Natural).unwrap();
        assert_eq!(CubicSpline::open_at(&start, centripetal.knots(), EndCondition::Natural).unwrap().knots().len(), 6);
    }

    #[test]
    fn control_points_reproduce_their_pieces() {
        let (_, points) = helix_points(5);
        let spline = CubicSpline::open(&points, Parametrization::Centripetal, EndCondition::Natural).unwrap();
        for (piece, [a, b, c, d]) in spline.control_points().enumerate() {
            let (start, end) = (spline.knots()[piece], spline.knots()[piece + 1]);
            for t in [0.0, 0.2, 0.7, 1.0] {
                // De Casteljau.
                let [e, f, g] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
                let point = e.lerp(f, t).lerp(f.lerp(g, t), t);
                assert!((point - spline.position(start + (end - start) * t)).length() < 1e-14, "{piece} {t}");
            }
        }
    }

    #[test]
    fn errors_name_the_invalid_parameter() {
        let points = [DVec3::X, DVec3::X, DVec3::Y];
        let at = |parameters: &[f64]| CubicSpline::open_at(&points, parameters, EndCondition::Natural);
        assert!(at(&[0.0, 1.0, 2.0]).is_ok());
        assert_eq!(at(&[0.0, 1.0]).unwrap_err(), SplineError::Parameter { index: 2 });
        assert_eq!(at(&[0.0, 1.0, 1.0]).unwrap_err(), SplineError::Parameter { index: 2 });
        assert_eq!(at(&[0.0, f64::NAN, 1.0]).unwrap_err(), SplineError::Parameter { index: 1 });
    }

    #[test]
    fn errors_name_the_invalid_point() {
        let error = |points: &[DVec3]| {
            CubicSpline::open(points, Parametrization::default(), EndCondition::default()).unwrap_err()
        };
        assert_eq!(error(&[DVec3::X]), SplineError::TooFewPoints { count: 1, needed: 2 });
        assert_eq!(error(&[]), SplineError::TooFewPoints { count: 0, needed: 2 });
        assert_eq!(error(&[DVec3::X, DVec3::NAN]), SplineError::NotFinite { index: 1 });
        assert_eq!(error(&[DVec3::X, DVec3::splat(1e200)]), SplineError::NotFinite { index: 1 });
        let repeated = [DVec3::X, DVec3::Y, DVec3::Y];
        assert_eq!(error(&repeated), SplineError::RepeatedPoint { index: 1, next: 2 });
        let ends = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::X];
        assert_eq!(
            CubicSpline::closed(&ends, Parametrization::default()).unwrap_err(),
            SplineError::RepeatedPoint { index: 3, next: 0 }
        );
    }
}
