//! Bodies eliminated on a device: of all topologies of a batch in one go, with one wait at its end. What every piece of it needs for a while
//! (geometry, values, states) is one set of buffers, which the device goes through piece by piece.

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;
use wgpu::{BufferBinding, BufferUsages};

use super::batch::{MOST_BYTES, TARGET};
use super::context::{DeviceLimits, GpuError};
use super::front::{EliminateParameters, Front, FrontLayout};
use super::kernels::{Kernels, Precision, Stage, WORKS_HEADER};
use super::layout::{MeshLayout, SystemState};
use crate::mechanics::compliance::arc::packed;

/// What bodies of a topology share on the device.
pub struct FrontTopology {
    layout: FrontLayout,
    stage: Stage,
    /// Bytes of each body while it is worked on: geometry, values, states, and its front where that is in storage.
    scratch: [u64; 4],
    /// And of its numbers and its works.
    travelling: [u64; 2],
    /// Bindings of `assemble` and of `eliminate` in their order, without what is of a body.
    of_assemble: [wgpu::Buffer; 5],
    of_eliminate: [wgpu::Buffer; 5],
}

/// Bodies of one topology, by their numbers.
pub struct Job<'a> {
    pub topology: &'a FrontTopology,
    /// `MeshLayout::body_numbers`, one body after the other.
    pub numbers: Vec<f64>,
}

/// Buffers that are kept from batch to batch, and how long a batch took.
pub struct Elimination {
    /// Those of `BUFFERS`, as large as any batch needed them.
    buffers: [Option<wgpu::Buffer>; 7],
    /// Time of a product of tiles, s; nothing before any was measured.
    pace: Option<f64>,
    /// Of the buffers of a dispatch together.
    most_bytes: u64,
    pub counts: Counts,
}

impl Default for Elimination {
    fn default() -> Elimination {
        Elimination {
            buffers: Default::default(),
            pace: None,
            most_bytes: MOST_BYTES,
            counts: Counts::default(),
        }
    }
}

/// What was asked of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub dispatches: u64,
    pub submits: u64,
    pub waits: u64,
    pub new_buffers: u64,
    pub bytes_up: u64,
    pub bytes_down: u64,
}

/// Bodies of a job that go together.
struct Piece {
    job: usize,
    bodies: u32,
    /// Their numbers in those of the job.
    of_job: Range<usize>,
    /// Products of tiles.
    products: u64,
    /// Bytes of their numbers and of their works, in the buffers of all.
    numbers: Range<u64>,
    works: Range<u64>,
}

/// Time of a product of tiles before any was measured, s: short for a processor, long for a GPU.
const FIRST_GUESS: f64 = 1e-7;

/// Offsets of bindings: the most that WebGPU lets a device ask for.
const ALIGNMENT: u64 = 256;

/// With less the device is given up.
const FEWEST_BYTES: u64 = 1 << 20;

/// A work in f32 is off by no more than so many roundings, times the greatest loss of a pivot, times the greatest work: seen of the blocks in
/// `tests/gpu_parity/elimination.rs`.
const AMPLIFIED: f64 = 42.0;

/// A body whose works may be off by more, relative to the greatest of them, is left to the processor. Forces feel less than a tenth of it.
pub const ROUGHEST: f64 = 7e-4;

impl FrontTopology {
    /// `None` where the device has no room for one body, or an invocation would make too many loop trips.
    pub fn new(
        kernels: &Kernels,
        mesh: &MeshLayout,
        layout: FrontLayout,
    ) -> Result<Option<FrontTopology>, GpuError> {
        let limits = &kernels.gpu.facts.limits;
        let (wide, invocations) = (kernels.precision.wide_bytes(), u64::from(kernels.invocations));
        let Some(front) = layout.front(wide, invocations, limits) else { return Ok(None) };
        let topology = FrontTopology::with(kernels, mesh, layout, front)?;
        let largest = topology.body_bytes().into_iter().max().unwrap_or(0);
        Ok((largest <= limits.bound_buffer()).then_some(topology))
    }

