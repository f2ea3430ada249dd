//! Ctrl-C.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

/// How long the work may take to notice that it is to stop, before the process ends over its head. Longer, and Ctrl-C seems
/// dead during a stage that never asks; shorter, and stages that ask now and then are not left to end in order.
const PATIENCE: Duration = Duration::from_millis(700);

/// A flag that Ctrl-C raises, and the unfinished outputs that must not stay behind.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    is_raised: AtomicBool,
    unfinished: Mutex<Unfinished>,
}

/// What a process that ends at once would leave behind.
#[derive(Debug, Default)]
pub(crate) struct Unfinished {
    folders: Vec<PathBuf>,
    is_committed: bool,
}

impl Unfinished {
    /// Declares the outputs to be in place: an interrupt comes too late.
    pub(crate) fn commit(&mut self) {
        self.is_committed = true;
    }
}

impl Interrupt {
    /// Listens for Ctrl-C and requests to terminate, from now on and for as long as the process lives.
    ///
    /// # Errors
    /// Where the system refuses.
    pub(crate) fn listen() -> Result<Self, ctrlc::Error> {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        ctrlc::set_handler(move || {
            heard.shared.is_raised.store(true, Ordering::SeqCst);
            thread::sleep(PATIENCE);
            // Waits for outputs that are just being put in place: those are all there or none.
            let unfinished = heard.unfinished();
            if unfinished.is_committed {
                return;
            }
            unfinished.folders.iter().for_each(|folder| drop(std::fs::remove_dir_all(folder)));
            let error = crate::command_error::CommandError::Interrupted;
            crate::console::print_error(&error, std::env::args_os().any(|argument| argument == "--json"));
            std::process::exit(error.exit_code().into());
        })?;
        Ok(interrupt)
    }

    pub(crate) fn is_raised(&self) -> bool {
        self.shared.is_raised.load(Ordering::SeqCst)
    }

    /// Remembers a folder to remove should the process have to end at once.
    pub(crate) fn add_unfinished(&self, folder: &Path) {
        self.unfinished().folders.push(folder.to_owned());
    }

    /// Keeps the process from ending over the head of its work for as long as the guard lives.
    pub(crate) fn unfinished(&self) -> MutexGuard<'_, Unfinished> {
        // The list stays whole whatever thread panicked with it.
        self.shared.unfinished.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
