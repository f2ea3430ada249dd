//! A sampled spine curve: points with unit tangents, open or closed.

use glam::DVec3;

use crate::spline::COORDINATE_LIMIT;
use crate::tangents::{TangentError, TangentRule, estimate_tangents};
use crate::{Curve, CurveJet};

/// Largest ratio of the closing chord of a closed spine to its longest other chord. Larger: the gap
/// of an open curve is accepted as a segment, and the frame jumps across it. Smaller: coarse closed
/// data with one long side are rejected.
const CLOSING_GAP: f64 = 4.0;

/// A sampled curve: at least two finite points with a unit tangent each.
///
/// A closed spine has one more segment, from its last point to its first. The first point is not
/// repeated.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Spine, TangentRule};
///
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(2.0, 1.0, 0.0), DVec3::new(2.0, 2.0, 0.0)];
/// let spine = Spine::from_points(points, false, TangentRule::Automatic)?;
/// assert_eq!(spine.segments(), 3);
/// assert!((spine.tangent(1).length() - 1.0).abs() < 1e-15);
/// assert_eq!(spine.chords()[0], 1.0);
/// # Ok::<(), isochore_curve::SpineError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spine {
    points: Vec<DVec3>,
    tangents: Vec<DVec3>,
    closed: bool,
}

/// Errors when constructing a [`Spine`]. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SpineError {
    /// Too few points.
    #[error("a spine needs at least {needed} points, not {count}")]
    TooFewPoints {
        /// Number of points.
        count: usize,
        /// Required number: two for an open spine, three for a closed one.
        needed: usize,
    },
    /// The numbers of points and tangents differ.
    #[error("{points} points with {tangents} tangents; give one tangent per point")]
    TangentCount {
        /// Number of points.
        points: usize,
        /// Number of tangents.
        tangents: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e50.
    #[error("point {index} has a coordinate that is NaN, infinite or beyond 1e50")]
    PointNotFinite {
        /// The point.
        index: usize,
    },
    /// A tangent is NaN, infinite or beyond 1e50.
    #[error("tangent {index} has a coordinate that is NaN, infinite or beyond 1e50")]
    TangentNotFinite {
        /// The tangent.
        index: usize,
    },
    /// A tangent is zero.
    #[error("tangent {index} is zero: the curve has a cusp or a constant part")]
    ZeroTangent {
        /// The tangent.
        index: usize,
    },
    /// The last point of a closed spine equals its first.
    #[error("point {index} repeats the first point; remove it, because a closed spine ends at its first point")]
    ClosingPointRepeated {
        /// The last point.
        index: usize,
    },
    /// The first and last points of a closed spine are far apart.
    #[error(
        "the points do not close: the last is {gap} from the first, and other neighbors are at most {longest} apart"
    )]
    NotClosed {
        /// Distance from the last point to the first.
        gap: f64,
        /// Longest distance between other neighbors.
        longest: f64,
    },
    /// The points do not determine a tangent.
    #[error(transparent)]
    Tangent(#[from] TangentError),
}

impl Spine {
    /// Creates a spine from points and tangents. Tangents of any length are normalized.
    ///
    /// Equal neighboring points are allowed: between them, frames rotate with the tangents.
    ///
    /// # Errors
    /// Every [`SpineError`] except [`SpineError::Tangent`].
    pub fn new(points: Vec<DVec3>, tangents: Vec<DVec3>, closed: bool) -> Result<Self, SpineError> {
        check_points(&points, closed)?;
        if points.len() != tangents.len() {
            return Err(SpineError::TangentCount { points: points.len(), tangents: tangents.len() });
        }
        if let Some(index) = tangents.iter().position(|&tangent| !is_ordinary(tangent)) {
            return Err(SpineError::TangentNotFinite { index });
        }
        let tangents = tangents
            .iter()
            .enumerate()
            .map(|(index, tangent)| tangent.try_normalize().ok_or(SpineError::ZeroTangent { index }))
            .collect::<Result<_, _>>()?;
        Ok(Self { points, tangents, closed })
    }

    /// Creates a spine from points, with tangents estimated by `rule`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`SpineError::Tangent`] if the points do not determine a tangent.
    pub fn from_points(points: Vec<DVec3>, closed: bool, rule: TangentRule<'_>) -> Result<Self, SpineError> {
        check_points(&points, closed)?;
        let tangents = estimate_tangents(&points, closed, rule)?;
        Ok(Self { points, tangents, closed })
    }

    /// Samples `curve` at `segments` equal steps of its parameter, with its tangents. The spine is
    /// closed if the curve is.
    ///
    /// # Errors
    /// As [`new`](Self::new). A cusp at a sample has a zero tangent.
    ///
    /// # Examples
    /// ```
    /// use isochore_curve::{Spine, TrigonometricCurve};
    ///
    /// let knot = Spine::sample(&TrigonometricCurve::torus_knot(), 64)?;
    /// assert!(knot.is_closed());
    /// assert_eq!((knot.points().len(), knot.segments()), (64, 64));
    /// assert_eq!(knot.point(64), knot.point(0));
    /// # Ok::<(), isochore_curve::SpineError>(())
    /// ```
    pub fn sample(curve: &impl Curve, segments: usize) -> Result<Self, SpineError> {
        let parameters = uniform_parameters(curve, segments);
        let samples = if curve.is_closed() { segments } else { segments + 1 };
        Self::from_jets(parameters[..samples].iter().map(|&parameter| curve.jet(parameter)), curve.is_closed())
    }

