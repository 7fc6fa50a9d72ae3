//! Bodies eliminated on a device: of all topologies of a batch in one go, with one wait at its end. What a body needs for a while
//! (geometry, values, states) is in one set of buffers, which the device goes through step by step; numbers and works of two flights have
//! buffers of their own, so that the device has work while the host reads what it has done.

use std::array::from_fn;
use std::collections::VecDeque;
use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use wgpu::BufferUsages;

use super::batch::{MOST_BYTES, TARGET};
use super::context::GpuError;
use super::dispatch::{ALIGNMENT, Argument, PassTimes, Reading, kept};
use super::elimination_plan::{Cursor, FlightPlan, Piece, Room, Step, order};
use super::front::{AMPLIFIED, EliminateParameters, ROUGHEST, WORKS_HEADER, WorksOfBody};
use super::front_topology::Job;
use super::kernels::{Kernels, Precision, Stage};
use crate::engine::backend::{Counts, IN_FLIGHT, Works};
use crate::mechanics::compliance::arc::packed;

/// Batches of jobs on their way through a device, buffers that are kept for the next ones, and how long a batch took.
pub struct Elimination {
    /// Those of `SCRATCH`, as large as any step needed them.
    scratch: [Option<wgpu::Buffer>; 4],
    /// Those of `TRAVELLING` of each flight.
    travelling: [[Option<wgpu::Buffer>; 4]; IN_FLIGHT],
    /// Time of a product of tiles, s; nothing before any was measured.
    pace: Option<f64>,
    /// Of all buffers together.
    most_bytes: u64,
    /// How often that was halved for want of memory.
    halved: u32,
    /// In the order they were begun, with the number of the first.
    batches: VecDeque<Batch>,
    first_batch: usize,
    flights: VecDeque<Submitted>,
    /// Flights so far.
    flown: usize,
    /// When the device was last seen to come to an end.
    idle_since: Option<Instant>,
    pub counts: Counts,
    /// Of `counts.busy` that of `eliminate` alone.
    pub eliminating: Duration,
}

impl Default for Elimination {
    fn default() -> Elimination {
        Elimination {
            scratch: Default::default(),
            travelling: Default::default(),
            pace: None,
            most_bytes: MOST_BYTES,
            halved: 0,
            batches: VecDeque::new(),
            first_batch: 0,
            flights: VecDeque::new(),
            flown: 0,
            idle_since: None,
            counts: Counts::default(),
            eliminating: Duration::ZERO,
        }
    }
}

/// Jobs that were begun together.
struct Batch {
    jobs: Vec<Job>,
    order: Vec<usize>,
    /// What is submitted.
    cursor: Cursor,
    works: Works,
    /// Bodies whose works are not there yet.
    left: usize,
}

/// Steps that go to the device together.
struct Flight {
    /// `None` of one whose works stay on the device.
    batch: Option<usize>,
    pieces: Vec<Piece>,
    products: u64,
    /// Bytes of works that come back, before those that tell how long passes took.
    works: u64,
    /// Of each pass that is timed whether it is one of `eliminate`.
    passes: Vec<bool>,
    begun: Instant,
}

/// What is submitted and not read back.
struct Submitted {
    flight: Flight,
    reading: Reading,
}

/// Works that stay on the device, until as many flights as are there at a time have followed.
pub struct KeptWorks {
    pub buffer: wgpu::Buffer,
    /// What they take of it.
    pub bytes: u64,
    /// Where in it, in numbers, that which is of each body begins: of one job after the other.
    pub places: Vec<u32>,
    pub unsent: Unsent,
}

/// The last commands of a flight, which wait for what rests on them to be submitted together.
pub struct Unsent {
    flight: Flight,
    commands: Option<wgpu::CommandBuffer>,
    /// That which took them.
    submission: Option<wgpu::SubmissionIndex>,
    /// Where the host can read what comes back, and its bytes.
    staging: wgpu::Buffer,
    staged: u64,
}

