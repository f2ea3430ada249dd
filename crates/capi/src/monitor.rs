//! Progress and cancellation through a callback.

use std::{
    ffi::{CString, c_char, c_void},
    sync::atomic::{AtomicBool, Ordering},
};

use isochore_mesh::Monitor;

/// Progress callback. Receives the name of the current stage and the completed fraction of that
/// stage, from 0 to 1. Returning false cancels the operation. It may be called from any thread and
/// from several threads at once. `context` is the pointer passed along with the callback.
pub type Progress = Option<unsafe extern "C" fn(stage: *const c_char, done: f64, context: *mut c_void) -> bool>;

/// Monitor that calls the progress callback of the caller.
#[derive(Debug)]
pub(crate) struct Watcher {
    progress: Progress,
    context: *mut c_void,
    is_cancelled: AtomicBool,
}

// SAFETY: the header requires that the callback and its context may be used from any thread.
unsafe impl Sync for Watcher {}

impl Watcher {
    pub(crate) fn new(progress: Progress, context: *mut c_void) -> Self {
        Self { progress, context, is_cancelled: AtomicBool::new(false) }
    }
}

impl Monitor for Watcher {
    fn update(&self, stage: &'static str, done: f64) {
        let Some(progress) = self.progress else { return };
        let stage = CString::new(stage).unwrap_or_default();
        // SAFETY: the caller passed the callback together with this context; `stage` is NUL-terminated.
        if !unsafe { progress(stage.as_ptr(), done, self.context) } {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}
