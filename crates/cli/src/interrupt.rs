//! Ctrl-C and requests to terminate.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use crate::command_error::CommandError;

/// Time that running work has to notice an interrupt before the process exits. Larger makes Ctrl-C
/// seem dead during a stage that never checks; smaller exits before a stage that checks rarely can
/// stop by itself.
const PATIENCE: Duration = Duration::from_millis(700);

/// A flag that Ctrl-C raises, and the temporary folders to remove before an immediate exit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    is_raised: AtomicBool,
    unfinished: Mutex<Unfinished>,
}

/// Temporary folders that an immediate exit would leave behind.
#[derive(Debug, Default)]
pub(crate) struct Unfinished {
    folders: Vec<PathBuf>,
    is_committed: bool,
}

impl Unfinished {
    /// Marks the outputs as complete; a later interrupt is ignored.
    pub(crate) fn commit(&mut self) {
        self.is_committed = true;
    }
}

impl Interrupt {
    /// Listens for Ctrl-C and requests to terminate until the process ends.
    ///
    /// # Errors
    /// The system refuses the handler.
    pub(crate) fn listen(is_json: bool) -> Result<Self, ctrlc::Error> {
        let interrupt = Self::default();
        let handled = interrupt.clone();
        ctrlc::set_handler(move || handled.exit_unless_committed(is_json))?;
        Ok(interrupt)
    }

    /// Raises the flag, waits for the work to stop by itself, and otherwise ends the process.
    fn exit_unless_committed(&self, is_json: bool) {
        self.shared.is_raised.store(true, Ordering::SeqCst);
        thread::sleep(PATIENCE);
        // A commit holds this lock, so the outputs are complete or untouched from here on.
        let unfinished = self.unfinished();
        if unfinished.is_committed {
            return;
        }
        for folder in &unfinished.folders {
            // The process ends either way; a folder that cannot be removed stays.
            let _ = std::fs::remove_dir_all(folder);
        }
        let error = CommandError::Interrupted;
        error.print(is_json);
        std::process::exit(error.exit_code().into());
    }

    pub(crate) fn is_raised(&self) -> bool {
        self.shared.is_raised.load(Ordering::SeqCst)
    }

    /// Registers a temporary folder to remove if the process must exit immediately.
    pub(crate) fn add_unfinished(&self, folder: &Path) {
        self.unfinished().folders.push(folder.to_owned());
    }

    /// Locks the list of temporary folders. The interrupt handler cannot end the process while the
    /// guard exists.
    pub(crate) fn unfinished(&self) -> MutexGuard<'_, Unfinished> {
        // A thread that panicked while holding the lock cannot have left the list inconsistent.
        self.shared.unfinished.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
