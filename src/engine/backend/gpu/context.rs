//! Devices: which adapters there are, what they can do, which one is taken, and opening it.
//!
//! The adapter is chosen here and not by wgpu, whose own choice may be a software adapter beside a real one, and
//! which panics on an environment variable that matches nothing.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

use foldhash::HashMap;

use super::layouts::Layouts;
pub use crate::engine::backend::adapter::{
    AdapterChoice, AdapterFacts, AdapterKind, DeviceFeatures, DeviceLimits, GpuError, choose,
};

/// Vulkan, on macOS Metal, on Windows Direct3D 12 too: wgpu is built with those of its system and knows no others.
const BACKENDS: wgpu::Backends =
    wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);

/// The adapters of this machine, in the order the drivers give.
pub struct Adapters {
    adapters: Vec<wgpu::Adapter>,
    pub facts: Vec<AdapterFacts>,
}

/// A kernel's name and text, and whether its indices are checked.
pub(super) type KernelKey = (&'static str, String, bool);

/// A kernel as the device has it.
pub(super) type MadeKernel = (wgpu::BindGroupLayout, Vec<wgpu::ComputePipeline>);

/// A device that is ready for work; a clone is the same device.
#[derive(Clone)]
pub struct GpuDevice {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub facts: AdapterFacts,
    /// Whether passes are timed.
    pub(super) is_timed: bool,
    /// What making kernels has taken, ns.
    pub(super) making: Arc<AtomicU64>,
    /// Those that were made: others ask for the same.
    pub(super) made: Arc<Mutex<HashMap<KernelKey, MadeKernel>>>,
    /// What is laid out for bodies that are eliminated on it.
    pub(super) layouts: Arc<Layouts>,
    /// Why it was lost, once it was.
    loss: Arc<OnceLock<String>>,
}

impl Adapters {
    /// Asks the drivers; none where there are no such drivers.
    pub fn enumerate() -> Adapters {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = BACKENDS;
        descriptor.flags = wgpu::InstanceFlags::empty();
        let instance = wgpu::Instance::new(descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(BACKENDS));
        let facts = adapters.iter().map(facts).collect();
        Adapters { adapters, facts }
    }

    /// Opens the adapter chosen, with all of its limits and the features of `DeviceFeatures` it has.
    pub fn open(&self, choice: AdapterChoice) -> Result<GpuDevice, GpuError> {
        let index = choose(&self.facts, choice)?;
        let (adapter, facts) = (&self.adapters[index], self.facts[index].clone());
        let wanted = wgpu::Features::SHADER_F64 | wgpu::Features::SUBGROUP | wgpu::Features::TIMESTAMP_QUERY;
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("jointsweep"),
            required_features: adapter.features() & wanted,
            required_limits: adapter.limits(),
            ..Default::default()
        });
        let (device, queue) = pollster::block_on(request).map_err(|error| GpuError::DeviceRefused {
            adapter: facts.name.clone(),
            problem: one_line(&error.to_string()),
        })?;
        let loss = Arc::new(OnceLock::new());
        let told = Arc::clone(&loss);
        device.set_device_lost_callback(move |reason, message| {
            let _ = told.set(one_line(&format!("{reason:?} {message}")));
        });
        Ok(GpuDevice {
            device,
            queue,
            facts,
            is_timed: false,
            making: Arc::default(),
            made: Arc::default(),
            layouts: Arc::default(),
            loss,
        })
    }
}

impl GpuDevice {
    /// With its passes timed, where it has a clock for them.
    pub fn timed(self) -> GpuDevice {
        GpuDevice { is_timed: self.facts.features.timestamps, ..self }
    }

    pub fn is_timed(&self) -> bool {
        self.is_timed
    }

    /// Time spent on making kernels so far.
    pub fn making_kernels(&self) -> Duration {
        Duration::from_nanos(self.making.load(Ordering::Relaxed))
    }

