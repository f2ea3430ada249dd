//! The path of the tool since the base, through which any point of the base is advected.

use std::ops::Range;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::Aabb;
use rayon::prelude::*;

/// Points that one task advects through the path. Larger leaves threads idle; smaller spends time on
/// scheduling.
const CHUNK: usize = 128;

/// The move between two poses.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) stroke: field::Stroke,
    /// Box that contains the support during the move.
    pub(super) reach: Aabb,
    /// Boxes of a smaller half-diagonal are not tested one by one, model units.
    finest: f64,
}

/// Half-diagonal of the smallest boxes of the index that are tested, as a fraction of the size of
/// the reach. Larger selects points that the flow leaves at rest; smaller spends more time on tests
/// than that takes.
const FINEST: f64 = 1.0 / 64.0;

/// Factor by which the ball around a box grows to contain the balls around all boxes inside. For a
/// box of sides b in one of sides a, whose centers differ by (a − b)/2 at most, |a − b| + |b| ≤ √2
/// |a|; the rest is for rounding.
const NESTING: f64 = 1.415;

impl Segment {
    pub(super) fn new(stroke: field::Stroke) -> Self {
        let reach = stroke.reach();
        Self { reach, finest: FINEST * reach.size().max_element(), stroke }
    }

    /// Whether the support may touch anything in these bounds. False is certain.
    pub(super) fn may_touch(&self, bounds: Aabb) -> bool {
        self.reach.overlaps(bounds) && self.stroke.may_touch(bounds.center(), 0.5 * bounds.size().length())
    }

    /// Whether any box within these bounds may pass [`may_touch`](Self::may_touch). False is
    /// certain.
    pub(super) fn may_touch_within(&self, bounds: Aabb) -> bool {
        let radius = 0.5 * NESTING * bounds.size().length();
        self.reach.overlaps(bounds) && (radius < self.finest || self.stroke.may_touch(bounds.center(), radius))
    }

    /// Advects those of `points` that are in reach. Returns the number of field evaluations.
    pub(super) fn advect(&self, points: &mut [DVec3]) -> u64 {
        let within: Vec<usize> = (0..points.len()).filter(|&index| self.reach.distance(points[index]) == 0.0).collect();
        if within.is_empty() {
            return 0;
        }
        let mut images: Vec<DVec3> = within.iter().map(|&index| points[index]).collect();
        let evaluations = self.stroke.advect(&mut images);
        within.into_iter().zip(images).for_each(|(index, image)| points[index] = image);
        evaluations
    }
}

/// Consecutive moves.
#[derive(Debug, Clone, Default)]
pub(super) struct Path {
    pub(super) segments: Vec<Segment>,
}

impl Path {
    /// Number of moves.
    pub(super) fn len(&self) -> usize {
        self.segments.len()
    }

    /// Advects points through some of the moves.
    pub(super) fn advect_range(&self, points: &mut [DVec3], moves: Range<usize>) {
        let segments = &self.segments[moves];
        let advect = |chunk: &mut [DVec3]| segments.iter().for_each(|segment| _ = segment.advect(chunk));
        points.par_chunks_mut(CHUNK).for_each(advect);
    }

    /// Advects points, each of which has already passed a number of moves, through the remaining
    /// moves. These numbers must be in ascending order. Returns the number of field evaluations.
    pub(super) fn advect_rest(&self, points: &mut [DVec3], passed: &[u32]) -> u64 {
        let advect = |(points, passed): (&mut [DVec3], &[u32])| {
            let first = passed[0] as usize;
            let segments = self.segments.iter().enumerate().skip(first);
            segments
                .map(|(index, segment)| {
                    let count = passed.partition_point(|&passed| passed as usize <= index);
                    segment.advect(&mut points[..count])
                })
                .sum::<u64>()
        };
        points.par_chunks_mut(CHUNK).zip(passed.par_chunks(CHUNK)).map(advect).sum()
    }
}
