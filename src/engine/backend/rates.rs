//! How fast a device condenses bodies beside the processor of the same machine.

use serde::{Deserialize, Serialize};

/// What was measured on one machine. Rates are times over those that `unit_costs` says of the processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Of condensation on one thread of the processor.
    pub processor: f64,
    /// On the device.
    pub device: f64,
    /// What one thread of the processor does for a body of the device, s.
    pub host: f64,
    /// Until the device has its kernels, s.
    pub start: f64,
}

impl Rates {
    /// As many threads of the processor condense as fast as the device does.
    pub fn threads(&self) -> f64 {
        self.processor / self.device
    }

    /// Whether these are rates at all, as what was kept in a file need not be.
    pub fn are_sound(&self) -> bool {
        let is_time = |time: f64| time.is_finite() && time > 0.0;
        [self.processor, self.device, self.host, self.start].into_iter().all(is_time)
    }
}
