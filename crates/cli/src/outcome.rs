//! Result of a command that finished its work.

use std::process::ExitCode;

/// Whether a finished command kept the promises of its recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    Done,
    PromiseMissed,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::SUCCESS,
            Outcome::PromiseMissed => Self::from(1),
        }
    }
}
