//! The numbers a device computes in.

use crate::engine::backend::adapter::{AdapterFacts, GpuError};
use crate::mechanics::solve::pcg::ALLOWED_DRIFT;
use crate::mechanics::solve::refine::RefineSettings;

/// The numbers the kernels compute in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    F32,
    F64,
    /// The iteration in f32, all else in f64.
    Mixed,
}

/// From this accuracy on f32 alone does.
const ROUGH: f64 = 1e-3;

impl Precision {
    /// Of a number of the iteration.
    pub const fn real_bytes(self) -> u64 {
        match self {
            Precision::F32 | Precision::Mixed => 4,
            Precision::F64 => 8,
        }
    }

    /// Of a number of any other stage: matrices, solutions, residuals, norms, compliances.
    pub const fn wide_bytes(self) -> u64 {
        match self {
            Precision::F32 => 4,
            Precision::F64 | Precision::Mixed => 8,
        }
    }

    /// Of a number of any stage but the iteration.
    pub const fn wide_epsilon(self) -> f64 {
        if self.wide_bytes() == 4 { f32::EPSILON as f64 } else { f64::EPSILON }
    }

    /// Whether the iteration needs matrices of its own.
    pub const fn narrows(self) -> bool {
        self.real_bytes() != self.wide_bytes()
    }

    /// The name on the command line and in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
            Precision::Mixed => "mixed",
        }
    }

    /// The numbers that are best for an accuracy, relative, of the force: f32 where that is enough, since contact is then the
    /// device's, too; else refined in f64, where the adapter has it.
    pub fn preferred(facts: &AdapterFacts, accuracy: f64) -> Precision {
        if facts.features.f64 { Precision::suited(accuracy) } else { Precision::F32 }
    }

    /// The same of an adapter that has f64.
    pub fn suited(accuracy: f64) -> Precision {
        if accuracy < ROUGH { Precision::Mixed } else { Precision::F32 }
    }

    /// Whether an adapter has these numbers.
    pub fn check(self, facts: &AdapterFacts) -> Result<(), GpuError> {
        if self.wide_bytes() == 8 && !facts.features.f64 {
            return Err(GpuError::Lacks { adapter: facts.name.clone(), what: "f64".into() });
        }
        Ok(())
    }

    /// How far to solve for what the rounding permits in f32, 1e-8 in mixed and 1e-10 in f64, relative, of the
    /// compliance.
    ///
    /// Measured on every shape and support at grading levels 1 and 3, plane strain, nu = 0.1 to 0.4999: the error of
    /// the compliance is the square of the true residual, times 0.1 to 10. In f32 rounding leaves 1e-6 to 5e-6 (block
    /// on its base: 5e-4, of which contact feels 1e-4), which a residual of 1e-3 does not add to. In mixed precision the iteration stalls at 2e-5
    /// (block on its base: 2e-3; nu = 0.4999: 0.1 to 1), and going there in one sweep takes fewer steps than two rounds
    /// to 1e-3, because conjugate gradients gain speed as they go. A second round is enough up to nu = 0.499, a third beyond, where the block on its
    /// base takes 16,000 steps and a concentric body 2,000.
    pub const fn settings(self) -> RefineSettings {
        let (tolerance, round_limit) = match self {
            Precision::F32 => (1e-3, 0),
            Precision::F64 => (3e-6, 0),
            Precision::Mixed => (1e-5, 3),
        };
        let goal = match self {
            Precision::Mixed => 3e-5,
            _ => ALLOWED_DRIFT * tolerance,
        };
        RefineSettings { tolerance, goal, round_limit, iteration_limit: 20_000 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::backend::adapter::{AdapterKind, DeviceFeatures, DeviceLimits};

    /// Below 0.1 % only, and where there is any.
    #[test]
    fn f64_is_used_where_it_is_needed() {
        let facts = |f64| AdapterFacts {
            name: String::new(),
            kind: AdapterKind::Discrete,
            driver: String::new(),
            limits: DeviceLimits::default(),
            features: DeviceFeatures { f64, subgroups: true, timestamps: true },
        };
        for (has_f64, accuracy, expected) in [
            (true, 1e-2, Precision::F32),
            (true, 1e-3, Precision::F32),
            (true, 9e-4, Precision::Mixed),
            (false, 1e-5, Precision::F32),
        ] {
            assert_eq!(Precision::preferred(&facts(has_f64), accuracy), expected, "{has_f64} {accuracy}");
        }
    }
}
