//! A batch of bodies on the device: its buffers, and the stages from a few numbers of each body to the compliance of
//! its ring. Nothing is read back between stages.

use std::time::Duration;

use bytemuck::Pod;
use wgpu::BufferUsages;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::batch::ITERATES;
use super::context::{GpuDevice, GpuError};
use super::kernels::{Kernels, Stage};
use super::layout::{MeshLayout, SystemLayout, SystemState};
use crate::mechanics::solve::pcg::PcgSettings;

/// Systems of a batch on the device: matrices of one sparsity, their iterates, and the compliances of their rings.
pub struct SystemBatch<'a> {
    kernels: &'a Kernels<'a>,
    layout: &'a SystemLayout,
    body_count: usize,
    row_starts: wgpu::Buffer,
    columns: wgpu::Buffer,
    diagonal_places: wgpu::Buffer,
    values: wgpu::Buffer,
    iterates: wgpu::Buffer,
    norms: wgpu::Buffer,
    states: wgpu::Buffer,
    compliance: wgpu::Buffer,
}

/// What is known of each system when it has ended, `[body][system]`, with systems beyond the ring's unknowns.
#[derive(Clone, Debug)]
pub struct SystemReports {
    pub states: Vec<SystemState>,
    /// |r|/|b| of the recursion and |b - K x|/|b|, in the precision of the kernels.
    pub recursive_residuals: Vec<f64>,
    pub true_residuals: Vec<f64>,
}