    /// With a front where one wants it.
    pub fn with(
        kernels: &Kernels,
        mesh: &MeshLayout,
        layout: FrontLayout,
        front: Front,
    ) -> Result<FrontTopology, GpuError> {
        let Kernels { gpu, precision, .. } = kernels;
        let stage = kernels.eliminate(front)?;
        let wide = precision.wide_bytes();
        let scratch = [
            2 * mesh.geometry_count() as u64 * wide,
            layout.places.len() as u64 * wide,
            size_of::<SystemState>() as u64,
            front.storage_bytes(wide),
        ];
        let travelling = [mesh.body_number_count() as u64, u64::from(layout.parameters.body_size)]
            .map(|count| count * wide);
        let reals = |label, numbers: &[f64]| gpu.filled(label, &precision.encode(numbers));
        let (of_assemble, of_eliminate) = gpu.checked("a topology", || {
            let of_assemble = [
                gpu.uniform(&layout.assembly),
                reals("shared_numbers", &mesh.shared_numbers),
                gpu.filled("element_grid", &mesh.element_grid),
                gpu.filled("source_starts", &layout.source_starts),
                gpu.filled("sources", &layout.sources),
            ];
            let of_eliminate = [
                gpu.uniform(&layout.parameters),
                gpu.filled("rows", &layout.rows),
                gpu.filled("tile_starts", &layout.tile_starts),
                gpu.filled("places", &layout.places),
                reals("loads", &layout.loads),
            ];
            (of_assemble, of_eliminate)
        })?;
        Ok(FrontTopology { layout, stage, scratch, travelling, of_assemble, of_eliminate })
    }

    /// What it takes, here and on the device.
    pub fn bytes(&self) -> u64 {
        let on_device = self.of_assemble.iter().chain(&self.of_eliminate).map(wgpu::Buffer::size);
        self.layout.bytes() + on_device.sum::<u64>()
    }

    /// Bytes of one body in each buffer that grows with the bodies.
    pub fn body_bytes(&self) -> [u64; 6] {
        let ([geometry, values, states, fronts], [numbers, works]) = (self.scratch, self.travelling);
        [geometry, values, states, fronts, numbers, works]
    }

    /// The most bodies of one dispatch, whose buffers may have so many bytes together.
    fn most_bodies(&self, limits: &DeviceLimits, most_bytes: u64) -> u64 {
        let bytes = self.body_bytes();
        let of_buffers = bytes.map(|bytes| limits.bound_buffer() / bytes.max(1));
        let of_memory = most_bytes / bytes.iter().sum::<u64>();
        let most =
            of_buffers.into_iter().chain([of_memory, u64::from(limits.workgroups_per_dimension)]).min();
        most.unwrap_or(1).max(1)
    }
}

impl Elimination {
    /// On a device that is known to take so long for a product of tiles, s.
    pub fn at_pace(pace: f64) -> Elimination {
        Elimination { pace: Some(pace), ..Elimination::default() }
    }

