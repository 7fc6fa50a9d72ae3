//! Time that passes, where the platform tells it.

use std::time::Duration;

/// Runs from its start on.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(#[cfg(not(target_family = "wasm"))] std::time::Instant);

impl Stopwatch {
    pub fn start() -> Stopwatch {
        Stopwatch(
            #[cfg(not(target_family = "wasm"))]
            std::time::Instant::now(),
        )
    }

    /// Since its start; nothing in WebAssembly, which has no clock of its own.
    pub fn elapsed(&self) -> Duration {
        #[cfg(target_family = "wasm")]
        return Duration::ZERO;
        #[cfg(not(target_family = "wasm"))]
        self.0.elapsed()
    }
}
