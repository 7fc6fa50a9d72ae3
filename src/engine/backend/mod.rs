//! What condenses bodies on meshes in place of the processor: a GPU, or what a test has for one.

pub mod adapter;
pub mod precision;
pub mod device_solver;
pub mod rates;
pub mod joints;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(not(feature = "gpu"))]
pub mod without_gpu;
pub mod choice;

use std::time::Duration;

use adapter::GpuError;
#[cfg(not(feature = "gpu"))]
pub use without_gpu as gpu;

use crate::engine::body_request::Group;
use joints::{JointGroup, JointStates};

/// The works of the ring modes on each body of each group, packed, without near fields; `None` for a body that is left to the processor.
pub type Works = Vec<Vec<Option<Vec<f64>>>>;

/// What a device is given at a time: it has work while the processor reads what it has done.
pub const IN_FLIGHT: usize = 2;

/// Condenses bodies, and may be lost. After an error nothing may be asked of it again but what it has done.
pub trait Device: Send + Sync {
    /// Gives it the bodies of some groups, and does not wait for them if it can work alone.
    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError>;

    /// Waits for what was begun before all else that is not finished.
    fn finish(&mut self) -> Result<Works, GpuError>;

    /// Whether it has a kernel for interpolated joints.
    fn solves_joints(&self) -> bool {
        false
    }

    /// The states of interpolated joints of each group, in their order; `None` for a joint with a load that has none. Only of a
    /// device that `solves_joints`.
    fn joints(&mut self, _: &[JointGroup]) -> Result<Vec<Vec<Option<JointStates>>>, GpuError> {
        Ok(Vec::new())
    }

    /// Where the time went, in the order the stages run.
    fn stages(&self) -> Vec<(&'static str, Duration)>;

    /// The greatest true residual of an iteration that works rest on.
    fn worst_residual(&self) -> f64;

    /// Columns of rings that were solved for by iteration.
    fn solves(&self) -> u64;
}
