//! The states of interpolated joints on a device: fits and spaces are uploaded once, a joint is some numbers up and some a load down.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::FRAC_PI_2;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};
use super::dispatch::{Argument, Reading};
use super::kernel_texts::{JOINTS, Variant};
use super::kernels::{Making, Precision, Stage};
use crate::engine::backend::joints::{
    InterpolatedJoint, JointGroup, JointStates, JointTablesKey, MOST_NODES,
};
use crate::mechanics::compliance::body_fit::{BodyFit, NEGLIGIBLE};
use crate::mechanics::compliance::row_sums::Rows;

/// Of a dispatch at most: few enough for any device's limit, and for a watchdog.
const MOST_JOINTS: usize = 8192;

/// Bytes that are found by a dispatch at most.
const MOST_FOUND: usize = 64 << 20;

/// Joints whose numbers a thread makes at a time.
const TOGETHER: usize = 256;

/// Tables are dropped beyond these many bytes before more are made.
const KEPT_BYTES: u64 = 256 << 20;

/// As the kernel is told of a fit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct FitParameters {
    pub product_count: u32,
    pub degree_count: u32,
    pub member_count: u32,
    pub coefficient_stride: u32,
    pub row_stride: u32,
    pub order_count: u32,
    pub products_at: u32,
    pub coefficients_at: u32,
    pub sizes_at: u32,
    pub rows_at: u32,
    pub padding: [u32; 2],
}

/// And of a dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JointParameters {
    pub fits: [FitParameters; 2],
    pub node_count: u32,
    pub load_count: u32,
    pub space_at: u32,
    pub turns_at: u32,
    pub cosines_at: u32,
    pub widest: f32,
    pub negligible: f32,
    pub padding: u32,
}

/// The kernel with the tables it has been given.
pub struct JointKernel {
    /// Of the counts of trial pressures that were asked for.
    stages: HashMap<usize, Stage>,
    making: Making,
    tables: HashMap<JointTablesKey, Tables>,
}

struct Tables {
    buffer: wgpu::Buffer,
    parameters: JointParameters,
}

/// What is in flight of a group: joints from one on.
struct Piece {
    group: usize,
    first: usize,
    reading: Reading,
}

impl JointKernel {
    pub fn new(making: Making) -> JointKernel {
        JointKernel { stages: HashMap::new(), making, tables: HashMap::new() }
    }

    /// The states of the joints of each group, in their order; `None` for a joint with a load that has none.
    pub fn solve(
        &mut self,
        gpu: &GpuDevice,
        groups: &[JointGroup],
    ) -> Result<Vec<Vec<Option<JointStates>>>, GpuError> {
        if self.tables.values().map(|tables| tables.buffer.size()).sum::<u64>() > KEPT_BYTES {
            self.tables.clear();
        }
        for group in groups {
            let terms = group.space.pressures.terms;
            if let Entry::Vacant(place) = self.stages.entry(terms) {
                let variant = Variant { terms, ..Variant::plain(Precision::F32, MOST_NODES as u32) };
                place.insert(Stage::new(gpu, &JOINTS, &variant, self.making)?);
            }
            if let Entry::Vacant(place) = self.tables.entry(group.key) {
                place.insert(gpu.checked("tables of fits", || Tables::of(gpu, group))?);
            }
        }
        // The device has the first ones while the numbers of the next ones are made.
        let mut pieces = Vec::new();
        for (number, group) in groups.iter().enumerate() {
            let most = MOST_JOINTS.min(MOST_FOUND / (4 * group.found_of_joint()));
            for first in (0..group.joints.len()).step_by(most) {
                let joints = &group.joints[first..group.joints.len().min(first + most)];
                let reading = gpu.checked("interpolated joints", || self.submit(gpu, group, joints))?;
                pieces.push(Piece { group: number, first, reading });
            }
        }
        let mut states: Vec<Vec<Option<JointStates>>> =
            groups.iter().map(|group| Vec::with_capacity(group.joints.len())).collect();
        for Piece { group, first, reading } in pieces {
            let JointGroup { joints, .. } = &groups[group];
            let size = groups[group].found_of_joint();
            let found = gpu.look(reading, bytemuck::pod_collect_to_vec::<u8, f32>)?;
            let of_joint = |(numbers, joint): (&[f32], _)| InterpolatedJoint::states(joint, numbers);
            let of_piece = found.par_chunks_exact(size).zip(&joints[first..]).map(of_joint);
            states[group].extend(of_piece.collect::<Vec<_>>());
        }
        Ok(states)
    }