    /// The names of those that were made so far, once each.
    pub fn made_kernels(&self) -> BTreeSet<&'static str> {
        // A thread that panicked has left the map whole.
        let made = self.made.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        made.keys().map(|(name, ..)| *name).collect()
    }

    /// Runs `work` and gives what the device has to say against it: misuse, want of memory, or a kernel that a driver's compiler refuses.
    /// Without this, wgpu panics.
    pub fn checked<T>(&self, what: &'static str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let misuse = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let refusal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let done = work();
        let refusal = pollster::block_on(refusal.pop());
        let misuse = pollster::block_on(misuse.pop()).or(refusal);
        // A buffer that was refused is then misused.
        match pollster::block_on(memory.pop()).or(misuse) {
            None => Ok(done),
            Some(problem) => {
                // A loss is told while polling.
                let _ = self.poll(wgpu::PollType::Poll);
                let is_memory = matches!(problem, wgpu::Error::OutOfMemory { .. });
                let (adapter, problem) = (self.facts.name.clone(), one_line(&problem.to_string()));
                Err(match self.loss.get() {
                    Some(loss) => self.lost(loss),
                    None if is_memory => GpuError::OutOfMemory { adapter, what, problem },
                    None => GpuError::Failed { adapter, what, problem },
                })
            }
        }
    }

    /// Looks or waits for what the device has done.
    pub(super) fn poll(&self, how: wgpu::PollType) -> Result<(), GpuError> {
        if let Some(loss) = self.loss.get() {
            return Err(self.lost(loss));
        }
        // wgpu panics where the driver tells it of the loss just now; what it leaves is not used any more.
        let polled = guarded(|| self.device.poll(how).map_err(|error| error.to_string()));
        match polled.unwrap_or_else(|| Err("the driver has lost the device".into())) {
            Ok(_) => Ok(()),
            Err(problem) => {
                let _ = self.loss.set(one_line(&problem));
                Err(self.lost(&problem))
            }
        }
    }

    /// Letting go of a device that hangs may never end, so one handle of it is kept for good.
    pub(super) fn lost(&self, problem: &str) -> GpuError {
        std::mem::forget((self.device.clone(), self.queue.clone()));
        GpuError::Lost { adapter: self.facts.name.clone(), problem: one_line(problem) }
    }
}

thread_local! {
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread does what may panic and is caught: nobody needs to be told.
pub fn is_guarded() -> bool {
    IS_GUARDED.get()
}

/// What `work` gives back; nothing where it panics.
fn guarded<T>(work: impl FnOnce() -> T) -> Option<T> {
    IS_GUARDED.set(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    IS_GUARDED.set(false);
    done.ok()
}

/// wgpu's messages have many.
fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn facts(adapter: &wgpu::Adapter) -> AdapterFacts {
    let (info, limits, features) = (adapter.get_info(), adapter.limits(), adapter.features());
    AdapterFacts {
        name: info.name,
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
            wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
            wgpu::DeviceType::Other => AdapterKind::Other,
            wgpu::DeviceType::Cpu => AdapterKind::Software,
        },
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_string(),
        limits: DeviceLimits {
            binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
            workgroups_per_dimension: limits.max_compute_workgroups_per_dimension,
            workgroup_bytes: limits.max_compute_workgroup_storage_size,
            invocations_per_workgroup: limits.max_compute_invocations_per_workgroup,
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
        },
        features: DeviceFeatures {
            f64: features.contains(wgpu::Features::SHADER_F64),
            subgroups: features.contains(wgpu::Features::SUBGROUP),
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_guarded_work_is_no_more_than_nothing() {
        assert_eq!(guarded(|| is_guarded().then_some(7)), Some(Some(7)));
        assert!(!is_guarded());
        assert_eq!(guarded(|| -> u32 { panic!("as wgpu does where a device is lost") }), None);
        assert!(!is_guarded());
    }
}
