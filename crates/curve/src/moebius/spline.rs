//! Splines of [`MoebiusSegment`]s.

use glam::DVec3;

use super::{MoebiusSegment, Tilt};
use crate::curve::{jet_of_segments, joints};
use crate::{Curve, CurveJet, Frame, FrameError, HermiteError, Spine, uniform_parameters};

/// A spline of rational curves of degree six, with a continuous tangent and a continuous rational
/// rotation-minimizing frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MoebiusSpline {
    segments: Vec<MoebiusSegment>,
    closed: bool,
}

impl MoebiusSpline {
    /// Interpolates points and tangents of `curve` at `segments` equal steps of its parameter.
    ///
    /// Position and frame are of third order between the joints and of fourth order at the joints.
    /// With [`Tilt::WhenNeeded`], the position is of fourth order everywhere.
    ///
    /// # Errors
    /// [`HermiteError`] with the first segment that has no solution.
    pub fn interpolate(curve: &impl Curve, segments: usize, tilt: Tilt) -> Result<Self, HermiteError> {
        let jets: Vec<CurveJet> = uniform_parameters(curve, segments).iter().map(|&u| curve.jet(u)).collect();
        let segments = jets
            .windows(2)
            .enumerate()
            .map(|(segment, pair)| {
                MoebiusSegment::hermite(pair[0].position, pair[1].position, pair[0].first, pair[1].first, tilt)
                    .map_err(|reason| HermiteError { segment, reason })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { segments, closed: curve.is_closed() })
    }

    /// Interpolates the points and tangents of `spine`.
    ///
    /// # Errors
    /// [`HermiteError`] with the first segment that has no solution.
    pub fn through(spine: &Spine, tilt: Tilt) -> Result<Self, HermiteError> {
        let segments = (0..spine.segments())
            .map(|i| {
                MoebiusSegment::hermite(
                    spine.point(i),
                    spine.point(i + 1),
                    spine.tangent(i),
                    spine.tangent(i + 1),
                    tilt,
                )
                .map_err(|reason| HermiteError { segment: i, reason })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { segments, closed: spine.is_closed() })
    }

    /// The segments in order.
    pub fn segments(&self) -> &[MoebiusSegment] {
        &self.segments
    }

    /// Points with rotation-minimizing frames, at `samples` equal parameter steps per segment, ends
    /// included.
    ///
    /// # Errors
    /// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first
    /// tangent.
    ///
    /// # Panics
    /// If `samples` is zero.
    pub fn frames(&self, reference: DVec3, samples: usize) -> Result<Vec<(DVec3, Frame)>, FrameError> {
        assert!(samples > 0, "at least one sample per segment");
        let parameters: Vec<f64> = (0..=samples).map(|i| i as f64 / samples as f64).collect();
        let mut r = reference;
        let mut all: Vec<(DVec3, Frame)> = Vec::with_capacity(self.segments.len() * samples + 1);
        for segment in &self.segments {
            let frames = segment.frames(&parameters, r)?;
            // The last frame of a segment equals the first of the next.
            all.pop();
            all.extend(parameters.iter().zip(&frames).map(|(&u, &frame)| (segment.position(u), frame)));
            r = frames[samples].r;
        }
        Ok(all)
    }
}

/// The parameter is the segment number plus the parameter within the segment.
impl Curve for MoebiusSpline {
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
