use super::context::{GpuDevice, GpuError};
use super::kernels::Precision;
use crate::engine::backend::Backend;
use crate::engine::outcome::DesignOutcome;
use crate::study::config::SolveOptions;
use crate::study::design::DesignCase;
use std::time::Duration;

/// A device, and the numbers to compute in.
#[derive(Clone, Copy)]
pub struct GpuChoice<'a> {
    pub device: &'a GpuDevice,
    pub precision: Precision,
}
pub struct GpuBackend<'a> {
    choice: GpuChoice<'a>,
}
impl<'a> GpuBackend<'a> {
    pub fn new(choice: GpuChoice<'a>, _options: SolveOptions) -> Result<GpuBackend<'a>, GpuError> {
        Ok(GpuBackend { choice })
    }
}
impl Backend for GpuBackend<'_> {
    fn solve(&mut self, _cases: &[DesignCase]) -> Result<Vec<DesignOutcome>, GpuError> {
        Err(GpuError::NoAdapter)
    }
    fn batch_size(&self) -> usize {
        1024
    }
    fn stages(&self) -> Vec<(&'static str, Duration)> {
        Vec::new()
    }
}
