//! The stroke under way: what it was made of, and the way of any point through it so far.

use std::sync::Arc;

use glam::DVec3;
use isochore_field as field;
use isochore_mesh::{Aabb, CompensatedSum};
use rayon::prelude::*;

use super::{InteractiveRefinement, MoveReceipt, SessionTool, StrokeReceipt, marks::Marks};
use crate::recipe::Key;

/// Points that one task carries through all that a stroke did so far.
const CHUNK: usize = 128;

/// A stroke that has begun and not ended.
#[derive(Debug, Clone)]
pub(super) struct ActiveStroke {
    pub(super) tool: Arc<SessionTool>,
    pub(super) refine: Option<InteractiveRefinement>,
    /// Poses so far, as the log writes them, and the last as it is worked with.
    pub(super) keys: Vec<Key>,
    pub(super) times: Vec<f64>,
    pub(super) pose: Option<field::Pose>,
    pub(super) way: Vec<Segment>,
    /// Triangles there when it began.
    pub(super) alive: usize,
    /// Triangles with a vertex that moved.
    pub(super) moved: Vec<u32>,
    pub(super) moved_marks: Marks,
    pub(super) splits: CompensatedSum,
    pub(super) remeshing: CompensatedSum,
    /// Size of all that was summed up, for the bound on rounding.
    pub(super) remeshed: f64,
    pub(super) receipt: StrokeReceipt,
}

/// The way between two poses.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) stroke: field::Stroke,
    pub(super) reach: Aabb,
    /// Boxes of a shorter half-diagonal are not asked about one by one, model units.
    finest: f64,
}

/// Half-diagonal of the finest boxes of the index that are asked about, as a share of the size of the reach. Larger lets points pass
/// that the flow finds at rest; smaller asks more often than that takes.
const FINEST: f64 = 1.0 / 64.0;

/// What a ball around a box is widened by so that it holds the balls around all boxes within. For a box of sides b in one of sides
/// a, whose centers differ by (a − b)/2 at most, |a − b| + |b| ≤ √2 |a|; the rest is for rounding.
const NESTING: f64 = 1.415;

impl Segment {
    pub(super) fn new(stroke: field::Stroke) -> Self {
        let reach = stroke.reach();
        Self { reach, finest: FINEST * reach.size().max_element(), stroke }
    }

    /// Whether the support may touch what has these bounds; false is certain.
    pub(super) fn may_touch(&self, bounds: Aabb) -> bool {
        self.reach.overlaps(bounds) && self.stroke.may_touch(bounds.center(), 0.5 * bounds.size().length())
    }

    /// Whether it [may touch](Self::may_touch) anything within these bounds; false is certain.
    pub(super) fn may_touch_within(&self, bounds: Aabb) -> bool {
        let radius = 0.5 * NESTING * bounds.size().length();
        self.reach.overlaps(bounds) && (radius < self.finest || self.stroke.may_touch(bounds.center(), radius))
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
            way: Vec::new(),
            alive,
            moved: Vec::new(),
            moved_marks: Marks::default(),
            splits: CompensatedSum::default(),
            remeshing: CompensatedSum::default(),
            remeshed: 0.0,
            receipt: StrokeReceipt::default(),
        }
    }

    /// Carries points of that surface through all that the stroke did so far. Returns how many times the fields were evaluated.
    pub(super) fn advect(&self, points: &mut [DVec3]) -> u64 {
        let carry = |chunk: &mut [DVec3]| {
            let (mut within, mut carried) = (Vec::new(), Vec::new());
            let mut evaluations = 0;
            for segment in &self.way {
                within.clear();
                within.extend((0..chunk.len()).filter(|&index| segment.reach.distance(chunk[index]) == 0.0));
                if within.is_empty() {
                    continue;
                }
                carried.clear();
                carried.extend(within.iter().map(|&index| chunk[index]));
                evaluations += segment.stroke.advect(&mut carried);
                within.iter().zip(&carried).for_each(|(&index, &point)| chunk[index] = point);
            }
            evaluations
        };
        points.par_chunks_mut(CHUNK).map(carry).sum()
    }

    /// Notes triangles that have a vertex that moved.
    pub(super) fn note_moved(&mut self, triangles: &[u32], count: usize) {
        self.moved_marks.resize(count);
        self.moved.extend(triangles.iter().filter(|&&triangle| self.moved_marks.insert(triangle)));
    }

    /// Takes what a move did into the receipt of the stroke.
    pub(super) fn note_edits(&mut self, done: &MoveReceipt) {
        let receipt = &mut self.receipt;
        receipt.inserted_vertices += done.inserted_vertices;
        receipt.removed_vertices += done.removed_vertices;
        receipt.flipped_edges += done.flipped_edges;
        receipt.is_limited |= done.is_limited;
        receipt.refused_splits = receipt.refused_splits.max(done.refused_splits);
        receipt.evaluations += done.evaluations;
        let (sum, now) = (&mut receipt.seconds, &done.seconds);
        sum.select += now.select;
        sum.flow += now.flow;
        sum.refine += now.refine;
        sum.index += now.index;
        sum.buffers += now.buffers;
    }
}
