//! Slots: what contact must know of a body, one slot a body, on the device. They are filled by `gram.wgsl` from a batch of
//! systems, or with a compliance that the processor has found.

use std::collections::BTreeSet;

use bytemuck::{Pod, Zeroable};

use super::context::GpuError;
use super::dispatch::Dispatch;
use super::layout::is_plane_strain;
use super::stages::SystemBatch;
use super::trial::{SLOT_HEADER, TrialKernels, slot_size};
use crate::engine::near_fields::{NearFieldKey, NearFieldKeys, NearFieldLibrary};
use crate::engine::request::BodyRequest;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass, PoissonRange};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::ring_loads::ring_loads;
use crate::mechanics::compliance::{NODE_COUNT, PressureCompliance};
use crate::mechanics::mesh::{RingTopology, SUPPORTED};

/// What `gram` is told.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GramParameters {
    pub ring_count: u32,
    pub block_count: u32,
    pub arc_count: u32,
    pub slot_size: u32,
    pub first_slot: u32,
    pub is_plane_strain: u32,
}

/// What bodies of one topology and range of Poisson's ratio share: the loads of the trial pressures, and the near fields.
pub struct GramShared {
    loads: wgpu::Buffer,
    /// One of the near fields; the others differ in the growth of their layers.
    key: NearFieldKey,
    /// Of the near fields on the device, ascending.
    growths: Vec<u32>,
    near_fields: wgpu::Buffer,
}

/// The slots of many bodies.
pub struct Slots<'a> {
    kernels: &'a TrialKernels<'a>,
    pub(super) buffer: wgpu::Buffer,
}

impl<'a> Slots<'a> {
    /// Slots of zeros, which are not sound.
    pub fn new(kernels: &'a TrialKernels<'a>, count: usize) -> Result<Slots<'a>, GpuError> {
        let bytes = slot_size(kernels.terms) as u64 * kernels.precision.wide_bytes();
        let gpu = kernels.gpu;
        let buffer = gpu.checked("slots", || gpu.empty("slots", bytes * count as u64))?;
        Ok(Slots { kernels, buffer })
    }

    /// Compliances that are known, each to its slot.
    pub fn write(&self, known: &[(u32, &PressureCompliance)]) -> Result<(), GpuError> {
        let TrialKernels { gpu, precision, terms, .. } = self.kernels;
        let bytes = slot_size(*terms) as u64 * precision.wide_bytes();
        gpu.checked("exact compliances", || {
            for (slot, PressureCompliance { amplitude, values, .. }) in known {
                let mut numbers = vec![1.0, *amplitude, 0.0];
                numbers.extend(values);
                gpu.queue.write_buffer(&self.buffer, u64::from(*slot) * bytes, &precision.encode(&numbers));
            }
        })
    }

    /// Compliances of the bodies of a batch that was solved, to the slots from `first_slot` on. One body at least.
    pub fn fill(
        &self,
        systems: &SystemBatch,
        shared: &GramShared,
        bodies: &[Body],
        first_slot: usize,
    ) -> Result<(), GpuError> {
        let gpu = self.kernels.gpu;
        gpu.checked("gram", || gpu.submit([self.gram(systems, shared, bodies, first_slot).pass()]))
    }

    pub(super) fn gram(
        &self,
        systems: &SystemBatch,
        shared: &GramShared,
        bodies: &[Body],
        first_slot: usize,
    ) -> Dispatch {
        let TrialKernels { gpu, precision, terms, gram, .. } = self.kernels;
        let parameters = GramParameters {
            ring_count: systems.layout.ring_count() as u32,
            block_count: systems.layout.block_count() as u32,
            arc_count: NODE_COUNT as u32,
            slot_size: slot_size(*terms) as u32,
            first_slot: first_slot as u32,
            is_plane_strain: is_plane_strain(bodies[0].idealization),
        };
        let numbers: Vec<f64> = bodies.iter().flat_map(|body| shared.numbers(body)).collect();
        let group = gpu.bind(
            gram,
            &[
                &gpu.uniform(&parameters),
                &systems.compliance,
                &shared.loads,
                &shared.near_fields,
                &gpu.filled("gram_bodies", &precision.encode(&numbers)),
                &systems.states,
                &systems.norms,
                &self.buffer,
            ],
        );
        Dispatch::new(gram, 0, &group, [bodies.len() as u32, NODE_COUNT as u32])
    }

    /// Whether each slot is sound, its worst true residual, and its compliance.
    pub fn read(&self) -> Result<Vec<(bool, f64, PressureCompliance)>, GpuError> {
        let TrialKernels { gpu, precision, terms, .. } = self.kernels;
        let numbers = precision.decode(&gpu.read(&self.buffer)?);
        let slots = numbers.chunks_exact(slot_size(*terms)).map(|slot| {
            let values = slot[SLOT_HEADER..].to_vec();
            (
                slot[0] == 1.0,
                slot[2],
                PressureCompliance { terms: *terms, amplitude: slot[1], bed: 0.0, values },
            )
        });
        Ok(slots.collect())
    }
}

