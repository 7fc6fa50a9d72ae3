//! What condenses bodies on meshes in place of the processor: a GPU, or what a test has for one.

pub mod adapter;
pub mod precision;
pub mod device_solver;
pub mod making;
pub mod rates;
pub mod joints;
pub mod drawn;
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
use crate::engine::question::counted::Told;
use drawn::DrawnDesigns;
use joints::{JointBatch, SolvedJoints};

/// The works of the ring modes on each body of each group, packed, without near fields; `None` for a body that is left to the processor.
pub type Works = Vec<Vec<Option<Vec<f64>>>>;

/// What a device is given at a time: it has work while the processor reads what it has done.
pub const IN_FLIGHT: usize = 2;

/// What was asked of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub dispatches: u64,
    pub submits: u64,
    pub waits: u64,
    /// Waits that the next flight was on the device for.
    pub waits_with_work: u64,
    pub new_buffers: u64,
    pub bytes_up: u64,
    pub bytes_down: u64,
    /// Time of all passes on the device, where it is timed.
    pub busy: Duration,
}

impl Counts {
    /// With those of another stage.
    pub fn and(self, other: Counts) -> Counts {
        Counts {
            dispatches: self.dispatches + other.dispatches,
            submits: self.submits + other.submits,
            waits: self.waits + other.waits,
            waits_with_work: self.waits_with_work + other.waits_with_work,
            new_buffers: self.new_buffers + other.new_buffers,
            bytes_up: self.bytes_up + other.bytes_up,
            bytes_down: self.bytes_down + other.bytes_down,
            busy: self.busy + other.busy,
        }
    }
}

/// Condenses bodies, and may be lost. After an error nothing may be asked of it again but what it has done.
pub trait Device: Send + Sync {
    /// Gives it the bodies of some groups, and does not wait for them if it can work alone.
    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError>;

    /// Waits for what was begun before all else that is not finished.
    fn finish(&mut self) -> Result<Works, GpuError>;

    /// What the rounding of its works leaves of a force, relative, at most.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// Which joints it has a kernel for.
    fn solves_joints(&self) -> SolvedJoints {
        SolvedJoints::None
    }

    /// Gives it joints that it solves, and does not wait for them if it can work alone.
    fn begin_joints(&mut self, _: &JointBatch) -> Result<(), GpuError> {
        Ok(())
    }

    /// The same of joints with bodies that it condenses for them, those of some groups, whose works stay there. False where it has no room
    /// for all of them together, or condenses otherwise: nothing is begun then.
    fn begin_whole(&mut self, _: &[Group], _: &JointBatch) -> Result<bool, GpuError> {
        Ok(false)
    }

    /// Has it draw designs, solve their joints and count their rows, and does not wait for them. False where it has no kernel for that, or
    /// no room: nothing is begun then.
    fn begin_drawn(&mut self, _: &DrawnDesigns) -> Result<bool, GpuError> {
        Ok(false)
    }

    /// Waits for the joints that were begun before all others: what the kernel has found (`joints::states`), one joint after another.
    fn finish_joints(&mut self) -> Result<Vec<f32>, GpuError> {
        Ok(Vec::new())
    }

    /// The same of joints whose rows were to be counted: what is told of as many as had room at a time, in their order.
    fn finish_answers(&mut self) -> Result<Vec<Told>, GpuError> {
        Ok(Vec::new())
    }

    /// Where the time went, in the order the stages run.
    fn stages(&self) -> Vec<(&'static str, Duration)>;

    /// What elimination and joints have asked of it.
    fn counts(&self) -> Counts {
        Counts::default()
    }

    /// The greatest true residual of an iteration that works rest on.
    fn worst_residual(&self) -> f64;

    /// Columns of rings that were solved for by iteration.
    fn solves(&self) -> u64;
}
