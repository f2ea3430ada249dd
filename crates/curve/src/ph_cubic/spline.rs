//! Splines of Pythagorean-hodograph cubics that follow a curve to a tolerance.

use super::{HermiteError, PhCubic, PhCubicError};
use crate::curve::{jet_of_segments, joints};
use crate::quadrature::gauss;
use crate::{Curve, CurveJet, Frame, FrameError, Spine, orthogonal_reference};

/// Halvings of a smooth piece of the curve at most. More only help tolerances near rounding.
const DEPTH: u32 = 24;

/// Points of a cubic compared with the curve. Fewer can miss a bulge: the error has at most three between the ends.
const CHECKS: usize = 9;

/// Turning of the curve over one segment, radians, at most. Larger: few points compare long arcs, and a short cut
/// between two branches of a knot passes. Smaller: more segments than a loose tolerance needs.
const LARGEST_TURNING: f64 = 1.2;

/// Newton steps that bring a point of the curve opposite to a point of the cubic; the first guess is off by third
/// order.
const NEWTON_STEPS: usize = 8;

/// A curve of [`PhCubic`] segments with continuous tangent.
#[derive(Debug, Clone, PartialEq)]
pub struct PhSpline {
    segments: Vec<PhCubic>,
    /// Parameters of the original curve at the joints.
    parameters: Vec<f64>,
    /// Largest distance found between the two curves.
    error: f64,
    closed: bool,
}

/// Why a curve has no spline of Pythagorean-hodograph cubics.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PhSplineError {
    /// The tolerance is not a positive number.
    #[error("the tolerance {tolerance} is not a positive number")]
    Tolerance {
        /// The tolerance given.
        tolerance: f64,
    },
    /// A segment has no cubic however short.
    #[error("near parameter {parameter} no segment is short enough: {reason}")]
    Segment {
        /// Parameter of the original curve.
        parameter: f64,
        /// Why the last and shortest segment failed.
        reason: PhCubicError,
    },
    /// The tolerance is not reached however short the segments.
    #[error("near parameter {parameter} the distance is still {error}")]
    Accuracy {
        /// Parameter of the original curve.
        parameter: f64,
        /// Distance reached.
        error: f64,
    },
}

impl PhSpline {
    /// Follows `curve` within `tolerance` model units, by halving its parameter intervals until each has a cubic close
    /// enough. Intervals are cut where the curvature vanishes, since the cubics have no inflection.
    ///
    /// # Errors
    /// A bad tolerance, and places that defeat every length of segment, as cusps do.
    pub fn follow(curve: &impl Curve, tolerance: f64) -> Result<Self, PhSplineError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(PhSplineError::Tolerance { tolerance });
        }
        let breaks = curve.breaks();
        let mut spline =
            Self { segments: Vec::new(), parameters: vec![breaks[0]], error: 0.0, closed: curve.is_closed() };
        for pair in breaks.windows(2) {
            // Two parts at least, so that a closed curve is not one segment from a point to itself.
            let middle = 0.5 * (pair[0] + pair[1]);
            spline.extend(curve, pair[0], middle, tolerance, DEPTH)?;
            spline.extend(curve, middle, pair[1], tolerance, DEPTH)?;
        }
        Ok(spline)
    }

    /// Interpolates `curve` at `segments` equal steps of its parameter.
    ///
    /// # Errors
    /// The first segment without a cubic.
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

    /// Passes through the points of `spine` with its tangents; its parameters are the stations, and its error is zero,
    /// since there is nothing between the points to compare with.
    ///
    /// # Errors
    /// The first segment without a cubic.
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

    /// Parameters of the original curve at the joints, one more than segments.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Largest distance from the original curve over the points compared, model units.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Exact arc length, model units.
    pub fn length(&self) -> f64 {
        self.segments.iter().map(PhCubic::length).sum()
    }

    /// Exact rotation-minimizing frames with their points, at `samples` equal parameter steps in each segment, and at
    /// the end.
    ///
    /// # Errors
    /// [`FrameError::Reference`] where `reference` is along the first tangent.
    ///
    /// # Panics
    /// If `samples` is zero.
    pub fn exact_frames(
        &self,
        reference: glam::DVec3,
        samples: usize,
    ) -> Result<Vec<(glam::DVec3, Frame)>, FrameError> {
        assert!(samples > 0, "at least one sample a segment");
        let parameters: Vec<f64> = (0..=samples).map(|i| i as f64 / samples as f64).collect();
        let mut r = reference;
        let mut all = Vec::with_capacity(self.segments.len() * samples + 1);
        for segment in &self.segments {
            let frames = segment.exact_frames(&parameters, r)?;
            // The last frame of a segment is the first of the next.
            all.pop();
            all.extend(parameters.iter().zip(&frames).map(|(&v, &frame)| (segment.position(v), frame)));
            r = frames[samples].r;
        }
        // Tangents of neighbors differ by rounding at the joints; the frames are exactly orthonormal to their own.
        for (_, frame) in &mut all {
            *frame = Frame::new(orthogonal_reference(frame.r, frame.t)?, frame.t);
        }
        Ok(all)
    }
}

/// Segment number plus the parameter inside the segment.
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

/// Largest distance of the cubic from the interval of the curve that it follows, both compared in the cubic's normal
/// planes.
fn deviation(curve: &impl Curve, cubic: &PhCubic, start: f64, end: f64) -> f64 {
    let whole = cubic.length();
    (1..=CHECKS)
        .map(|i| {
            let v = i as f64 / (CHECKS + 1) as f64;
            let jet = cubic.jet(v);
            // Start at the same share of the length, then into the normal plane.
            let share = gauss(&mut |x| cubic.speed(x), 0.0, v) / whole;
            let mut parameter = start + (end - start) * share;
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

/// Where to cut an interval: at a nearly vanishing curvature inside it, else in the middle.
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
    // Golden-section search for the least curvature next to the lowest sample.
    let (mut low, mut high) = (at(lowest - 1), at(lowest + 1));
    let golden = 0.618_033_988_749_894_8;
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if curve.jet(a).curvature() <= curve.jet(b).curvature() { high = b } else { low = a }
    }
    let found = 0.5 * (low + high);
    // Never a sliver, which would not end the recursion.
    let margin = 0.01 * (end - start);
    if found - start > margin && end - found > margin { found } else { middle }
}
