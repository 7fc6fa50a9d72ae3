//! What stands in for `gpu` in a program that is built without GPUs: the same names, and no device to be had.

/// No adapters, and why.
pub mod context {
    use std::convert::Infallible;

    pub use crate::engine::backend::adapter::{
        AdapterChoice, AdapterFacts, AdapterKind, DeviceFeatures, DeviceLimits, GpuError,
    };

    pub struct Adapters {
        pub facts: Vec<AdapterFacts>,
    }

    impl Adapters {
        /// None.
        pub fn enumerate() -> Adapters {
            Adapters { facts: Vec::new() }
        }

        /// Always an error.
        pub fn open(&self, _: AdapterChoice) -> Result<GpuDevice, GpuError> {
            Err(GpuError::NotBuilt)
        }
    }

    /// Always an error.
    pub fn choose(_: &[AdapterFacts], _: AdapterChoice) -> Result<usize, GpuError> {
        Err(GpuError::NotBuilt)
    }

    /// Never.
    pub fn is_guarded() -> bool {
        false
    }

    /// There is none.
    #[derive(Clone)]
    pub struct GpuDevice {
        pub facts: AdapterFacts,
        pub(super) none: Infallible,
    }
}

pub mod kernels {
    pub use crate::engine::backend::precision::Precision;
}

pub mod calibration {
    use super::context::{GpuDevice, GpuError};
    use super::kernels::Precision;
    use crate::engine::backend::device_solver::DeviceSolver;
    use crate::engine::backend::joints::SolvedJoints;
    use crate::engine::backend::rates::Rates;

    /// Of no device.
    pub fn measure(
        gpu: &GpuDevice,
        _: Precision,
        _: DeviceSolver,
        _: SolvedJoints,
    ) -> Result<Rates, GpuError> {
        match gpu.none {}
    }
}

pub mod solver {
    use std::convert::Infallible;
    use std::marker::PhantomData;
    use std::time::Duration;

    use super::context::{GpuDevice, GpuError};
    use super::kernels::Precision;
    use crate::engine::backend::device_solver::DeviceSolver;
    use crate::engine::backend::joints::SolvedJoints;
    use crate::engine::backend::making::Making;
    use crate::engine::backend::{Device, Works};
    use crate::engine::body_request::Group;

    /// There is none.
    pub struct GpuCondenser<'a>(Infallible, PhantomData<&'a GpuDevice>);

    impl<'a> GpuCondenser<'a> {
        pub fn new(
            gpu: &'a GpuDevice,
            _: Precision,
            _: DeviceSolver,
            _: Making,
        ) -> Result<GpuCondenser<'a>, GpuError> {
            match gpu.none {}
        }

        pub fn sharing(self, _: usize) -> GpuCondenser<'a> {
            match self.0 {}
        }

        pub fn solving_joints(self, _: SolvedJoints) -> GpuCondenser<'a> {
            match self.0 {}
        }
    }

    impl Device for GpuCondenser<'_> {
        fn begin(&mut self, _: &[Group]) -> Result<(), GpuError> {
            match self.0 {}
        }

        fn finish(&mut self) -> Result<Works, GpuError> {
            match self.0 {}
        }

        fn stages(&self) -> Vec<(&'static str, Duration)> {
            match self.0 {}
        }

        fn worst_residual(&self) -> f64 {
            match self.0 {}
        }

        fn solves(&self) -> u64 {
            match self.0 {}
        }
    }
}
