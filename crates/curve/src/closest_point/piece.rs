//! Pieces of a curve with bounds that exclude them from a query.

use glam::DVec3;

use crate::Curve;
use crate::quadrature::gauss;

/// Largest turning of the tangent within one piece of a [`ClosestPoint`](super::ClosestPoint), radians. Larger: more
/// pieces fail the monotonicity test and are split again at every query. Smaller: more spheres to
/// test.
const PIECE_TURNING: f64 = 0.3;

/// Largest number of halvings of a smooth piece whose turning is too large. Reached only near
/// cusps. Larger: more pieces at cusps. Smaller: loose bounds at cusps.
const PIECE_DEPTH: u32 = 12;

/// A part of the curve, with bounds of its points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Parameter at the start.
    pub(super) start: f64,
    /// Parameter at the end.
    pub(super) end: f64,
    /// Position at the midpoint of the parameter interval.
    pub(super) center: DVec3,
    /// Largest arc length from the center to an end. No point of the piece is farther from the
    /// center.
    pub(super) radius: f64,
    /// Position at the start, and the vector from the start to the end.
    pub(super) chord: [DVec3; 2],
    /// Upper bound of the distance of the piece from its chord: length · turning / 4. The triangle
    /// of the chord and the farthest point turns at most as much as the piece itself.
    pub(super) height: f64,
    /// If all points of the piece are nearer to the query than this, the piece has at most one
    /// minimum.
    pub(super) calm_distance: f64,
    /// Whether it begins at the first end of an open curve.
    pub(super) is_first: bool,
    /// Whether it ends at the last end of an open curve.
    pub(super) is_last: bool,
    /// Parameter at which the slope at the end is evaluated. For the last piece of a closed curve,
    /// it is the start of the domain. Both pieces at the seam then use the same sign, so rounding
    /// cannot lose a minimum between them.
    pub(super) end_of_slope: f64,
}

impl Piece {
    /// Distance from `query` to the chord, and an estimate of the nearest parameter: that of the
    /// nearest fraction of the chord.
    pub(super) fn chord_distance(&self, query: DVec3) -> (f64, f64) {
        let [start, chord] = self.chord;
        let offset = query - start;
        let squared = chord.length_squared();
        let fraction = if squared > 0.0 { (offset.dot(chord) / squared).clamp(0.0, 1.0) } else { 0.5 };
        ((offset - chord * fraction).length(), self.start + (self.end - self.start) * fraction)
    }
}

/// Splits `curve` at its breaks, and further until each piece turns by at most [`PIECE_TURNING`].
pub(super) fn split(curve: &impl Curve) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for pair in curve.breaks().windows(2) {
        cut(curve, pair[0], pair[1], PIECE_DEPTH, &mut pieces);
    }
    let last = pieces.len() - 1;
    pieces[0].is_first = !curve.is_closed();
    pieces[last].is_last = !curve.is_closed();
    if curve.is_closed() {
        pieces[last].end_of_slope = pieces[0].start;
    }
    pieces
}

/// Halves [start, end] until its turning is at most [`PIECE_TURNING`], and appends the parts to
/// `pieces`.
fn cut(curve: &impl Curve, start: f64, end: f64, depth: u32, pieces: &mut Vec<Piece>) {
    let middle = 0.5 * (start + end);
    // Integrate the turning: differences of sampled tangents would miss full turns.
    let turning = gauss(&mut |u| curve.jet(u).tangent_derivative().length(), start, end);
    if turning > PIECE_TURNING && depth > 0 {
        cut(curve, start, middle, depth - 1, pieces);
        cut(curve, middle, end, depth - 1, pieces);
        return;
    }
    let speed = &mut |u| curve.jet(u).speed();
    // The margins cover rounding and the quadrature error, which is small because the turning is.
    let (left, right) = (gauss(speed, start, middle), gauss(speed, middle, end));
    let radius = left.max(right) * (1.0 + 1e-6);
    let height = (0.25 * turning * (1.0 + 1e-3) * (left + right)).min(2.0 * radius);
    // Queries nearer than the center of curvature have no second minimum. The factor allows for the
    // error of the sampled curvature.
    let samples = [0.0, 0.25, 0.5, 0.75, 1.0].map(|fraction| curve.jet(start + (end - start) * fraction));
    let curvature = samples.iter().map(|jet| jet.curvature()).fold(0.0, f64::max);
    let (first, last) = (curve.position(start), curve.position(end));
    pieces.push(Piece {
        start,
        end,
        center: curve.position(middle),
        radius,
        chord: [first, last - first],
        height,
        calm_distance: 0.7 / curvature,
        is_first: false,
        is_last: false,
        end_of_slope: end,
    });
}
