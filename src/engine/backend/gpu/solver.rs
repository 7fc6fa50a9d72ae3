//! A batch of designs on a device: the distinct bodies first, topology by topology, then the contact of every design.
//! What comes back is the answer to each load and nothing else. What the device cannot do the processor does.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::batch::{BodyCounts, KernelFacts, adapted, batches};
use super::contact::{DeviceJoint, LoadResponse, RESPONSE_SIZE, answers};
use super::context::{AdapterKind, GpuDevice, GpuError};
use super::grouping::{DistinctBodies, GroupKey, distinct};
use super::kernels::{Kernels, Precision};
use super::layout::MeshLayout;
use super::slots::{GramShared, Slots};
use super::stages::SystemBatch;
use super::trial::{TrialKernels, slot_size};
use crate::engine::backend::cpu::CpuBackend;
use crate::engine::backend::{Backend, add_stages};
use crate::engine::near_fields::{NearFieldKey, NearFieldKeys, NearFieldLibrary};
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::{Estimate, JointPlan, Want};
use crate::engine::request::{BodyRequest, Fidelity, SpaceKey, TopologyKey};
use crate::engine::respond::{LoadState, Solving, Way};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::contact::loading::NoState;
use crate::mechanics::mesh::RingTopology;
use crate::mechanics::solve::refine::RefineSettings;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

/// A device, and the numbers to compute in.
#[derive(Clone, Copy)]
pub struct GpuChoice<'a> {
    pub device: &'a GpuDevice,
    pub precision: Precision,
}

impl GpuChoice<'_> {
    /// Designs of a batch that keeps the device busy.
    pub fn batch_size(&self) -> usize {
        if self.device.facts.kind == AdapterKind::Software { SOFTWARE_BATCH } else { BATCH }
    }
}

/// Solves batches on a device; keeps what bodies of a topology share.
pub struct GpuBackend<'a> {
    choice: GpuChoice<'a>,
    options: SolveOptions,
    kernels: Kernels<'a>,
    /// By the count of trial pressures.
    trials: HashMap<usize, TrialKernels<'a>>,
    groups: HashMap<GroupKey, Group>,
    /// For exact bodies, and designs without an answer.
    cpu: CpuBackend,
    pub report: GpuReport,
}

/// What a device has done so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct GpuReport {
    /// Bodies condensed, and the columns of their rings that were solved for.
    pub bodies: u64,
    pub solves: u64,
    /// The greatest |b - K x|/|b| of a column that an outcome rests on.
    pub worst_residual: f64,
    /// Wall times: plans and what bodies share; from numbers to slots; from slots to answers; from answers to outcomes.
    pub preparation: Duration,
    pub condensation: Duration,
    pub contact: Duration,
    pub outcomes: Duration,
}

/// What the bodies of a group share on the device.
pub(super) struct Group {
    pub(super) layout: MeshLayout,
    pub(super) counts: BodyCounts,
    pub(super) shared: GramShared,
    pub(super) facts: KernelFacts,
}

/// Invocations of a workgroup: the twin's count of partial sums, two subgroups of the common size.
pub const INVOCATIONS: u32 = 64;

/// Time of an iteration of one body before any was measured, s: short for a processor and long for a large GPU.
pub(super) const FIRST_GUESS: f64 = 1e-5;

/// Designs of a batch: enough for thousands of bodies of a topology, few enough to stay small here.
const BATCH: usize = 16_384;

/// The same on software, whose user waits.
const SOFTWARE_BATCH: usize = 256;

/// What groups share on the device is dropped beyond these many bytes, before more is made.
const KEPT_BYTES: u64 = 256 << 20;

/// Joints that need more of them are solved one half after the other.
const MOST_NEAR_FIELDS: usize = 1000;

/// Steps of conjugate gradients on Q8 meshes over the root of the unknowns, to a residual of 1e-6.
const STEPS_PER_ROOT: f64 = 8.0;

