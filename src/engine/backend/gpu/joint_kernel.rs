//! The states of joints on a device: what they have in common is uploaded once (`joint_tables`), a joint is some numbers up and some a load
//! down. The joints of a batch go in one flight, if there is room, with one wait at its end.

use std::collections::VecDeque;
use std::ops::Range;

use foldhash::HashMap;
use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};
use super::dispatch::{ALIGNMENT, Argument, Reading};
use super::elimination::{Counts, kept};
use super::joint_tables::{JointParameters, TableArena};
use super::kernel_texts::{JOINTS, Variant};
use super::kernels::{Making, Precision, Stage};
use crate::engine::backend::joints::{BatchedJoint, JointBatch, JointTables, MOST_NODES};

/// Of a dispatch at most: few enough for any device's limit, and for a watchdog.
const MOST_JOINTS: usize = 8192;

/// What goes up or down with a flight at most, bytes; with less the device is given up.
const MOST_BYTES: u64 = 64 << 20;
const FEWEST_BYTES: u64 = 1 << 20;

/// The kernel with the tables it has been given, and batches on their way through it.
pub struct JointKernel {
    /// Of the counts of trial pressures that were asked for.
    stages: HashMap<usize, Stage>,
    making: Making,
    tables: TableArena,
    /// In the order they were begun.
    batches: VecDeque<Batch>,
    /// Buffers that no flight has.
    free: Vec<Buffers>,
    most_bytes: u64,
    pub counts: Counts,
}

/// Those of `TRAVELLING`.
type Buffers = [Option<wgpu::Buffer>; 5];

/// Joints that were begun together.
#[derive(Default)]
struct Batch {
    /// What is submitted and not read back.
    flights: VecDeque<Flight>,
    found: Vec<f32>,
}

struct Flight {
    buffers: Buffers,
    reading: Reading,
}

/// A joint as the kernel has it: where its parameters are, its numbers and what is found of it begin, and how many loads it has.
type Placed = [u32; 4];

