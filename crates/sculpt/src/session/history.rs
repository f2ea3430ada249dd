//! Undo and redo: the strokes done and undone, each with the difference to its other state.

use std::collections::VecDeque;

use super::{History, log::Logged, surface::delta::SurfaceDelta};

/// A stroke or remesh with the difference between the states before and after it.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) logged: Logged,
    pub(super) delta: SurfaceDelta,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Steps {
    /// Strokes that can no longer be undone.
    pub(super) forgotten: Vec<Logged>,
    pub(super) done: VecDeque<Step>,
    /// The last one is the next to redo.
    pub(super) undone: Vec<Step>,
}

impl Steps {
    /// Adds a new stroke and discards the undone ones. Forgets the oldest strokes until at most
    /// `most` bytes are in use, but keeps the last stroke. Returns the number of forgotten strokes.
    pub(super) fn push(&mut self, step: Step, most: usize) -> usize {
        self.undone.clear();
        self.done.push_back(step);
        let mut bytes = self.bytes();
        let mut dropped = 0;
        while bytes > most && self.done.len() > 1 {
            let Some(oldest) = self.done.pop_front() else { break };
            bytes -= oldest.bytes();
            self.forgotten.push(oldest.logged);
            dropped += 1;
        }
        dropped
    }

    pub(super) fn bytes(&self) -> usize {
        self.done.iter().chain(&self.undone).map(Step::bytes).sum()
    }

    pub(super) fn history(&self) -> History {
        History {
            undoable: self.done.len(),
            redoable: self.undone.len(),
            forgotten: self.forgotten.len(),
            bytes: self.bytes(),
        }
    }
}

impl Step {
    pub(super) fn bytes(&self) -> usize {
        self.delta.bytes()
            + self.logged.path.as_ref().map_or(0, |path| path.keys.capacity() * size_of::<crate::recipe::Key>())
    }
}
