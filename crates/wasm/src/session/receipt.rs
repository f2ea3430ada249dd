//! Results of moves and strokes.

use isochore_sculpt::session;
use wasm_bindgen::prelude::*;

/// Result of one move.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MoveReceipt {
    pub(super) receipt: session::MoveReceipt,
}

/// Result of one stroke.
#[wasm_bindgen]
#[derive(Debug)]
pub struct StrokeReceipt {
    pub(super) receipt: session::StrokeReceipt,
}

/// Two sheets of a surface that come close to each other.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Sheets {
    sheets: session::Sheets,
}

/// Size of the undo history.
#[wasm_bindgen]
#[derive(Debug)]
pub struct History {
    pub(super) history: session::History,
}

#[wasm_bindgen]
impl MoveReceipt {
    /// Number of vertices that moved.
    #[wasm_bindgen(getter, js_name = movedVertices)]
    pub fn moved_vertices(&self) -> u32 {
        self.receipt.moved_vertices as u32
    }

    /// Number of vertices that splits inserted.
    #[wasm_bindgen(getter, js_name = insertedVertices)]
    pub fn inserted_vertices(&self) -> u32 {
        self.receipt.inserted_vertices as u32
    }

    /// Whether the limit on triangles prevented splits.
    #[wasm_bindgen(getter, js_name = isLimited)]
    pub fn is_limited(&self) -> bool {
        self.receipt.is_limited
    }

    /// Number of edges that remain too long or too coarse because the stroke has distorted the
    /// surface too much for a split to help.
    #[wasm_bindgen(getter, js_name = refusedSplits)]
    pub fn refused_splits(&self) -> u32 {
        self.receipt.refused_splits as u32
    }

    /// Whether the stroke has been ended, because the surface would cross itself farther on. Later
    /// moves of the stroke have no effect.
    #[wasm_bindgen(getter, js_name = isStopped)]
    pub fn is_stopped(&self) -> bool {
        self.receipt.is_stopped
    }
}

#[wasm_bindgen]
impl StrokeReceipt {
    /// Number of moves; the first pose does not count.
    #[wasm_bindgen(getter)]
    pub fn moves(&self) -> u32 {
        self.receipt.moves as u32
    }

    /// Number of existing vertices that the stroke moved or removed.
    #[wasm_bindgen(getter, js_name = touchedVertices)]
    pub fn touched_vertices(&self) -> u32 {
        self.receipt.touched_vertices as u32
    }

    /// Number of vertices that splits inserted.
    #[wasm_bindgen(getter, js_name = insertedVertices)]
    pub fn inserted_vertices(&self) -> u32 {
        self.receipt.inserted_vertices as u32
    }

    /// Number of vertices that collapses removed.
    #[wasm_bindgen(getter, js_name = removedVertices)]
    pub fn removed_vertices(&self) -> u32 {
        self.receipt.removed_vertices as u32
    }

    /// Number of edges that were flipped.
    #[wasm_bindgen(getter, js_name = flippedEdges)]
    pub fn flipped_edges(&self) -> u32 {
        self.receipt.flipped_edges as u32
    }

    /// Whether the limit on triangles prevented splits.
    #[wasm_bindgen(getter, js_name = isLimited)]
    pub fn is_limited(&self) -> bool {
        self.receipt.is_limited
    }

    /// Largest number of edges in any move that remained too long or too coarse because the stroke
    /// has distorted the surface too much for a split to help.
    #[wasm_bindgen(getter, js_name = refusedSplits)]
    pub fn refused_splits(&self) -> u32 {
        self.receipt.refused_splits as u32
    }

