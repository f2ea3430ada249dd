//! The spine of a strip: a curve that may deform over time.

use std::sync::Arc;

use glam::DVec3;
use isochore_curve::{CubicSpline, Curve, CurveJet, EndCondition, Parametrization, SplineError};

use super::StripError;

/// The spine of a strip, over the time from 0 to 1.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_field::{StripError, StripSpine};
///
/// let start = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
/// let end = start.map(|point| point + DVec3::Z);
/// assert!(!StripSpine::through(&start)?.is_reshaping());
/// assert!(StripSpine::between(&start, &end)?.is_reshaping());
///
/// let error = StripSpine::between(&start, &end[..2]).unwrap_err();
/// assert_eq!(error, StripError::PointCounts { start: 3, end: 2 });
/// # Ok::<(), StripError>(())
/// ```
#[derive(Debug, Clone)]
pub struct StripSpine(Shape);

#[derive(Debug, Clone)]
enum Shape {
    Still(SpineCurve),
    Reshaping { start: CubicSpline, end: CubicSpline },
}

impl StripSpine {
    /// The C² cubic spline through `points`, in order.
    ///
    /// # Errors
    /// [`StripError::Spine`] if no spline passes through the points.
    pub fn through(points: &[DVec3]) -> Result<Self, StripError> {
        Ok(Self(Shape::Still(SpineCurve::Spline(spline(points, "the spine")?))))
    }

    /// The C² cubic spline through points that each move from a position in `start` to the position
    /// with the same index in `end`, along a straight line at constant speed.
    ///
    /// # Errors
    /// [`StripError::PointCounts`] if the numbers of points differ, [`StripError::Spine`] if no
    /// spline passes through the points of one list.
    pub fn between(start: &[DVec3], end: &[DVec3]) -> Result<Self, StripError> {
        if start.len() != end.len() {
            return Err(StripError::PointCounts { start: start.len(), end: end.len() });
        }
        let lists = ["the spine", "the end of the spine"];
        let [first, last] = [spline(start, lists[0])?, spline(end, lists[1])?];
        // Mean parameters suit both shapes and are constant in time, so every point of the curve
        // also moves along a straight line.
        let parameters: Vec<f64> = first.knots().iter().zip(last.knots()).map(|(a, b)| 0.5 * (a + b)).collect();
        let at = |points: &[DVec3], list| {
            CubicSpline::open_at(points, &parameters, EndCondition::Natural)
                .map_err(|source| StripError::Spine { list, source })
        };
        Ok(Self(Shape::Reshaping { start: at(start, lists[0])?, end: at(end, lists[1])? }))
    }

    /// Any curve that does not change with time.
    pub fn along(curve: Arc<dyn Curve>) -> Self {
        Self(Shape::Still(SpineCurve::Other(curve)))
    }

    /// Whether the spine changes its shape or position over time.
    pub fn is_reshaping(&self) -> bool {
        matches!(self.0, Shape::Reshaping { .. })
    }

    /// The curve at `time`.
    pub(crate) fn at(&self, time: f64) -> SpineCurve {
        match &self.0 {
            Shape::Still(curve) => curve.clone(),
            Shape::Reshaping { start, end } => SpineCurve::Spline(start.blend(end, time)),
        }
    }

    /// Velocity of the spine's point at `parameter`, constant in time.
    pub(super) fn velocity(&self, parameter: f64) -> DVec3 {
        match &self.0 {
            Shape::Still(_) => DVec3::ZERO,
            Shape::Reshaping { start, end } => end.position(parameter) - start.position(parameter),
        }
    }

    /// Upper bound on the speed of the spine's points when all of them also move with `travel`.
    pub(super) fn top_speed(&self, travel: DVec3) -> f64 {
        match &self.0 {
            Shape::Still(_) => travel.length(),
            // The velocity is also a spline and stays within the hulls of its control points.
            Shape::Reshaping { start, end } => start
                .control_points()
                .flatten()
                .zip(end.control_points().flatten())
                .map(|(start, end)| (end - start + travel).length())
                .fold(0.0, f64::max),
        }
    }
}

fn spline(points: &[DVec3], list: &'static str) -> Result<CubicSpline, StripError> {
    let spline: Result<_, SplineError> = CubicSpline::open(points, Parametrization::Centripetal, EndCondition::Natural);
    spline.map_err(|source| StripError::Spine { list, source })
}

/// A spine at one instant.
#[derive(Debug, Clone)]
pub(crate) enum SpineCurve {
    Spline(CubicSpline),
    Other(Arc<dyn Curve>),
}

impl Curve for SpineCurve {
    fn domain(&self) -> (f64, f64) {
        match self {
            Self::Spline(curve) => curve.domain(),
            Self::Other(curve) => curve.domain(),
        }
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        match self {
            Self::Spline(curve) => curve.jet(parameter),
            Self::Other(curve) => curve.jet(parameter),
        }
    }

    fn is_closed(&self) -> bool {
        match self {
            Self::Spline(curve) => curve.is_closed(),
            Self::Other(curve) => curve.is_closed(),
        }
    }

    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Spline(curve) => curve.breaks(),
            Self::Other(curve) => curve.breaks(),
        }
    }
}
