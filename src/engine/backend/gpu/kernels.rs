//! The pipelines of the kernels on a device.

use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use wgpu::ShaderStages;

use super::batch::{KernelFacts, OnChip};
use super::context::{AdapterKind, GpuDevice, GpuError, MadeKernel};
use super::front::Front;
use super::kernel_texts::Access::{self, Read, Uniform, Written};
use super::kernel_texts::{
    ASSEMBLE, CONDENSE, ELIMINATE, KernelFile, NARROW, PCG, REFINE, Sums, Variant, WORKS,
};
use super::shared_data::{SharedData, SharedPlace};
pub use crate::engine::backend::making::Making;
pub use crate::engine::backend::precision::Precision;

impl Precision {
    /// Wide numbers as the device stores them.
    pub fn encode(self, numbers: &[f64]) -> Vec<u8> {
        match self.wide_bytes() {
            4 => numbers.iter().flat_map(|&number| (number as f32).to_le_bytes()).collect(),
            _ => bytemuck::cast_slice(numbers).to_vec(),
        }
    }

    /// Wide numbers that the device has stored.
    pub fn decode(self, bytes: &[u8]) -> Vec<f64> {
        match self.wide_bytes() {
            4 => bytes.as_chunks().0.iter().map(|number| f64::from(f32::from_le_bytes(*number))).collect(),
            _ => bytemuck::pod_collect_to_vec(bytes),
        }
    }
}

/// Pipelines of one file, in the order of its entry points.
#[derive(Clone)]
pub struct Stage {
    pub bindings: &'static [(&'static str, Access)],
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
    making: Making,
}

/// All kernels in one precision.
pub struct Kernels<'a> {
    pub gpu: &'a GpuDevice,
    pub precision: Precision,
    pub invocations: u32,
    pub assemble: Stage,
    around_iteration: OnceLock<AroundIteration>,
    pcg: Mutex<HashMap<OnChip, Stage>>,
    eliminate: Mutex<HashMap<Front, Stage>>,
    shared: Mutex<SharedData>,
    sums: Sums,
    pub making: Making,
}

/// What conjugate gradients need beside `pcg`: elimination has no use for them.
pub struct AroundIteration {
    /// Where the iteration needs matrices of its own.
    pub narrow: Option<Stage>,
    pub refine: Stage,
    pub condense: Stage,
    pub works: Stage,
}

impl<'a> Kernels<'a> {
    /// `invocations`: of a workgroup, a power of two.
    pub fn new(
        gpu: &'a GpuDevice,
        precision: Precision,
        invocations: u32,
        making: Making,
    ) -> Result<Kernels<'a>, GpuError> {
        let sums = if gpu.facts.features.subgroups { Sums::Subgroups } else { Sums::Tree };
        Kernels::build(gpu, precision, invocations, sums, making)
    }

    /// With sums as the twins take them, to the bit.
    pub fn with_tree(
        gpu: &'a GpuDevice,
        precision: Precision,
        invocations: u32,
        making: Making,
    ) -> Result<Kernels<'a>, GpuError> {
        Kernels::build(gpu, precision, invocations, Sums::Tree, making)
    }

    fn build(
        gpu: &'a GpuDevice,
        precision: Precision,
        invocations: u32,
        sums: Sums,
        making: Making,
    ) -> Result<Kernels<'a>, GpuError> {
        let lacks = |what: &str| GpuError::Lacks { adapter: gpu.facts.name.clone(), what: what.to_string() };
        precision.check(&gpu.facts)?;
        if !invocations.is_power_of_two() || invocations > gpu.facts.limits.invocations_per_workgroup {
            return Err(lacks(&format!("workgroups of {invocations} invocations")));
        }
        let variant = Variant { sums, ..Variant::plain(precision, invocations) };
        Ok(Kernels {
            gpu,
            precision,
            invocations,
            assemble: Stage::new(gpu, &ASSEMBLE, &variant, making)?,
            around_iteration: OnceLock::new(),
            pcg: Mutex::default(),
            eliminate: Mutex::default(),
            shared: Mutex::default(),
            sums,
            making,
        })
    }

    /// Made when they are first asked for.
    pub fn around_iteration(&self) -> Result<&AroundIteration, GpuError> {
        if let Some(made) = self.around_iteration.get() {
            return Ok(made);
        }
        let variant = Variant { sums: self.sums, ..Variant::plain(self.precision, self.invocations) };
        let stage = |file| Stage::new(self.gpu, file, &variant, self.making);
        let made = AroundIteration {
            narrow: self.precision.narrows().then(|| stage(&NARROW)).transpose()?,
            refine: stage(&REFINE)?,
            condense: stage(&CONDENSE)?,
            works: stage(&WORKS)?,
        };
        Ok(self.around_iteration.get_or_init(|| made))
    }

    /// The iteration with so much on chip; made when it is first asked for.
    pub fn pcg(&self, on_chip: OnChip) -> Result<Stage, GpuError> {
        self.kept(&self.pcg, on_chip, &PCG, |variant| variant.on_chip = on_chip)
    }

    /// Elimination with such a front; made when it is first asked for.
    pub fn eliminate(&self, front: Front) -> Result<Stage, GpuError> {
        let invocations = match self.gpu.facts.kind {
            AdapterKind::Software => self.invocations,
            _ => self.invocations.max(front.invocations()),
        };
        self.kept(&self.eliminate, front, &ELIMINATE, |variant| {
            (variant.front, variant.invocations) = (front, invocations)
        })
    }

    /// Uploads what the bodies of a topology share: lists, and numbers of which those behind each other begin at whole vectors.
    pub fn share(&self, lists: &[u32], numbers: &[f64]) -> Result<SharedPlace, GpuError> {
        // A thread that panicked has left at most a hole.
        let mut shared = self.shared.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let (precision, wide) = (self.precision, self.precision.wide_bytes());
        shared.place(self.gpu, lists, &precision.encode(numbers), wide)
    }

    fn kept<K: Copy + Eq + std::hash::Hash>(
        &self,
        made: &Mutex<HashMap<K, Stage>>,
        key: K,
        file: &KernelFile,
        vary: impl FnOnce(&mut Variant),
    ) -> Result<Stage, GpuError> {
        // A thread that panicked has left the map whole.
        let mut made = made.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(stage) = made.get(&key) {
            return Ok(stage.clone());
        }
        let mut variant = Variant { sums: self.sums, ..Variant::plain(self.precision, self.invocations) };
        vary(&mut variant);
        let stage = Stage::new(self.gpu, file, &variant, self.making)?;
        made.insert(key, stage.clone());
        Ok(stage)
    }

    /// For the planner; the time is of the last dispatch.
    pub fn facts(&self, seconds_per_iteration: f64) -> KernelFacts {
        KernelFacts {
            bytes_per_real: self.precision.real_bytes(),
            bytes_per_wide: self.precision.wide_bytes(),
            invocations: u64::from(self.invocations),
            seconds_per_iteration,
        }
    }
}

