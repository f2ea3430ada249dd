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
    /// Number of vertices that collapses removed.
    pub removed_vertices: usize,
    /// Number of flipped edges.
    pub flipped_edges: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Number of edges that remain too long because the stroke has distorted the surface too much
    /// for a split to help.
    pub refused_splits: usize,
}

impl From<session::MoveReceipt> for MoveReceipt {
    fn from(done: session::MoveReceipt) -> Self {
        Self {
            moved_vertices: done.moved_vertices,
            inserted_vertices: done.inserted_vertices,
            removed_vertices: done.removed_vertices,
            flipped_edges: done.flipped_edges,
            is_limited: done.is_limited,
            refused_splits: done.refused_splits,
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
}

impl From<Option<session::LockSkipped>> for LockSkipped {
    fn from(skipped: Option<session::LockSkipped>) -> Self {
        match skipped {
            None => Self::No,
            Some(session::LockSkipped::Off) => Self::Off,
            Some(session::LockSkipped::NeedsClosed) => Self::NeedsClosed,
            Some(session::LockSkipped::NoHold) => Self::NoHold,
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
    /// Number of flipped edges.
    pub flipped_edges: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Largest number of edges in any move that remained too long because the stroke has distorted
    /// the surface too much for a split to help.
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
            undo_bytes: done.undo_bytes,
            forgotten_strokes: done.forgotten_strokes,
        }
    }
}
