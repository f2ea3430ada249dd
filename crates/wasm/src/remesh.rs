//! Remeshing.

use std::sync::Arc;

use isochore_mesh::NoProgress;
use isochore_sculpt::session;
use wasm_bindgen::prelude::*;

use crate::{
    error::thrown,
    mesh::Mesh,
    options::{RemeshOptions, count, options},
};

/// Result of a remesh outside a session.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Remeshed {
    mesh: Mesh,
    receipt: session::RemeshReceipt,
}

/// Counts and measures of a remesh.
#[wasm_bindgen]
#[derive(Debug)]
pub struct RemeshReceipt {
    pub(crate) receipt: session::RemeshReceipt,
}

/// Replaces the triangles of a mesh by even ones on the same surface. Seams, hard edges, borders
/// between materials, the boundary and sharp edges are kept, attributes are carried, and the volume
/// of a closed mesh is restored. No triangles that did not cross before cross afterwards. Throws if
/// the mesh is not a manifold, consistently oriented surface, or an option is out of range.
#[wasm_bindgen]
pub fn remesh(mesh: &Mesh, options: Option<RemeshOptions>) -> Result<Remeshed, JsError> {
    let options = chosen(options)?;
    let done = isochore_sculpt::remesh(Arc::clone(&mesh.mesh), &options, &NoProgress).map_err(thrown)?;
    Ok(Remeshed { mesh: Mesh { mesh: done.mesh.into() }, receipt: done.receipt })
}

/// Options of a remesh from an object.
pub(crate) fn chosen(options: Option<RemeshOptions>) -> Result<session::RemeshOptions, JsError> {
    let options = self::options(options, &["edgeLength", "deviation", "maxTriangles"])?;
    let default = session::RemeshOptions::default();
    Ok(session::RemeshOptions {
        edge_length: options.edge_length(),
        deviation: options.deviation(),
        max_triangles: count("maxTriangles", options.max_triangles(), default.max_triangles)?,
    })
}

#[wasm_bindgen]
impl Remeshed {
    /// Counts and measures.
    #[wasm_bindgen(getter)]
    pub fn receipt(&self) -> RemeshReceipt {
        RemeshReceipt { receipt: self.receipt }
    }

    /// Returns the new mesh and frees this object.
    #[wasm_bindgen(js_name = intoMesh)]
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }
}

#[wasm_bindgen]
impl RemeshReceipt {
    /// Number of triangles before.
    #[wasm_bindgen(getter, js_name = trianglesBefore)]
    pub fn triangles_before(&self) -> u32 {
        self.receipt.triangles_before as u32
    }

    /// Number of triangles after.
    #[wasm_bindgen(getter, js_name = trianglesAfter)]
    pub fn triangles_after(&self) -> u32 {
        self.receipt.triangles_after as u32
    }

    /// Number of split edges.
    #[wasm_bindgen(getter)]
    pub fn splits(&self) -> u32 {
        self.receipt.splits as u32
    }

    /// Number of collapsed edges.
    #[wasm_bindgen(getter)]
    pub fn collapses(&self) -> u32 {
        self.receipt.collapses as u32
    }

    /// Number of flipped edges.
    #[wasm_bindgen(getter)]
    pub fn flips(&self) -> u32 {
        self.receipt.flips as u32
    }

    /// Whether the limit on triangles prevented splits.
    #[wasm_bindgen(getter, js_name = isLimited)]
    pub fn is_limited(&self) -> bool {
        self.receipt.is_limited
    }

    /// Largest allowed distance between the surfaces before and after, model units.
    #[wasm_bindgen(getter)]
    pub fn allowance(&self) -> f64 {
        self.receipt.allowance
    }

    /// Signed volume change before the lock, cubic model units, or undefined if the surface is open.
    #[wasm_bindgen(getter, js_name = unlockedVolumeChange)]
    pub fn unlocked_volume_change(&self) -> Option<f64> {
        self.receipt.unlocked_volume_change
    }

    /// Signed volume change, cubic model units, or undefined if the surface is open.
    #[wasm_bindgen(getter, js_name = volumeChange)]
    pub fn volume_change(&self) -> Option<f64> {
        self.receipt.volume_change
    }

    /// Largest displacement by the volume lock, model units, or undefined if it was skipped.
    #[wasm_bindgen(getter, js_name = lockMaxShift)]
    pub fn lock_max_shift(&self) -> Option<f64> {
        self.receipt.lock_max_shift
    }

    /// Reason why the volume lock was skipped, or undefined if it was applied: `off`, `needs_closed`
    /// or `no_hold`, as for a stroke.
    #[wasm_bindgen(getter, js_name = lockSkipped)]
    pub fn lock_skipped(&self) -> Option<String> {
        self.receipt.lock_skipped.map(|skipped| skipped.name().to_owned())
    }

    /// Memory that undo holds for this remesh, in bytes; 0 outside a session.
    #[wasm_bindgen(getter, js_name = undoBytes)]
    pub fn undo_bytes(&self) -> f64 {
        self.receipt.undo_bytes as f64
    }

    /// Number of older steps that were removed from the history to stay within the memory budget.
    #[wasm_bindgen(getter, js_name = forgottenStrokes)]
    pub fn forgotten_strokes(&self) -> u32 {
        self.receipt.forgotten_strokes as u32
    }
}
