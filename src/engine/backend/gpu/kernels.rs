//! The kernels: their text in each precision, and their pipelines on a device.

use std::collections::HashMap;
use std::sync::Mutex;

use wgpu::ShaderStages;

use super::batch::{KernelFacts, OnChip, works_tile};
use super::context::{GpuDevice, GpuError};
use super::front::Front;
pub use super::front::WORKS_HEADER;
use super::layout::{SLICE, SystemOutcome};
use super::shared_data::{SharedData, SharedPlace};
pub use crate::engine::backend::precision::Precision;
use crate::mechanics::compliance::ring_modes::MOST_MODES;
use crate::mechanics::layers::{MOST_STEPS, SHRINK, STEEPEST, TOLERANCE};
use crate::mechanics::mesh::{CROWDING, LEEWAY, THICK_WALL};

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
            4 => bytemuck::pod_collect_to_vec::<u8, f32>(bytes).into_iter().map(f64::from).collect(),
            _ => bytemuck::pod_collect_to_vec(bytes),
        }
    }
}

/// How a kernel uses what it is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    Uniform,
    Read,
    Written,
}

use Access::{Read, Uniform, Written};

/// A number that stands in a twin.
#[derive(Clone, Copy, Debug)]
pub enum Constant {
    /// u32.
    Count(usize),
    /// In the numbers of the kernel.
    Wide(f64),
}

impl Constant {
    fn text(self, name: &str) -> String {
        match self {
            Constant::Count(count) => format!("const {name} = {count}u;\n"),
            Constant::Wide(number) => format!("const {name} = wide({number:?});\n"),
        }
    }
}

/// One file of kernels: its text, its entry points, and its bindings by name, in their order.
pub struct KernelFile {
    pub name: &'static str,
    pub text: &'static str,
    pub entry_points: &'static [&'static str],
    pub bindings: &'static [(&'static str, Access)],
    /// What it has from its twin, by name.
    pub constants: &'static [(&'static str, Constant)],
    /// What it takes sums of over a workgroup.
    pub summand: Option<&'static str>,
}

const COMMON: &str = include_str!("../../../../shaders/common.wgsl");
const SUM_TREE: &str = include_str!("../../../../shaders/sum_tree.wgsl");
const SUM_SUBGROUPS: &str = include_str!("../../../../shaders/sum_subgroups.wgsl");

pub const ASSEMBLE: KernelFile = KernelFile {
    name: "assemble",
    text: concat!(
        include_str!("../../../../shaders/functions.wgsl"),
        include_str!("../../../../shaders/topologies.wgsl"),
        include_str!("../../../../shaders/assemble.wgsl")
    ),
    entry_points: &["assemble"],
    bindings: &[
        ("topologies", Read),
        ("bodies", Read),
        ("shared_numbers", Read),
        ("lists", Read),
        ("geometry", Written),
        ("values", Written),
        ("states", Written),
    ],
    constants: &[
        ("LEEWAY", Constant::Wide(LEEWAY)),
        ("CROWDING", Constant::Wide(CROWDING)),
        ("THICK_WALL", Constant::Wide(THICK_WALL)),
        ("SHRINK", Constant::Wide(SHRINK)),
        ("TOLERANCE", Constant::Wide(TOLERANCE)),
        ("STEEPEST", Constant::Wide(STEEPEST)),
        ("MOST_STEPS", Constant::Count(MOST_STEPS)),
    ],
    summand: None,
};

pub const PCG: KernelFile = KernelFile {
    name: "pcg",
    text: include_str!("../../../../shaders/pcg.wgsl"),
    entry_points: &["solve"],
    bindings: &[
        ("parameters", Uniform),
        ("slice_starts", Read),
        ("columns", Read),
        ("diagonal_places", Read),
        ("values", Read),
        ("iterates", Written),
        ("norms", Written),
        ("states", Written),
    ],
    constants: &[],
    summand: Some("real4"),
};

pub const NARROW: KernelFile = KernelFile {
    name: "narrow",
    text: include_str!("../../../../shaders/narrow.wgsl"),
    entry_points: &["narrow"],
    bindings: &[("parameters", Uniform), ("values", Read), ("narrowed", Written)],
    constants: &[],
    summand: None,
};

pub const REFINE: KernelFile = KernelFile {
    name: "refine",
    text: include_str!("../../../../shaders/refine.wgsl"),
    entry_points: &["start", "refine", "settle"],
    bindings: &[
        ("parameters", Uniform),
        ("slice_starts", Read),
        ("columns", Read),
        ("diagonal_places", Read),
        ("values", Read),
        ("iterates", Written),
        ("norms", Written),
        ("states", Written),
        ("solutions", Written),
    ],
    constants: &[],
    summand: Some("wide4"),
};

