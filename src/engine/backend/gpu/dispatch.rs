//! Buffers, bindings, submissions and what is read back: the few things that every stage asks of a device.

use std::time::Duration;

use bytemuck::Pod;
use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};
use super::kernels::Stage;

/// A batch that takes longer hangs. After that even letting go of the device may block.
const LONGEST_WAIT: Duration = Duration::from_secs(120);

/// One dispatch: what runs, on what, in how many workgroups along two dimensions.
pub(crate) type Pass<'a> = (&'a wgpu::ComputePipeline, &'a wgpu::BindGroup, [u32; 2]);

/// A dispatch that is kept, to be submitted as often as one likes.
#[derive(Clone)]
pub(crate) struct Dispatch {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) group: wgpu::BindGroup,
    pub(crate) workgroups: [u32; 2],
}

impl Dispatch {
    /// Of the entry point of a stage with this index.
    pub(crate) fn new(
        stage: &Stage,
        entry: usize,
        group: &wgpu::BindGroup,
        workgroups: [u32; 2],
    ) -> Dispatch {
        Dispatch { pipeline: stage.pipelines[entry].clone(), group: group.clone(), workgroups }
    }

    pub(crate) fn pass(&self) -> Pass<'_> {
        (&self.pipeline, &self.group, self.workgroups)
    }
}

impl GpuDevice {
    pub(crate) fn uniform<T: Pod>(&self, parameters: &T) -> wgpu::Buffer {
        self.uploaded("parameters", bytemuck::bytes_of(parameters), BufferUsages::UNIFORM)
    }

    /// A buffer that kernels only read.
    pub(crate) fn filled<T: Pod>(&self, label: &str, contents: &[T]) -> wgpu::Buffer {
        self.uploaded(label, bytemuck::cast_slice(contents), BufferUsages::STORAGE)
    }

    /// Not by wgpu's `create_buffer_init`, which panics where there is no memory or the device is lost.
    fn uploaded(&self, label: &str, contents: &[u8], usage: BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            // A binding may not be empty.
            size: contents.len().max(16) as u64,
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, contents);
        buffer
    }

    /// A buffer that kernels write, of zeros.
    pub(crate) fn empty(&self, label: &str, size: u64) -> wgpu::Buffer {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.with_usage(label, size, usage)
    }

    pub(crate) fn with_usage(&self, label: &str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// Buffers in the order of the stage's bindings.
    pub(crate) fn bind(&self, stage: &Stage, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        self.bind_parts(stage, buffers.iter().map(|buffer| buffer.as_entire_buffer_binding()))
    }

    /// Parts of buffers in the order of the stage's bindings.
    pub(crate) fn bind_parts<'a>(
        &self,
        stage: &Stage,
        parts: impl IntoIterator<Item = wgpu::BufferBinding<'a>>,
    ) -> wgpu::BindGroup {
        let entry =
            |(binding, part)| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::Buffer(part) };
        let entries: Vec<_> = (0..).zip(parts).map(entry).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &stage.layout,
            entries: &entries,
        })
    }

    /// Dispatches in order, in one submission.
    pub(crate) fn submit<'a>(&self, passes: impl IntoIterator<Item = Pass<'a>>) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (pipeline, group, [x, y]) in passes {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(x, y, 1);
        }
        self.queue.submit([encoder.finish()]);
    }

    /// Waits for all work submitted so far.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(LONGEST_WAIT) };
        self.device.poll(wait).map_err(|error| self.lost(&error.to_string()))?;
        Ok(())
    }

    /// Waits for all work submitted so far and copies a buffer back.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let staging = self.checked("reading back", || {
            let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
            let staging = self.with_usage("staging", buffer.size(), usage);
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
            self.queue.submit([encoder.finish()]);
            staging
        })?;
        self.mapped(&staging, buffer.size(), |bytes| bytes.to_vec())
    }

    /// Waits for all work submitted so far and looks at the first bytes of a buffer that can be mapped.
    pub(crate) fn mapped<T>(
        &self,
        staging: &wgpu::Buffer,
        size: u64,
        look: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        let (sender, receiver) = std::sync::mpsc::channel();
        self.checked("reading back", || {
            staging.map_async(wgpu::MapMode::Read, ..size, move |result| drop(sender.send(result)));
        })?;
        self.wait()?;
        let lost = |problem: String| self.lost(&problem);
        receiver.recv().map_err(|error| lost(error.to_string()))?.map_err(|error| lost(error.to_string()))?;
        let view = staging.get_mapped_range(..size).map_err(|error| lost(error.to_string()))?;
        let seen = look(&view);
        drop(view);
        staging.unmap();
        Ok(seen)
    }
}
