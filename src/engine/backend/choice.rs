//! Which device condenses bodies, in which numbers, and by what.

use crate::engine::backend::adapter::{AdapterKind, GpuError};
use crate::engine::backend::device_solver::DeviceSolver;
use crate::engine::backend::gpu::context::GpuDevice;
use crate::engine::backend::gpu::solver::GpuCondenser;
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::backend::making::Making;
use crate::engine::backend::precision::Precision;

/// A device and how it computes.
#[derive(Clone, Copy)]
pub struct GpuChoice<'a> {
    pub device: &'a GpuDevice,
    pub precision: Precision,
    pub solver: DeviceSolver,
    /// Which joints are the device's, too.
    pub joints: SolvedJoints,
    /// Tests may have kernels that are watched.
    pub making: Making,
}

/// Designs of a batch: on meshes enough to keep a large device busy together with those of other crews, few enough to stay in caches here; of
/// interpolated ones, which are little work each, more.
const BATCH: usize = 8192;
const INTERPOLATED_BATCH: usize = 16_384;

/// Of those that a device draws it has nothing to wait for but its own kernels.
const DRAWN_BATCH: usize = 65_536;

/// The same on software, whose user waits.
const SOFTWARE_BATCH: usize = 256;

impl<'a> GpuChoice<'a> {
    /// By the solver that suits each mesh; with joints where single precision is good enough for them, but for software, which is slower than the
    /// processor itself.
    pub fn new(device: &'a GpuDevice, precision: Precision) -> GpuChoice<'a> {
        let joints = match device.facts.kind {
            AdapterKind::Software => SolvedJoints::None,
            _ => joints_in(precision),
        };
        GpuChoice { device, precision, solver: DeviceSolver::Auto, joints, making: Making::Trusted }
    }

    /// Designs of a batch that keeps the device busy.
    pub fn batch_size(&self, are_interpolated: bool) -> usize {
        match self.device.facts.kind {
            AdapterKind::Software => SOFTWARE_BATCH,
            _ if are_interpolated => INTERPOLATED_BATCH,
            _ => BATCH,
        }
    }

    /// Whether the device may draw designs itself, whose rows it counts.
    pub fn draws(&self) -> bool {
        self.joints >= SolvedJoints::Interpolated && self.device.facts.features.f64
    }

    /// Designs of a batch that it draws.
    pub fn drawn_batch_size(&self) -> usize {
        match self.device.facts.kind {
            AdapterKind::Software => SOFTWARE_BATCH,
            _ => DRAWN_BATCH,
        }
    }

    /// The device with its kernels.
    pub fn condenser(&self) -> Result<GpuCondenser<'a>, GpuError> {
        Ok(GpuCondenser::new(self.device, self.precision, self.solver, self.making)?
            .solving_joints(self.joints))
    }
}

/// Which joints a device solves that computes in these numbers.
pub fn joints_in(precision: Precision) -> SolvedJoints {
    match precision {
        Precision::F64 => SolvedJoints::None,
        Precision::Mixed => SolvedJoints::Interpolated,
        Precision::F32 => SolvedJoints::All,
    }
}
