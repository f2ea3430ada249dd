//! The stroke under way: its poses so far, the path of any point through it, and the sums for its
//! receipt.

use std::sync::Arc;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, CompensatedSum};
use rayon::prelude::*;

use super::{InteractiveRefinement, SessionTool, StrokeReceipt, marks::Marks};
use crate::recipe::Key;

/// Points that one task advects through all moves of the stroke. Larger leaves threads idle;
/// smaller spends time on scheduling.
const CHUNK: usize = 128;

/// A stroke that has begun and not ended.
#[derive(Debug, Clone)]
pub(super) struct ActiveStroke {
    pub(super) tool: Arc<SessionTool>,
    pub(super) refine: Option<InteractiveRefinement>,
    /// Poses so far, as recorded in the log.
    pub(super) keys: Vec<Key>,
    pub(super) times: Vec<f64>,
    /// The last pose.
    pub(super) pose: Option<field::Pose>,
    /// Moves between consecutive poses.
    pub(super) path: Vec<Segment>,
    /// Number of triangles at the beginning of the stroke.
    pub(super) alive: usize,
    /// Triangles with a vertex that moved.
    pub(super) moved: Vec<u32>,
    pub(super) moved_marks: Marks,
    /// Volume added by splits.
    pub(super) splits: CompensatedSum,
    /// Volume added by collapses and flips.
    pub(super) remeshing: CompensatedSum,
    /// Sum of the absolute values in `remeshing`, for the bound on rounding.
    pub(super) remeshed: f64,
    pub(super) receipt: StrokeReceipt,
}

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
    fn advect(&self, points: &mut [DVec3]) -> u64 {
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

impl ActiveStroke {
    pub(super) fn new(tool: Arc<SessionTool>, refine: Option<InteractiveRefinement>, alive: usize) -> Self {
        Self {
            tool,
            refine,
            keys: Vec::new(),
            times: Vec::new(),
            pose: None,
            path: Vec::new(),
            alive,
            moved: Vec::new(),
            moved_marks: Marks::default(),
            splits: CompensatedSum::default(),
            remeshing: CompensatedSum::default(),
            remeshed: 0.0,
            receipt: StrokeReceipt::default(),
        }
    }

    /// Advects points of the surface at the beginning of the stroke through all moves so far.
    /// Returns the number of field evaluations.
    pub(super) fn advect(&self, points: &mut [DVec3]) -> u64 {
        let advect = |chunk: &mut [DVec3]| self.path.iter().map(|segment| segment.advect(chunk)).sum::<u64>();
        points.par_chunks_mut(CHUNK).map(advect).sum()
    }

    /// Notes triangles with a vertex that moved; `count` is the number of all triangles.
    pub(super) fn note_moved(&mut self, triangles: &[u32], count: usize) {
        self.moved_marks.resize(count);
        self.moved.extend(triangles.iter().filter(|&&triangle| self.moved_marks.insert(triangle)));
    }
}
