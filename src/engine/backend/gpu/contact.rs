//! The contact of many joints on the device: from the slots of their bodies to the answer to each load.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::batch::MOST_TRIPS;
use super::context::{AdapterKind, GpuError};
use super::dispatch::Dispatch;
use super::slots::Slots;
use super::trial::{TrialKernels, slot_size};
use crate::engine::respond::{LoadState, loads_in_contact};
use crate::mechanics::compliance::NODE_COUNT;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::contact::loading::{DimensionlessLoad, NoState};
use crate::study::design::DesignCase;

/// No slot: the body is exact.
pub const NO_SLOT: u32 = u32::MAX;

/// No slot: the body is compared with nothing, its change is all the work that goes into it.
pub const NOTHING: u32 = u32::MAX - 1;

/// Numbers that `find` says of each load.
pub const RESPONSE_SIZE: usize = 12;

/// What `sample` and `find` are told.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ContactParameters {
    pub design_count: u32,
    pub step_count: u32,
    pub slot_size: u32,
    pub evaluation_limit: u32,
    pub term_count: u32,
}

/// A joint as the device meets it.
#[derive(Clone, Debug)]
pub struct DeviceJoint {
    /// Slots of the pin, the plate, and what either is compared with: the same on the next coarser mesh, `NOTHING`, or
    /// `NO_SLOT`.
    pub slots: [u32; 4],
    /// Young's moduli of the pin and the plate.
    pub moduli: [f64; 2],
    /// Radial clearance over the hole's radius.
    pub clearance: f64,
    /// > 0.
    pub loads: Vec<DimensionlessLoad>,
}

/// What the device answers for one load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadResponse {
    /// With the worst true residual of the bodies.
    Found {
        state: LoadState,
        residual: f64,
    },
    TooWide,
    /// A compliance that was not solved for, or is not positive definite.
    Broken,
    /// The search did not end in the evaluations it was given.
    Unfinished,
}

impl DeviceJoint {
    pub fn new(case: &DesignCase, slots: [u32; 4]) -> DeviceJoint {
        let joint = &case.joint;
        DeviceJoint {
            slots,
            moduli: [&joint.pin, &joint.plate].map(|part| part.material.youngs_modulus),
            clearance: joint.radial_clearance / joint.hole_radius,
            loads: loads_in_contact(case).collect(),
        }
    }

    /// What the joint's numbers are divided by on the device, so that they are of order one: the softer body's modulus.
    fn unit(&self) -> f64 {
        self.moduli[0].min(self.moduli[1])
    }

    /// Whether a load prescribes the force, and the logarithm of e over what it prescribes.
    fn step(&self, load: DimensionlessLoad) -> (bool, f64) {
        match load {
            DimensionlessLoad::Indentation(delta) => (false, (self.clearance / delta).ln_1p()),
            // A neat fit has one half angle, whatever the load.
            DimensionlessLoad::Force(_) if self.clearance == 0.0 => (false, 0.0),
            DimensionlessLoad::Force(force) => (true, (self.clearance / (force / self.unit())).ln()),
        }
    }
}

impl LoadResponse {
    fn decode(numbers: &[f64], unit: f64) -> LoadResponse {
        let &[outcome, half_angle, b, indentation, force, stiffness, energy, peak, ..] = numbers else {
            unreachable!("{RESPONSE_SIZE} numbers a load")
        };
        match outcome {
            0.0 => {
                let square = b * b;
                let state = LoadState {
                    half_angle,
                    indentation: square * indentation,
                    force: unit * square * force,
                    tangent_stiffness: unit * stiffness,
                    energy: unit * square * square * energy,
                    peak_pressure: unit * 0.5 * b * peak,
                    truncation: numbers[8],
                    change: numbers[9],
                    thin_walls: 0.0,
                    pressure_is_positive: numbers[10] == 1.0,
                };
                LoadResponse::Found { state, residual: numbers[11] }
            }
            1.0 => LoadResponse::TooWide,
            3.0 => LoadResponse::Unfinished,
            _ => LoadResponse::Broken,
        }
    }

    /// As the processor would say it; `None` where it must look itself.
    pub fn state(&self) -> Option<Result<LoadState, NoState>> {
        match self {
            LoadResponse::Found { state, .. } => Some(Ok(*state)),
            LoadResponse::TooWide => Some(Err(NoState::ContactTooWide)),
            LoadResponse::Broken | LoadResponse::Unfinished => None,
        }
    }
}

/// The answers to the loads of all joints, one after the other.
pub fn answers(
    kernels: &TrialKernels,
    space: &PressureSpace,
    slots: &Slots,
    joints: &[DeviceJoint],
) -> Result<Vec<LoadResponse>, GpuError> {
    if joints.iter().all(|joint| joint.loads.is_empty()) {
        return Ok(Vec::new());
    }
    let contact =
        Contact::new(kernels, space, slots, joints, evaluation_limit(kernels.terms, kernels.gpu.facts.kind))?;
    contact.solve()
}

/// Joints on the device with their loads, of which there is one at least.
pub(super) struct Contact<'a> {
    kernels: &'a TrialKernels<'a>,
    /// What the force of each load is divided by.
    units: Vec<f64>,
    pub(super) sample: Dispatch,
    pub(super) find: Dispatch,
    responses: wgpu::Buffer,
}

