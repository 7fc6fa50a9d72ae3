//! Which device condenses bodies, and how.

use crate::engine::backend::gpu::context::GpuDevice;
use crate::engine::backend::precision::Precision;

/// A device, the numbers to compute in, and by what.
#[derive(Clone, Copy)]
pub struct GpuChoice<'a> {
    pub device: &'a GpuDevice,
    pub precision: Precision,
    pub solver: DeviceSolver,
}

impl<'a> GpuChoice<'a> {
    /// By the solver that suits each mesh.
    pub fn new(device: &'a GpuDevice, precision: Precision) -> GpuChoice<'a> {
        GpuChoice { device, precision, solver: DeviceSolver::Auto }
    }
}

/// By elimination or by iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceSolver {
    /// Elimination; conjugate gradients where a mesh is too fine for it.
    #[default]
    Auto,
    /// Elimination; the processor where a mesh is too fine for it.
    Eliminate,
    /// Conjugate gradients with Jacobi's preconditioner.
    Pcg,
}

impl DeviceSolver {
    /// The name on the command line and in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            DeviceSolver::Auto => "auto",
            DeviceSolver::Eliminate => "eliminate",
            DeviceSolver::Pcg => "pcg",
        }
    }
}
