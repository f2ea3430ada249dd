//! Frenet frames, for comparison.

use crate::{Curve, Frame};

/// Error of [`frenet_frames`]: the curve has no Frenet frame at a parameter.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the curve has no Frenet frame at parameter {parameter}: its curvature or speed is zero")]
pub struct FrenetError {
    /// The parameter.
    pub parameter: f64,
}

/// Frenet frames of `curve` at `parameters`: r is the principal normal, s the binormal.
///
/// # Errors
/// [`FrenetError`] with the first parameter at which curvature or speed is zero.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{Bezier, TrigonometricCurve, frenet_frames};
///
/// let helix = TrigonometricCurve::helix(1.0, 0.5, (0.0, 6.0));
/// let frames = frenet_frames(&helix, &[0.0])?;
/// assert!(frames[0].r.distance(-DVec3::X) < 1e-15, "the normal points to the axis");
///
/// let line = Bezier::new(vec![DVec3::ZERO, DVec3::X]);
/// assert_eq!(frenet_frames(&line, &[0.0, 0.5]).unwrap_err().parameter, 0.0);
/// # Ok::<(), isochore_curve::FrenetError>(())
/// ```
pub fn frenet_frames(curve: &impl Curve, parameters: &[f64]) -> Result<Vec<Frame>, FrenetError> {
    parameters
        .iter()
        .map(|&parameter| {
            let jet = curve.jet(parameter);
            let normal = jet.normal().ok_or(FrenetError { parameter })?;
            let tangent = jet.tangent();
            // Rounding of the cross products leaves a small component along the tangent.
            Ok(Frame::new(normal.reject_from_normalized(tangent).normalize(), tangent))
        })
        .collect()
}
