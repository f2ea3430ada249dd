//! Frenet frames, kept as a rival for comparison.

use crate::{Curve, Frame};

/// A parameter at which a curve has no Frenet frame.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the curve has no Frenet frame at parameter {parameter}: its curvature or speed vanishes there")]
pub struct FrenetError {
    /// The parameter.
    pub parameter: f64,
}

/// Frenet frames of `curve` at `parameters`: r is the principal normal, s the binormal.
///
/// # Errors
/// Where curvature or speed vanishes.
pub fn frenet_frames(curve: &impl Curve, parameters: &[f64]) -> Result<Vec<Frame>, FrenetError> {
    parameters
        .iter()
        .map(|&parameter| {
            let jet = curve.jet(parameter);
            let normal = jet.normal().ok_or(FrenetError { parameter })?;
            let tangent = jet.tangent();
            // Rounding of the cross products left a little of the tangent in the normal.
            Ok(Frame::new(normal.reject_from_normalized(tangent).normalize(), tangent))
        })
        .collect()
}