pub const CONDENSE: KernelFile = KernelFile {
    name: "condense",
    text: include_str!("../../../../shaders/condense.wgsl"),
    entry_points: &["condense"],
    bindings: &[("parameters", Uniform), ("solutions", Read), ("compliance", Written)],
    constants: &[],
    summand: None,
};

pub const WORKS: KernelFile = KernelFile {
    name: "works",
    text: include_str!("../../../../shaders/works.wgsl"),
    entry_points: &["sum_works"],
    bindings: &[
        ("parameters", Uniform),
        ("compliance", Read),
        ("loads", Read),
        ("states", Read),
        ("norms", Read),
        ("works", Written),
    ],
    constants: &[],
    summand: None,
};

pub const ELIMINATE: KernelFile = KernelFile {
    name: "eliminate",
    text: concat!(
        include_str!("../../../../shaders/topologies.wgsl"),
        include_str!("../../../../shaders/eliminate.wgsl")
    ),
    entry_points: &["eliminate"],
    bindings: &[
        ("topologies", Read),
        ("lists", Read),
        ("loads", Read),
        ("values", Read),
        ("states", Read),
        ("works", Written),
        ("fronts", Written),
    ],
    constants: &[],
    summand: None,
};

/// What a device can do at most.
pub const ROOFLINE: KernelFile = KernelFile {
    name: "roofline",
    text: include_str!("../../../../shaders/roofline.wgsl"),
    entry_points: &["copy", "multiply_add"],
    bindings: &[("parameters", Uniform), ("source", Read), ("copied", Written)],
    constants: &[],
    summand: None,
};

/// The files of kernels that turn bodies into works of their rings' modes.
pub const KERNEL_FILES: [&KernelFile; 7] = [&ASSEMBLE, &NARROW, &PCG, &REFINE, &CONDENSE, &WORKS, &ELIMINATE];

/// How the invocations of a workgroup add their parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sums {
    /// In the order of the twins.
    Tree,
    /// In the order of the device, where it has subgroups.
    Subgroups,
}

/// What the text of a kernel depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    pub precision: Precision,
    /// Of a workgroup, a power of two.
    pub invocations: u32,
    /// Of `pcg`.
    pub on_chip: OnChip,
    /// Of `eliminate`.
    pub front: Front,
    pub sums: Sums,
}

impl Variant {
    /// With all vectors in storage, the smallest front and sums as a tree.
    pub fn plain(precision: Precision, invocations: u32) -> Variant {
        let front = Front::SMALLEST;
        Variant { precision, invocations, on_chip: OnChip::NOTHING, front, sums: Sums::Tree }
    }
}

impl KernelFile {
    /// The whole text in one precision and for one size of workgroup, with all vectors in storage and sums as a tree.
    pub fn source(&self, precision: Precision, invocations: u32) -> String {
        self.variant(&Variant::plain(precision, invocations))
    }

    /// How many of its bindings are storage.
    pub fn storage_buffers(&self) -> usize {
        self.bindings.iter().filter(|(_, access)| *access != Uniform).count()
    }

    /// Its entry points, which do nothing.
    pub fn empty(&self, invocations: u32) -> String {
        let empty = |name: &&str| format!("@compute @workgroup_size({invocations})\nfn {name}() {{}}\n");
        self.entry_points.iter().map(empty).collect()
    }

