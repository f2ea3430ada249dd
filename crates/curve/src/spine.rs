//! A sampled spine curve: points with unit tangents, open or closed.

use glam::DVec3;

use crate::spline::COORDINATE_LIMIT;
use crate::tangents::{TangentError, TangentRule, estimate_tangents};
use crate::{Curve, CurveJet};

/// A closed spine whose closing chord is this many times longer than its longest other chord is refused as open data.
/// Larger: the gap of an open curve passes as a segment, and the frame jumps across it. Smaller: coarse but closed data
/// with one long side are refused.
const CLOSING_GAP: f64 = 4.0;

/// Samples of a curve that are fit to carry frames: at least two finite points with a unit tangent each.
///
/// A closed spine has one segment from its last point back to its first, which is not repeated.
#[derive(Debug, Clone, PartialEq)]
pub struct Spine {
    points: Vec<DVec3>,
    tangents: Vec<DVec3>,
    closed: bool,
}

/// Why samples are no [`Spine`]. Indices count from zero.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SpineError {
    /// Too few points.
    #[error("a spine needs at least {needed} points, not {count}")]
    TooFewPoints {
        /// Points given.
        count: usize,
        /// Two for an open spine, three for a closed one.
        needed: usize,
    },
    /// Points and tangents are not one to one.
    #[error("{points} points come with {tangents} tangents")]
    TangentCount {
        /// Points given.
        points: usize,
        /// Tangents given.
        tangents: usize,
    },
    /// A coordinate is NaN, infinite or beyond 1e50.
    #[error("point {index} has a coordinate that is not a finite number of ordinary size")]
    PointNotFinite {
        /// The point.
        index: usize,
    },
    /// A tangent is NaN, infinite or beyond 1e50.
    #[error("tangent {index} has a coordinate that is not a finite number of ordinary size")]
    TangentNotFinite {
        /// The tangent.
        index: usize,
    },
    /// A given tangent is zero.
    #[error("tangent {index} is zero: the curve has a cusp or stands still there")]
    ZeroTangent {
        /// The tangent.
        index: usize,
    },
    /// The last point of a closed spine is its first.
    #[error("point {index} repeats the first point; leave it out, a closed spine returns by itself")]
    ClosingPointRepeated {
        /// The last point.
        index: usize,
    },
    /// The ends of points that should close are far apart.
    #[error("the ends are {gap} apart while neighbors are at most {longest}: these points do not close")]
    NotClosed {
        /// Distance from the last point to the first.
        gap: f64,
        /// Longest distance of other neighbors.
        longest: f64,
    },
    /// Points alone do not determine a tangent.
    #[error(transparent)]
    Tangent(#[from] TangentError),
}

impl Spine {
    /// The spine with given points and tangents, which may have any length.
    ///
    /// Equal neighboring points are allowed: frames turn with the tangents there.
    ///
    /// # Errors
    /// Too few points, unequal counts, coordinates that are not finite, a zero tangent, or points that do not close.
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

    /// The spine with given points and tangents estimated from them by `rule`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and a tangent that the points do not determine.
    pub fn from_points(points: Vec<DVec3>, closed: bool, rule: TangentRule<'_>) -> Result<Self, SpineError> {
        check_points(&points, closed)?;
        let tangents = estimate_tangents(&points, closed, rule)?;
        Ok(Self { points, tangents, closed })
    }

    /// `segments` equal steps of the parameter along `curve`, with its tangents. Closed where the curve is.
    ///
    /// # Errors
    /// As [`new`](Self::new); a cusp among the samples is a zero tangent.
    pub fn sample(curve: &impl Curve, segments: usize) -> Result<Self, SpineError> {
        let parameters = uniform_parameters(curve, segments);
        let samples = if curve.is_closed() { segments } else { segments + 1 };
        Self::from_jets(parameters[..samples].iter().map(|&parameter| curve.jet(parameter)), curve.is_closed())
    }

    /// The spine with the points and tangents of `jets`.
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