impl Unsent {
    /// Submits other commands behind these, where they have not gone before.
    pub fn submit_with(&mut self, queue: &wgpu::Queue, others: wgpu::CommandBuffer) -> wgpu::SubmissionIndex {
        let is_first = self.commands.is_some();
        let submission = queue.submit(self.commands.take().into_iter().chain([others]));
        if is_first {
            self.submission = Some(submission.clone());
        }
        submission
    }
}

/// Time of a product of tiles before any was measured, s: short for a processor, long for a GPU.
const FIRST_GUESS: f64 = 1e-7;

/// With less the device is given up.
const FEWEST_BYTES: u64 = 1 << 20;

impl Elimination {
    /// On a device that is known to take so long for a product of tiles, s.
    pub fn at_pace(pace: f64) -> Elimination {
        Elimination { pace: Some(pace), ..Elimination::default() }
    }

    /// With buffers of so many bytes together.
    pub fn with_bytes(most_bytes: u64) -> Elimination {
        Elimination { most_bytes, ..Elimination::default() }
    }

    /// The works on the bodies of each job, where no other batch is begun; `None` for a body without a mesh, whose stiffness is not positive
    /// definite or loses too many digits.
    pub fn condense(&mut self, kernels: &Kernels, jobs: Vec<Job>) -> Result<Works, GpuError> {
        self.begin(kernels, jobs)?;
        self.finish(kernels)
    }

    /// Gives the device a batch, and does not wait for it. Where the device runs out of memory, it comes with smaller buffers and more
    /// waits.
    pub fn begin(&mut self, kernels: &Kernels, jobs: Vec<Job>) -> Result<(), GpuError> {
        let counts = jobs.iter().map(Job::count);
        let works = counts.clone().map(|count| vec![None; count]).collect();
        let left = counts.sum();
        self.batches.push_back(Batch { order: order(&jobs), cursor: Cursor::default(), works, left, jobs });
        self.submit_what_fits(kernels)
    }

    /// Waits for the batch that was begun before all others; empty if there is none.
    pub fn finish(&mut self, kernels: &Kernels) -> Result<Works, GpuError> {
        loop {
            match self.batches.front() {
                None => return Ok(Works::new()),
                Some(batch) if batch.left == 0 => {
                    self.first_batch += 1;
                    return Ok(self.batches.pop_front().map(|batch| batch.works).unwrap_or_default());
                }
                Some(_) => self.land(kernels)?,
            }
            self.submit_what_fits(kernels)?;
        }
    }

