//! Estimation of chords from tangents, for double reflection without points.
//!
//! Source: Wang et al. 2008, equation (17): ∫ t du over the segment with the Adams–Moulton weights
//! of order four. The paper omits the formulas for the two ends. They use the same quadrature with
//! the stencil shifted inward.

use glam::DVec3;

use crate::Spine;

/// Estimates a vector parallel to the chord of `segment` from the tangents of samples at equal
/// steps of a smooth parameter. Only its direction is meaningful.
pub fn chord_from_tangents(spine: &Spine, segment: usize) -> DVec3 {
    let tangents = spine.tangents();
    let count = tangents.len();
    let (start, end) = (spine.tangent(segment), spine.tangent(segment + 1));
    let last = spine.segments() - 1;
    if spine.is_closed() {
        let (before, after) = (tangents[(segment + count - 1) % count], tangents[(segment + 2) % count]);
        13.0 * (start + end) - (before + after)
    } else if last == 0 {
        start + end
    } else if last == 1 {
        // Three tangents: the weights of order three.
        let (near, far) = if segment == 0 { (start, tangents[2]) } else { (end, tangents[0]) };
        5.0 * near + 8.0 * tangents[1] - far
    } else if segment == 0 {
        9.0 * start + 19.0 * end - 5.0 * tangents[2] + tangents[3]
    } else if segment == last {
        9.0 * end + 19.0 * start - 5.0 * tangents[count - 3] + tangents[count - 4]
    } else {
        13.0 * (start + end) - (tangents[segment - 1] + tangents[segment + 2])
    }
}