/// And the most they are given: nu = 0.499 in plane strain asks for eight times as many as others. Dispatches beyond what
/// is needed find nothing to do, but must be looked at.
const MOST_STEPS_PER_ROOT: f64 = 100.0;

impl<'a> GpuBackend<'a> {
    pub fn new(choice: GpuChoice<'a>, options: SolveOptions) -> Result<GpuBackend<'a>, GpuError> {
        Ok(GpuBackend {
            kernels: Kernels::new(choice.device, choice.precision, INVOCATIONS)?,
            choice,
            options,
            trials: HashMap::new(),
            groups: HashMap::new(),
            cpu: CpuBackend::new(options),
            report: GpuReport::default(),
        })
    }

    /// The joints of one space: their outcomes and what they want; `None` for those that the processor must solve.
    fn solve_joints(
        &mut self,
        space: SpaceKey,
        joints: &[(&DesignCase, JointPlan)],
    ) -> Result<Vec<Option<(DesignOutcome, Want)>>, GpuError> {
        let started = Instant::now();
        let (bodies, design_slots) = distinct(joints);
        let meshed = bodies.requests.iter().filter(|request| request.fidelity != Fidelity::Series);
        let near_fields: HashSet<NearFieldKey> =
            meshed.flat_map(|request| NearFieldKeys::of(request).around).collect();
        if near_fields.len() > MOST_NEAR_FIELDS && joints.len() > 1 {
            let (first, second) = joints.split_at(joints.len() / 2);
            let mut solved = self.solve_joints(space, first)?;
            solved.extend(self.solve_joints(space, second)?);
            return Ok(solved);
        }
        self.prepare(space, &bodies, near_fields)?;
        let (kernels, library) = (&self.trials[&space.terms], &self.cpu.library);
        let slots = Slots::new(kernels, bodies.requests.len())?;
        let exact = (0..).zip(&bodies.requests).filter(|(_, request)| request.fidelity == Fidelity::Series);
        let known: Vec<(u32, &PressureCompliance)> =
            exact.map(|(slot, request)| (slot, &**library.compliance(&request.key()))).collect();
        slots.write(&known)?;
        self.report.preparation += started.elapsed();

        let started = Instant::now();
        for own in &bodies.groups {
            if let Some(group) = self.groups.get_mut(&own.key) {
                condense(&self.kernels, group, &bodies.of(own), own.slots.start, &slots, &mut self.report)?;
            }
        }
        self.report.condensation += started.elapsed();

        let started = Instant::now();
        let device_joints: Vec<DeviceJoint> =
            joints.iter().zip(design_slots).map(|((case, _), slots)| DeviceJoint::new(case, slots)).collect();
        let answers = answers(kernels, &library.shared.space(space).space, &slots, &device_joints)?;
        self.report.contact += started.elapsed();

        let started = Instant::now();
        let own: Vec<_> = device_joints
            .iter()
            .scan(0, |end, joint| {
                let start = *end;
                *end += joint.loads.len();
                Some(start..*end)
            })
            .collect();
        let accuracy = self.options.accuracy;
        let solved = joints
            .par_iter()
            .zip(own)
            .with_min_len(64)
            .map(|((case, plan), own)| {
                let states: Option<Vec<Result<LoadState, NoState>>> =
                    answers[own].iter().map(LoadResponse::state).collect();
                let (backend, limit) = (BackendKind::Gpu, space.limit());
                let solving = Solving { backend, way: Way::Planned(*plan), limit, accuracy };
                Some(solving.respond(case, states?))
            })
            .collect();
        for answer in &answers {
            if let LoadResponse::Found { residual, .. } = answer {
                self.report.worst_residual = self.report.worst_residual.max(*residual);
            }
        }
        self.report.outcomes += started.elapsed();
        Ok(solved)
    }

    /// Makes what the bodies share, and those that are exact.
    fn prepare(
        &mut self,
        space: SpaceKey,
        bodies: &DistinctBodies,
        near_fields: HashSet<NearFieldKey>,
    ) -> Result<(), GpuError> {
        let GpuChoice { device, precision } = self.choice;
        if let Entry::Vacant(entry) = self.trials.entry(space.terms) {
            entry.insert(TrialKernels::new(device, precision, INVOCATIONS, space.terms)?);
        }
        let is_exact = |request: &&BodyRequest| request.fidelity == Fidelity::Series;
        let exact: Vec<BodyRequest> = bodies.requests.iter().filter(is_exact).copied().collect();
        self.cpu.library.solve(&exact);
        let library = &mut self.cpu.library.shared;
        library.prepare(near_fields.into_iter());
        if self.groups.values().map(|group| group.shared.bytes()).sum::<u64>() > KEPT_BYTES {
            self.groups.clear();
        }
        for group in &bodies.groups {
            let trial = &self.trials[&space.terms];
            let requests = &bodies.requests[group.slots.clone()];
            match self.groups.entry(group.key.clone()) {
                Entry::Occupied(mut known) => known.get_mut().shared.cover(trial, library, requests)?,
                Entry::Vacant(entry) => {
                    let facts = self.kernels.facts(FIRST_GUESS);
                    entry.insert(Group::new(&group.key.0, requests, facts, trial, library)?);
                }
            }
        }
        Ok(())
    }

    /// The end of the joints, from `first` on, whose slots and whose answers fit into a buffer each; one at least.
    fn end_of_piece(
        &self,
        space: SpaceKey,
        joints: &[(usize, JointPlan)],
        cases: &[DesignCase],
        first: usize,
    ) -> usize {
        let (mut of_slots, mut of_answers) = (0, 0);
        let fits = |(index, _): &&(usize, JointPlan)| {
            of_slots += 4 * slot_size(space.terms) as u64;
            of_answers += answer_numbers(&cases[*index]);
            of_slots.max(of_answers) <= self.buffer_numbers()
        };
        first + joints[first..].iter().take_while(fits).count().max(1)
    }

    /// Numbers that fit into a buffer.
    fn buffer_numbers(&self) -> u64 {
        self.choice.device.facts.limits.bound_buffer() / self.choice.precision.wide_bytes()
    }

    /// What `case` is solved with first; `None` where no mesh is needed, or none is allowed, or walls are so thin that their
    /// error must be told, or the answers of this design alone are too many for a buffer.
    fn plan(&self, case: &DesignCase) -> Option<JointPlan> {
        let SolveOptions { method, accuracy } = self.options;
        if method == MethodChoice::ClosedForm || answer_numbers(case) > self.buffer_numbers() {
            return None;
        }
        let plan = JointPlan::cheapest(case, method, accuracy).ok()?;
        (plan.estimate != Estimate::Exact && !plan.has_thin_walls()).then_some(plan)
    }
}

impl Backend for GpuBackend<'_> {
    fn solve(&mut self, cases: &[DesignCase]) -> Result<Vec<DesignOutcome>, GpuError> {
        let mut outcomes: Vec<Option<DesignOutcome>> = vec![None; cases.len()];
        let mut for_cpu: Vec<usize> = Vec::new();
        let mut open: Vec<(usize, JointPlan)> = Vec::new();
        for (index, case) in cases.iter().enumerate() {
            match self.plan(case) {
                Some(plan) => open.push((index, plan)),
                None => for_cpu.push(index),
            }
        }
        while !open.is_empty() {
            let mut by_space: HashMap<SpaceKey, Vec<(usize, JointPlan)>> = HashMap::new();
            for (index, plan) in open.drain(..) {
                by_space.entry(plan.pin.space).or_default().push((index, plan));
            }
            for (space, joints) in by_space {
                let mut first = 0;
                while first < joints.len() {
                    let end = self.end_of_piece(space, &joints, cases, first);
                    let piece = &joints[first..end];
                    first = end;
                    let joints: Vec<(&DesignCase, JointPlan)> =
                        piece.iter().map(|(index, plan)| (&cases[*index], *plan)).collect();
                    for ((index, plan), solved) in piece.iter().zip(self.solve_joints(space, &joints)?) {
                        match solved {
                            None => for_cpu.push(*index),
                            Some((outcome, want)) => {
                                outcomes[*index] = Some(outcome);
                                let next = plan.next(want);
                                open.extend(next.map(|plan| (*index, plan)));
                            }
                        }
                    }
                }
            }
        }
        let left: Vec<DesignCase> = for_cpu.iter().map(|index| cases[*index].clone()).collect();
        for (index, outcome) in for_cpu.into_iter().zip(self.cpu.solve(&left)) {
            outcomes[index] = Some(outcome);
        }
        Ok(outcomes.into_iter().flatten().collect())
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        let GpuReport { preparation, condensation, contact, outcomes, .. } = self.report;
        let mut stages = vec![
            ("preparation", preparation),
            ("condensation on the GPU", condensation),
            ("contact on the GPU", contact),
            ("outcomes", outcomes),
        ];
        add_stages(&mut stages, self.cpu.stages());
        stages
    }

