//! Splines of Pythagorean-hodograph cubics that approximate a curve within a tolerance.

use super::{HermiteError, PhCubic, PhCubicError};
use crate::curve::{jet_of_segments, joints};
use crate::quadrature::gauss;
use crate::{Curve, CurveJet, Frame, FrameError, Spine, orthogonal_reference};

/// Largest number of halvings of a smooth piece of the curve. Larger: useful only for tolerances
/// near rounding error. Smaller: tight tolerances fail.
const DEPTH: u32 = 24;

/// Points of a cubic that are compared with the curve. Larger: more time. Smaller: a local maximum
/// of the error can be missed; there are at most three between the ends.
const CHECKS: usize = 9;

/// Largest turning of the curve over one segment, radians. Larger: the points are too few for long
/// arcs, and a shortcut between two branches of a knot is accepted. Smaller: more segments than a
/// loose tolerance needs.
const LARGEST_TURNING: f64 = 1.2;

/// Newton steps that move a point of the curve into the normal plane of the cubic. Larger: no
/// effect. Smaller: the distance is overestimated; the error of the initial guess is of third
/// order.
const NEWTON_STEPS: usize = 8;

/// A curve of [`PhCubic`] segments with continuous tangent.
///
/// # Examples
/// ```
/// use isochore_curve::{PhSpline, TrigonometricCurve, length};
///
/// let knot = TrigonometricCurve::torus_knot();
/// let spline = PhSpline::follow(&knot, 1e-3)?;
/// assert!(spline.error() <= 1e-3);
/// assert!((spline.length() - length(&knot)).abs() < 1e-2);
/// # Ok::<(), isochore_curve::PhSplineError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PhSpline {
    segments: Vec<PhCubic>,
    /// Parameters of the original curve at the joints.
    parameters: Vec<f64>,
    /// Largest distance between the two curves at the compared points.
    error: f64,
    closed: bool,
}

/// Errors when approximating a curve by Pythagorean-hodograph cubics.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PhSplineError {
    /// The tolerance is not a positive number.
    #[error("the tolerance {tolerance} is not a positive number")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// Even the shortest segment has no cubic.
    #[error("near parameter {parameter}, even the shortest segment has no cubic: {reason}")]
    Segment {
        /// Parameter of the original curve.
        parameter: f64,
        /// Reason for the failure of the shortest segment.
        reason: PhCubicError,
    },
    /// Even the shortest segment exceeds the tolerance.
    #[error("near parameter {parameter}, the distance of the shortest segment is {error}, above the tolerance")]
    Accuracy {
        /// Parameter of the original curve.
        parameter: f64,
        /// Distance of the shortest segment, model units.
        error: f64,
    },
}

impl PhSpline {
    /// Approximates `curve` within `tolerance` model units. Parameter intervals are halved until
    /// the cubic of each is close enough. Intervals are split at points of zero curvature, because
    /// the cubics have no inflections.
    ///
    /// # Errors
    /// - [`PhSplineError::Tolerance`] if `tolerance` is not positive and finite.
    /// - [`PhSplineError::Segment`] or [`PhSplineError::Accuracy`] if the shortest segment fails,
    ///   for example at a cusp.
    pub fn follow(curve: &impl Curve, tolerance: f64) -> Result<Self, PhSplineError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(PhSplineError::Tolerance { tolerance });
        }
        let breaks = curve.breaks();
        let mut spline =
            Self { segments: Vec::new(), parameters: vec![breaks[0]], error: 0.0, closed: curve.is_closed() };
        for pair in breaks.windows(2) {
            // Use at least two parts, because one segment of a closed curve would join a point to
            // itself.
            let middle = 0.5 * (pair[0] + pair[1]);
            spline.extend(curve, pair[0], middle, tolerance, DEPTH)?;
            spline.extend(curve, middle, pair[1], tolerance, DEPTH)?;
        }
        Ok(spline)
    }

    /// Interpolates `curve` at `segments` equal steps of its parameter.
    ///
    /// # Errors
    /// [`HermiteError`] with the first segment that has no cubic.
    pub fn interpolate(curve: &impl Curve, segments: usize) -> Result<Self, HermiteError> {
        let parameters = crate::uniform_parameters(curve, segments);
        let mut cubics = Vec::with_capacity(segments);
        let mut error: f64 = 0.0;
        for (segment, pair) in parameters.windows(2).enumerate() {
            let cubic =
                between(&curve.jet(pair[0]), &curve.jet(pair[1])).map_err(|reason| HermiteError { segment, reason })?;
            error = error.max(deviation(curve, &cubic, pair[0], pair[1]));
            cubics.push(cubic);
        }
        Ok(Self { segments: cubics, parameters, error, closed: curve.is_closed() })
    }

    /// Interpolates the points and tangents of `spine`. The parameters are the stations. The error
    /// is zero, because the spine has no points in between for comparison.
    ///
    /// # Errors
    /// [`HermiteError`] with the first segment that has no cubic.
    pub fn through(spine: &Spine) -> Result<Self, HermiteError> {
        let segments = (0..spine.segments())
            .map(|i| {
                PhCubic::hermite(spine.point(i), spine.point(i + 1), spine.tangent(i), spine.tangent(i + 1))
                    .map_err(|reason| HermiteError { segment: i, reason })
            })
            .collect::<Result<_, _>>()?;
        let parameters = (0..=spine.segments()).map(|i| i as f64).collect();
        Ok(Self { segments, parameters, error: 0.0, closed: spine.is_closed() })
    }

    /// Appends cubics for [start, end], halving the interval at most `depth` times.
    fn extend(
        &mut self,
        curve: &impl Curve,
        start: f64,
        end: f64,
        tolerance: f64,
        depth: u32,
    ) -> Result<(), PhSplineError> {
        let cubic = between(&curve.jet(start), &curve.jet(end));
        let failure = match cubic {
            Ok(cubic) => {
                let error = deviation(curve, &cubic, start, end);
                let turning = gauss(&mut |u| curve.jet(u).tangent_derivative().length(), start, end);
                if error <= tolerance && turning <= LARGEST_TURNING {
                    self.segments.push(cubic);
                    self.parameters.push(end);
                    self.error = self.error.max(error);
                    return Ok(());
                }
                PhSplineError::Accuracy { parameter: start, error }
            }
            Err(reason) => PhSplineError::Segment { parameter: start, reason },
        };
        if depth == 0 {
            return Err(failure);
        }
        let cut = cut(curve, start, end);
        self.extend(curve, start, cut, tolerance, depth - 1)?;
        self.extend(curve, cut, end, tolerance, depth - 1)
    }

    /// The segments in order.
    pub fn segments(&self) -> &[PhCubic] {
        &self.segments
    }

    /// Parameters of the original curve at the joints. There is one more than there are segments.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Largest distance from the original curve at the compared points, model units.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Exact arc length, model units.
    pub fn length(&self) -> f64 {
        self.segments.iter().map(PhCubic::length).sum()
    }

    /// Points with exact rotation-minimizing frames, at `samples` equal parameter steps per
    /// segment, ends included.
    ///
    /// # Errors
    /// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first
    /// tangent.
    ///
    /// # Panics
    /// If `samples` is zero.
    pub fn exact_frames(
        &self,
        reference: glam::DVec3,
        samples: usize,
    ) -> Result<Vec<(glam::DVec3, Frame)>, FrameError> {
        assert!(samples > 0, "at least one sample per segment");
        let parameters: Vec<f64> = (0..=samples).map(|i| i as f64 / samples as f64).collect();
        let mut r = reference;
        let mut all = Vec::with_capacity(self.segments.len() * samples + 1);
        for segment in &self.segments {
            let frames = segment.exact_frames(&parameters, r)?;
            // The last frame of a segment equals the first of the next.
            all.pop();
            all.extend(parameters.iter().zip(&frames).map(|(&v, &frame)| (segment.position(v), frame)));
            r = frames[samples].r;
        }
        // At the joints, the tangents of neighboring segments differ by rounding. Make each frame
        // orthonormal to its own tangent.
        for (_, frame) in &mut all {
            *frame = Frame::new(orthogonal_reference(frame.r, frame.t)?, frame.t);
        }
        Ok(all)
    }
}

