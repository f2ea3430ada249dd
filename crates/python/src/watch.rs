//! Long operations that release the global interpreter lock, and that signals and the progress
//! callback can cancel.

use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::Duration,
};

use isochore_mesh::Monitor;
use pyo3::{
    Bound, PyAny, Python,
    types::{PyAnyMethods, PyBool},
};

use crate::error::Failure;

/// Period at which the calling thread checks for signals and reports progress.
const INTERVAL: Duration = Duration::from_millis(50);

/// State shared by the worker threads and the calling thread.
#[derive(Debug, Default)]
struct Blackboard {
    is_cancelled: AtomicBool,
    stage: Mutex<(&'static str, f64)>,
}

impl Monitor for Blackboard {
    fn update(&self, stage: &'static str, done: f64) {
        if let Ok(mut current) = self.stage.try_lock() {
            *current = (stage, done);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

/// Runs `work` on another thread without the global interpreter lock.
///
/// Meanwhile this thread handles signals and calls `progress(stage, fraction)`, if given. An
/// exception that either raises cancels the work and is raised again. A result of False cancels the
/// work and raises `Cancelled`.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Monitor) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let blackboard = Blackboard::default();
    let (done, is_done) = channel();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let result = work(&blackboard);
            // The receiver lives until the worker has finished.
            let _ = done.send(());
            result
        });
        let mut raised = None;
        let mut is_done = is_done;
        loop {
            let (message, receiver) = py.detach(move || (is_done.recv_timeout(INTERVAL), is_done));
            is_done = receiver;
            if !matches!(message, Err(RecvTimeoutError::Timeout)) {
                break;
            }
            if raised.is_none()
                && let Err(failure) = attend(py, progress, &blackboard)
            {
                blackboard.is_cancelled.store(true, Ordering::Relaxed);
                raised = Some(failure);
            }
        }
        let result = py.detach(|| worker.join());
        match (raised, result) {
            (Some(failure), _) => Err(failure),
            (None, Ok(result)) => result,
            (None, Err(panic)) => std::panic::resume_unwind(panic),
        }
    })
}

/// Handles pending signals and calls the progress callback.
fn attend(py: Python<'_>, progress: Option<&Bound<'_, PyAny>>, blackboard: &Blackboard) -> Result<(), Failure> {
    py.check_signals()?;
    let Some(progress) = progress else { return Ok(()) };
    let stage = blackboard.stage.lock().map_or_else(|poisoned| *poisoned.into_inner(), |stage| *stage);
    if stage.0.is_empty() {
        return Ok(());
    }
    let answer = progress.call1(stage)?;
    if answer.is(PyBool::new(py, false)) { Err(Failure::Cancelled) } else { Ok(()) }
}
