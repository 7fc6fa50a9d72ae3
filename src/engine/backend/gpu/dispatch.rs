//! Buffers, bindings, submissions and what is read back: the few things that every stage asks of a device.

use std::ops::Range;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use bytemuck::Pod;
use wgpu::{BufferBinding, BufferSize, BufferUsages};

use super::context::{GpuDevice, GpuError};
use super::kernels::Stage;
use crate::engine::backend::Counts;

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

/// What a kernel is given for one of its bindings.
#[derive(Clone)]
pub(crate) struct Argument<'a> {
    name: &'static str,
    binding: BufferBinding<'a>,
}

impl<'a> Argument<'a> {
    pub(crate) fn whole(name: &'static str, buffer: &'a wgpu::Buffer) -> Argument<'a> {
        Argument { name, binding: buffer.as_entire_buffer_binding() }
    }

    /// Some bytes of a buffer, which has them: wgpu refuses any other. They begin at a multiple of `ALIGNMENT`.
    pub(crate) fn part(name: &'static str, buffer: &'a wgpu::Buffer, bytes: Range<u64>) -> Argument<'a> {
        let size = wgpu::BufferSize::new(bytes.end - bytes.start);
        Argument { name, binding: BufferBinding { buffer, offset: bytes.start, size } }
    }
}

/// Of a part of a buffer that is bound, bytes: the most that WebGPU lets a device ask for.
pub(crate) const ALIGNMENT: u64 = 256;

/// What a submission copies to where the host can read it.
pub(crate) struct Reading {
    staging: wgpu::Buffer,
    size: u64,
    submission: wgpu::SubmissionIndex,
    mapped: Arc<OnceLock<Result<(), wgpu::BufferAsyncError>>>,
}

/// When passes begin and end on a device that is timed; nothing on others.
pub(crate) struct PassTimes {
    timed: Option<Timed>,
}

struct Timed {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    passes: u32,
    begun: u32,
}

/// Of one set of queries.
const MOST_TIMED: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;

impl PassTimes {
    /// Of so many passes at most; further ones are not timed.
    pub(crate) fn of(gpu: &GpuDevice, passes: usize) -> PassTimes {
        let timed = (gpu.is_timed && passes > 0).then(|| {
            let passes = passes.min(MOST_TIMED) as u32;
            let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * passes,
            });
            let size = u64::from(2 * passes * wgpu::QUERY_SIZE);
            let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
            let resolved = gpu.with_usage("times", size, usage);
            Timed { queries, resolved, passes, begun: 0 }
        });
        PassTimes { timed }
    }

    /// What they take where they are read.
    pub(crate) fn bytes(&self) -> u64 {
        self.timed.as_ref().map_or(0, |timed| timed.resolved.size())
    }

    /// A pass that begins now.
    pub(crate) fn next(&mut self) -> wgpu::ComputePassDescriptor<'_> {
        let open = self.timed.as_mut().filter(|timed| timed.begun < timed.passes);
        let timestamp_writes = open.map(|Timed { queries, begun, .. }| {
            *begun += 1;
            wgpu::ComputePassTimestampWrites {
                query_set: queries,
                beginning_of_pass_write_index: Some(2 * *begun - 2),
                end_of_pass_write_index: Some(2 * *begun - 1),
            }
        });
        wgpu::ComputePassDescriptor { label: None, timestamp_writes }
    }

    /// Copies them behind other bytes; those of passes that were not begun are zero.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer, at: u64) {
        if let Some(Timed { queries, resolved, begun, .. }) = &self.timed {
            encoder.clear_buffer(resolved, 0, None);
            encoder.resolve_query_set(queries, 0..2 * begun, resolved, 0);
            encoder.copy_buffer_to_buffer(resolved, 0, to, at, resolved.size());
        }
    }
}

