//! Progress and cancellation of long work.

/// Watches long work: hears how far it is, and may stop it.
pub trait Monitor: Sync {
    /// Called now and then, from any thread, with the stage at work and the share of it that is done, from 0 to 1.
    fn update(&self, _stage: &'static str, _done: f64) {}

    /// Asked now and then, from any thread; true ends the work with [`Cancelled`].
    fn is_cancelled(&self) -> bool {
        false
    }

    /// [`update`](Self::update), then an error if the work is to stop.
    ///
    /// # Errors
    /// [`Cancelled`] when [`is_cancelled`](Self::is_cancelled) says so.
    fn check(&self, stage: &'static str, done: f64) -> Result<(), Cancelled> {
        self.update(stage, done);
        self.check_cancelled()
    }

    /// An error if the work is to stop.
    ///
    /// # Errors
    /// [`Cancelled`] when [`is_cancelled`](Self::is_cancelled) says so.
    fn check_cancelled(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// A monitor that hears nothing and stops nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Monitor for NoProgress {}

/// The work was stopped by its [`Monitor`]; it left nothing half done behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;