/// The parameter is the segment number plus the parameter within the segment.
impl Curve for PhSpline {
    fn domain(&self) -> (f64, f64) {
        (0.0, self.segments.len() as f64)
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        jet_of_segments(&self.segments, parameter)
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn breaks(&self) -> Vec<f64> {
        joints(self.segments.len())
    }
}

fn between(start: &CurveJet, end: &CurveJet) -> Result<PhCubic, PhCubicError> {
    PhCubic::hermite(start.position, end.position, start.first, end.first)
}

/// Largest distance between the cubic and the interval of the curve that it approximates, measured
/// in the normal planes of the cubic.
fn deviation(curve: &impl Curve, cubic: &PhCubic, start: f64, end: f64) -> f64 {
    let whole = cubic.length();
    (1..=CHECKS)
        .map(|i| {
            let v = i as f64 / (CHECKS + 1) as f64;
            let jet = cubic.jet(v);
            // Start at the same fraction of the length, then move into the normal plane.
            let fraction = gauss(&mut |x| cubic.speed(x), 0.0, v) / whole;
            let mut parameter = start + (end - start) * fraction;
            for _ in 0..NEWTON_STEPS {
                let other = curve.jet(parameter);
                let along = other.first.dot(jet.first);
                if along == 0.0 {
                    break;
                }
                let step = (jet.position - other.position).dot(jet.first) / along;
                parameter = (parameter + step).clamp(start, end);
            }
            curve.position(parameter).distance(jet.position)
        })
        .fold(0.0, f64::max)
}

/// Parameter at which to split an interval: a point of nearly zero curvature inside it, or else the
/// midpoint.
fn cut(curve: &impl Curve, start: f64, end: f64) -> f64 {
    let middle = 0.5 * (start + end);
    let at = |i: usize| start + (end - start) * i as f64 / 8.0;
    let curvatures: Vec<f64> = (0..=8).map(|i| curve.jet(at(i)).curvature()).collect();
    let mean = curvatures.iter().sum::<f64>() / 9.0;
    let Some(lowest) = (1..8).min_by(|&a, &b| curvatures[a].total_cmp(&curvatures[b])) else { return middle };
    let turns_back =
        (0..8).any(|i| curve.jet(at(i)).curvature_vector().dot(curve.jet(at(i + 1)).curvature_vector()) < 0.0);
    if curvatures[lowest] > 0.3 * mean || !turns_back {
        return middle;
    }
    // Golden-section search for the smallest curvature near the lowest sample.
    let (mut low, mut high) = (at(lowest - 1), at(lowest + 1));
    let golden = 0.618_033_988_749_894_8;
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if curve.jet(a).curvature() <= curve.jet(b).curvature() { high = b } else { low = a }
    }
    let found = 0.5 * (low + high);
    // Avoid slivers: with them, the recursion does not terminate.
    let margin = 0.01 * (end - start);
    if found - start > margin && end - found > margin { found } else { middle }
}
