//! Progress and cancellation of long operations.

/// Observes the progress of a long operation and can cancel it.
///
/// ```
/// use isochore_mesh::{Monitor, SplitError, primitives};
///
/// struct Stop;
/// impl Monitor for Stop {
///     fn is_cancelled(&self) -> bool {
///         true
///     }
/// }
/// let split = primitives::icosphere(1.0, 1).split_to_length(0.1, 100_000, &Stop);
/// assert!(matches!(split, Err(SplitError::Cancelled(_))));
/// ```
pub trait Monitor: Sync {
    /// Called occasionally, from any thread, with the current stage and its completed fraction, 0
    /// to 1.
    fn update(&self, _stage: &'static str, _done: f64) {}

    /// Called occasionally, from any thread. Return `true` to end the operation with [`Cancelled`].
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Calls [`update`](Self::update), then [`check_cancelled`](Self::check_cancelled).
    ///
    /// # Errors
    /// [`Cancelled`] if [`is_cancelled`](Self::is_cancelled) returns `true`.
    fn check(&self, stage: &'static str, done: f64) -> Result<(), Cancelled> {
        self.update(stage, done);
        self.check_cancelled()
    }

    /// Turns a request to cancel into an error.
    ///
    /// # Errors
    /// [`Cancelled`] if [`is_cancelled`](Self::is_cancelled) returns `true`.
    fn check_cancelled(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// A monitor that ignores progress and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Monitor for NoProgress {}

/// The [`Monitor`] cancelled the operation. No partial result remains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;
