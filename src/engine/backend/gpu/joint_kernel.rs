//! The states of joints on a device: batches on their way through the kernel, from what each flight takes up (`joint_load`) to what it finds. The
//! joints of a batch go in one flight, if there is room, with one wait at its end.

use std::collections::VecDeque;
use std::ops::Range;

use foldhash::HashMap;
use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};
use super::dispatch::{self, Argument, PassTimes, Reading};
use super::elimination::KeptWorks;
use super::joint_load::{Arenas, Load, whole_parts};
use super::joint_passes::{Asking, Bound, pieces};
use super::kernel_texts::{ANSWERING, ANSWERS, JOINTS, Variant};
use super::kernels::{Making, Precision, Stage};
use crate::engine::backend::joints::{
    AskedOfJoints, BatchedJoint, JointBatch, JointKind, JointNumbers, JointTables, MOST_NODES,
};
use crate::engine::backend::{Counts, IN_FLIGHT};
use crate::engine::question::counted::{Layout, Told};

/// What goes up or down with a flight at most, bytes; with less the device is given up.
const MOST_BYTES: u64 = 64 << 20;
const FEWEST_BYTES: u64 = 1 << 20;

/// The kernel with the tables it has been given, and batches on their way through it.
pub struct JointKernel {
    /// Of the kinds of joints that were asked for.
    pub(super) stages: HashMap<JointKind, Stage>,
    /// What counts rows, by the functions of its question.
    pub(super) answers: Option<(String, Stage)>,
    pub(super) making: Making,
    pub(super) arenas: Arenas,
    /// In the order they were begun.
    pub(super) batches: VecDeque<Batch>,
    /// What draws designs, by the functions of its question.
    pub(super) draw: Option<(String, Stage)>,
    /// Buffers that no flight has.
    pub(super) free: Vec<Buffers>,
    pub(super) most_bytes: u64,
    pub counts: Counts,
}

/// Those of `TRAVELLING`, of `ASKING` where rows are counted, and of `DRAWING` where designs are drawn.
#[derive(Default)]
pub(super) struct Buffers {
    pub joints: [Option<wgpu::Buffer>; 5],
    pub answers: [Option<wgpu::Buffer>; 3],
    pub drawing: [Option<wgpu::Buffer>; 3],
}

/// Joints that were begun together.
#[derive(Default)]
pub(super) struct Batch {
    /// What is submitted and not read back.
    pub flights: VecDeque<Flight>,
    pub found: Vec<f32>,
    /// Whether rows are counted, and then what is told in the place of what is found.
    pub is_counted: bool,
    pub told: Vec<Told>,
}

pub(super) struct Flight {
    pub joints: usize,
    pub wanted: Wanted,
    /// Nothing where tables are too large for the device: its joints have no states.
    pub on_device: Option<(Buffers, Reading)>,
}

/// What comes back of a flight, before what tells how long passes took.
pub(super) enum Wanted {
    /// So many words of states.
    Found(usize),
    /// Counts: some parts of them.
    Told(Layout, Vec<Range<usize>>),
}

impl Wanted {
    pub(super) fn bytes(&self) -> u64 {
        let words = match self {
            Wanted::Found(words) => *words,
            Wanted::Told(_, parts) => parts.iter().map(Range::len).sum(),
        };
        bytes(words)
    }

    /// From where it is found to where the host can read it.
    pub(super) fn copy(&self, from: &wgpu::Buffer, to: &wgpu::Buffer, encoder: &mut wgpu::CommandEncoder) {
        let mut at = 0;
        let mut copy = |words: Range<usize>| {
            encoder.copy_buffer_to_buffer(from, bytes(words.start), to, at, bytes(words.len()));
            at += bytes(words.len());
        };
        match self {
            Wanted::Found(words) => copy(0..*words),
            Wanted::Told(_, parts) => parts.iter().cloned().for_each(copy),
        }
    }
}

pub(super) fn bytes(words: usize) -> u64 {
    (size_of::<u32>() * words) as u64
}