impl<'a> Contact<'a> {
    /// `evaluation_limit`: of one search.
    pub(super) fn new(
        kernels: &'a TrialKernels<'a>,
        space: &PressureSpace,
        slots: &Slots,
        joints: &[DeviceJoint],
        evaluation_limit: u32,
    ) -> Result<Contact<'a>, GpuError> {
        let TrialKernels { gpu, precision, invocations, terms, contact, .. } = kernels;
        let mut numbers = Vec::with_capacity(2 * joints.len());
        let (mut steps, mut factors, mut units) = (Vec::new(), Vec::new(), Vec::new());
        for (design, joint) in (0_u32..).zip(joints) {
            let unit = joint.unit();
            numbers.extend(joint.moduli.map(|modulus| unit / modulus));
            for load in &joint.loads {
                let (by_force, factor) = joint.step(*load);
                steps.push(2 * design + u32::from(by_force));
                factors.push(factor);
                units.push(unit);
            }
        }
        numbers.extend(factors);
        let design_slots: Vec<[u32; 4]> = joints.iter().map(|joint| joint.slots).collect();
        let parameters = ContactParameters {
            design_count: joints.len() as u32,
            step_count: steps.len() as u32,
            slot_size: slot_size(*terms) as u32,
            evaluation_limit,
            term_count: *terms as u32,
        };
        let wide = precision.wide_bytes();
        gpu.checked("contact", || {
            let samples = (joints.len() * (NODE_COUNT + 1)) as u64;
            let responses = gpu.empty("responses", (steps.len() * RESPONSE_SIZE) as u64 * wide);
            let group = gpu.bind(
                contact,
                &[
                    &gpu.uniform(&parameters),
                    &gpu.filled("space", &precision.encode(&space_numbers(kernels, space))),
                    &slots.buffer,
                    &gpu.filled("design_slots", &design_slots),
                    &gpu.filled("numbers", &precision.encode(&numbers)),
                    &gpu.filled("steps", &steps),
                    &gpu.empty("samples", samples * 4 * wide),
                    &responses,
                ],
            );
            let groups = |count: u64| {
                let groups = count.div_ceil(u64::from(*invocations));
                let limit = u64::from(gpu.facts.limits.workgroups_per_dimension);
                [groups.min(limit) as u32, groups.div_ceil(limit) as u32]
            };
            let sample = Dispatch::new(contact, 0, &group, groups(samples));
            let find = Dispatch::new(contact, 1, &group, groups(steps.len() as u64));
            Contact { kernels, units, sample, find, responses }
        })
    }

    /// The answers to the loads, one joint after the other.
    pub(super) fn solve(&self) -> Result<Vec<LoadResponse>, GpuError> {
        let TrialKernels { gpu, precision, .. } = self.kernels;
        gpu.checked("contact", || gpu.submit([self.sample.pass(), self.find.pass()]))?;
        let numbers = precision.decode(&gpu.read(&self.responses)?);
        let answers = numbers.par_chunks_exact(RESPONSE_SIZE).zip(&self.units);
        Ok(answers.map(|(numbers, unit)| LoadResponse::decode(numbers, *unit)).collect())
    }
}

/// `space` of `contact.wgsl`.
fn space_numbers(kernels: &TrialKernels, space: &PressureSpace) -> Vec<f64> {
    // Where a search ends: of f32 some roundings of a logarithm are left.
    let (tolerance, narrowest) =
        if kernels.precision.wide_bytes() == 8 { (1e-11, 1e-14) } else { (1e-6, 3e-7) };
    let mut numbers = vec![space.limit, tolerance, narrowest, 0.0];
    for ((abscissa, weight), arc) in space.nodes().zip(&space.arcs) {
        numbers.extend([abscissa, weight, arc.half_angle]);
    }
    let step = std::f64::consts::PI / (2 * space.terms) as f64;
    numbers.extend((0..4 * space.terms).map(|i| (i as f64 * step).cos()));
    numbers
}

/// Evaluations of one search at most: bisection alone would need about 60, interpolation takes 4 to 8.
const MOST_EVALUATIONS: u64 = 60;

/// Evaluations of one search on an adapter: those of software bound the loop trips of an invocation.
pub fn evaluation_limit(terms: usize, kind: AdapterKind) -> u32 {
    if kind != AdapterKind::Software {
        return MOST_EVALUATIONS as u32;
    }
    let entries = packed_count(terms) as u64;
    let terms = terms as u64;
    let nodes = NODE_COUNT as u64;
    let of_compliance = entries * (1 + nodes / 4);
    // Weights, compliance, Cholesky, substitutions and sums, elementary functions.
    let evaluation = 2 * nodes + of_compliance + terms.pow(3) / 6 + 3 * terms * terms / 2 + 6 * terms + 200;
    // Samples and first guess, changes since the coarser meshes, positivity.
    let others = 4 * (nodes + 1) + 300 + 2 * (of_compliance + entries) + (2 * terms + 2) * (terms + 1);
    ((MOST_TRIPS - others) / evaluation).min(MOST_EVALUATIONS) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::arc::TERM_CHOICES;

    /// Interpolation needs no more than 8; a search that is cut short goes to the processor.
    #[test]
    fn searches_have_room_within_the_bound_on_loops() {
        for terms in TERM_CHOICES {
            let limit = evaluation_limit(terms, AdapterKind::Software);
            assert!((8..=60).contains(&limit), "{terms}: {limit}");
        }
    }
}