impl<'a> SystemBatch<'a> {
    /// Room for `body_count` bodies; their matrices come from `assemble` or `write_values`.
    pub fn new(
        kernels: &'a Kernels<'a>,
        layout: &'a SystemLayout,
        body_count: usize,
    ) -> Result<SystemBatch<'a>, GpuError> {
        let device = &kernels.gpu.device;
        let real = kernels.precision.bytes();
        let (bodies, systems) = (body_count as u64, (body_count * layout.system_count()) as u64);
        let empty = |label, bytes| empty_buffer(device, label, bytes);
        kernels.gpu.checked("room for a batch", || SystemBatch {
            kernels,
            layout,
            body_count,
            row_starts: filled_buffer(device, "row_starts", &layout.row_starts),
            columns: filled_buffer(device, "columns", &layout.columns),
            diagonal_places: filled_buffer(device, "diagonal_places", &layout.diagonal_places),
            values: empty("values", bodies * layout.columns.len() as u64 * real),
            iterates: empty("iterates", systems * ITERATES * layout.unknown_count() as u64 * real),
            norms: empty("norms", systems * 3 * real),
            states: empty("states", systems * size_of::<SystemState>() as u64),
            compliance: empty("compliance", systems * layout.ring_count() as u64 * real),
        })
    }

    /// The matrices of all bodies, `[body][value]`.
    pub fn write_values(&self, values: &[f64]) -> Result<(), GpuError> {
        let Kernels { gpu, precision, .. } = self.kernels;
        gpu.checked("matrix values", || gpu.queue.write_buffer(&self.values, 0, &precision.encode(values)))
    }

    /// Builds the matrices from the numbers of each body (`MeshLayout::body_numbers`, one after the other) and readies
    /// the systems.
    ///
    /// Returns the reach of every grid point and the gradients of every element, for inspection.
    pub fn assemble(&self, mesh: &MeshLayout, body_numbers: &[f64]) -> Result<Geometry, GpuError> {
        let Kernels { gpu, precision, .. } = self.kernels;
        let reals = |label, numbers: &[f64]| filled_buffer(&gpu.device, label, &precision.encode(numbers));
        let (grid, size) = (mesh.grid_count(), mesh.geometry_count());
        gpu.checked("assemble", || {
            let bytes = (self.body_count * size) as u64 * 2 * precision.bytes();
            let geometry = empty_buffer(&gpu.device, "geometry", bytes);
            let bindings = [
                &uniform_buffer(&gpu.device, &mesh.parameters),
                &reals("bodies", body_numbers),
                &reals("shared_numbers", &mesh.shared_numbers),
                &filled_buffer(&gpu.device, "element_grid", &mesh.element_grid),
                &filled_buffer(&gpu.device, "source_starts", &mesh.source_starts),
                &filled_buffer(&gpu.device, "sources", &mesh.sources),
                &geometry,
                &self.values,
                &self.states,
            ];
            self.submit(&self.kernels.assemble, &bindings, &[0], [self.body_count as u32, 1]);
            Geometry { buffer: geometry, grid, size }
        })
    }

    /// Solves for unit forces on the ring's unknowns, `step_count` steps a dispatch, until all systems must have
    /// stopped: those that have, end at once. `step_count` is that of the `Batch`: with more, Mesa 22 leaves the
    /// iteration early and says nothing.
    pub fn pcg(&self, settings: &PcgSettings, step_count: u32) -> Result<(), GpuError> {
        let dispatches = settings.iteration_limit.div_ceil(step_count as usize);
        let entries: Vec<usize> = std::iter::once(0).chain(std::iter::repeat_n(1, dispatches)).collect();
        self.run("pcg", &self.kernels.pcg, settings, step_count, &self.states, &entries)
    }

    /// The true residuals and, from the columns as they are, the compliances of the rings.
    pub fn condense(&self, settings: &PcgSettings) -> Result<(), GpuError> {
        self.run("condense", &self.kernels.condense, settings, 0, &self.compliance, &[0, 1])
    }

    fn run(
        &self,
        what: &'static str,
        stage: &Stage,
        settings: &PcgSettings,
        step_count: u32,
        last: &wgpu::Buffer,
        entries: &[usize],
    ) -> Result<(), GpuError> {
        let gpu = self.kernels.gpu;
        gpu.checked(what, || {
            let bindings = [
                &uniform_buffer(&gpu.device, &self.layout.parameters(settings, step_count)),
                &self.row_starts,
                &self.columns,
                &self.diagonal_places,
                &self.values,
                &self.iterates,
                &self.norms,
                last,
            ];
            self.submit(
                stage,
                &bindings,
                entries,
                [self.body_count as u32, self.layout.block_count() as u32],
            );
        })
    }

    /// One dispatch for each of `entries`, in order.
    fn submit(&self, stage: &Stage, bindings: &[&wgpu::Buffer], entries: &[usize], groups: [u32; 2]) {
        let GpuDevice { device, queue, .. } = self.kernels.gpu;
        let resources = bindings.iter().map(|buffer| buffer.as_entire_binding());
        let bound =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &stage.layout,
            entries: &bound.collect::<Vec<_>>(),
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for &entry in entries {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&stage.pipelines[entry]);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(groups[0], groups[1], 1);
        }
        queue.submit([encoder.finish()]);
    }

    /// The matrices, `[body][value]`.
    pub fn read_values(&self) -> Result<Vec<f64>, GpuError> {
        self.read_reals(&self.values)
    }

    /// The solutions, `[body][system][unknown]`, with systems beyond the ring's unknowns.
    pub fn read_columns(&self) -> Result<Vec<f64>, GpuError> {
        let size = self.layout.unknown_count();
        let iterates = self.read_reals(&self.iterates)?;
        // Of [body][block][x, r, p, q][unknown][system in block] the x.
        let blocks = iterates.chunks_exact(16 * size);
        Ok(blocks
            .flat_map(|block| {
                (0..4).flat_map(move |system| block[system..4 * size].iter().step_by(4).copied())
            })
            .collect())
    }

    /// The compliances of the rings, `[body][row][column]`.
    pub fn read_compliance(&self) -> Result<Vec<f64>, GpuError> {
        let padded = self.read_reals(&self.compliance)?;
        let rows = padded.chunks_exact(self.layout.system_count());
        Ok(rows.flat_map(|row| row[..self.layout.ring_count()].iter().copied()).collect())
    }

    pub fn read_reports(&self) -> Result<SystemReports, GpuError> {
        let states = bytemuck::pod_collect_to_vec(&self.read(&self.states)?);
        let norms = self.read_reals(&self.norms)?;
        let blocks = || norms.chunks_exact(12);
        let recursive = |block: &'_ [f64], system: usize| {
            let (norm, norm_b) = (block[system].sqrt(), block[4 + system]);
            if norm == 0.0 { 0.0 } else { norm / norm_b }
        };
        Ok(SystemReports {
            states,
            recursive_residuals: blocks()
                .flat_map(|block| [0, 1, 2, 3].map(|i| recursive(block, i)))
                .collect(),
            true_residuals: blocks().flat_map(|block| [8, 9, 10, 11].map(|i| block[i])).collect(),
        })
    }

    /// Coordinates less those of the ring's point of their line, `[body][row][column]`.
    pub fn read_reaches(&self, geometry: &Geometry) -> Result<Vec<[f64; 2]>, GpuError> {
        let numbers = self.read_reals(&geometry.buffer)?;
        let bodies = numbers.chunks_exact(2 * geometry.size);
        Ok(bodies
            .flat_map(|body| body[..2 * geometry.grid].chunks_exact(2).map(|place| [place[0], place[1]]))
            .collect())
    }

    fn read_reals(&self, buffer: &wgpu::Buffer) -> Result<Vec<f64>, GpuError> {
        Ok(self.kernels.precision.decode(&self.read(buffer)?))
    }

    /// Waits for all work submitted so far and copies a buffer back.
    fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let GpuDevice { device, queue, .. } = self.kernels.gpu;
        let lost = |problem: String| GpuError::Lost { adapter: self.kernels.gpu.facts.name.clone(), problem };
        let (sender, receiver) = std::sync::mpsc::channel();
        let staging = self.kernels.gpu.checked("reading back", || {
            let staging = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("staging"),
                size: buffer.size(),
                usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
            queue.submit([encoder.finish()]);
            staging.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
            staging
        })?;
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(LONGEST_WAIT) };
        device.poll(wait).map_err(|error| lost(error.to_string()))?;
        receiver.recv().map_err(|error| lost(error.to_string()))?.map_err(|error| lost(error.to_string()))?;
        let view = staging.get_mapped_range(..).map_err(|error| lost(error.to_string()))?;
        Ok(view.to_vec())
    }
}

/// A batch that takes longer hangs. After that even letting go of the device may block.
const LONGEST_WAIT: Duration = Duration::from_secs(120);

/// Where `assemble` has put its coordinates.
pub struct Geometry {
    buffer: wgpu::Buffer,
    grid: usize,
    size: usize,
}

fn uniform_buffer<T: Pod>(device: &wgpu::Device, parameters: &T) -> wgpu::Buffer {
    let contents = bytemuck::bytes_of(parameters);
    device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage: BufferUsages::UNIFORM })
}

fn filled_buffer<T: Pod>(device: &wgpu::Device, label: &str, contents: &[T]) -> wgpu::Buffer {
    let contents = bytemuck::cast_slice(contents);
    device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents,
        usage: BufferUsages::STORAGE,
    })
}

fn empty_buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}