/// Buffers of at least these sizes: those that are there, or new ones.
pub(crate) fn kept<'a, const N: usize>(
    gpu: &GpuDevice,
    buffers: &'a mut [Option<wgpu::Buffer>; N],
    kinds: [(&'static str, BufferUsages); N],
    sizes: [u64; N],
    counts: &mut Counts,
) -> [&'a wgpu::Buffer; N] {
    for ((buffer, size), (label, usage)) in buffers.iter_mut().zip(sizes).zip(kinds) {
        if buffer.as_ref().is_none_or(|buffer| buffer.size() < size) {
            // With some room, as the next batch may be a little larger.
            let roomy = (size + size / 4).next_multiple_of(8).min(gpu.facts.limits.buffer_bytes);
            *buffer = Some(gpu.with_usage(label, roomy.max(size), usage));
            counts.new_buffers += 1;
        }
    }
    buffers.each_ref().map(|buffer| buffer.as_ref().unwrap_or_else(|| unreachable!("was made above")))
}

impl GpuDevice {
    /// How long passes took, each from what `PassTimes` has left of it.
    pub(crate) fn pass_times(&self, times: &[u8]) -> Vec<Duration> {
        let times: Vec<u64> = bytemuck::pod_collect_to_vec(times);
        let tick = f64::from(self.queue.get_timestamp_period());
        let of_pass = |pass: &[u64]| pass[1].saturating_sub(pass[0]) as f64 * tick;
        times.chunks_exact(2).map(|pass| Duration::from_nanos(of_pass(pass) as u64)).collect()
    }

    /// How long all of them took.
    pub(crate) fn busy(&self, times: &[u8]) -> Duration {
        self.pass_times(times).into_iter().sum()
    }

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

    /// Writes pieces one behind another, so many bytes in all, from the beginning of a buffer on.
    pub(crate) fn write_pieces<'a>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
        pieces: impl Iterator<Item = &'a [f32]>,
    ) {
        let room = BufferSize::new(bytes).and_then(|bytes| self.queue.write_buffer_with(buffer, 0, bytes));
        // Without room wgpu has said why.
        let Some(mut room) = room else { return };
        let mut end = 0;
        for piece in pieces {
            let piece: &[u8] = bytemuck::cast_slice(piece);
            let start = end;
            end += piece.len();
            room.slice(start..end).copy_from_slice(piece);
        }
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

    /// What a stage is given, by the names of its bindings and in their order.
    pub(crate) fn bind(&self, stage: &Stage, arguments: &[Argument]) -> wgpu::BindGroup {
        let names = || arguments.iter().map(|argument| argument.name);
        let wanted = || stage.bindings.iter().map(|(name, _)| *name);
        assert!(names().eq(wanted()), "{:?} for {:?}", Vec::from_iter(names()), Vec::from_iter(wanted()));
        let resources =
            arguments.iter().map(|argument| wgpu::BindingResource::Buffer(argument.binding.clone()));
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
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

    /// The first bytes of a buffer to another one.
    pub(crate) fn copy(&self, from: &wgpu::Buffer, to: &wgpu::Buffer, size: u64) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(from, 0, to, 0, size);
        self.queue.submit([encoder.finish()]);
    }

    /// Submits what was written and waits for it: wgpu keeps what is written to, and what that is written from, until then.
    pub(crate) fn settle(&self) -> Result<(), GpuError> {
        let submission = self.checked("writing", || self.queue.submit([]))?;
        self.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(LONGEST_WAIT) })
    }

    /// Waits for all work submitted so far: what times dispatches does.
    #[cfg(feature = "files")]
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(LONGEST_WAIT) };
        self.poll(wait)
    }

    /// Waits for all work submitted so far and copies a buffer back.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let reading = self.checked("reading back", || {
            let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
            let staging = self.with_usage("staging", buffer.size(), usage);
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
            let submission = self.queue.submit([encoder.finish()]);
            self.reading(&staging, buffer.size(), submission)
        })?;
        self.look(reading)
    }

    /// Asks for the first bytes of a buffer as a submission leaves it.
    pub(crate) fn reading(
        &self,
        staging: &wgpu::Buffer,
        size: u64,
        submission: wgpu::SubmissionIndex,
    ) -> Reading {
        let mapped = Arc::new(OnceLock::new());
        let told = Arc::clone(&mapped);
        staging.map_async(wgpu::MapMode::Read, ..size, move |result| drop(told.set(result)));
        Reading { staging: staging.clone(), size, submission, mapped }
    }

    /// Whether the submission has ended already.
    pub(crate) fn is_there(&self, reading: &Reading) -> Result<bool, GpuError> {
        self.poll(wgpu::PollType::Poll)?;
        Ok(reading.mapped.get().is_some())
    }

    /// Waits for the end of the submission.
    pub(crate) fn await_end(&self, Reading { submission, mapped, .. }: &Reading) -> Result<(), GpuError> {
        let submission_index = Some(submission.clone());
        self.poll(wgpu::PollType::Wait { submission_index, timeout: Some(LONGEST_WAIT) })?;
        // It may be another thread that polls, and is about to tell.
        match mapped.wait() {
            Ok(()) => Ok(()),
            Err(error) => Err(self.lost(&error.to_string())),
        }
    }

    /// The same, with what it has left.
    pub(crate) fn look(&self, reading: Reading) -> Result<Vec<u8>, GpuError> {
        self.await_end(&reading)?;
        let Reading { staging, size, .. } = reading;
        let view = staging.get_mapped_range(..size).map_err(|error| self.lost(&error.to_string()))?;
        // Of a device that another thread finds lost wgpu frees all buffers, this one, too.
        let own = view.to_vec();
        drop(view);
        self.checked("reading back", || staging.unmap())?;
        Ok(own)
    }
}
