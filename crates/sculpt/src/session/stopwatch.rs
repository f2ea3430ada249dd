//! Wall time, where there is a clock.

/// Measures stages one after the other.
#[derive(Debug)]
pub(super) struct Stopwatch {
    #[cfg(not(all(target_arch = "wasm32", target_os = "unknown")))]
    last: std::time::Instant,
}

#[cfg(not(all(target_arch = "wasm32", target_os = "unknown")))]
impl Stopwatch {
    pub(super) fn start() -> Self {
        Self { last: std::time::Instant::now() }
    }

    /// Seconds since the last call.
    pub(super) fn lap(&mut self) -> f64 {
        let now = std::time::Instant::now();
        (now - std::mem::replace(&mut self.last, now)).as_secs_f64()
    }
}

/// The bare web target has no clock, and asking for the time there panics.
#[cfg(all(target_arch = "wasm32", target_os = "unknown"))]
impl Stopwatch {
    pub(super) fn start() -> Self {
        Self {}
    }

    pub(super) fn lap(&mut self) -> f64 {
        0.0
    }
}
