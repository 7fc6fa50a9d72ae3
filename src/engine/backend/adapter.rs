//! What is told of the adapters of a machine, with or without a GPU in it, and which one is taken.

use std::fmt;

/// Why there is no device to compute on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    #[error(
        "this jointsweep was built without GPUs: build it with `--features gpu`, or leave the choice to `--backend auto`"
    )]
    NotBuilt,
    #[error("no Vulkan adapter: a Vulkan driver and its loader (libvulkan.so.1) must be installed")]
    NoAdapter,
    #[error("no GPU, only {software}, which is software and slower than the processor itself")]
    OnlySoftware { software: String },
    #[error("no adapter is called `{wanted}`; there are: {}", .found.join(", "))]
    NoSuchAdapter { wanted: String, found: Vec<String> },
    #[error("{adapter} gives no device: {problem}")]
    DeviceRefused { adapter: String, problem: String },
    #[error("{adapter} lacks {what}")]
    Lacks { adapter: String, what: String },
    #[error("{adapter}, {what}: {problem}")]
    Failed { adapter: String, what: &'static str, problem: String },
    #[error("{adapter}, {what}: out of memory ({problem})")]
    OutOfMemory { adapter: String, what: &'static str, problem: String },
    #[error("{adapter} was lost: {problem}")]
    Lost { adapter: String, problem: String },
}

/// What an adapter is made of, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    Discrete,
    Integrated,
    /// A share of a GPU, lent to a virtual machine.
    Virtual,
    Other,
    /// Vulkan on the processor: as right as the others and never fast.
    Software,
}

impl fmt::Display for AdapterKind {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            AdapterKind::Discrete => "discrete GPU",
            AdapterKind::Integrated => "integrated GPU",
            AdapterKind::Virtual => "virtual GPU",
            AdapterKind::Other => "other",
            AdapterKind::Software => "software",
        })
    }
}

/// The limits that decide how a sweep is split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceLimits {
    /// Most bytes of one binding.
    pub binding_bytes: u64,
    /// Most bytes of one buffer.
    pub buffer_bytes: u64,
    pub workgroups_per_dimension: u32,
    /// Memory that the invocations of a workgroup share, bytes. wgpu does not check it (gfx-rs/wgpu#8946).
    pub workgroup_bytes: u32,
    pub invocations_per_workgroup: u32,
    pub storage_buffers: u32,
}

impl DeviceLimits {
    /// Most bytes of a buffer that a kernel can see whole.
    pub fn bound_buffer(&self) -> u64 {
        self.binding_bytes.min(self.buffer_bytes)
    }
}

/// What kernels may use beyond the common ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceFeatures {
    pub f64: bool,
    pub subgroups: bool,
    pub timestamps: bool,
}

/// An adapter in words and numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterFacts {
    pub name: String,
    pub kind: AdapterKind,
    /// Name and version of the driver.
    pub driver: String,
    pub limits: DeviceLimits,
    pub features: DeviceFeatures,
}

/// Which adapter is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdapterChoice<'a> {
    /// The best GPU; no software.
    Best,
    /// The best one, software too, whose name or driver holds this, in capitals or not.
    Named(&'a str),
}

/// The index of the adapter to take: by kind, then in the order given.
pub fn choose(adapters: &[AdapterFacts], choice: AdapterChoice) -> Result<usize, GpuError> {
    let best = |is_wanted: &dyn Fn(&AdapterFacts) -> bool| {
        let wanted = adapters.iter().enumerate().filter(|(_, adapter)| is_wanted(adapter));
        wanted.min_by_key(|(_, adapter)| adapter.kind).map(|(index, _)| index)
    };
    let Some(first) = adapters.first() else { return Err(GpuError::NoAdapter) };
    match choice {
        AdapterChoice::Best => best(&|adapter| adapter.kind != AdapterKind::Software)
            .ok_or_else(|| GpuError::OnlySoftware { software: first.name.clone() }),
        AdapterChoice::Named(wanted) => {
            let word = wanted.to_lowercase();
            let holds = |text: &str| text.to_lowercase().contains(&word);
            best(&|adapter| holds(&adapter.name) || holds(&adapter.driver)).ok_or_else(|| {
                let found = adapters.iter().map(|adapter| adapter.name.clone()).collect();
                GpuError::NoSuchAdapter { wanted: wanted.to_string(), found }
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: AdapterKind) -> AdapterFacts {
        let limits = DeviceLimits {
            binding_bytes: 1 << 27,
            buffer_bytes: 1 << 28,
            workgroups_per_dimension: 65_535,
            workgroup_bytes: 32_768,
            invocations_per_workgroup: 1024,
            storage_buffers: 8,
        };
        let features = DeviceFeatures { f64: true, subgroups: true, timestamps: true };
        AdapterFacts { name: name.into(), kind, driver: format!("{name}-driver 1.0"), limits, features }
    }

    #[test]
    fn a_real_gpu_comes_before_software_and_a_better_one_first() {
        let software = adapter("llvmpipe", AdapterKind::Software);
        let integrated = adapter("Iris", AdapterKind::Integrated);
        let discrete = adapter("H200", AdapterKind::Discrete);
        let twin = adapter("H200", AdapterKind::Discrete);
        let all = [software.clone(), integrated.clone(), discrete, twin];
        assert_eq!(choose(&all, AdapterChoice::Best), Ok(2));
        assert_eq!(choose(&[software, integrated], AdapterChoice::Best), Ok(1));
    }

    #[test]
    fn software_is_taken_only_by_name() {
        let all = [adapter("llvmpipe (LLVM 15)", AdapterKind::Software)];
        let only = GpuError::OnlySoftware { software: "llvmpipe (LLVM 15)".into() };
        assert_eq!(choose(&all, AdapterChoice::Best), Err(only));
        assert_eq!(choose(&all, AdapterChoice::Named("LLVMpipe")), Ok(0));
        assert_eq!(choose(&all, AdapterChoice::Named("driver 1")), Ok(0));
        let missing = GpuError::NoSuchAdapter { wanted: "H200".into(), found: vec![all[0].name.clone()] };
        assert_eq!(choose(&all, AdapterChoice::Named("H200")), Err(missing));
    }

    #[test]
    fn without_adapters_there_is_an_error_whatever_is_wanted() {
        for choice in [AdapterChoice::Best, AdapterChoice::Named("H200")] {
            assert_eq!(choose(&[], choice), Err(GpuError::NoAdapter));
        }
    }
}