    /// Some joints of a group, in one dispatch.
    fn submit(&self, gpu: &GpuDevice, group: &JointGroup, joints: &[InterpolatedJoint]) -> Reading {
        let Tables { buffer, parameters } = &self.tables[&group.key];
        let stage = &self.stages[&group.space.pressures.terms];
        let parameters = JointParameters { load_count: group.load_count as u32, ..*parameters };
        let numbers: Vec<f32> = joints
            .par_chunks(TOGETHER)
            .flat_map_iter(|joints| {
                let mut numbers = Vec::with_capacity(joints.len() * group.numbers_of_joint());
                joints.iter().for_each(|joint| joint.numbers(&mut numbers));
                numbers
            })
            .collect();
        let size = (4 * joints.len() * group.found_of_joint()) as u64;
        let found = gpu.empty("found", size);
        let staging = gpu.with_usage("staging", size, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        let (uniform, of_joints) = (gpu.uniform(&parameters), gpu.filled("joints", &numbers));
        let arguments = [
            Argument::whole("parameters", &uniform),
            Argument::whole("tables", buffer),
            Argument::whole("joints", &of_joints),
            Argument::whole("found", &found),
        ];
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&stage.pipelines[0]);
        pass.set_bind_group(0, &gpu.bind(stage, &arguments), &[]);
        pass.dispatch_workgroups(joints.len() as u32, 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&found, 0, &staging, 0, size);
        let submission = gpu.queue.submit([encoder.finish()]);
        gpu.reading(&staging, size, submission)
    }
}

impl Tables {
    fn of(gpu: &GpuDevice, group: &JointGroup) -> Tables {
        let mut words: Vec<u32> = Vec::new();
        let fits = group.fits.map(|(fit, rows)| of_fit(fit, rows, &mut words));
        let mut add = |numbers: &mut dyn Iterator<Item = f64>| {
            let at = words.len() as u32;
            words.extend(numbers.map(|number| (number as f32).to_bits()));
            at
        };
        let node_count = group.space.arcs().len();
        let parameters = JointParameters {
            fits,
            node_count: node_count as u32,
            load_count: 0,
            space_at: add(&mut group.space.node_numbers().flatten()),
            turns_at: add(&mut group.space.pressures.turns.iter().copied()),
            cosines_at: add(
                &mut (0..4 * node_count).map(|step| (FRAC_PI_2 * step as f64 / node_count as f64).cos())
            ),
            widest: group.space.widest() as f32,
            negligible: NEGLIGIBLE,
            padding: 0,
        };
        Tables { buffer: gpu.filled("tables", &words), parameters }
    }
}

/// Adds what is known of a fit.
fn of_fit(fit: &BodyFit, rows: &Rows, words: &mut Vec<u32>) -> FitParameters {
    let products_at = words.len() as u32;
    let degrees = fit.polynomials.degrees();
    let degree_count = 1 + degrees.iter().flatten().copied().max().unwrap_or(0);
    words.extend(degrees.iter().map(|degrees| u32::from_le_bytes(*degrees)));
    let mut add = |numbers: &[f32]| {
        let at = words.len() as u32;
        words.extend(numbers.iter().map(|number| number.to_bits()));
        at
    };
    let member_count = fit.member_count();
    FitParameters {
        product_count: degrees.len() as u32,
        degree_count: u32::from(degree_count),
        member_count: member_count as u32,
        coefficient_stride: fit.coefficients().stride() as u32,
        row_stride: rows.stride() as u32,
        order_count: (rows.sizes().len() / (member_count + 2)) as u32,
        products_at,
        coefficients_at: add(fit.coefficients().values()),
        sizes_at: add(rows.sizes()),
        rows_at: add(rows.values()),
        padding: [0; 2],
    }
}
