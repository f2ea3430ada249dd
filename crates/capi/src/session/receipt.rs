//! Results of moves and strokes.

use isochore_sculpt::session;

/// Result of one move.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct MoveReceipt {
    /// Number of vertices that moved.
    pub moved_vertices: usize,
    /// Number of vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Number of edges that remain too long or too coarse because the stroke has distorted the
    /// surface too much for a split to help.
    pub refused_splits: usize,
    /// Whether the stroke has been ended, because the surface would cross itself farther on. Later
    /// moves of the stroke have no effect.
    pub is_stopped: bool,
}

impl From<session::MoveReceipt> for MoveReceipt {
    fn from(done: session::MoveReceipt) -> Self {
        Self {
            moved_vertices: done.moved_vertices,
            inserted_vertices: done.inserted_vertices,
            is_limited: done.is_limited,
            refused_splits: done.refused_splits,
            is_stopped: done.is_stopped,
        }
    }
}

/// Reason why a stroke ended without the volume lock.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LockSkipped {
    /// The lock was applied.
    #[default]
    No = 0,
    /// The session has the lock disabled.
    Off = 1,
    /// The surface is open and has no volume.
    NeedsClosed = 2,
    /// The vertices that moved cannot change the volume. The lock of the next stroke corrects the
    /// remaining error.
    NoHold = 3,
    /// Sheets of the surface are so close that the lock would make them cross. The lock of the next
    /// stroke corrects the remaining error.
    Crossings = 4,
}

impl From<Option<session::LockSkipped>> for LockSkipped {
    fn from(skipped: Option<session::LockSkipped>) -> Self {
        match skipped {
            None => Self::No,
            Some(session::LockSkipped::Off) => Self::Off,
            Some(session::LockSkipped::NeedsClosed) => Self::NeedsClosed,
            Some(session::LockSkipped::NoHold) => Self::NoHold,
            Some(session::LockSkipped::Crossings) => Self::Crossings,
        }
    }
}

/// Result of one stroke.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct StrokeReceipt {
    /// Number of moves; the first pose does not count.
    pub moves: usize,
    /// Number of existing vertices that the stroke moved or removed.
    pub touched_vertices: usize,
    /// Number of vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Number of vertices that collapses removed.
    pub removed_vertices: usize,
    /// Number of edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Largest number of edges in any move that remained too long or too coarse because the stroke
    /// has distorted the surface too much for a split to help.
    pub refused_splits: usize,
    /// Whether the surface is closed. If not, the volume changes below are 0.
    pub has_volume: bool,
    /// Signed volume change by moving vertices, cubic model units.
    pub volume_flow: f64,
    /// Signed volume change by splits, cubic model units.
    pub volume_splits: f64,
    /// Signed volume change by collapses and flips, cubic model units.
    pub volume_remeshing: f64,
    /// Bound on the rounding error of these changes, cubic model units.
    pub volume_rounding: f64,
    /// Largest displacement by the volume lock, model units; 0 if it was skipped.
    pub lock_max_shift: f64,
    /// Reason why the volume lock was skipped.
    pub lock_skipped: LockSkipped,
    /// Whether the stroke was ended before its last pose, because the surface would have crossed
    /// itself. The log contains the shortened stroke; a stroke that was ended at 0 leaves no trace.
    pub is_stopped: bool,
    /// Fraction of the stroke at which it ended; 1 if it was not ended early.
    pub stopped_at: f64,
    /// Whether the two sheets that would have crossed are known.
    pub has_sheets: bool,
    /// Distance between these sheets when the stroke ended, model units.
    pub sheets_gap: f64,
    /// The point midway between these sheets, model units.
    pub sheets_at: [f64; 3],
    /// Number of pairs of triangles that the stroke made cross. Zero unless this stroke, or an
    /// earlier one, kept all triangles.
    pub crossings: usize,
    /// Wall time of finding and removing crossings, seconds.
    pub certificate_seconds: f64,
    /// Memory that undo holds for this stroke, in bytes.
    pub undo_bytes: usize,
    /// Number of older strokes that were removed from the history to stay within the memory budget.
    pub forgotten_strokes: usize,
}

impl From<session::StrokeReceipt> for StrokeReceipt {
    fn from(done: session::StrokeReceipt) -> Self {
        let volume = done.volume.unwrap_or_default();
        Self {
            moves: done.moves,
            touched_vertices: done.touched_vertices,
            inserted_vertices: done.inserted_vertices,
            removed_vertices: done.removed_vertices,
            flipped_edges: done.flipped_edges,
            is_limited: done.is_limited,
            refused_splits: done.refused_splits,
            has_volume: done.volume.is_some(),
            volume_flow: volume.flow,
            volume_splits: volume.splits,
            volume_remeshing: volume.remeshing,
            volume_rounding: volume.rounding,
            lock_max_shift: done.lock_max_shift.unwrap_or(0.0),
            lock_skipped: done.lock_skipped.into(),
            is_stopped: done.stopped_at.is_some(),
            stopped_at: done.stopped_at.unwrap_or(1.0),
            has_sheets: done.sheets.is_some(),
            sheets_gap: done.sheets.map_or(0.0, |sheets| sheets.gap),
            sheets_at: done.sheets.map_or([0.0; 3], |sheets| sheets.at.to_array()),
            crossings: done.crossings,
            certificate_seconds: done.certificate_seconds,
            undo_bytes: done.undo_bytes,
            forgotten_strokes: done.forgotten_strokes,
        }
    }
}