/// Parameters, places, numbers and what is found, and that where the host can read it.
pub(super) const TRAVELLING: [(&str, BufferUsages); 5] = [
    ("parameters", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("places", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("joints", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("found", BufferUsages::STORAGE.union(BufferUsages::COPY_SRC)),
    ("staging", BufferUsages::COPY_DST.union(BufferUsages::MAP_READ)),
];

/// Tables of a question, its designs, and what is told of them.
pub(super) const ASKING: [(&str, BufferUsages); 3] = [
    ("asked", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("designs", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("told", BufferUsages::STORAGE.union(BufferUsages::COPY_SRC).union(BufferUsages::COPY_DST)),
];

impl JointKernel {
    pub fn new(making: Making) -> JointKernel {
        JointKernel {
            stages: HashMap::default(),
            answers: None,
            draw: None,
            making,
            arenas: Arenas::default(),
            batches: VecDeque::new(),
            free: Vec::new(),
            most_bytes: MOST_BYTES,
            counts: Counts::default(),
        }
    }

    /// Gives the device joints, and does not wait for them. Where the device runs out of memory, they come in smaller flights.
    pub fn begin(&mut self, gpu: &GpuDevice, batch: &JointBatch) -> Result<(), GpuError> {
        self.begin_with(gpu, batch, None)
    }

    /// The same of joints whose bodies are condensed before, if their works stay on the device: in one submission with the last of that.
    pub fn begin_with(
        &mut self,
        gpu: &GpuDevice,
        batch: &JointBatch,
        mut works: Option<&mut KeptWorks>,
    ) -> Result<(), GpuError> {
        self.make_stages(gpu, &batch.tables)?;
        let mut found = Vec::new();
        match &batch.asked {
            Some(asked) => self.make_answers(gpu, &asked.question.text)?,
            None => found.reserve(batch.joints.iter().map(BatchedJoint::found).sum()),
        }
        let is_counted = batch.asked.is_some();
        self.batches.push_back(Batch { found, is_counted, ..Batch::default() });
        let mut first = 0;
        while first < batch.joints.len() {
            self.land_all_but(gpu, IN_FLIGHT - 1)?;
            let flown = self.fly(gpu, batch, first, works.as_deref_mut());
            first += self.on_its_way(gpu, flown)?;
        }
        Ok(())
    }

    /// The kernels of joints with some tables.
    pub(super) fn make_stages(&mut self, gpu: &GpuDevice, tables: &[JointTables]) -> Result<(), GpuError> {
        for joints in tables.iter().map(JointTables::kind) {
            if !self.stages.contains_key(&joints) {
                let plain = Variant::plain(Precision::F32, MOST_NODES as u32);
                let stage = Stage::new(gpu, &JOINTS, &Variant { joints, ..plain }, self.making)?;
                self.stages.insert(joints, stage);
            }
        }
        Ok(())
    }

    /// Adds a flight to the last batch; tells how many joints are on their way with it: none where there was no memory, and the next one may
    /// take half of it.
    pub(super) fn on_its_way(
        &mut self,
        gpu: &GpuDevice,
        flown: Result<Flight, GpuError>,
    ) -> Result<usize, GpuError> {
        match flown {
            Ok(flight) => {
                let joints = flight.joints;
                if let Some(own) = self.batches.back_mut() {
                    own.flights.push_back(flight);
                }
                Ok(joints)
            }
            Err(error) => self.halve_after(gpu, error).map(|()| 0),
        }
    }

    /// Goes on with flights of half the size where memory is short.
    pub(super) fn halve_after(&mut self, gpu: &GpuDevice, error: GpuError) -> Result<(), GpuError> {
        if !matches!(error, GpuError::OutOfMemory { .. }) || self.most_bytes <= FEWEST_BYTES {
            return Err(error);
        }
        // What is in flight keeps its buffers until it has landed, and what was written to until that is submitted.
        self.land_all_but(gpu, 0)?;
        self.most_bytes /= 2;
        self.free.clear();
        self.arenas = Arenas::default();
        gpu.settle()
    }

    /// How often flights were halved for want of memory.
    pub fn halved(&self) -> u32 {
        (MOST_BYTES / self.most_bytes).ilog2()
    }

    /// Waits for the batch that was begun before all others: what is found of its joints, one after another.
    pub fn finish(&mut self, gpu: &GpuDevice) -> Result<Vec<f32>, GpuError> {
        Ok(self.finished(gpu, false)?.map(|batch| batch.found).unwrap_or_default())
    }

    /// The same of a batch whose rows were counted.
    pub fn finish_answers(&mut self, gpu: &GpuDevice) -> Result<Vec<Told>, GpuError> {
        Ok(self.finished(gpu, true)?.map(|batch| batch.told).unwrap_or_default())
    }

    fn finished(&mut self, gpu: &GpuDevice, is_counted: bool) -> Result<Option<Batch>, GpuError> {
        let is_wanted = |batch: &Batch| batch.is_counted == is_counted;
        let Some(index) = self.batches.iter().position(is_wanted) else { return Ok(None) };
        while !self.batches[index].flights.is_empty() {
            self.land(gpu, index)?;
        }
        Ok(self.batches.remove(index))
    }

    /// The kernel that counts rows, with the functions of a question.
    pub(super) fn make_answers(&mut self, gpu: &GpuDevice, functions: &str) -> Result<(), GpuError> {
        if self.answers.as_ref().is_none_or(|(known, _)| known != functions) {
            let variant = Variant::plain(Precision::F32, ANSWERING);
            let stage = Stage::with_functions(gpu, &ANSWERS, &variant, functions, self.making)?;
            self.answers = Some((functions.to_string(), stage));
        }
        Ok(())
    }

    /// Waits for the oldest flights, until so many are left.
    pub(super) fn land_all_but(&mut self, gpu: &GpuDevice, left: usize) -> Result<(), GpuError> {
        let mut in_flight: usize = self.batches.iter().map(|batch| batch.flights.len()).sum();
        for index in 0..self.batches.len() {
            while in_flight > left && !self.batches[index].flights.is_empty() {
                self.land(gpu, index)?;
                in_flight -= 1;
            }
        }
        Ok(())
    }

    /// Waits for the first flight of a batch.
    fn land(&mut self, gpu: &GpuDevice, index: usize) -> Result<(), GpuError> {
        let Batch { flights, found, told, .. } = &mut self.batches[index];
        let Some(Flight { joints, wanted, on_device }) = flights.pop_front() else { return Ok(()) };
        let Some((buffers, reading)) = on_device else {
            match wanted {
                Wanted::Found(words) => found.extend(std::iter::repeat_n(0.0, words)),
                Wanted::Told(..) => told.push(Told { designs: joints, ..Told::default() }),
            }
            return Ok(());
        };
        let mut all = Vec::new();
        let own = gpu.look(reading)?;
        let (own, times) = own.split_at(wanted.bytes() as usize);
        self.counts.busy += gpu.busy(times);
        match wanted {
            Wanted::Found(_) => found.extend(own.as_chunks().0.iter().map(|word| f32::from_ne_bytes(*word))),
            Wanted::Told(..) => all = words_of(own),
        }
        if let Wanted::Told(layout, parts) = wanted {
            let mut own = Told { designs: joints, parts, all };
            if !layout.is_whole(&own) {
                // Values lie farther out than was known: all of it.
                let [.., Some(buffer)] = &buffers.answers else { return Ok(()) };
                let mut all = words_of(&gpu.read(buffer)?);
                all.truncate(layout.words(joints));
                self.counts.submits += 1;
                self.counts.waits += 1;
                self.counts.bytes_down += bytes(all.len());
                own = Told { designs: joints, parts: std::iter::once(0..all.len()).collect(), all };
            }
            told.push(own);
        }
        self.free.push(buffers);
        self.counts.waits += 1;
        let is_more = self.batches.iter().any(|batch| !batch.flights.is_empty());
        self.counts.waits_with_work += u64::from(is_more);
        Ok(())
    }

    /// As many joints from one on as there is room for, one at least.
    fn fly(
        &mut self,
        gpu: &GpuDevice,
        batch: &JointBatch,
        first: usize,
        works: Option<&mut KeptWorks>,
    ) -> Result<Flight, GpuError> {
        let load = self.arenas.load(gpu, (batch, first), works.as_deref(), self.most_bytes)?;
        self.counts.bytes_up += load.of_tables;
        let joints = load.count.max(1);
        let wanted = match &batch.asked {
            Some(AskedOfJoints { question, ranges, .. }) => {
                Wanted::Told(question.layout.clone(), question.layout.worth_reading(ranges, joints))
            }
            None if load.count == 0 => Wanted::Found(batch.joints[first].found()),
            None => Wanted::Found(load.found_bytes as usize / size_of::<f32>()),
        };
        if load.count == 0 {
            return Ok(Flight { joints, wanted, on_device: None });
        }
        let mut buffers = self.free.pop().unwrap_or_default();
        let asked = batch.asked.as_ref().map(|asked| &asked.tables[..]);
        let reading = self.submit(gpu, &mut buffers, &load, (&batch.numbers, works), (asked, &wanted))?;
        Ok(Flight { joints, wanted, on_device: Some((buffers, reading)) })
    }

    fn submit(
        &mut self,
        gpu: &GpuDevice,
        Buffers { joints: buffers, answers, .. }: &mut Buffers,
        load: &Load,
        (numbers, works): (&JointNumbers, Option<&mut KeptWorks>),
        (asked, wanted): (Option<&[f32]>, &Wanted),
    ) -> Result<Reading, GpuError> {
        let Load { parameters, places, designs, found_bytes, .. } = load;
        let pieces: usize = places.iter().map(|(_, places)| pieces(places.len())).sum();
        let mut times =
            gpu.checked("joints", || PassTimes::of(gpu, pieces + usize::from(asked.is_some())))?;
        let staged = wanted.bytes() + times.bytes();
        let sizes = [
            size_of_val(&parameters[..]) as u64,
            places.iter().map(|(_, places)| whole_parts(places)).sum(),
            bytes(load.numbers.len()),
            *found_bytes,
            staged,
        ];
        // Before anything is written: wgpu loses a device that has no memory for what is written.
        let (counts, stages, tables) = (&mut self.counts, &self.stages, self.arenas.tables.buffer());
        // A binding may not be empty.
        let near_fields = self.arenas.near_fields.buffer().unwrap_or(tables);
        let kept = gpu.checked("joints", || dispatch::kept(gpu, buffers, TRAVELLING, sizes, counts))?;
        let [of_parameters, of_places, of_joints, found, staging] = kept;
        counts.bytes_up += sizes[..3].iter().sum::<u64>();
        counts.bytes_down += wanted.bytes();
        let mut counting = None;
        if let (Some(asked), Some((_, stage)), Wanted::Told(layout, _)) = (asked, &self.answers, wanted) {
            let told = bytes(layout.words(designs.len()));
            let sizes = [size_of_val(asked) as u64, size_of_val(&designs[..]) as u64, told];
            counts.bytes_up += sizes[..2].iter().sum::<u64>();
            let kept = gpu.checked("answers", || dispatch::kept(gpu, answers, ASKING, sizes, counts))?;
            counting = Some((kept, asked, stage, told));
        }
        gpu.checked("joints", || {
            gpu.queue.write_buffer(of_parameters, 0, bytemuck::cast_slice(parameters));
            gpu.write_pieces(of_joints, sizes[2], numbers.within(load.numbers.clone()));
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let bound = Bound {
                parameters: of_parameters,
                tables,
                places: of_places,
                joints: of_joints,
                works: match &works {
                    Some(works) => Argument::part("works", &works.buffer, 0..works.bytes),
                    None => Argument::whole("works", tables),
                },
                near_fields,
                found,
            };
            let mut at = 0;
            for (kind, own) in places {
                gpu.queue.write_buffer(of_places, at, bytemuck::cast_slice(own));
                let stage = (&stages[kind], kind.together);
                bound.solve(gpu, stage, (at, own.len()), (&mut encoder, &mut times), counts);
                at += whole_parts(own);
            }
            let mut read = found;
            if let Some(([of_asked, of_designs, told], asked, stage, size)) = counting {
                gpu.queue.write_buffer(of_asked, 0, bytemuck::cast_slice(asked));
                gpu.queue.write_buffer(of_designs, 0, bytemuck::cast_slice(designs));
                encoder.clear_buffer(told, 0, Some(size));
                let asking = Asking { asked: of_asked, designs: (of_designs, designs.len()), told };
                bound.count(gpu, stage, &asking, (&mut encoder, &mut times), counts);
                read = told;
            }
            wanted.copy(read, staging, &mut encoder);
            times.resolve(&mut encoder, staging, wanted.bytes());
            let submission = match works {
                Some(works) => works.unsent.submit_with(&gpu.queue, encoder.finish()),
                None => gpu.queue.submit([encoder.finish()]),
            };
            counts.submits += 1;
            gpu.reading(staging, staged, submission)
        })
    }
}

fn words_of(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|word| u32::from_ne_bytes(*word)).collect()
}