    /// Creates a spine from the positions and first derivatives of `jets`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_jets(jets: impl IntoIterator<Item = CurveJet>, closed: bool) -> Result<Self, SpineError> {
        let (points, tangents) = jets.into_iter().map(|jet| (jet.position, jet.first)).unzip();
        Self::new(points, tangents, closed)
    }

    /// The points, model units.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The unit tangents.
    pub fn tangents(&self) -> &[DVec3] {
        &self.tangents
    }

    /// Returns true if the last point is followed by the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number of segments: the number of points on a closed spine, one less on an open one.
    pub fn segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len() - 1 }
    }

    /// Point at a station. Station `segments()` of a closed spine is point 0.
    ///
    /// # Panics
    /// If `station` is greater than [`segments`](Self::segments).
    pub fn point(&self, station: usize) -> DVec3 {
        self.points[self.index(station)]
    }

    /// Unit tangent at a station, numbered as in [`point`](Self::point).
    ///
    /// # Panics
    /// If `station` is greater than [`segments`](Self::segments).
    pub fn tangent(&self, station: usize) -> DVec3 {
        self.tangents[self.index(station)]
    }

    fn index(&self, station: usize) -> usize {
        if self.closed && station == self.points.len() { 0 } else { station }
    }

    /// Reverses the spine: the order of the stations and the direction of the tangents. A closed
    /// spine keeps its first point.
    pub fn reversed(&self) -> Self {
        let mut points = self.points.clone();
        let mut tangents: Vec<DVec3> = self.tangents.iter().map(|&tangent| -tangent).collect();
        points.reverse();
        tangents.reverse();
        if self.closed {
            points.rotate_right(1);
            tangents.rotate_right(1);
        }
        Self { points, tangents, closed: self.closed }
    }

    /// Chord lengths of the segments, model units.
    pub fn chords(&self) -> Vec<f64> {
        (0..self.segments()).map(|i| self.point(i).distance(self.point(i + 1))).collect()
    }

    /// Angles between the tangents at the ends of the segments, radians.
    pub fn turning_angles(&self) -> Vec<f64> {
        (0..self.segments())
            .map(|i| {
                let (start, end) = (self.tangent(i), self.tangent(i + 1));
                libm::atan2(start.cross(end).length(), start.dot(end))
            })
            .collect()
    }

    /// Default reference vector for the first frame: the discrete Frenet normal at the first point,
    /// from a difference stencil over the first tangents. If the tangent does not turn, the result
    /// is [`perpendicular`] to it.
    pub fn default_reference(&self) -> DVec3 {
        let count = self.tangents.len();
        let derivative = if self.closed && count >= 5 {
            let at = |offset: usize| self.tangents[offset % count];
            8.0 * (at(1) - at(count - 1)) - (at(2) - at(count - 2))
        } else if count >= 5 {
            let t = &self.tangents;
            -25.0 * t[0] + 48.0 * t[1] - 36.0 * t[2] + 16.0 * t[3] - 3.0 * t[4]
        } else {
            self.tangents[1] - self.tangents[0]
        };
        let across = derivative.reject_from_normalized(self.tangents[0]);
        // The stencils return twelve times the turn per step, so this is a turn of about 1e-10
        // radians. Below it, the direction is rounding error of the input.
        if across.length() > 1e-9 { across.normalize() } else { perpendicular(self.tangents[0]) }
    }
}

/// `segments + 1` equally spaced parameters over the domain of `curve`, ends included.
pub fn uniform_parameters(curve: &impl Curve, segments: usize) -> Vec<f64> {
    let (first, last) = curve.domain();
    (0..=segments)
        .map(|i| if i == segments { last } else { first + (last - first) * (i as f64 / segments as f64) })
        .collect()
}

/// A unit vector perpendicular to the unit vector `tangent`, in the plane of `tangent` and the
/// coordinate axis of its smallest component.
pub fn perpendicular(tangent: DVec3) -> DVec3 {
    let size = tangent.abs();
    let axis = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    (axis - tangent * tangent.dot(axis)).normalize()
}

fn is_ordinary(vector: DVec3) -> bool {
    vector.is_finite() && vector.abs().max_element() <= COORDINATE_LIMIT
}

fn check_points(points: &[DVec3], closed: bool) -> Result<(), SpineError> {
    let needed = if closed { 3 } else { 2 };
    let count = points.len();
    if count < needed {
        return Err(SpineError::TooFewPoints { count, needed });
    }
    if let Some(index) = points.iter().position(|&point| !is_ordinary(point)) {
        return Err(SpineError::PointNotFinite { index });
    }
    if closed {
        let gap = points[0].distance(points[count - 1]);
        if gap == 0.0 {
            return Err(SpineError::ClosingPointRepeated { index: count - 1 });
        }
        let longest = points.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
        if gap > CLOSING_GAP * longest {
            return Err(SpineError::NotClosed { gap, longest });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
