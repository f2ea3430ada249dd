//! Frames by the classical Runge–Kutta method applied to r′ = −(r · t′) t, for comparison.

use glam::DVec3;

use crate::frame::{FrameError, orthogonal_reference};
use crate::{Curve, Frame};

/// Computes frames along `curve` at the given parameters, with one Runge–Kutta step between
/// neighbors.
///
/// As in Wang et al. 2008, the integrated r is neither projected nor normalized. The returned
/// frames are orthonormal. The form (t × t′) × r of equation (6) gives different numbers, because
/// the two forms agree only while r is normal to t.
///
/// # Errors
/// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first tangent.
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