impl Stage {
    /// Of so many that a dispatch needs those that it is made of: of kernels that do nothing one, since software takes its time for each.
    pub(crate) fn workgroups(&self, needed: u32) -> u32 {
        if self.making == Making::Empty { needed.min(1) } else { needed }
    }

    pub(crate) fn new(
        gpu: &GpuDevice,
        file: &KernelFile,
        variant: &Variant,
        making: Making,
    ) -> Result<Stage, GpuError> {
        Stage::with_functions(gpu, file, variant, "", making)
    }

    /// Of a kernel that lacks some functions, with these.
    pub(crate) fn with_functions(
        gpu: &GpuDevice,
        file: &KernelFile,
        variant: &Variant,
        functions: &str,
        making: Making,
    ) -> Result<Stage, GpuError> {
        let storage_buffers = file.storage_buffers();
        if storage_buffers > gpu.facts.limits.storage_buffers as usize {
            let what = format!("{storage_buffers} storage buffers");
            return Err(GpuError::Lacks { adapter: gpu.facts.name.clone(), what });
        }
        let source = match making {
            Making::Empty => file.empty(variant.invocations),
            Making::Trusted | Making::Checked => file.variant(variant) + functions,
        };
        let is_checked = making == Making::Checked;
        // A thread that panicked has left the map whole.
        let mut known = gpu.made.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let key = (file.name, source, is_checked);
        if let Some((layout, pipelines)) = known.get(&key).cloned() {
            return Ok(Stage { bindings: file.bindings, layout, pipelines, making });
        }
        let started = Instant::now();
        let made = gpu.checked(file.name, || Stage::build(&gpu.device, file, &key.1, is_checked))?;
        gpu.making.fetch_add(started.elapsed().as_nanos() as u64, Ordering::Relaxed);
        known.insert(key, made.clone());
        let (layout, pipelines) = made;
        Ok(Stage { bindings: file.bindings, layout, pipelines, making })
    }

    fn build(device: &wgpu::Device, file: &KernelFile, source: &str, is_checked: bool) -> MadeKernel {
        let entry = |(binding, (_, access)): (u32, &(&str, Access))| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match access {
                    Uniform => wgpu::BufferBindingType::Uniform,
                    Read => wgpu::BufferBindingType::Storage { read_only: true },
                    Written => wgpu::BufferBindingType::Storage { read_only: false },
                },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = (0..).zip(file.bindings).map(entry).collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(file.name),
            entries: &entries,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(file.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(file.name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        };
        let checks = match is_checked {
            true => wgpu::ShaderRuntimeChecks::checked(),
            false => wgpu::ShaderRuntimeChecks::unchecked(),
        };
        // SAFETY: the text is the crate's own. Its loops end and its divisors are sizes, which are not zero; its indices
        // stay within buffers that `SystemBatch` sizes by the layout they come from.
        let module = unsafe { device.create_shader_module_trusted(descriptor, checks) };
        let pipeline = |entry_point: &&'static str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    zero_initialize_workgroup_memory: is_checked,
                    ..Default::default()
                },
                cache: None,
            })
        };
        let pipelines = file.entry_points.iter().map(pipeline).collect();
        (layout, pipelines)
    }
}