impl GramShared {
    /// For requests of one topology and range of Poisson's ratio, one at least, that `library` was prepared for.
    pub fn new(
        kernels: &TrialKernels,
        library: &NearFieldLibrary,
        topology: &RingTopology,
        requests: &[BodyRequest],
    ) -> Result<GramShared, GpuError> {
        let TrialKernels { gpu, precision, .. } = kernels;
        let loads = trial_loads(&library.space(requests[0].space).space, topology);
        let mut shared = gpu.checked("trial loads", || GramShared {
            loads: gpu.filled("loads", &precision.encode(&loads)),
            key: NearFieldKeys::of(&requests[0]).around[0],
            growths: Vec::new(),
            near_fields: gpu.empty("near_fields", precision.wide_bytes()),
        })?;
        shared.cover(kernels, library, requests)?;
        Ok(shared)
    }

    /// What it takes on the device.
    pub fn bytes(&self) -> u64 {
        self.loads.size() + self.near_fields.size()
    }

    /// Takes in the near fields of more requests like those before.
    pub fn cover(
        &mut self,
        kernels: &TrialKernels,
        library: &NearFieldLibrary,
        requests: &[BodyRequest],
    ) -> Result<(), GpuError> {
        let TrialKernels { gpu, precision, .. } = kernels;
        let wanted = requests.iter().flat_map(|request| NearFieldKeys::of(request).around);
        let wanted: BTreeSet<u32> = wanted.map(|(class, _)| class.growth).collect();
        if wanted.iter().all(|growth| self.growths.binary_search(growth).is_ok()) {
            return Ok(());
        }
        let (class, space) = self.key;
        let key = |growth: u32| (NearFieldClass { growth, ..class }, space);
        // Those of before, too, where the library still has them.
        let before = self.growths.iter().copied().filter(|growth| library.has(&key(*growth)));
        self.growths = before.collect::<BTreeSet<u32>>().union(&wanted).copied().collect();
        let near_fields = self.growths.iter().map(|growth| library.near_field(&key(*growth)));
        let numbers = near_field_numbers(class.range, near_fields);
        self.near_fields =
            gpu.checked("near fields", || gpu.filled("near_fields", &precision.encode(&numbers)))?;
        Ok(())
    }

    /// `bodies` of `gram.wgsl`.
    fn numbers(&self, body: &Body) -> [f64; 3] {
        let Body { poissons_ratio, idealization, .. } = *body;
        let coordinate = self.key.0.range.coordinate(poissons_ratio);
        [idealization.margin(poissons_ratio), coordinate, self.place(body)]
    }

    /// Where the near field of a body lies among those on the device: the number of the first it lies between, and how far
    /// from there to the next. Not a number where they are not there, which spoils the slot.
    fn place(&self, body: &Body) -> f64 {
        let ([below, _], between) = NearFieldClass::around(body, self.key.0.grading);
        let number = self.growths.binary_search(&below.growth);
        number.map_or(f64::NAN, |number| number as f64 + between)
    }
}

/// `near_fields` of `gram.wgsl`.
fn near_field_numbers<'a>(range: PoissonRange, near_fields: impl Iterator<Item = &'a NearField>) -> Vec<f64> {
    let nodes = range.nodes().into_iter();
    let mut numbers: Vec<f64> = nodes.flat_map(|(coordinate, weight)| [coordinate, weight]).collect();
    numbers.extend(near_fields.flat_map(|near_field| near_field.values.iter().flatten()));
    numbers
}

/// Loads of the trial pressures on the ring's unknowns, `[arc][ring unknown][k]`.
fn trial_loads(space: &PressureSpace, topology: &RingTopology) -> Vec<f64> {
    let (count, terms) = (topology.ring_unknown_count(), space.terms);
    let mut placed = vec![0.0; space.arcs.len() * count * terms];
    let arcs = ring_loads(space, topology.element, &topology.ring_angles);
    for (arc, placed) in arcs.iter().zip(placed.chunks_exact_mut(count * terms)) {
        for node in 0..arc.node_count {
            for component in 0..2 {
                let unknown = topology.unknowns[2 * topology.ring_nodes[node] as usize + component];
                if unknown != SUPPORTED {
                    let to = (unknown as usize - topology.ring_start) * terms;
                    let from = (node * 2 + component) * terms;
                    placed[to..to + terms].copy_from_slice(&arc.values[from..from + terms]);
                }
            }
        }
    }
    placed
}
