//! The stroke under way: its poses so far and the sums for its receipt.

use std::sync::Arc;

use isochore_field as field;
use isochore_mesh::CompensatedSum;

use super::{
    InteractiveRefinement, MovedVolume, SessionTool, Sheets, StrokeReceipt,
    marks::Touched,
    path::Path,
    refinement::{Midpoints, Splits},
    surface::Surface,
};
use crate::recipe::Key;

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
    /// Number of triangles at the beginning of the stroke.
    pub(super) alive: usize,
    /// Triangles that were moved or split.
    pub(super) touched: Touched,
    pub(super) phase: Phase,
    /// Volume moved before the base was made.
    pub(super) moved_before: MovedVolume,
    /// The moment at which the stroke was ended. Later poses are ignored.
    pub(super) stopped: Option<Stopped>,
    /// Number of triangles that splits have added because of crossings.
    pub(super) untangling: usize,
    /// Whether new crossings remain.
    pub(super) has_crossings: bool,
    /// Volume added by splits.
    pub(super) splits: CompensatedSum,
    /// Volume added by collapses and flips.
    pub(super) remeshing: CompensatedSum,
    /// Sum of the absolute values in `remeshing`, for the bound on rounding.
    pub(super) remeshed: f64,
    pub(super) receipt: StrokeReceipt,
}

/// The part of a stroke since the base was made.
#[derive(Debug, Clone, Default)]
pub(super) struct Phase {
    /// Moves between consecutive poses.
    pub(super) path: Path,
    pub(super) midpoints: Midpoints,
    /// Triangles that were moved or split.
    pub(super) triangles: Touched,
    /// Vertices that were moved or inserted.
    pub(super) vertices: Touched,
    /// Number of inserted vertices.
    pub(super) inserted: usize,
}

/// The end of a stroke before its last pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stopped {
    /// Number of moves before the end, the last one in part.
    pub(super) moves: f64,
    /// Number of moves that the host has asked for.
    pub(super) asked: usize,
    pub(super) sheets: Option<Sheets>,
}

impl ActiveStroke {
    pub(super) fn new(tool: Arc<SessionTool>, refine: Option<InteractiveRefinement>, alive: usize) -> Self {
        Self {
            tool,
            refine,
            keys: Vec::new(),
            times: Vec::new(),
            pose: None,
            alive,
            touched: Touched::default(),
            phase: Phase::default(),
            moved_before: MovedVolume::default(),
            stopped: None,
            untangling: 0,
            has_crossings: false,
            splits: CompensatedSum::default(),
            remeshing: CompensatedSum::default(),
            remeshed: 0.0,
            receipt: StrokeReceipt::default(),
        }
    }

    /// The poses before and after a move of the path.
    pub(super) fn poses_of(&self, index: usize) -> [field::Pose; 2] {
        let first = self.first_key() + index;
        // Recorded keys are valid.
        [first, first + 1].map(|key| self.keys[key].pose().unwrap_or(field::Pose::IDENTITY))
    }

    /// Index of the key at the beginning of the path.
    fn first_key(&self) -> usize {
        self.keys.len() - 1 - self.phase.path.len()
    }

    /// Ends the stroke after some `whole` moves of the path, or at `key` in the next move. `path` is
    /// the path up to there, and `fraction` is the fraction of the old path before the end.
    pub(super) fn stop(&mut self, key: Option<Key>, path: Path, fraction: f64, sheets: Option<Sheets>) {
        let (first, asked) = (self.first_key(), self.keys.len() - 1);
        let moves = fraction * self.phase.path.len() as f64;
        let last = first + moves as usize;
        self.stopped = Some(Stopped { moves: first as f64 + moves, asked, sheets });
        self.keys.truncate(last + 1);
        if let Some(key) = key {
            let [before, after] = [self.times[last], self.times[last + 1]];
            self.keys.push(key);
            self.times[last + 1] = before + moves.fract() * (after - before);
        }
        self.times.truncate(self.keys.len());
        self.receipt.moves = self.keys.len() - 1;
        self.phase.path = path;
        self.phase.midpoints.clear();
    }

    /// Makes the surface the base of the rest of the stroke, which has moved the volume `moved` so far.
    pub(super) fn rebase(&mut self, surface: &mut Surface, moved: MovedVolume) {
        self.moved_before = moved;
        for &vertex in self.phase.vertices.items() {
            surface.bases.rebase(vertex, surface.position(vertex));
        }
        let Phase { path, midpoints, triangles, vertices, inserted } = &mut self.phase;
        path.segments.clear();
        midpoints.clear();
        triangles.clear();
        vertices.clear();
        *inserted = 0;
    }

    /// Fraction of the stroke at which it was ended. `None` if it was not.
    pub(super) fn stopped_at(&self) -> Option<f64> {
        self.stopped.map(|stopped| stopped.moves / stopped.asked as f64)
    }

    /// Notes splits and the triangles `changed` that were moved or split.
    pub(super) fn note(&mut self, surface: &Surface, changed: &[u32], splits: &Splits) {
        let triangles = surface.corners.items().len();
        self.touched.extend(changed, triangles);
        self.phase.triangles.extend(changed, triangles);
        self.phase.vertices.extend(&splits.inserted, surface.positions.items().len());
        self.phase.inserted += splits.inserted.len();
        splits.volumes.iter().for_each(|&volume| self.splits.add(volume));
    }
}
