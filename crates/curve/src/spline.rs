//! The C² cubic spline through given points.

use glam::DVec3;

use crate::{Curve, CurveJet};

mod error;
mod points;
mod second_derivatives;

pub use error::SplineError;
pub(crate) use points::COORDINATE_LIMIT;
use points::{check_points, spacings};

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
    /// Whether the last piece returns to the first point.
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

    /// The open spline with given parameter steps between its valid points.
    fn open_with(points: &[DVec3], spacings: &[f64], end_condition: EndCondition) -> Self {
        let slopes: Vec<DVec3> = (0..spacings.len()).map(|i| (points[i + 1] - points[i]) / spacings[i]).collect();
        let seconds = second_derivatives::of_open(spacings, &slopes, end_condition);
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
        let seconds = second_derivatives::of_closed(&spacings, &slopes);
        Ok(Self::from_seconds(points, &spacings, &slopes, &seconds, true))
    }

    /// The spline with the given second derivatives at its points.
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

#[cfg(test)]
mod tests;
