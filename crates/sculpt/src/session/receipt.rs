//! What moves, strokes, undo and redo did.

use std::fmt;

/// What one [`move_to`](super::Session::move_to) did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
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
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Wall time by stage.
    pub seconds: MoveSeconds,
}

/// Wall time of the stages of a move, in seconds; zero where there is no clock.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MoveSeconds {
    /// Finding what the tool can touch.
    pub select: f64,
    /// Carrying vertices along the flow.
    pub flow: f64,
    /// Splits, collapses and flips.
    pub refine: f64,
    /// Letting the index over the triangles follow.
    pub index: f64,
    /// Normals and the rest of the buffers.
    pub buffers: f64,
}

impl MoveSeconds {
    /// All stages together.
    pub fn total(&self) -> f64 {
        self.select + self.flow + self.refine + self.index + self.buffers
    }
}

/// What one stroke did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeReceipt {
    /// Moves that it was made of, the first pose not counted.
    pub moves: usize,
    /// Time between its first and last pose, as the host told it.
    pub duration: f64,
    /// Vertices there before that it moved or removed.
    pub touched_vertices: usize,
    /// Vertices that splits inserted; some of them may be removed again.
    pub inserted_vertices: usize,
    /// Vertices that collapses removed.
    pub removed_vertices: usize,
    /// Edges that were flipped.
    pub flipped_edges: usize,
    /// Whether the limit on triangles kept edges from being split.
    pub is_limited: bool,
    /// The most edges in any move that stayed too long because the stroke has stirred the surface there too much for a split to help.
    pub refused_splits: usize,
    /// Evaluations of the fields.
    pub evaluations: u64,
    /// What became of the volume; none where the surface is open.
    pub volume: Option<StrokeVolume>,
    /// Longest displacement by the lock of this stroke, model units; none where it was skipped.
    pub lock_max_shift: Option<f64>,
    /// Why the lock was skipped; none where it acted.
    pub lock_skipped: Option<LockSkipped>,
    /// Wall time of all moves by stage.
    pub seconds: MoveSeconds,
    /// Bytes that undo holds for this stroke, with what it will need for making it again.
    pub undo_bytes: usize,
    /// Strokes that undo forgot, oldest first, to make room for this one.
    pub forgotten_strokes: usize,
}

/// Why a stroke ended without its lock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LockSkipped {
    /// The session locks no stroke.
    Off,
    /// The surface is open and has no volume.
    NeedsClosed,
    /// The stroke has moved nothing that the volume depends on, or too little for a displacement of that to give it back. What is
    /// missing is left for the lock of the next stroke.
    NoHold,
}

impl LockSkipped {
    /// The name that programs go by: `off`, `needs_closed`, `no_hold`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::NeedsClosed => "needs_closed",
            Self::NoHold => "no_hold",
        }
    }
}

impl fmt::Display for LockSkipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "the lock was skipped: the session has none",
            Self::NeedsClosed => "the lock was skipped: the mesh is open and has no volume",
            Self::NoHold => "the lock was skipped: nothing moved that the volume depends on",
        })
    }
}

/// Signed changes of the volume inside the flat triangles by one stroke, cubic model units. Their sum is the whole change.
///
/// The flow itself keeps volumes up to its time step. `flow` and `splits` are what flat triangles make of it, and tend to cancel:
/// flat triangles cut a curved image short, and a vertex inserted where the flow carries it gives some of that back.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeVolume {
    /// By moving vertices: the error of the time step and the facet error.
    pub flow: f64,
    /// By inserting vertices on the image of the surface.
    pub splits: f64,
    /// By collapses and flips, which the flow knows nothing of.
    pub remeshing: f64,
    /// Bound on the rounding in these numbers.
    pub rounding: f64,
}

impl StrokeVolume {
    /// The bare change: what the method itself gives, remeshing apart.
    pub fn bare(&self) -> f64 {
        self.flow + self.splits
    }

    /// The whole change.
    pub fn total(&self) -> f64 {
        self.flow + self.splits + self.remeshing
    }
}

/// What can be undone and redone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct History {
    /// Strokes that can be undone.
    pub undoable: usize,
    /// Strokes that can be redone.
    pub redoable: usize,
    /// Strokes that can no longer be undone, because the byte budget made undo forget them. The log still has them.
    pub forgotten: usize,
    /// Bytes held, with what redo will need for strokes that are not undone yet: undo and redo change nothing in it.
    pub bytes: usize,
}
