//! Designs that a device draws itself: in one submission they are drawn, their joints solved and their rows counted. What goes up does not
//! grow with the designs.

use std::ops::Range;

use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};
use super::dispatch::{self, Argument, PassTimes, Reading};
use super::joint_kernel::{ASKING, Batch, Buffers, Flight, JointKernel, TRAVELLING, Wanted, bytes};
use super::joint_load::Placed;
use super::joint_passes::{Asking, Bound, DESIGN_BYTES, pieces};
use super::joint_tables::JointParameters;
use super::kernel_texts::{DRAW, Variant};
use super::kernels::{Making, Precision, Stage};
use crate::engine::backend::IN_FLIGHT;
use crate::engine::backend::drawn::{DrawSettings, DrawnDesigns};
use crate::engine::backend::joints::{JointKind, JointTables};
use crate::engine::question::counted::MOST_ROWS;

/// What the kernel that draws reads.
const DRAWING: [(&str, BufferUsages); 3] = [
    ("settings", BufferUsages::UNIFORM.union(BufferUsages::COPY_DST)),
    ("words", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
    ("numbers", BufferUsages::STORAGE.union(BufferUsages::COPY_DST)),
];

/// Designs that a workgroup draws.
const TOGETHER: u32 = 64;

impl JointKernel {
    /// Has the device draw designs and count their rows, and does not wait for them. False where it has no room for what they have in
    /// common, or computes in f32 alone: nothing is begun then.
    pub fn begin_drawn(&mut self, gpu: &GpuDevice, drawn: &DrawnDesigns) -> Result<bool, GpuError> {
        if !gpu.facts.features.f64 || self.most_designs(gpu, &drawn.settings) == 0 {
            return Ok(false);
        }
        loop {
            match self.have_room(gpu, &drawn.tables) {
                Ok(true) => break,
                Ok(false) => return Ok(false),
                Err(error) => self.halve_after(gpu, error)?,
            }
        }
        self.make_stages(gpu, &drawn.tables)?;
        self.make_answers(gpu, &drawn.asked.question.text)?;
        if self.draw.as_ref().is_none_or(|(known, _)| known != drawn.functions) {
            let variant = Variant::plain(Precision::F64, TOGETHER);
            let stage = Stage::with_functions(gpu, &DRAW, &variant, drawn.functions, self.making)?;
            self.draw = Some((drawn.functions.to_string(), stage));
        }
        self.batches.push_back(Batch { is_counted: true, ..Batch::default() });
        let Range { mut start, end } = drawn.designs;
        while start < end {
            self.land_all_but(gpu, IN_FLIGHT - 1)?;
            let count = self.most_designs(gpu, &drawn.settings).min((end - start) as usize);
            let flown = self.fly_drawn(gpu, drawn, (start, count.max(1)));
            start += self.on_its_way(gpu, flown)? as u32;
        }
        Ok(true)
    }

    /// Brings tables to the device that are not there yet; false where it has no room for all of them.
    fn have_room(&mut self, gpu: &GpuDevice, tables: &[JointTables]) -> Result<bool, GpuError> {
        let all: Vec<&JointTables> = tables.iter().collect();
        let (met, bytes) = self.arenas.tables.meet(gpu, &all)?;
        self.counts.bytes_up += bytes;
        Ok(met == tables.len())
    }

    /// Designs of a flight at most.
    fn most_designs(&self, gpu: &GpuDevice, settings: &DrawSettings) -> usize {
        let DrawSettings { stride, found_stride, load_count, .. } = *settings;
        let most_bytes = self.most_bytes.min(gpu.facts.limits.binding_bytes);
        let of_bytes = most_bytes / bytes(stride.max(found_stride) as usize).max(1);
        (of_bytes as usize).min(MOST_ROWS / load_count.max(1) as usize)
    }

    fn fly_drawn(
        &mut self,
        gpu: &GpuDevice,
        drawn: &DrawnDesigns,
        (first, count): (u32, usize),
    ) -> Result<Flight, GpuError> {
        // They go where memory is short.
        if !self.have_room(gpu, &drawn.tables)? {
            let what = "room for tables of joints".to_string();
            return Err(GpuError::Lacks { adapter: gpu.facts.name.clone(), what });
        }
        let tables = drawn.tables.iter();
        let parameters: Vec<JointParameters> = tables.map(|own| self.arenas.tables.parameters(own)).collect();
        let question = &drawn.asked.question;
        let parts = question.layout.worth_reading(&drawn.asked.ranges, count);
        let wanted = Wanted::Told(question.layout.clone(), parts);
        let mut buffers = self.free.pop().unwrap_or_default();
        let reading = self.submit_drawn(gpu, &mut buffers, drawn, &parameters, (first, count), &wanted)?;
        Ok(Flight { joints: count, wanted, on_device: Some((buffers, reading)) })
    }

    fn submit_drawn(
        &mut self,
        gpu: &GpuDevice,
        Buffers { joints, answers, drawing }: &mut Buffers,
        DrawnDesigns { settings, words, numbers, tables, asked, .. }: &DrawnDesigns,
        parameters: &[JointParameters],
        (first, count): (u32, usize),
        wanted: &Wanted,
    ) -> Result<Reading, GpuError> {
        let (Some((_, draw)), Some((_, answer)), Wanted::Told(layout, _)) =
            (&self.draw, &self.answers, wanted)
        else {
            unreachable!("kernels are made before")
        };
        let settings = DrawSettings { first, design_count: count as u32, ..*settings };
        let mut kinds: Vec<JointKind> = tables.iter().map(JointTables::kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let passes = 2 + kinds.len() * pieces(count);
        let mut times = gpu.checked("joints", || PassTimes::of(gpu, passes))?;
        let staged = wanted.bytes() + times.bytes();
        let sizes = [
            size_of_val(parameters) as u64,
            (count * size_of::<Placed>()) as u64,
            bytes(settings.stride as usize * count),
            bytes(settings.found_stride as usize * count),
            staged,
        ];
        let told_bytes = bytes(layout.words(count));
        let of_answers = [size_of_val(&asked.tables[..]) as u64, (count * DESIGN_BYTES) as u64, told_bytes];
        let of_drawing = [size_of::<DrawSettings>(), size_of_val(&words[..]), size_of_val(&numbers[..])];
        let of_drawing = of_drawing.map(|size| size as u64);
        let counts = &mut self.counts;
        // Before anything is written: wgpu loses a device that has no memory for what is written.
        let [of_parameters, places, numbers_of_joints, found, staging] =
            gpu.checked("joints", || dispatch::kept(gpu, joints, TRAVELLING, sizes, counts))?;
        let [of_asked, designs, told] =
            gpu.checked("answers", || dispatch::kept(gpu, answers, ASKING, of_answers, counts))?;
        let [of_settings, of_words, of_numbers] =
            gpu.checked("drawing", || dispatch::kept(gpu, drawing, DRAWING, of_drawing, counts))?;
        counts.bytes_up += sizes[0] + of_answers[0] + of_drawing.iter().sum::<u64>();
        counts.bytes_down += wanted.bytes();
        let tables = self.arenas.tables.buffer();
        let stages = &self.stages;
        gpu.checked("joints", || {
            gpu.queue.write_buffer(of_parameters, 0, bytemuck::cast_slice(parameters));
            gpu.queue.write_buffer(of_asked, 0, bytemuck::cast_slice(&asked.tables));
            gpu.queue.write_buffer(of_settings, 0, bytemuck::bytes_of(&settings));
            gpu.queue.write_buffer(of_words, 0, bytemuck::cast_slice(words));
            gpu.queue.write_buffer(of_numbers, 0, bytemuck::cast_slice(numbers));
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.clear_buffer(told, 0, Some(told_bytes));
            draw_designs(
                gpu,
                draw,
                count,
                (&mut encoder, &mut times),
                &[
                    Argument::part("settings", of_settings, 0..of_drawing[0]),
                    Argument::whole("words", of_words),
                    Argument::whole("numbers", of_numbers),
                    Argument::whole("joints", numbers_of_joints),
                    Argument::whole("places", places),
                    Argument::whole("designs", designs),
                ],
            );
            counts.dispatches += 1;
            let bound = Bound {
                parameters: of_parameters,
                tables,
                places,
                joints: numbers_of_joints,
                works: Argument::whole("works", tables),
                near_fields: tables,
                found,
            };
            for kind in &kinds {
                let stage = (&stages[kind], kind.together);
                bound.solve(gpu, stage, (0, count), (&mut encoder, &mut times), counts);
            }
            let asking = Asking { asked: of_asked, designs: (designs, count), told };
            bound.count(gpu, answer, &asking, (&mut encoder, &mut times), counts);
            wanted.copy(told, staging, &mut encoder);
            times.resolve(&mut encoder, staging, wanted.bytes());
            let submission = gpu.queue.submit([encoder.finish()]);
            counts.submits += 1;
            gpu.reading(staging, staged, submission)
        })
    }
}

/// What a device writes of designs: their numbers, one design after another, and of each where they begin, where what is found of it would,
/// and its loads, none where it is left to the processor.
pub fn drawn_numbers(
    gpu: &GpuDevice,
    DrawnDesigns { designs, settings, words, numbers, functions, .. }: &DrawnDesigns,
) -> Result<(Vec<f32>, Vec<[u32; 4]>), GpuError> {
    let count = designs.len();
    let variant = Variant::plain(Precision::F64, TOGETHER);
    let stage = Stage::with_functions(gpu, &DRAW, &variant, functions, Making::Checked)?;
    let settings = DrawSettings { first: designs.start, design_count: count as u32, ..*settings };
    let [of_joints, places, of_designs] = gpu.checked("drawing", || {
        let joints = gpu.empty("joints", bytes(settings.stride as usize * count));
        let places = gpu.empty("places", (count * size_of::<Placed>()) as u64);
        let designs = gpu.empty("designs", (count * DESIGN_BYTES) as u64);
        let own = [gpu.uniform(&settings), gpu.filled("words", words), gpu.filled("numbers", numbers)];
        let arguments = [
            Argument::whole("settings", &own[0]),
            Argument::whole("words", &own[1]),
            Argument::whole("numbers", &own[2]),
            Argument::whole("joints", &joints),
            Argument::whole("places", &places),
            Argument::whole("designs", &designs),
        ];
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        draw_designs(gpu, &stage, count, (&mut encoder, &mut PassTimes::of(gpu, 0)), &arguments);
        gpu.queue.submit([encoder.finish()]);
        [joints, places, designs]
    })?;
    drop(places);
    let [numbers, designs] = [gpu.read(&of_joints)?, gpu.read(&of_designs)?];
    Ok((bytemuck::pod_collect_to_vec(&numbers), bytemuck::pod_collect_to_vec(&designs)))
}

fn draw_designs(
    gpu: &GpuDevice,
    stage: &Stage,
    count: usize,
    (encoder, times): (&mut wgpu::CommandEncoder, &mut PassTimes),
    arguments: &[Argument],
) {
    let mut pass = encoder.begin_compute_pass(&times.next());
    pass.set_pipeline(&stage.pipelines[0]);
    pass.set_bind_group(0, &gpu.bind(stage, arguments), &[]);
    pass.dispatch_workgroups(stage.workgroups(count.div_ceil(TOGETHER as usize) as u32), 1, 1);
}
