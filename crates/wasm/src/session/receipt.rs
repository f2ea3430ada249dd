//! What moves and strokes did.

use isochore_sculpt::session;
use wasm_bindgen::prelude::*;

/// What one move did.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MoveReceipt {
    pub(super) receipt: session::MoveReceipt,
}

/// What one stroke did.
#[wasm_bindgen]
#[derive(Debug)]
pub struct StrokeReceipt {
    pub(super) receipt: session::StrokeReceipt,
}

/// What can be undone and redone.
#[wasm_bindgen]
#[derive(Debug)]
pub struct History {
    pub(super) history: session::History,
}

#[wasm_bindgen]
impl MoveReceipt {
    /// Vertices that moved.
    #[wasm_bindgen(getter, js_name = movedVertices)]
    pub fn moved_vertices(&self) -> u32 {
        self.receipt.moved_vertices as u32
    }

    /// Vertices that splits inserted.
    #[wasm_bindgen(getter, js_name = insertedVertices)]
    pub fn inserted_vertices(&self) -> u32 {
        self.receipt.inserted_vertices as u32
    }

    /// Vertices that collapses removed.
    #[wasm_bindgen(getter, js_name = removedVertices)]
    pub fn removed_vertices(&self) -> u32 {
        self.receipt.removed_vertices as u32
    }

    /// Edges that were flipped.
    #[wasm_bindgen(getter, js_name = flippedEdges)]
    pub fn flipped_edges(&self) -> u32 {
        self.receipt.flipped_edges as u32
    }

    /// Whether the limit on triangles kept edges from being split.
    #[wasm_bindgen(getter, js_name = isLimited)]
    pub fn is_limited(&self) -> bool {
        self.receipt.is_limited
    }

    /// Edges that stay too long because the stroke has stirred the surface there too much for a split to help.
    #[wasm_bindgen(getter, js_name = refusedSplits)]
    pub fn refused_splits(&self) -> u32 {
        self.receipt.refused_splits as u32
    }
}

#[wasm_bindgen]
impl StrokeReceipt {
    /// Moves that it was made of.
    #[wasm_bindgen(getter)]
    pub fn moves(&self) -> u32 {
        self.receipt.moves as u32
    }

    /// Vertices there before that it moved or removed.
    #[wasm_bindgen(getter, js_name = touchedVertices)]
    pub fn touched_vertices(&self) -> u32 {
        self.receipt.touched_vertices as u32
    }

    /// Vertices that splits inserted.
    #[wasm_bindgen(getter, js_name = insertedVertices)]
    pub fn inserted_vertices(&self) -> u32 {
        self.receipt.inserted_vertices as u32
    }

    /// Vertices that collapses removed.
    #[wasm_bindgen(getter, js_name = removedVertices)]
    pub fn removed_vertices(&self) -> u32 {
        self.receipt.removed_vertices as u32
    }

    /// Edges that were flipped.
    #[wasm_bindgen(getter, js_name = flippedEdges)]
    pub fn flipped_edges(&self) -> u32 {
        self.receipt.flipped_edges as u32
    }

    /// Whether the limit on triangles kept edges from being split.
    #[wasm_bindgen(getter, js_name = isLimited)]
    pub fn is_limited(&self) -> bool {
        self.receipt.is_limited
    }

    /// The most edges in any move that stayed too long because the stroke has stirred the surface there too much for a split to help.
    #[wasm_bindgen(getter, js_name = refusedSplits)]
    pub fn refused_splits(&self) -> u32 {
        self.receipt.refused_splits as u32
    }

    /// Signed change of the volume before any lock, cubic model units: the sum of those by flow, splits and remeshing. Undefined, as
    /// these are, where the surface is open.
    #[wasm_bindgen(getter, js_name = volumeChange)]
    pub fn volume_change(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.total())
    }

    /// Signed change of the volume by the flow, cubic model units.
    #[wasm_bindgen(getter, js_name = volumeFlow)]
    pub fn volume_flow(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.flow)
    }

    /// By splits.
    #[wasm_bindgen(getter, js_name = volumeSplits)]
    pub fn volume_splits(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.splits)
    }

    /// By collapses and flips.
    #[wasm_bindgen(getter, js_name = volumeRemeshing)]
    pub fn volume_remeshing(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.remeshing)
    }

    /// Bound on the rounding in these.
    #[wasm_bindgen(getter, js_name = volumeRounding)]
    pub fn volume_rounding(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.rounding)
    }

    /// Longest displacement by the lock, model units; undefined where it was skipped.
    #[wasm_bindgen(getter, js_name = lockMaxShift)]
    pub fn lock_max_shift(&self) -> Option<f64> {
        self.receipt.lock_max_shift
    }

    /// Why the lock was skipped, undefined where it acted: `off`, the session has none; `needs_closed`, the surface is open;
    /// `no_hold`, nothing moved that the volume depends on, and the lock of the next stroke has to make up for what is missing.
    #[wasm_bindgen(getter, js_name = lockSkipped)]
    pub fn lock_skipped(&self) -> Option<String> {
        self.receipt.lock_skipped.map(|skipped| skipped.name().to_owned())
    }

    /// Bytes that undo holds for it.
    #[wasm_bindgen(getter, js_name = undoBytes)]
    pub fn undo_bytes(&self) -> f64 {
        self.receipt.undo_bytes as f64
    }

    /// Older strokes that undo forgot to make room.
    #[wasm_bindgen(getter, js_name = forgottenStrokes)]
    pub fn forgotten_strokes(&self) -> u32 {
        self.receipt.forgotten_strokes as u32
    }
}

#[wasm_bindgen]
impl History {
    /// Strokes that can be undone.
    #[wasm_bindgen(getter)]
    pub fn undoable(&self) -> u32 {
        self.history.undoable as u32
    }

    /// Strokes that can be redone.
    #[wasm_bindgen(getter)]
    pub fn redoable(&self) -> u32 {
        self.history.redoable as u32
    }

    /// Strokes that can no longer be undone.
    #[wasm_bindgen(getter)]
    pub fn forgotten(&self) -> u32 {
        self.history.forgotten as u32
    }

    /// Bytes held.
    #[wasm_bindgen(getter)]
    pub fn bytes(&self) -> f64 {
        self.history.bytes as f64
    }
}
