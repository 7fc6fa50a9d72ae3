//! The kernels: their text in each precision, and their pipelines on a device.

use wgpu::ShaderStages;

use super::context::{GpuDevice, GpuError};

/// The numbers a kernel computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    F32,
    F64,
}

impl Precision {
    pub const fn bytes(self) -> u64 {
        match self {
            Precision::F32 => 4,
            Precision::F64 => 8,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        }
    }

    /// Numbers as the device stores them.
    pub fn encode(self, numbers: &[f64]) -> Vec<u8> {
        match self {
            Precision::F32 => numbers.iter().flat_map(|&number| (number as f32).to_le_bytes()).collect(),
            Precision::F64 => bytemuck::cast_slice(numbers).to_vec(),
        }
    }

    /// Numbers that the device has stored.
    pub fn decode(self, bytes: &[u8]) -> Vec<f64> {
        match self {
            Precision::F32 => {
                bytemuck::pod_collect_to_vec::<u8, f32>(bytes).into_iter().map(f64::from).collect()
            }
            Precision::F64 => bytemuck::pod_collect_to_vec(bytes),
        }
    }
}

/// One file of kernels: its text, its entry points, and which of its storage bindings are written.
pub struct KernelFile {
    pub name: &'static str,
    pub text: &'static str,
    pub entry_points: &'static [&'static str],
    pub written: &'static [bool],
}

const COMMON: &str = include_str!("../../../../shaders/common.wgsl");

pub const ASSEMBLE: KernelFile = KernelFile {
    name: "assemble",
    text: include_str!("../../../../shaders/assemble.wgsl"),
    entry_points: &["assemble"],
    written: &[false, false, false, false, false, true, true, true],
};

pub const PCG: KernelFile = KernelFile {
    name: "pcg",
    text: include_str!("../../../../shaders/pcg.wgsl"),
    entry_points: &["start", "solve"],
    written: &[false, false, false, false, true, true, true],
};

pub const CONDENSE: KernelFile = KernelFile {
    name: "condense",
    text: include_str!("../../../../shaders/condense.wgsl"),
    entry_points: &["residual", "condense"],
    written: &[false, false, false, false, true, true, true],
};

/// Every file of kernels.
pub const KERNEL_FILES: [&KernelFile; 3] = [&ASSEMBLE, &PCG, &CONDENSE];

impl KernelFile {
    /// The whole text in one precision and for one size of workgroup.
    pub fn source(&self, precision: Precision, invocations: u32) -> String {
        let real = precision.name();
        format!("alias real = {real};\nconst INVOCATIONS = {invocations}u;\n{COMMON}\n{}", self.text)
    }
}

/// Pipelines of one file, in the order of its entry points.
pub struct Stage {
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
}

/// All kernels in one precision.
pub struct Kernels<'a> {
    pub gpu: &'a GpuDevice,
    pub precision: Precision,
    pub assemble: Stage,
    pub pcg: Stage,
    pub condense: Stage,
}

impl<'a> Kernels<'a> {
    /// `invocations`: of a workgroup, a power of two.
    pub fn new(gpu: &'a GpuDevice, precision: Precision, invocations: u32) -> Result<Kernels<'a>, GpuError> {
        let lacks = |what: &str| GpuError::Lacks { adapter: gpu.facts.name.clone(), what: what.to_string() };
        if precision == Precision::F64 && !gpu.facts.features.f64 {
            return Err(lacks("f64"));
        }
        if !invocations.is_power_of_two() || invocations > gpu.facts.limits.invocations_per_workgroup {
            return Err(lacks(&format!("workgroups of {invocations} invocations")));
        }
        let stage = |file: &KernelFile| -> Result<Stage, GpuError> {
            if file.written.len() > gpu.facts.limits.storage_buffers as usize {
                return Err(lacks(&format!("{} storage buffers", file.written.len())));
            }
            gpu.checked(file.name, || Stage::new(&gpu.device, file, &file.source(precision, invocations)))
        };
        let (assemble, pcg, condense) = (stage(&ASSEMBLE)?, stage(&PCG)?, stage(&CONDENSE)?);
        Ok(Kernels { gpu, precision, assemble, pcg, condense })
    }
}

impl Stage {
    fn new(device: &wgpu::Device, file: &KernelFile, source: &str) -> Stage {
        let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage =
            file.written.iter().map(|written| wgpu::BufferBindingType::Storage { read_only: !written });
        let types = std::iter::once(wgpu::BufferBindingType::Uniform).chain(storage);
        let entries: Vec<_> = (0..).zip(types).map(entry).collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(file.name),
            entries: &entries,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(file.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file.name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = |entry_point: &&'static str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        Stage { pipelines: file.entry_points.iter().map(pipeline).collect(), layout }
    }
}
