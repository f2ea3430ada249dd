//! Remeshing in a session.

use std::ffi::c_void;

use super::Session;
use crate::{
    error::{Status, guarded},
    memory::{put_optional, reference_mut},
    monitor::{Progress, Watcher},
    remesh::{RemeshOptions, RemeshReceipt},
};

/// Replaces the triangles of the surface by even ones, as `isochore_remesh` does. Undo restores all
/// bits. Frozen edges and vertices that the mask holds stay. A remesh is not part of the log.
/// `options`, `progress` and `receipt` may be NULL.
///
/// Returns `ISOCHORE_STATUS_STATE` if a stroke is in progress, `ISOCHORE_STATUS_ARGUMENT` if an option
/// is out of range, and `ISOCHORE_STATUS_CANCELLED` if `progress` returned false.
///
/// Preconditions: `session` is a handle. `options` is NULL or readable. `receipt` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isochore_session_remesh(
    session: *mut Session,
    options: *const RemeshOptions,
    progress: Progress,
    context: *mut c_void,
    receipt: *mut RemeshReceipt,
) -> Status {
    guarded(|| {
        // SAFETY: the caller guarantees it.
        let (session, options) = unsafe { (reference_mut("session", session)?, RemeshOptions::read(options)) };
        let done = session.session.remesh(&options, &Watcher::new(progress, context))?;
        // SAFETY: the caller guarantees it.
        unsafe { put_optional(receipt, done.into()) };
        Ok(())
    })
}