    /// Signed volume change before the lock, cubic model units: the sum of the changes by flow,
    /// splits and remeshing. These are undefined if the surface is open.
    #[wasm_bindgen(getter, js_name = volumeChange)]
    pub fn volume_change(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.total())
    }

    /// Signed volume change by moving vertices, cubic model units.
    #[wasm_bindgen(getter, js_name = volumeFlow)]
    pub fn volume_flow(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.flow)
    }

    /// Signed volume change by splits, cubic model units.
    #[wasm_bindgen(getter, js_name = volumeSplits)]
    pub fn volume_splits(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.splits)
    }

    /// Signed volume change by collapses and flips, cubic model units.
    #[wasm_bindgen(getter, js_name = volumeRemeshing)]
    pub fn volume_remeshing(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.remeshing)
    }

    /// Bound on the rounding error of these changes, cubic model units.
    #[wasm_bindgen(getter, js_name = volumeRounding)]
    pub fn volume_rounding(&self) -> Option<f64> {
        self.receipt.volume.map(|volume| volume.rounding)
    }

    /// Largest displacement by the volume lock, model units, or undefined if it was skipped.
    #[wasm_bindgen(getter, js_name = lockMaxShift)]
    pub fn lock_max_shift(&self) -> Option<f64> {
        self.receipt.lock_max_shift
    }

    /// Reason why the volume lock was skipped, or undefined if it was applied. `off`: the session
    /// has it disabled. `needs_closed`: the surface is open. `no_hold`: the moved vertices cannot
    /// change the volume. `crossings`: sheets of the surface are so close that the lock would make
    /// them cross. In the last two cases the lock of the next stroke corrects the remaining error.
    #[wasm_bindgen(getter, js_name = lockSkipped)]
    pub fn lock_skipped(&self) -> Option<String> {
        self.receipt.lock_skipped.map(|skipped| skipped.name().to_owned())
    }

    /// Fraction of the stroke, from 0 to 1, at which it was ended because the surface would have
    /// crossed itself, or undefined. The log contains the shortened stroke. A stroke that was ended
    /// at 0 leaves no trace.
    #[wasm_bindgen(getter, js_name = stoppedAt)]
    pub fn stopped_at(&self) -> Option<f64> {
        self.receipt.stopped_at
    }

    /// The two sheets that would have crossed, when the stroke was ended, or undefined.
    #[wasm_bindgen(getter)]
    pub fn sheets(&self) -> Option<Sheets> {
        self.receipt.sheets.map(|sheets| Sheets { sheets })
    }

    /// Number of pairs of triangles that the stroke made cross. Zero unless this stroke, or an
    /// earlier one, had `refine: false`.
    #[wasm_bindgen(getter)]
    pub fn crossings(&self) -> u32 {
        self.receipt.crossings as u32
    }

    /// Wall time of finding and removing crossings, seconds.
    #[wasm_bindgen(getter, js_name = certificateSeconds)]
    pub fn certificate_seconds(&self) -> f64 {
        self.receipt.certificate_seconds
    }

    /// Memory that undo holds for this stroke, in bytes.
    #[wasm_bindgen(getter, js_name = undoBytes)]
    pub fn undo_bytes(&self) -> f64 {
        self.receipt.undo_bytes as f64
    }

    /// Number of older strokes that were removed from the history to stay within the memory budget.
    #[wasm_bindgen(getter, js_name = forgottenStrokes)]
    pub fn forgotten_strokes(&self) -> u32 {
        self.receipt.forgotten_strokes as u32
    }
}

#[wasm_bindgen]
impl Sheets {
    /// Distance between the sheets, model units.
    #[wasm_bindgen(getter)]
    pub fn gap(&self) -> f64 {
        self.sheets.gap
    }

    /// The point midway between the sheets: x, y, z, model units.
    #[wasm_bindgen(getter)]
    pub fn at(&self) -> Vec<f64> {
        self.sheets.at.to_array().to_vec()
    }
}

#[wasm_bindgen]
impl History {
    /// Number of strokes that can be undone.
    #[wasm_bindgen(getter)]
    pub fn undoable(&self) -> u32 {
        self.history.undoable as u32
    }

    /// Number of strokes that can be redone.
    #[wasm_bindgen(getter)]
    pub fn redoable(&self) -> u32 {
        self.history.redoable as u32
    }

    /// Number of strokes that the memory budget has removed from the history. The log still
    /// contains them.
    #[wasm_bindgen(getter)]
    pub fn forgotten(&self) -> u32 {
        self.history.forgotten as u32
    }

    /// Memory in use, in bytes.
    #[wasm_bindgen(getter)]
    pub fn bytes(&self) -> f64 {
        self.history.bytes as f64
    }
}
