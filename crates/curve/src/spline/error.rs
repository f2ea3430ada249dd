//! Errors when constructing a spline.

/// Errors when constructing a [`CubicSpline`](super::CubicSpline).
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
