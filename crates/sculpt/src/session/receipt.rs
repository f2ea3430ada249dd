//! Receipts of moves and strokes, and the state of undo and redo.

use std::fmt;

use super::Sheets;

/// Result of one [`move_to`](super::Session::move_to).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MoveReceipt {
    /// Vertices that moved.
    pub moved_vertices: usize,
    /// Vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Whether the limit on triangles kept edges from being split.
    pub is_limited: bool,
    /// Edges that remain too long or too coarse because the stroke has distorted the surface too
    /// much for a split to help.
    pub refused_splits: usize,
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Whether the stroke has been ended, because the surface would cross itself farther on. This
    /// and later moves of the stroke end at the same moment.
    pub is_stopped: bool,
    /// Wall time by stage.
    pub seconds: MoveSeconds,
}

/// Wall time of the stages of a move, in seconds; zero on platforms without a clock.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MoveSeconds {
    /// Selecting what the tool may touch.
    pub select: f64,
    /// Advecting vertices along the flow.
    pub flow: f64,
    /// Splits.
    pub refine: f64,
    /// Updating the index over the triangles.
    pub index: f64,
    /// Updating normals and the other buffers.
    pub buffers: f64,
    /// Finding and removing crossings.
    pub certificate: f64,
}

impl MoveSeconds {
    /// Sum of all stages.
    pub fn total(&self) -> f64 {
        self.select + self.flow + self.refine + self.index + self.buffers + self.certificate
    }
}

/// Result of one stroke.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeReceipt {
    /// Number of moves. The first pose does not count.
    pub moves: usize,
    /// Time from the first to the last pose by the host's clock, seconds.
    pub duration: f64,
    /// Existing vertices that the stroke moved or removed.
    pub touched_vertices: usize,
    /// Vertices that splits inserted, including those that were removed again.
    pub inserted_vertices: usize,
    /// Vertices that collapses removed.
    pub removed_vertices: usize,
    /// Edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the limit on triangles kept edges from being split.
    pub is_limited: bool,
    /// Maximum over all moves of [`MoveReceipt::refused_splits`].
    pub refused_splits: usize,
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Change of the volume. `None` if the surface is open.
    pub volume: Option<StrokeVolume>,
    /// Longest displacement by the lock of this stroke, model units. `None` if the lock was
    /// skipped.
    pub lock_max_shift: Option<f64>,
    /// Reason why the lock was skipped. `None` if it acted.
    pub lock_skipped: Option<LockSkipped>,
    /// Fraction of the stroke, from 0 to 1, at which it was ended because the surface would have
    /// crossed itself. `None` if the whole stroke was made. The log contains the shortened stroke. A
    /// stroke that was ended at 0 leaves no trace.
    pub stopped_at: Option<f64>,
    /// The two sheets that would have crossed, at the moment when the stroke was ended. `None` if it
    /// was not ended, or if the surface would have folded over.
    pub sheets: Option<Sheets>,
    /// Number of pairs of triangles that the stroke made cross and that did not cross in the mesh as
    /// opened. Zero, unless this stroke, or an earlier one, kept all triangles.
    pub crossings: usize,
    /// Wall time of all moves by stage.
    pub seconds: MoveSeconds,
    /// Wall time of finding and removing crossings, during moves and at the end of the stroke,
    /// seconds.
    pub certificate_seconds: f64,
    /// Bytes that undo holds for this stroke, including those that redo will need.
    pub undo_bytes: usize,
    /// Number of oldest strokes that undo has forgotten to stay within its memory.
    pub forgotten_strokes: usize,
}

impl StrokeReceipt {
    /// Adds the result of a move, except the number of moves.
    pub(super) fn add(&mut self, receipt: &MoveReceipt) {
        self.inserted_vertices += receipt.inserted_vertices;
        self.is_limited |= receipt.is_limited;
        self.refused_splits = self.refused_splits.max(receipt.refused_splits);
        self.evaluations += receipt.evaluations;
        self.seconds.select += receipt.seconds.select;
        self.seconds.flow += receipt.seconds.flow;
        self.seconds.refine += receipt.seconds.refine;
        self.seconds.index += receipt.seconds.index;
        self.seconds.buffers += receipt.seconds.buffers;
        self.seconds.certificate += receipt.seconds.certificate;
    }
}

/// Reasons for a stroke to end without the lock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LockSkipped {
    /// The session has no lock.
    Off,
    /// The surface is open and has no volume.
    NeedsClosed,
    /// The stroke has moved nothing that the volume depends on, or too little to restore the
    /// volume. The lock of the next stroke corrects the remaining difference.
    NoHold,
    /// Sheets of the surface are so close everywhere that the lock would make them cross. The lock
    /// of the next stroke corrects the remaining difference.
    Crossings,
}

impl LockSkipped {
    /// Identifier for programs: `off`, `needs_closed`, `no_hold` or `crossings`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::NeedsClosed => "needs_closed",
            Self::NoHold => "no_hold",
            Self::Crossings => "crossings",
        }
    }
}

impl fmt::Display for LockSkipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "the lock was skipped: the session has no lock",
            Self::NeedsClosed => "the lock was skipped: the mesh is open and has no volume",
            Self::NoHold => "the lock was skipped: nothing moved that the volume depends on",
            Self::Crossings => "the lock was skipped: it would make the surface cross itself",
        })
    }
}

/// Signed changes of the volume inside the flat triangles by one stroke, cubic model units. The
/// total is the sum of the three parts.
///
/// The flow itself preserves volume up to the error of its time step. `flow` and `splits` are
/// caused by flat triangles and tend to cancel: flat triangles cut a curved image short, and a
/// vertex inserted on the image corrects part of this.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeVolume {
    /// Change by moving vertices: the error of the time step and the facet error.
    pub flow: f64,
    /// Change by inserting vertices on the image of the surface.
    pub splits: f64,
    /// Change by collapses and flips, which are not part of the flow.
    pub remeshing: f64,
    /// Bound on the rounding error of these numbers.
    pub rounding: f64,
}

impl StrokeVolume {
    /// Change by the method itself, without remeshing.
    pub fn bare(&self) -> f64 {
        self.flow + self.splits
    }

    /// Total change.
    pub fn total(&self) -> f64 {
        self.flow + self.splits + self.remeshing
    }
}

/// State of undo and redo.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct History {
    /// Strokes that can be undone.
    pub undoable: usize,
    /// Strokes that can be redone.
    pub redoable: usize,
    /// Strokes that can no longer be undone because undo has forgotten them. The log still contains
    /// them.
    pub forgotten: usize,
    /// Bytes in use, including those that redo will need for strokes that are not undone yet. Undo
    /// and redo do not change this number.
    pub bytes: usize,
}