/// Parameters, places, numbers and what is found, and that where the host can read it.
const TRAVELLING: [(&str, BufferUsages); 5] = [
    ("parameters", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("places", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("joints", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("found", BufferUsages::STORAGE.union(BufferUsages::COPY_SRC)),
    ("staging", BufferUsages::COPY_DST.union(BufferUsages::MAP_READ)),
];

/// What a flight takes up.
struct Load {
    /// Of the joints that are left.
    count: usize,
    parameters: Vec<JointParameters>,
    /// Of each count of trial pressures.
    places: Vec<(usize, Vec<Placed>)>,
    found_bytes: u64,
}

impl JointKernel {
    pub fn new(making: Making) -> JointKernel {
        JointKernel {
            stages: HashMap::default(),
            making,
            tables: TableArena::default(),
            batches: VecDeque::new(),
            free: Vec::new(),
            most_bytes: MOST_BYTES,
            counts: Counts::default(),
        }
    }

    /// Gives the device joints, and does not wait for them. Where the device runs out of memory, they come in smaller flights.
    pub fn begin(&mut self, gpu: &GpuDevice, batch: &JointBatch) -> Result<(), GpuError> {
        for JointTables { space: (key, _), .. } in &batch.tables {
            if !self.stages.contains_key(&key.terms) {
                let plain = Variant::plain(Precision::F32, MOST_NODES as u32);
                let stage = Stage::new(gpu, &JOINTS, &Variant { terms: key.terms, ..plain }, self.making)?;
                self.stages.insert(key.terms, stage);
            }
        }
        self.batches.push_back(Batch::default());
        let mut first = 0;
        while first < batch.joints.len() {
            match gpu.checked("joints", || self.fly(gpu, batch, first)) {
                Ok((count, flight)) => {
                    first += count;
                    if let Some(own) = self.batches.back_mut() {
                        own.flights.push_back(flight);
                    }
                }
                Err(GpuError::OutOfMemory { .. }) if self.most_bytes > FEWEST_BYTES => {
                    // What is in flight keeps its buffers until it has landed.
                    for index in 0..self.batches.len() {
                        self.land(gpu, index)?;
                    }
                    self.most_bytes /= 2;
                    self.free.clear();
                    self.tables = TableArena::default();
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Waits for the batch that was begun before all others: what is found of its joints, one after another.
    pub fn finish(&mut self, gpu: &GpuDevice) -> Result<Vec<f32>, GpuError> {
        if !self.batches.is_empty() {
            self.land(gpu, 0)?;
        }
        Ok(self.batches.pop_front().map(|batch| batch.found).unwrap_or_default())
    }

    /// Waits for all flights of a batch.
    fn land(&mut self, gpu: &GpuDevice, index: usize) -> Result<(), GpuError> {
        let Batch { flights, found } = &mut self.batches[index];
        while let Some(Flight { buffers, reading }) = flights.pop_front() {
            gpu.look(reading, |bytes| match found.is_empty() {
                true => *found = bytemuck::pod_collect_to_vec(bytes),
                false => found.extend(bytemuck::pod_collect_to_vec::<u8, f32>(bytes)),
            })?;
            self.free.push(buffers);
            self.counts.waits += 1;
        }
        Ok(())
    }

    /// As many joints from one on as there is room for; tells how many.
    fn fly(&mut self, gpu: &GpuDevice, batch: &JointBatch, first: usize) -> (usize, Flight) {
        let Load { count, parameters, places, found_bytes } = self.load(gpu, batch, first);
        let numbers =
            &batch.numbers[numbers_of(batch, first).start..numbers_of(batch, first + count - 1).end];
        // Those of each count of trial pressures begin at a part of the buffer.
        let whole_part =
            |places: &(usize, Vec<Placed>)| size_of_val(&places.1[..]).next_multiple_of(ALIGNMENT as usize);
        let sizes = [
            size_of_val(&parameters[..]) as u64,
            places.iter().map(whole_part).sum::<usize>() as u64,
            size_of_val(numbers) as u64,
            found_bytes,
            found_bytes,
        ];
        let mut buffers = self.free.pop().unwrap_or_default();
        let [of_parameters, of_places, of_joints, found, staging] =
            kept(gpu, &mut buffers, TRAVELLING, sizes, &mut self.counts);
        gpu.queue.write_buffer(of_parameters, 0, bytemuck::cast_slice(&parameters));
        gpu.queue.write_buffer(of_joints, 0, bytemuck::cast_slice(numbers));
        self.counts.bytes_up += sizes[..3].iter().sum::<u64>();
        self.counts.bytes_down += found_bytes;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut at = 0;
        for of_terms in &places {
            let (terms, own) = of_terms;
            gpu.queue.write_buffer(of_places, at, bytemuck::cast_slice(own));
            let tables = self.tables.buffer().unwrap_or_else(|| unreachable!("joints have tables"));
            for (piece, joints) in own.chunks(MOST_JOINTS).enumerate() {
                let stage = &self.stages[terms];
                let from = at + (piece * MOST_JOINTS * size_of::<Placed>()) as u64;
                let arguments = [
                    Argument::whole("parameters", of_parameters),
                    Argument::whole("tables", tables),
                    Argument::part("places", of_places, from..from + size_of_val(joints) as u64),
                    Argument::whole("joints", of_joints),
                    Argument::whole("found", found),
                ];
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&stage.pipelines[0]);
                pass.set_bind_group(0, &gpu.bind(stage, &arguments), &[]);
                pass.dispatch_workgroups(joints.len() as u32, 1, 1);
                drop(pass);
                self.counts.dispatches += 1;
            }
            at += whole_part(of_terms) as u64;
        }
        encoder.copy_buffer_to_buffer(found, 0, staging, 0, found_bytes);
        let submission = gpu.queue.submit([encoder.finish()]);
        self.counts.submits += 1;
        let reading = gpu.reading(staging, found_bytes, submission);
        (count, Flight { buffers, reading })
    }

    /// What there is room for of the joints from one on, one at least, whose tables are there then.
    fn load(&mut self, gpu: &GpuDevice, batch: &JointBatch, first: usize) -> Load {
        let most = (self.most_bytes.min(gpu.facts.limits.binding_bytes) / 4) as usize;
        let start = numbers_of(batch, first).start;
        // Tables in the order in which joints ask for them, and their places in it.
        let mut tables: Vec<&JointTables> = Vec::new();
        let mut order: Vec<Option<u32>> = vec![None; batch.tables.len()];
        let (mut count, mut found) = (0, 0);
        for (place, joint) in batch.joints.iter().enumerate().skip(first) {
            if count > 0 && (numbers_of(batch, place).end - start > most || found + joint.found() > most) {
                break;
            }
            found += joint.found();
            count += 1;
            order[joint.tables as usize].get_or_insert_with(|| {
                tables.push(&batch.tables[joint.tables as usize]);
                tables.len() as u32 - 1
            });
        }
        let (met, bytes) = self.tables.meet(gpu, &tables);
        self.counts.bytes_up += bytes;
        let tables = &tables[..met];
        let mut load = Load {
            count: 0,
            parameters: tables.iter().map(|tables| self.tables.parameters(tables)).collect(),
            places: Vec::new(),
            found_bytes: 0,
        };
        for joint in &batch.joints[first..first + count] {
            let Some(own) = order[joint.tables as usize].filter(|own| (*own as usize) < met) else { break };
            let terms = tables[own as usize].space.0.terms;
            let numbers_at = joint.numbers_at - start as u32;
            let placed = [own, numbers_at, (load.found_bytes / 4) as u32, joint.load_count];
            match load.places.iter_mut().find(|(own, _)| *own == terms) {
                Some((_, places)) => places.push(placed),
                None => load.places.push((terms, vec![placed])),
            }
            load.count += 1;
            load.found_bytes += 4 * joint.found() as u64;
        }
        load
    }
}

/// Of a joint, among those of its batch.
fn numbers_of(batch: &JointBatch, joint: usize) -> Range<usize> {
    let at = |joint: &BatchedJoint| joint.numbers_at as usize;
    at(&batch.joints[joint])..batch.joints.get(joint + 1).map_or(batch.numbers.len(), at)
}
