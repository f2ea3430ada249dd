//! Splines of [`MoebiusSegment`]s.

use glam::DVec3;

use super::{MoebiusSegment, Tilt};
use crate::curve::{jet_of_segments, joints};
use crate::{Curve, CurveJet, Frame, FrameError, HermiteError, Spine, uniform_parameters};

/// Rational curves of degree six with continuous tangent and a continuous rational rotation-minimizing frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MoebiusSpline {
    segments: Vec<MoebiusSegment>,
    closed: bool,
}

impl MoebiusSpline {
    /// Interpolates points and tangents of `curve` at `segments` equal steps of its parameter: third order in position
    /// and frame between the joints, fourth at the joints; with [`Tilt::WhenNeeded`] fourth order in position
    /// throughout.
    ///
    /// # Errors
    /// The first segment without a solution.
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

    /// Passes through the points of `spine` with its tangents.
    ///
    /// # Errors
    /// The first segment without a solution.
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

    /// Points and rotation-minimizing frames at `samples` equal parameter steps in each segment, and at the end.
    ///
    /// # Errors
    /// [`FrameError::Reference`] where `reference` is along the first tangent.
    ///
    /// # Panics
    /// If `samples` is zero.
    pub fn frames(&self, reference: DVec3, samples: usize) -> Result<Vec<(DVec3, Frame)>, FrameError> {
        assert!(samples > 0, "at least one sample a segment");
        let parameters: Vec<f64> = (0..=samples).map(|i| i as f64 / samples as f64).collect();
        let mut r = reference;
        let mut all: Vec<(DVec3, Frame)> = Vec::with_capacity(self.segments.len() * samples + 1);
        for segment in &self.segments {
            let frames = segment.frames(&parameters, r)?;
            // The last frame of a segment is the first of the next.
            all.pop();
            all.extend(parameters.iter().zip(&frames).map(|(&u, &frame)| (segment.position(u), frame)));
            r = frames[samples].r;
        }
        Ok(all)
    }
}

/// Segment number plus the parameter inside the segment.
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
