//! Remeshing.

use std::ffi::c_void;

use isochore_sculpt::{RemeshError, remesh, session};

use crate::{
    error::{Failure, Status, guarded},
    memory::{hand_over, put_optional, reference},
    mesh::Mesh,
    monitor::{Progress, Watcher},
    session::LockSkipped,
};

/// Options of a remesh. Zero selects the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct RemeshOptions {
    /// Length of the edges, model units. By default edges are as long as `deviation` allows.
    pub edge_length: f64,
    /// Largest distance between the surfaces before and after, as a fraction of the longest side of
    /// the bounding box. By default 0.001, or a tenth of the edge length if that is given.
    pub deviation: f64,
    /// Splits stop at this number of triangles.
    pub max_triangles: usize,
}

/// Result of a remesh.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct RemeshReceipt {
    /// Number of triangles before.
    pub triangles_before: usize,
    /// Number of triangles after.
    pub triangles_after: usize,
    /// Number of split edges.
    pub splits: usize,
    /// Number of collapsed edges.
    pub collapses: usize,
    /// Number of flipped edges.
    pub flips: usize,
    /// Whether the limit on triangles prevented splits.
    pub is_limited: bool,
    /// Largest allowed distance between the surfaces before and after, model units.
    pub allowance: f64,
    /// Whether the surface is closed. If not, the volume changes below are 0.
    pub has_volume: bool,
    /// Signed volume change before the volume lock, cubic model units.
    pub unlocked_volume_change: f64,
    /// Signed volume change, cubic model units.
    pub volume_change: f64,
    /// Largest displacement by the volume lock, model units; 0 if it was skipped.
    pub lock_max_shift: f64,
    /// Reason why the volume lock was skipped.
    pub lock_skipped: LockSkipped,
    /// Elapsed time, seconds.
    pub seconds: f64,
    /// Memory that undo holds for this remesh, in bytes; 0 outside a session.
    pub undo_bytes: usize,
    /// Number of older steps that were removed from the history to stay within the memory budget.
    pub forgotten_strokes: usize,
}

impl RemeshOptions {
    /// The options, or the defaults if `options` is NULL.
    ///
    /// # Safety
    /// `options` is NULL or readable.
    pub(crate) unsafe fn read(options: *const Self) -> session::RemeshOptions {
        // SAFETY: the caller guarantees it.
        let options = unsafe { options.as_ref() }.copied().unwrap_or_default();
        let mut chosen = session::RemeshOptions::default();
        if options.edge_length != 0.0 {
            chosen.edge_length = Some(options.edge_length);
        }
        if options.deviation != 0.0 {
            chosen.deviation = Some(options.deviation);
        }
        if options.max_triangles != 0 {
            chosen.max_triangles = options.max_triangles;
        }
        chosen
    }
}

impl From<session::RemeshReceipt> for RemeshReceipt {
    fn from(done: session::RemeshReceipt) -> Self {
        Self {
            triangles_before: done.triangles_before,
            triangles_after: done.triangles_after,
            splits: done.splits,
            collapses: done.collapses,
            flips: done.flips,
            is_limited: done.is_limited,
            allowance: done.allowance,
            has_volume: done.volume_change.is_some(),
            unlocked_volume_change: done.unlocked_volume_change.unwrap_or(0.0),
            volume_change: done.volume_change.unwrap_or(0.0),
            lock_max_shift: done.lock_max_shift.unwrap_or(0.0),
            lock_skipped: done.lock_skipped.into(),
            seconds: done.seconds,
            undo_bytes: done.undo_bytes,
            forgotten_strokes: done.forgotten_strokes,
        }
    }
}

/// Replaces the triangles of a mesh by even ones on the same surface. Seams, hard edges, borders
/// between materials, the boundary and sharp edges are kept, attributes are carried, and the volume of
/// a closed mesh is restored. No triangles that did not cross before cross afterwards.
///
/// Stores the new mesh in `remeshed`. `options`, `progress` and `receipt` may be NULL.
///
/// Returns `ISOCHORE_STATUS_MESH` if the mesh is not a manifold, consistently oriented surface,
/// `ISOCHORE_STATUS_ARGUMENT` if an option or the size of the mesh is out of range, and
/// `ISOCHORE_STATUS_CANCELLED` if `progress` returned false.
///
/// Preconditions: `mesh` is a handle. `options` is NULL or readable. `remeshed` is writable. `receipt`
/// is NULL or writable. Free the mesh with `isochore_mesh_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_remesh(
    mesh: *const Mesh,
    options: *const RemeshOptions,
    progress: Progress,
    context: *mut c_void,
    remeshed: *mut *mut Mesh,
    receipt: *mut RemeshReceipt,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (mesh, options) = unsafe { (reference("mesh", mesh)?, RemeshOptions::read(options)) };
        if remeshed.is_null() {
            return Err(Failure::argument("remeshed is NULL"));
        }
        let done = remesh(mesh.mesh.clone(), &options, &Watcher::new(progress, context))?;
        // SAFETY: the caller guarantees it.
        unsafe {
            hand_over("remeshed", remeshed, Mesh { mesh: done.mesh.into() })?;
            put_optional(receipt, done.receipt.into());
        }
        Ok(())
    })
}

impl From<RemeshError> for Failure {
    fn from(error: RemeshError) -> Self {
        match error {
            RemeshError::Mesh(error) => Self::new(Status::Mesh, error),
            RemeshError::Options(error) => error.into(),
            RemeshError::Cancelled(cancelled) => cancelled.into(),
        }
    }
}