    /// The works on the bodies of each job; `None` for a body without a mesh, whose stiffness is not positive definite or loses too many
    /// digits. Where the device runs out of memory, with smaller buffers and more waits.
    pub fn condense(
        &mut self,
        kernels: &Kernels,
        jobs: &[Job],
    ) -> Result<Vec<Vec<Option<Vec<f64>>>>, GpuError> {
        let mut works: Vec<Vec<Option<Vec<f64>>>> = vec![vec![]; jobs.len()];
        loop {
            let pieces = self.pieces(kernels, jobs, &works);
            if pieces.is_empty() {
                return Ok(works);
            }
            match self.round(kernels, jobs, &pieces) {
                Ok(found) => {
                    for (piece, found) in pieces.iter().zip(found) {
                        works[piece.job].extend(found);
                    }
                }
                Err(GpuError::OutOfMemory { .. }) if self.most_bytes > FEWEST_BYTES => {
                    self.most_bytes /= 2;
                    self.buffers = Default::default();
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// How often buffers were halved for want of memory.
    pub fn halved(&self) -> u32 {
        (MOST_BYTES / self.most_bytes).ilog2()
    }

    /// The works on the bodies of some pieces, with one wait.
    fn round(
        &mut self,
        kernels: &Kernels,
        jobs: &[Job],
        pieces: &[Piece],
    ) -> Result<Vec<Vec<Option<Vec<f64>>>>, GpuError> {
        let Kernels { gpu, precision, .. } = kernels;
        let ends = |piece: &Piece| (piece.numbers.end, piece.works.end);
        let (up, down) = pieces.last().map_or((0, 0), ends);
        let mut numbers = vec![0; up as usize];
        for piece in pieces {
            let own = &jobs[piece.job].numbers[piece.of_job.clone()];
            numbers[bytes(&piece.numbers)].copy_from_slice(&precision.encode(own));
        }
        let started = Instant::now();
        let staging = gpu.checked("elimination", || self.submit(kernels, jobs, pieces, &numbers, down))?;
        let found = gpu.mapped(&staging, down, |all| {
            let of_piece = |piece: &Piece| -> Vec<Option<Vec<f64>>> {
                let numbers = precision.decode(&all[bytes(&piece.works)]);
                let EliminateParameters { body_size, mode_count, .. } =
                    jobs[piece.job].topology.layout.parameters;
                let of_bodies = numbers.chunks_exact(body_size as usize);
                of_bodies.map(|own| judged(own, mode_count as usize, *precision)).collect()
            };
            pieces.par_iter().map(of_piece).collect()
        })?;
        let products: u64 = pieces.iter().map(|piece| piece.products).sum();
        let measured = started.elapsed().as_secs_f64() / products.max(1) as f64;
        // A small batch is mostly its own start.
        self.pace = Some(self.pace.map_or(measured, |known| measured.min(2.0 * known)));
        self.counts.waits += 1;
        self.counts.bytes_up += up;
        self.counts.bytes_down += down;
        Ok(found)
    }

    /// The bodies of each job that have no works yet, in pieces that the device has room for and that take no longer than a dispatch may;
    /// so many of them as travel together.
    fn pieces(&self, kernels: &Kernels, jobs: &[Job], done: &[Vec<Option<Vec<f64>>>]) -> Vec<Piece> {
        let limits = &kernels.gpu.facts.limits;
        let wide = kernels.precision.wide_bytes();
        let together = limits.buffer_bytes.min(self.most_bytes);
        let mut pieces = Vec::new();
        let (mut up, mut down) = (0_u64, 0_u64);
        for (number, Job { topology, numbers }) in jobs.iter().enumerate() {
            let in_time = TARGET.as_secs_f64() / (self.pace() * topology.layout.tile_products() as f64);
            let most = topology.most_bodies(limits, self.most_bytes).min((in_time as u64).max(1));
            let size = (topology.travelling[0] / wide) as usize;
            let mut first = done[number].len();
            while first < numbers.len() / size {
                let bodies = most.min((numbers.len() / size - first) as u64);
                let of_job = first * size..(first + bodies as usize) * size;
                let [numbers, works] = topology.travelling.map(|bytes| bodies * bytes);
                if !pieces.is_empty() && (up + numbers).max(down + works) > together {
                    return pieces;
                }
                pieces.push(Piece {
                    job: number,
                    bodies: bodies as u32,
                    of_job,
                    products: bodies * topology.layout.tile_products(),
                    numbers: up..up + numbers,
                    works: down..down + works,
                });
                up = (up + numbers).next_multiple_of(ALIGNMENT);
                down = (down + works).next_multiple_of(ALIGNMENT);
                first += bodies as usize;
            }
        }
        pieces
    }

    fn pace(&self) -> f64 {
        self.pace.unwrap_or(FIRST_GUESS)
    }

    /// All pieces in order, and the copy of their works to what is handed over; a submission ends where it has taken long enough.
    fn submit(
        &mut self,
        kernels: &Kernels,
        jobs: &[Job],
        pieces: &[Piece],
        numbers: &[u8],
        down: u64,
    ) -> wgpu::Buffer {
        let Kernels { gpu, assemble, .. } = kernels;
        let most = |part: usize| {
            let bytes = |piece: &Piece| u64::from(piece.bodies) * jobs[piece.job].topology.scratch[part];
            pieces.iter().map(bytes).max().unwrap_or(0)
        };
        // A binding may not be empty.
        let sizes = [most(0), most(1), most(2), most(3).max(32), numbers.len() as u64, down, down];
        for ((buffer, size), (label, usage)) in self.buffers.iter_mut().zip(sizes).zip(BUFFERS) {
            if buffer.as_ref().is_none_or(|buffer| buffer.size() < size) {
                *buffer = Some(gpu.with_usage(label, size, usage));
                self.counts.new_buffers += 1;
            }
        }
        let [geometry, values, states, fronts, of_numbers, of_works, staging] = self
            .buffers
            .each_ref()
            .map(|buffer| buffer.as_ref().unwrap_or_else(|| unreachable!("was made above")));
        gpu.queue.write_buffer(of_numbers, 0, numbers);
        let pace = self.pace();
        let mut left = pieces.iter().peekable();
        while left.peek().is_some() {
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            let mut taken = 0.0;
            while let Some(piece) = left.next_if(|_| taken < TARGET.as_secs_f64()) {
                let topology = jobs[piece.job].topology;
                let whole = wgpu::Buffer::as_entire_buffer_binding;
                let [parameters, shared, grid, source_starts, sources] =
                    topology.of_assemble.each_ref().map(whole);
                let [geometry, values, states, fronts] = [geometry, values, states, fronts].map(whole);
                let bodies = part(of_numbers, &piece.numbers);
                let bindings = [
                    parameters,
                    bodies,
                    shared,
                    grid,
                    source_starts,
                    sources,
                    geometry,
                    values.clone(),
                    states.clone(),
                ];
                let assembly = gpu.bind_parts(assemble, bindings);
                let [parameters, rows, tile_starts, places, loads] =
                    topology.of_eliminate.each_ref().map(whole);
                let works = part(of_works, &piece.works);
                let bindings = [parameters, rows, tile_starts, places, loads, values, states, works, fronts];
                let elimination = gpu.bind_parts(&topology.stage, bindings);
                for (stage, group) in [(assemble, &assembly), (&topology.stage, &elimination)] {
                    pass.set_pipeline(&stage.pipelines[0]);
                    pass.set_bind_group(0, group, &[]);
                    pass.dispatch_workgroups(piece.bodies, 1, 1);
                    self.counts.dispatches += 1;
                }
                taken += pace * piece.products as f64;
            }
            drop(pass);
            if left.peek().is_none() {
                encoder.copy_buffer_to_buffer(of_works, 0, staging, 0, down);
            }
            gpu.queue.submit([encoder.finish()]);
            self.counts.submits += 1;
        }
        staging.clone()
    }
}

/// Geometry, values, states and fronts of a piece; numbers and works of all, and these where the host can read them.
const BUFFERS: [(&str, BufferUsages); 7] = [
    ("geometry", BufferUsages::STORAGE),
    ("values", BufferUsages::STORAGE),
    ("states", BufferUsages::STORAGE),
    ("fronts", BufferUsages::STORAGE),
    ("bodies", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("works", BufferUsages::STORAGE.union(BufferUsages::COPY_SRC)),
    ("staging", BufferUsages::COPY_DST.union(BufferUsages::MAP_READ)),
];

fn bytes(range: &Range<u64>) -> Range<usize> {
    range.start as usize..range.end as usize
}

fn part<'a>(buffer: &'a wgpu::Buffer, bytes: &Range<u64>) -> BufferBinding<'a> {
    BufferBinding { buffer, offset: bytes.start, size: wgpu::BufferSize::new(bytes.end - bytes.start) }
}

/// The works of one body, if they are sound. The softer a body, the more of what its elements take up cancels.
fn judged(numbers: &[f64], modes: usize, precision: Precision) -> Option<Vec<f64>> {
    let (header, works) = numbers.split_at(WORKS_HEADER);
    let greatest = (0..modes).map(|mode| works[packed(mode, mode)]).fold(0.0, f64::max);
    let rounding = AMPLIFIED * header[1] * greatest * precision.wide_epsilon();
    (header[0] == 1.0 && rounding <= ROUGHEST).then(|| works.to_vec())
}
