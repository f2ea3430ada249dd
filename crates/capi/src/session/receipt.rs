//! What moves and strokes did.

use isochore_sculpt::session;

/// What one move did.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct MoveReceipt {
    /// Vertices that moved.
    pub moved_vertices: usize,
    /// Vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Vertices that collapses removed.
    pub removed_vertices: usize,
    /// Edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the limit on triangles kept edges from being split.
    pub is_limited: bool,
    /// Edges that stay too long because the stroke has stirred the surface there too much for a split to help.
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

/// Why a stroke ended without its lock.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LockSkipped {
    /// It did not: the lock acted.
    #[default]
    No = 0,
    /// The session has none.
    Off = 1,
    /// The surface is open and has no volume.
    NeedsClosed = 2,
    /// Nothing has moved that the volume depends on; what is missing is left for the lock of the next stroke.
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

/// What one stroke did.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct StrokeReceipt {
    /// Moves that it was made of.
    pub moves: usize,
    /// Vertices there before that it moved or removed.
    pub touched_vertices: usize,
    /// Vertices that splits inserted.
    pub inserted_vertices: usize,
    /// Vertices that collapses removed.
    pub removed_vertices: usize,
    /// Edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the limit on triangles kept edges from being split.
    pub is_limited: bool,
    /// The most edges in any move that stayed too long because the stroke has stirred the surface there too much for a split to help.
    pub refused_splits: usize,
    /// Whether the surface is closed, and the changes of its volume below mean something.
    pub has_volume: bool,
    /// Signed change of the volume by the flow, cubic model units.
    pub volume_flow: f64,
    /// By splits.
    pub volume_splits: f64,
    /// By collapses and flips.
    pub volume_remeshing: f64,
    /// Bound on the rounding in these.
    pub volume_rounding: f64,
    /// Longest displacement by the lock, model units; zero where it was skipped.
    pub lock_max_shift: f64,
    /// Why the lock was skipped.
    pub lock_skipped: LockSkipped,
    /// Bytes that undo holds for it.
    pub undo_bytes: usize,
    /// Older strokes that undo forgot to make room.
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
