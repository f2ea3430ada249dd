//! Exact frames of analytic curves, by quadrature relative to a fixed direction.
//!
//! The smallest rotation from a fixed unit vector a to the tangent t moves a frame along the curve.
//! Relative to a rotation-minimizing frame, this frame rotates about the tangent at the rate −a ·
//! (t × t′)/(1 + a · t). The rate is regular at points of zero curvature. It is singular only at t
//! = −a, so a is chosen far from all reversed tangents.

use glam::DVec3;

use crate::frame::{FrameError, orthogonal_reference};
use crate::quadrature::integrate;
use crate::rotation::rotate_minimally;
use crate::{Curve, Frame};

/// Candidates for the fixed vector. Larger: more time, and little gain once the smallest 1 + a · t
/// is near its maximum. Smaller: the rate has steeper peaks, which need more panels.
const DIRECTIONS: usize = 400;
/// Tangents with which each candidate is compared, with the same trade-off.
const TANGENTS: usize = 500;

/// Rotation-minimizing frames of `curve` at ascending `parameters`, accurate to about 1e-13 radians
/// for smooth curves. They serve as the reference for sampled methods.
///
/// # Errors
/// [`FrameError::Reference`] if `reference` is zero, not finite, or parallel to the first tangent.
///
/// # Examples
/// ```
/// use glam::DVec3;
/// use isochore_curve::{TrigonometricCurve, exact_frames};
///
/// // On a helix, the frame lags behind the Frenet frame by the torsion: τ ds = 0.75/1.25² · 1.25 du.
/// let helix = TrigonometricCurve::helix(1.0, 0.75, (0.0, 1.0));
/// let frames = exact_frames(&helix, &[0.0, 1.0], -DVec3::X)?;
/// let normal = DVec3::new(-1f64.cos(), -1f64.sin(), 0.0);
/// assert!((frames[1].angle_to(normal) - 0.6).abs() < 1e-13);
/// # Ok::<(), isochore_curve::FrameError>(())
/// ```
pub fn exact_frames(curve: &impl Curve, parameters: &[f64], reference: DVec3) -> Result<Vec<Frame>, FrameError> {
    let Some(&first) = parameters.first() else { return Ok(Vec::new()) };
    let fixed = far_from_reversed_tangents(curve);
    let breaks = curve.breaks();
    let mut rate = |parameter: f64| {
        let jet = curve.jet(parameter);
        let tangent = jet.tangent();
        fixed.dot(tangent.cross(jet.tangent_derivative())) / (1.0 + fixed.dot(tangent))
    };
    let start = curve.jet(first).tangent();
    let reference = orthogonal_reference(reference, start)?;
    let at_fixed = rotate_minimally(start, fixed, reference).ok_or(FrameError::Reference)?;
    let mut angle = 0.0;
    let mut previous = first;
    parameters
        .iter()
        .map(|&parameter| {
            let inner = breaks.iter().copied().filter(|&at| at > previous && at < parameter);
            for end in inner.chain(std::iter::once(parameter)).collect::<Vec<_>>() {
                angle += integrate(&mut rate, previous, end, 1.0);
                previous = end;
            }
            let tangent = curve.jet(parameter).tangent();
            let r = rotate_minimally(fixed, tangent, at_fixed).ok_or(FrameError::Reference)?;
            Ok(Frame::new(r, tangent).turned(angle))
        })
        .collect()
}

/// The direction a that maximizes the minimum of 1 + a · t, among evenly distributed candidates.
fn far_from_reversed_tangents(curve: &impl Curve) -> DVec3 {
    let (first, last) = curve.domain();
    let tangents: Vec<DVec3> =
        (0..TANGENTS).map(|i| curve.jet(first + (last - first) * i as f64 / (TANGENTS - 1) as f64).tangent()).collect();
    let mut best = (f64::NEG_INFINITY, DVec3::Z);
    for i in 0..DIRECTIONS {
        // A spiral on the sphere with equal areas between candidates.
        let height = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = libm::sincos(i as f64 * 2.399_963_229_728_653);
        let radius = (1.0 - height * height).sqrt();
        let direction = DVec3::new(radius * cos, radius * sin, height);
        let min = tangents.iter().map(|tangent| direction.dot(*tangent)).fold(f64::INFINITY, f64::min);
        if min > best.0 {
            best = (min, direction);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;
    use crate::{Bezier, TrigonometricCurve};

    #[test]
    fn torus_knot_has_the_known_frames() {
        // Reference values from 40-digit arithmetic. The quadrature is accurate to about 1e-13.
        let frames =
            exact_frames(&TrigonometricCurve::torus_knot(), &[0.0, FRAC_PI_2, PI, 1.5 * PI, TAU], -DVec3::X).unwrap();
        let expected = [
            DVec3::new(0.353_477_886_329_446_45, -0.618_586_301_076_531_3, 0.701_715_306_941_869_4),
            DVec3::new(-0.132_549_095_104_206_05, 0.953_039_884_452_82, 0.272_297_109_843_662_84),
            DVec3::new(-0.249_578_070_751_202_28, -0.436_761_623_814_604, 0.864_262_732_369_583_4),
        ];
        for (frame, r) in frames[1..4].iter().zip(expected) {
            assert!((frame.r - r).length() < 1e-12, "{}, expected {r}", frame.r);
        }
        let closing = frames[4].angle_to(frames[0].r);
        assert!((closing + 2.875_711_997_865_894).abs() < 1e-12, "{closing}");
    }

    #[test]
    fn inflections_do_not_disturb_the_frame() {
        // Zheng 3.4: the torsion at the midpoint is large, but the frame is not affected.
        let frames = exact_frames(&Bezier::s_curve(0.01), &[0.0, 1.0], DVec3::Z).unwrap();
        let exact = DVec3::new(0.0, -0.024_223_287_508_502, 0.999_706_573_121_47);
        assert!((frames[1].r - exact).length() < 1e-13, "{}", frames[1].r);
    }
}