    pub fn variant(&self, variant: &Variant) -> String {
        let Variant {
            precision,
            invocations,
            on_chip: OnChip { vectors, capacity },
            front: Front { rows, is_on_chip },
            sums,
        } = variant;
        let name = |bytes: u64| if bytes == 4 { "f32" } else { "f64" };
        let (real, wide) = (name(precision.real_bytes()), name(precision.wide_bytes()));
        // WGSL wants `enable subgroups;` first, which naga does not read (gfx-rs/wgpu#5555).
        let sums = match (self.summand, sums) {
            (None, _) => String::new(),
            (Some(summand), Sums::Tree) => format!("alias summand = {summand};\n{SUM_TREE}"),
            (Some(summand), Sums::Subgroups) => format!("alias summand = {summand};\n{SUM_SUBGROUPS}"),
        };
        let outcomes = SystemOutcome::ALL.map(|(name, outcome)| (name, Constant::Count(outcome as usize)));
        let tile_rows = works_tile(u64::from(*invocations)) as usize;
        let sizes = [
            ("SLICE", SLICE),
            ("MOST_MODES", MOST_MODES),
            ("WORKS_HEADER", WORKS_HEADER),
            ("TILE_ROWS", tile_rows),
        ];
        let sizes = sizes.map(|(name, size)| (name, Constant::Count(size)));
        let constants = outcomes.iter().chain(&sizes).chain(self.constants);
        let constants: String = constants.map(|(name, constant)| constant.text(name)).collect();
        let text = self.text;
        let double = precision.wide_bytes() == 8;
        format!(
            "alias real = {real};\nalias wide = {wide};\nconst IS_WIDE_DOUBLE = {double};\nconst INVOCATIONS = {invocations}u;\n\
             const ON_CHIP = {vectors}u;\nconst CAPACITY = {capacity}u;\nconst FRONT = {rows}u;\nconst IS_FRONT_ON_CHIP = {is_on_chip};\n\
             {constants}{COMMON}\n{sums}\n{text}"
        )
    }
}

/// How the text of a file becomes pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// As it is.
    Trusted,
    /// Every index and every loop is watched at run time, and memory begins with zeros: slower, for tests.
    Checked,
    /// Its entry points do nothing, and no body has works: what is left is what a processor does around them.
    Empty,
}

/// Pipelines of one file, in the order of its entry points.
#[derive(Clone)]
pub struct Stage {
    pub bindings: &'static [(&'static str, Access)],
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
}

/// All kernels in one precision.
pub struct Kernels<'a> {
    pub gpu: &'a GpuDevice,
    pub precision: Precision,
    pub invocations: u32,
    pub assemble: Stage,
    /// Where the iteration needs matrices of its own.
    pub narrow: Option<Stage>,
    pcg: Mutex<HashMap<OnChip, Stage>>,
    eliminate: Mutex<HashMap<Front, Stage>>,
    shared: Mutex<SharedData>,
    pub refine: Stage,
    pub condense: Stage,
    pub works: Stage,
    sums: Sums,
    making: Making,
}

impl<'a> Kernels<'a> {
    /// `invocations`: of a workgroup, a power of two.
    pub fn new(gpu: &'a GpuDevice, precision: Precision, invocations: u32) -> Result<Kernels<'a>, GpuError> {
        let sums = if gpu.facts.features.subgroups { Sums::Subgroups } else { Sums::Tree };
        Kernels::build(gpu, precision, invocations, sums, Making::Trusted)
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
        let stage = |file| Stage::new(gpu, file, &variant, making);
        Ok(Kernels {
            gpu,
            precision,
            invocations,
            assemble: stage(&ASSEMBLE)?,
            narrow: precision.narrows().then(|| stage(&NARROW)).transpose()?,
            pcg: Mutex::default(),
            eliminate: Mutex::default(),
            shared: Mutex::default(),
            refine: stage(&REFINE)?,
            condense: stage(&CONDENSE)?,
            works: stage(&WORKS)?,
            sums,
            making,
        })
    }

    /// The iteration with so much on chip; made when it is first asked for.
    pub fn pcg(&self, on_chip: OnChip) -> Result<Stage, GpuError> {
        self.kept(&self.pcg, on_chip, &PCG, |variant| variant.on_chip = on_chip)
    }

    /// Elimination with such a front; made when it is first asked for.
    pub fn eliminate(&self, front: Front) -> Result<Stage, GpuError> {
        self.kept(&self.eliminate, front, &ELIMINATE, |variant| variant.front = front)
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
    pub(crate) fn new(
        gpu: &GpuDevice,
        file: &KernelFile,
        variant: &Variant,
        making: Making,
    ) -> Result<Stage, GpuError> {
        let storage_buffers = file.storage_buffers();
        if storage_buffers > gpu.facts.limits.storage_buffers as usize {
            let what = format!("{storage_buffers} storage buffers");
            return Err(GpuError::Lacks { adapter: gpu.facts.name.clone(), what });
        }
        let source = match making {
            Making::Empty => file.empty(variant.invocations),
            Making::Trusted | Making::Checked => file.variant(variant),
        };
        let is_checked = making == Making::Checked;
        gpu.checked(file.name, || Stage::build(&gpu.device, file, &source, is_checked))
    }

    fn build(device: &wgpu::Device, file: &KernelFile, source: &str, is_checked: bool) -> Stage {
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
        Stage { bindings: file.bindings, layout, pipelines }
    }
}
