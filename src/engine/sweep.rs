//! Designs x plan x backend -> outcomes in design order.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Duration;

use crate::engine::outcome::DesignOutcome;
use crate::error::Error;

/// What a sweep did, for the summary and the manifest.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    pub designs: u64,
    pub steps: u64,
    pub distinct_bodies: u64,
    /// Steps by status.
    pub statuses: BTreeMap<String, u64>,
    /// Wall time of each stage, in the order they run, summed over threads.
    pub stages: Vec<(&'static str, Duration)>,
    /// True when the receiver ended the sweep before its last design.
    pub interrupted: bool,
}

/// Hands every outcome to `receive`, in design order whatever the threads, until it breaks.
pub type Receive<'a> = &'a mut dyn FnMut(DesignOutcome) -> Result<ControlFlow<()>, Error>;
