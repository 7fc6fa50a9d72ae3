//! How a device condenses bodies.

/// By elimination or by iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceSolver {
    /// What is the least work: elimination, and the processor where a mesh is too fine for it.
    Auto,
    /// Elimination, and the processor where a mesh is too fine for it.
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