    /// Encodes jobs whose works stay on the device; what is unsent is to be given back with `sent`. `None` where they do not travel together,
    /// or the device runs out of memory.
    pub fn keep(&mut self, kernels: &Kernels, jobs: &[Job]) -> Result<Option<KeptWorks>, GpuError> {
        while self.flights.len() >= IN_FLIGHT {
            self.land(kernels)?;
        }
        let (order, mut cursor) = (order(jobs), Cursor::default());
        let plan = FlightPlan::next(jobs, &order, &mut cursor, &self.room(kernels));
        let bytes = plan.works;
        if cursor.place < order.len() || bytes == 0 || bytes > kernels.gpu.facts.limits.bound_buffer() {
            return Ok(None);
        }
        let wide = kernels.precision.wide_bytes();
        let firsts: Vec<usize> =
            jobs.iter().scan(0, |next, job| Some(std::mem::replace(next, *next + job.count()))).collect();
        let mut places = vec![0; jobs.iter().map(Job::count).sum()];
        for Piece { job, bodies, works } in plan.steps.iter().flat_map(|step| &step.pieces) {
            let size = jobs[*job].topology.elimination.body_size;
            let first = (works.start / wide) as u32;
            for (own, body) in bodies.clone().enumerate() {
                places[firsts[*job] + body] = first + own as u32 * size;
            }
        }
        let numbers = encoded(jobs, &plan, kernels.precision);
        let slot = self.flown % IN_FLIGHT;
        match self.encode(kernels, None, plan, &numbers) {
            Ok(unsent) => {
                let kept = |buffer| KeptWorks { buffer, bytes, places, unsent };
                Ok(self.travelling[slot][2].clone().map(kept))
            }
            Err(GpuError::OutOfMemory { .. }) if self.most_bytes > FEWEST_BYTES => {
                self.halve(kernels)?;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// How often buffers were halved for want of memory.
    pub fn halved(&self) -> u32 {
        self.halved
    }

    /// As many flights as may be on the device.
    fn submit_what_fits(&mut self, kernels: &Kernels) -> Result<(), GpuError> {
        while self.flights.len() < IN_FLIGHT {
            let is_open = |batch: &Batch| batch.cursor.place < batch.order.len();
            let Some(index) = self.batches.iter().position(is_open) else { break };
            let Batch { jobs, order, cursor, .. } = &self.batches[index];
            let mut cursor = *cursor;
            let plan = FlightPlan::next(jobs, order, &mut cursor, &self.room(kernels));
            let numbers = encoded(jobs, &plan, kernels.precision);
            let encoded = self.encode(kernels, Some(index), plan, &numbers);
            match encoded.and_then(|unsent| self.sent(kernels, unsent)) {
                Ok(()) => self.batches[index].cursor = cursor,
                Err(GpuError::OutOfMemory { .. }) if self.most_bytes > FEWEST_BYTES => self.halve(kernels)?,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Goes on with buffers of half the size.
    fn halve(&mut self, kernels: &Kernels) -> Result<(), GpuError> {
        // What is in flight keeps its buffers until it has landed.
        while !self.flights.is_empty() {
            self.land(kernels)?;
        }
        self.most_bytes /= 2;
        self.halved += 1;
        (self.scratch, self.travelling) = Default::default();
        Ok(())
    }

    /// Half of all bytes is for what the device works on, half for what two flights take up and down.
    fn room<'a>(&self, kernels: &'a Kernels) -> Room<'a> {
        Room {
            limits: &kernels.gpu.facts.limits,
            scratch: self.most_bytes / 2,
            travelling: self.most_bytes / 2 / IN_FLIGHT as u64,
            pace: self.pace(),
            wide: kernels.precision.wide_bytes(),
        }
    }

    fn pace(&self) -> f64 {
        self.pace.unwrap_or(FIRST_GUESS)
    }

    /// All steps in order, and the copy of their works to what is handed over to a batch. A submission ends where it has taken long enough;
    /// the last one is left to be made.
    fn encode(
        &mut self,
        kernels: &Kernels,
        index: Option<usize>,
        mut plan: FlightPlan,
        numbers: &[u8],
    ) -> Result<Unsent, GpuError> {
        let gpu = kernels.gpu;
        let fronts = plan.steps.iter().flat_map(|step| &step.fronts);
        let stages: Vec<Stage> =
            fronts.map(|step| kernels.eliminate(step.front)).collect::<Result<_, _>>()?;
        // Something must come back to tell that the flight has ended.
        let works = if index.is_some() { plan.works } else { plan.works.min(ALIGNMENT) };
        let flight = Flight {
            batch: index.map(|index| self.first_batch + index),
            pieces: plan.steps.iter_mut().flat_map(|step| std::mem::take(&mut step.pieces)).collect(),
            products: plan.steps.iter().map(|step| step.products).sum(),
            works,
            passes: Vec::new(),
            begun: Instant::now(),
        };
        let unsent = gpu.checked("elimination", || self.fly(kernels, &plan, numbers, stages, flight))?;
        self.counts.bytes_up += (numbers.len() + plan.topologies.len()) as u64;
        self.counts.bytes_down += works;
        self.flown += 1;
        Ok(unsent)
    }

    /// A flight all of whose commands are with the device from here on.
    pub fn sent(&mut self, kernels: &Kernels, unsent: Unsent) -> Result<(), GpuError> {
        let Unsent { flight, commands, submission, staging, staged } = unsent;
        let gpu = kernels.gpu;
        let reading = gpu.checked("elimination", || {
            let submission = submission.unwrap_or_else(|| {
                self.counts.submits += 1;
                gpu.queue.submit(commands)
            });
            gpu.reading(&staging, staged, submission)
        })?;
        self.flights.push_back(Submitted { flight, reading });
        Ok(())
    }

    /// Submits all but the last commands of a flight, whose passes it fills in.
    fn fly(
        &mut self,
        kernels: &Kernels,
        plan: &FlightPlan,
        numbers: &[u8],
        stages: Vec<Stage>,
        mut flight: Flight,
    ) -> Unsent {
        let Kernels { gpu, assemble, .. } = kernels;
        let most = |part: usize| plan.steps.iter().map(|step| step.scratch[part]).max().unwrap_or(0);
        // A binding may not be empty.
        let sizes = from_fn(|part| if part == 3 { most(part).max(EMPTY_FRONT) } else { most(part) });
        let (slot, pace) = (self.flown % IN_FLIGHT, self.pace());
        let [geometry, values, states, fronts] =
            kept(gpu, &mut self.scratch, SCRATCH, sizes, &mut self.counts);
        let most_passes = plan.steps.iter().map(|step| 1 + step.fronts.len()).sum();
        let mut times = PassTimes::of(gpu, most_passes);
        let staged = flight.works + times.bytes();
        let sizes = [numbers.len() as u64, plan.topologies.len() as u64, plan.works, staged];
        let [of_numbers, of_topologies, of_works, staging] =
            kept(gpu, &mut self.travelling[slot], TRAVELLING, sizes, &mut self.counts);
        gpu.queue.write_buffer(of_numbers, 0, numbers);
        gpu.queue.write_buffer(of_topologies, 0, &plan.topologies);
        let (mut left, mut stages) = (plan.steps.iter().peekable(), stages.into_iter());
        loop {
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            // A pass each, so that each is timed.
            let mut dispatch = |stage: &Stage, arguments: &[Argument], bodies: u32, is_elimination: bool| {
                let mut pass = encoder.begin_compute_pass(&times.next());
                flight.passes.push(is_elimination);
                pass.set_pipeline(&stage.pipelines[0]);
                pass.set_bind_group(0, &gpu.bind(stage, arguments), &[]);
                pass.dispatch_workgroups(stage.workgroups(bodies), 1, 1);
                self.counts.dispatches += 1;
            };
            let mut taken = 0.0;
            while let Some(step) = left.next_if(|_| taken < TARGET.as_secs_f64()) {
                let Step { shared, scratch, .. } = step;
                let of_values = || Argument::part("values", values, 0..scratch[1]);
                let of_states = || Argument::part("states", states, 0..scratch[2]);
                let arguments = [
                    Argument::part("topologies", of_topologies, step.topology_bytes.clone()),
                    Argument::part("bodies", of_numbers, step.numbers.clone()),
                    Argument::whole("shared_numbers", &shared.numbers),
                    Argument::whole("lists", &shared.lists),
                    Argument::part("geometry", geometry, 0..scratch[0]),
                    of_values(),
                    of_states(),
                ];
                dispatch(assemble, &arguments, step.bodies, false);
                for (front, stage) in step.fronts.iter().zip(&mut stages) {
                    let arguments = [
                        Argument::part("topologies", of_topologies, front.topology_bytes.clone()),
                        Argument::whole("lists", &shared.lists),
                        Argument::whole("loads", &shared.numbers),
                        of_values(),
                        of_states(),
                        Argument::part("works", of_works, step.works.clone()),
                        Argument::part("fronts", fronts, 0..scratch[3].max(EMPTY_FRONT)),
                    ];
                    dispatch(&stage, &arguments, front.bodies, true);
                }
                taken += pace * step.products as f64;
            }
            let is_last = left.peek().is_none();
            if is_last {
                encoder.copy_buffer_to_buffer(of_works, 0, staging, 0, flight.works);
                times.resolve(&mut encoder, staging, flight.works);
                let commands = Some(encoder.finish());
                return Unsent { flight, commands, submission: None, staging: staging.clone(), staged };
            }
            gpu.queue.submit([encoder.finish()]);
            self.counts.submits += 1;
        }
    }

    /// Waits for the first flight and takes its works.
    fn land(&mut self, kernels: &Kernels) -> Result<(), GpuError> {
        let Kernels { gpu, precision, .. } = kernels;
        let Some(Submitted { flight, reading }) = self.flights.pop_front() else { return Ok(()) };
        let Flight { batch, pieces, products, works: size, passes, begun } = flight;
        let was_there = gpu.is_there(&reading)?;
        let batch = batch.map(|batch| batch - self.first_batch);
        gpu.await_end(&reading)?;
        let ended = Instant::now();
        let all = gpu.look(reading)?;
        let (all, times) = all.split_at(size as usize);
        if let Some(Batch { jobs, works, left, .. }) = batch.map(|batch| &mut self.batches[batch]) {
            let of_piece = |piece: &Piece| -> Vec<Option<Vec<f64>>> {
                let EliminateParameters { body_size, mode_count, .. } = jobs[piece.job].topology.elimination;
                let size = body_size as usize * precision.wide_bytes() as usize;
                let of_bodies = all[bytes(&piece.works)].chunks_exact(size);
                of_bodies.map(|own| judged(own, mode_count as usize, *precision)).collect()
            };
            let found: Vec<_> = pieces.par_iter().map(of_piece).collect();
            for (piece, found) in pieces.into_iter().zip(found) {
                *left -= found.len();
                works[piece.job].splice(piece.bodies, found);
            }
        }
        // The device began when it was given this, or when it had ended what was before.
        let began = self.idle_since.map_or(begun, |idle| idle.max(begun));
        let measured = (ended - began).as_secs_f64() / products.max(1) as f64;
        // A small flight is mostly its own start; one that was there already tells no more than that it took no longer.
        let most = self.pace.map_or(f64::INFINITY, |known| if was_there { known } else { 2.0 * known });
        self.pace = Some(measured.min(most));
        self.idle_since = (!was_there).then_some(ended);
        for (time, is_elimination) in gpu.pass_times(times).into_iter().zip(passes) {
            self.counts.busy += time;
            self.eliminating += if is_elimination { time } else { Duration::ZERO };
        }
        // Works that stay there are looked for when what rests on them has been waited for.
        if batch.is_some() || !was_there {
            self.counts.waits += 1;
            self.counts.waits_with_work += u64::from(!self.flights.is_empty());
        }
        Ok(())
    }
}

/// Geometry, values, states and fronts of a step.
const SCRATCH: [(&str, BufferUsages); 4] = [
    ("geometry", BufferUsages::STORAGE),
    ("values", BufferUsages::STORAGE),
    ("states", BufferUsages::STORAGE),
    ("fronts", BufferUsages::STORAGE),
];

/// Of all steps of a flight: numbers, topologies and works, and these where the host can read them.
const TRAVELLING: [(&str, BufferUsages); 4] = [
    ("bodies", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("topologies", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("works", BufferUsages::STORAGE.union(BufferUsages::COPY_SRC)),
    ("staging", BufferUsages::COPY_DST.union(BufferUsages::MAP_READ)),
];

/// What is bound in place of fronts where there are none, bytes: a row of a tile.
const EMPTY_FRONT: u64 = 32;

/// The numbers of all bodies of a flight as the device takes them.
fn encoded(jobs: &[Job], plan: &FlightPlan, precision: Precision) -> Vec<u8> {
    let mut encoded = Vec::with_capacity(plan.numbers as usize);
    for step in &plan.steps {
        encoded.resize(step.numbers.start as usize, 0);
        for Piece { job, bodies, .. } in &step.pieces {
            let Job { numbers, .. } = &jobs[*job];
            let size = jobs[*job].body_size();
            encoded.extend(precision.encode(&numbers[bodies.start * size..bodies.end * size]));
        }
    }
    encoded
}

fn bytes(range: &Range<u64>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// The works of one body, if they are sound. The softer a body, the more of what its elements take up cancels.
fn judged(bytes: &[u8], modes: usize, precision: Precision) -> Option<Vec<f64>> {
    let mut numbers = precision.decode(bytes);
    let WorksOfBody { is_sound, spoilt: loss, works } = WorksOfBody::of(&numbers);
    let greatest = (0..modes).map(|mode| works[packed(mode, mode)]).fold(0.0, f64::max);
    let rounding = AMPLIFIED * loss * greatest * precision.wide_epsilon();
    let is_good = is_sound && rounding <= ROUGHEST;
    numbers.drain(..WORKS_HEADER);
    is_good.then_some(numbers)
}
