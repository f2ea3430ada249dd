//! Wall time.

use web_time::Instant;

/// Measures stages one after the other.
#[derive(Debug)]
pub(super) struct Stopwatch {
    last: Instant,
}

impl Stopwatch {
    pub(super) fn start() -> Self {
        Self { last: Instant::now() }
    }

    /// Seconds since the last call.
    pub(super) fn lap(&mut self) -> f64 {
        let now = Instant::now();
        (now - std::mem::replace(&mut self.last, now)).as_secs_f64()
    }
}