    /// True where the last point is followed by the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number of segments: as many as points on a closed spine, one fewer on an open one.
    pub fn segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len() - 1 }
    }

    /// Point at a station: station `segments()` of a closed spine is point 0 again.
    ///
    /// # Panics
    /// If `station` is greater than [`segments`](Self::segments).
    pub fn point(&self, station: usize) -> DVec3 {
        self.points[self.index(station)]
    }

    /// Unit tangent at a station, counted as in [`point`](Self::point).
    ///
    /// # Panics
    /// If `station` is greater than [`segments`](Self::segments).
    pub fn tangent(&self, station: usize) -> DVec3 {
        self.tangents[self.index(station)]
    }

    fn index(&self, station: usize) -> usize {
        if self.closed && station == self.points.len() { 0 } else { station }
    }

    /// The same spine run backwards: stations in reverse order and tangents reversed. A closed spine keeps its first
    /// point.
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

    /// The discrete Frenet normal at the first point, which is where frames start by default: the direction in which
    /// the tangent turns, by a difference stencil over the first tangents. Where the tangent does not turn, a vector
    /// perpendicular to it in its plane with the axis of its smallest component.
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
        // Twelve times a turn of 1e-10 radians: below it the direction is rounding of the input.
        if across.length() > 1e-9 { across.normalize() } else { perpendicular(self.tangents[0]) }
    }
}

/// `segments + 1` equally spaced parameters from the first to the last of `curve`.
pub fn uniform_parameters(curve: &impl Curve, segments: usize) -> Vec<f64> {
    let (first, last) = curve.domain();
    (0..=segments)
        .map(|i| if i == segments { last } else { first + (last - first) * (i as f64 / segments as f64) })
        .collect()
}

/// A unit vector perpendicular to the unit vector `tangent`, in its plane with the axis of its smallest component.
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
mod tests {
    use super::*;
    use crate::{Bezier, TrigonometricCurve};

    #[test]
    fn bad_samples_are_named() {
        let make = |points: &[DVec3], tangents: &[DVec3], closed| {
            Spine::new(points.to_vec(), tangents.to_vec(), closed).unwrap_err()
        };
        assert_eq!(make(&[DVec3::X], &[DVec3::X], false), SpineError::TooFewPoints { count: 1, needed: 2 });
        assert_eq!(make(&[DVec3::X; 2], &[DVec3::X], false), SpineError::TangentCount { points: 2, tangents: 1 });
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::X * 9.0];
        assert_eq!(make(&[DVec3::X, DVec3::NAN], &line[..2], false), SpineError::PointNotFinite { index: 1 });
        let infinite = [DVec3::X, DVec3::splat(f64::INFINITY)];
        assert_eq!(make(&line[..2], &infinite, false), SpineError::TangentNotFinite { index: 1 });
        assert_eq!(make(&line[..2], &[DVec3::X, DVec3::ZERO], false), SpineError::ZeroTangent { index: 1 });
        let repeated = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::X];
        assert_eq!(make(&repeated, &[DVec3::X; 4], true), SpineError::ClosingPointRepeated { index: 3 });
        let open: Vec<DVec3> = (0..9).map(|i| DVec3::X * f64::from(i)).collect();
        assert_eq!(make(&open, &[DVec3::X; 9], true), SpineError::NotClosed { gap: 8.0, longest: 1.0 });
    }

    #[test]
    fn a_cusp_of_a_formula_is_a_zero_tangent() {
        // t³, t²: the tangent vanishes in the middle of [−1, 1].
        let cusp = Bezier::new(
            [(-1.0, 1.0), (1.0, -1.0 / 3.0), (-1.0, -1.0 / 3.0), (1.0, 1.0)]
                .map(|(x, y)| DVec3::new(x, y, 0.0))
                .to_vec(),
        );
        assert_eq!(Spine::sample(&cusp, 4).unwrap_err(), SpineError::ZeroTangent { index: 2 });
    }

    #[test]
    fn default_reference_is_the_frenet_normal_where_there_is_one() {
        // One-sided differences of fourth order: error h⁴/5 times the fifth derivative, h = 0.06, here 8 · 1e-5.
        let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 6.0));
        let reference = Spine::sample(&helix, 100).unwrap().default_reference();
        assert!((reference - helix.jet(0.0).normal().unwrap()).length() < 2e-5);
        let line = Spine::new(vec![DVec3::ZERO, DVec3::Z], vec![DVec3::Z; 2], false).unwrap();
        assert_eq!(line.default_reference(), DVec3::X);
    }

    #[test]
    fn reversal_twice_is_the_identity() {
        for closed in [false, true] {
            let points: Vec<DVec3> = [DVec3::X, DVec3::Y, DVec3::Z].to_vec();
            let spine = Spine::new(points.clone(), points, closed).unwrap();
            assert_eq!(spine.reversed().reversed(), spine);
            assert_eq!(closed, spine.reversed().points()[0] == DVec3::X);
        }
    }
}