    fn worst_residual(&self) -> f64 {
        self.report.worst_residual
    }

    fn solves(&self) -> u64 {
        self.report.solves
    }
}

impl Group {
    /// For requests of one group, one at least.
    pub(super) fn new(
        key: &TopologyKey,
        requests: &[BodyRequest],
        facts: KernelFacts,
        kernels: &TrialKernels,
        library: &NearFieldLibrary,
    ) -> Result<Group, GpuError> {
        let body = &requests[0].body;
        let grading = key.grading(body);
        let layout = MeshLayout::new(body, &grading).map_err(|error| GpuError::Failed {
            adapter: kernels.gpu.facts.name.clone(),
            what: "layout",
            problem: error.to_string(),
        })?;
        let shared = GramShared::new(kernels, library, &RingTopology::new(body, &grading), requests)?;
        Ok(Group { counts: layout.counts(), layout, shared, facts })
    }
}

/// From bodies of one group to their slots, from `first_slot` on, batch by batch. A body too large for the device keeps its slot of zeros,
/// which is not sound.
fn condense(
    kernels: &Kernels,
    group: &mut Group,
    bodies: &[Body],
    first_slot: usize,
    slots: &Slots,
    report: &mut GpuReport,
) -> Result<(), GpuError> {
    let Group { layout, counts, shared, facts } = group;
    let precision = kernels.precision;
    let numbers: Vec<Vec<f64>> =
        bodies.par_iter().with_min_len(64).map(|body| layout.body_numbers(body)).collect();
    let root = (counts.unknowns as f64).sqrt();
    let iteration_limit = (MOST_STEPS_PER_ROOT * root) as usize;
    let mut first = 0;
    while first < bodies.len() {
        // Only the first is used: it tells how the next one is to be cut.
        let left = vec![*counts; bodies.len() - first];
        let Ok(planned) = batches(&left, facts, &kernels.gpu.facts.limits) else { break };
        let Some(batch) = planned.first() else { break };
        let started = Instant::now();
        let own = first..first + batch.bodies.len();
        let systems = SystemBatch::new(kernels, &layout.systems, own.len())?;
        let settings = RefineSettings { iteration_limit, ..precision.settings() };
        systems.assemble_and_condense(layout, &numbers[own.clone()].concat(), &settings, batch.iterations)?;
        slots.fill(&systems, shared, &bodies[own.clone()], first_slot + own.start)?;
        // The next batch is cut by the time of this one, and takes its memory.
        kernels.gpu.wait()?;
        let dispatches = (STEPS_PER_ROOT * root / f64::from(batch.iterations)).ceil().max(1.0);
        *facts = adapted(facts, batch, started.elapsed().div_f64(dispatches));
        report.bodies += own.len() as u64;
        report.solves += own.len() as u64 * counts.ring_columns;
        first = own.end;
    }
    Ok(())
}

/// Numbers of the answers to a design's loads.
fn answer_numbers(case: &DesignCase) -> u64 {
    (RESPONSE_SIZE * case.steps.len()) as u64
}
