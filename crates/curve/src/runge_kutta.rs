//! Frames by the classical Runge–Kutta method on r′ = −(r · t′) t, kept as a rival for comparison.

use glam::DVec3;

use crate::frame::{FrameError, orthogonal_reference};
use crate::{Curve, Frame};

/// Carries a frame along `curve` from parameter to parameter, one Runge–Kutta step each.
///
/// The steps themselves neither project nor normalize r, as in Wang et al. 2008; the frames returned do. The form
/// (t × t′) × r, equation (6), gives other numbers, since the two agree only as long as r is normal to t.
///
/// # Errors
/// [`FrameError::Reference`] where `reference` is along the first tangent.
pub fn runge_kutta_frames(curve: &impl Curve, parameters: &[f64], reference: DVec3) -> Result<Vec<Frame>, FrameError> {
    let rate = |parameter: f64, r: DVec3| {
        let jet = curve.jet(parameter);
        -jet.tangent() * r.dot(jet.tangent_derivative())
    };
    let Some(&first) = parameters.first() else { return Ok(Vec::new()) };
    let mut r = orthogonal_reference(reference, curve.jet(first).tangent())?;
    let mut frames = vec![Frame::new(r, curve.jet(first).tangent())];
    for pair in parameters.windows(2) {
        let (start, end) = (pair[0], pair[1]);
        let (step, middle) = (end - start, 0.5 * (start + end));
        let k1 = rate(start, r);
        let k2 = rate(middle, r + k1 * (0.5 * step));
        let k3 = rate(middle, r + k2 * (0.5 * step));
        let k4 = rate(end, r + k3 * step);
        r += (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (step / 6.0);
        let tangent = curve.jet(end).tangent();
        frames.push(Frame::new(orthogonal_reference(r, tangent)?, tangent));
    }
    Ok(frames)
}
