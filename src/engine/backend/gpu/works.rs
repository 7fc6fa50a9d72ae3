//! The works of ring modes on the bodies of a batch that was solved: what the device hands over.

use bytemuck::{Pod, Zeroable};

use super::batch::COLUMNS_ABREAST;
use super::context::GpuError;
use super::dispatch::{Argument, Dispatch};
use super::front::{WORKS_HEADER, WorksOfBody};
use super::kernels::Kernels;
use super::stages::SystemBatch;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::ring_modes::{Push, RingModes};
use crate::mechanics::mesh::RingTopology;

/// What `works` is told.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct WorksParameters {
    pub ring_count: u32,
    pub block_count: u32,
    pub mode_count: u32,
    pub body_size: u32,
}

/// The loads of ring modes on a topology, on the device.
pub struct ModeLoads {
    buffer: wgpu::Buffer,
    count: usize,
    pushes: usize,
}

/// The works on one body, with the worst true residual of its systems.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyWorks {
    pub works: Vec<f64>,
    pub residual: f64,
}

/// The works of a batch before they are computed.
pub(crate) struct WorksBuffer {
    pub(crate) dispatch: Dispatch,
    buffer: wgpu::Buffer,
    body_size: usize,
}

impl ModeLoads {
    /// Of these ways to push, the normal first.
    pub fn new(
        kernels: &Kernels,
        modes: &RingModes,
        pushes: &[Push],
        topology: &RingTopology,
    ) -> Result<ModeLoads, GpuError> {
        let Kernels { gpu, precision, .. } = *kernels;
        // Columns of C come in blocks.
        let rows = topology.ring_unknown_count().next_multiple_of(COLUMNS_ABREAST as usize);
        let mut loads = vec![0.0; pushes.len() * rows * modes.count];
        let of_pushes = modes.unknown_loads(pushes, topology);
        for (of_push, loads) in of_pushes.into_iter().zip(loads.chunks_exact_mut(rows * modes.count)) {
            for (unknown, load) in of_push {
                loads[unknown * modes.count..][..modes.count].copy_from_slice(&load);
            }
        }
        let buffer = gpu.checked("loads of modes", || gpu.filled("loads", &precision.encode(&loads)))?;
        Ok(ModeLoads { buffer, count: modes.count, pushes: pushes.len() })
    }

    /// What it takes on the device.
    pub fn bytes(&self) -> u64 {
        self.buffer.size()
    }

    /// Of modes.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Of ways to push.
    pub fn pushes(&self) -> usize {
        self.pushes
    }

    /// Numbers that the works of one body take.
    pub fn body_size(&self) -> usize {
        WORKS_HEADER + self.pushes * packed_count(self.count)
    }
}

impl SystemBatch<'_> {
    /// The works on the bodies of the batch, which was condensed; `None` for those whose systems have failed.
    pub fn works(&self, loads: &ModeLoads) -> Result<Vec<Option<BodyWorks>>, GpuError> {
        let Kernels { gpu, precision, .. } = *self.kernels();
        let WorksBuffer { dispatch, buffer, body_size } = self.works_buffer(loads)?;
        gpu.checked("works", || gpu.submit([dispatch.pass()]))?;
        let numbers = precision.decode(&gpu.read(&buffer)?);
        let of_body = |numbers: &[f64]| {
            let WorksOfBody { is_sound, spoilt, works } = WorksOfBody::of(numbers);
            is_sound.then(|| BodyWorks { works: works.to_vec(), residual: spoilt })
        };
        Ok(numbers.chunks_exact(body_size).map(of_body).collect())
    }

    pub(crate) fn works_buffer(&self, loads: &ModeLoads) -> Result<WorksBuffer, GpuError> {
        let (Kernels { gpu, precision, .. }, works) = (self.kernels(), &self.around_iteration.works);
        let parameters = WorksParameters {
            ring_count: self.layout.ring_count() as u32,
            block_count: self.layout.block_count() as u32,
            mode_count: loads.count as u32,
            body_size: loads.body_size() as u32,
        };
        let bytes = (self.body_count() * loads.body_size()) as u64 * precision.wide_bytes();
        gpu.checked("works", || {
            let buffer = gpu.empty("works", bytes);
            let parameters = gpu.uniform(&parameters);
            let arguments = [
                Argument::whole("parameters", &parameters),
                Argument::whole("compliance", &self.compliance),
                Argument::whole("loads", &loads.buffer),
                Argument::whole("states", &self.states),
                Argument::whole("norms", &self.norms),
                Argument::whole("works", &buffer),
            ];
            let group = gpu.bind(works, &arguments);
            let dispatch = Dispatch::new(works, 0, &group, [self.body_count() as u32, loads.pushes as u32]);
            WorksBuffer { dispatch, buffer, body_size: loads.body_size() }
        })
    }
}
