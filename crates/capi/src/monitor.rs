//! Progress and cancellation through a function of the caller's.

use std::{
    ffi::{CString, c_char, c_void},
    sync::atomic::{AtomicBool, Ordering},
};

use isochore_mesh::Monitor;

/// Hears now and then, on any thread and from several at once, the stage at work and the share of it that is done, from 0 to 1;
/// returning false stops the work. `context` is what was given along with the function.
pub type Progress = Option<unsafe extern "C" fn(stage: *const c_char, done: f64, context: *mut c_void) -> bool>;

/// A caller's function that watches the work.
#[derive(Debug)]
pub(crate) struct Watcher {
    progress: Progress,
    context: *mut c_void,
    is_cancelled: AtomicBool,
}

// SAFETY: the header demands that the function may be called with its context from any thread.
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
        // SAFETY: the function came from the caller together with its context; the text ends with a zero.
        if !unsafe { progress(stage.as_ptr(), done, self.context) } {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}
