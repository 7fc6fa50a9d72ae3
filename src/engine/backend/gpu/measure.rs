//! What each kernel takes, on batches as large as the planner makes them: times, with the work that was done in them.

use std::collections::HashMap;
use std::time::Duration;

use super::batch::{Batch, KernelFacts, adapted, batches};
use super::contact::{Contact, DeviceJoint, LoadResponse, NO_SLOT, evaluation_limit};
use super::context::{AdapterKind, GpuError};
use super::dispatch::{Dispatch, Pass};
use super::grouping::{BodyGroup, DistinctBodies, distinct};
use super::kernels::{Kernels, Precision, Stage};
use super::layout::SystemState;
use super::roofline::{run, seconds};
use super::slots::Slots;
use super::solver::{FIRST_GUESS, GpuChoice, Group, INVOCATIONS};
use super::stages::{Rounds, SystemBatch};
use super::trial::{TrialKernels, slot_size};
use super::work::{Joints, Sizes, Work};
use crate::engine::bodies::BodyLibrary;
use crate::engine::near_fields::{NearFieldKeys, NearFieldLibrary};
use crate::engine::plan::JointPlan;
use crate::engine::request::{BodyRequest, Fidelity, SpaceKey, mesh_size};
use crate::engine::respond::loads_in_contact;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::PressureCompliance;
use crate::study::config::MethodChoice;
use crate::study::design::DesignCase;

/// One kernel on one batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelTime {
    pub kernel: &'static str,
    pub precision: Precision,
    /// Bytes of the numbers it computes in: which arithmetic peak is its own.
    pub number_bytes: u64,
    /// Of the meshes.
    pub level: usize,
    pub unknowns: u64,
    /// Bodies of the batch, or designs.
    pub items: u64,
    /// Wall time from submission to end, median, s.
    pub seconds: f64,
    pub work: Work,
    /// Steps of all systems in `pcg`, evaluations of all searches in `find`.
    pub iterations: Option<u64>,
}

/// How much is measured, and how often.
struct Effort {
    /// Bodies of a batch at most.
    bodies: usize,
    samples: usize,
}

impl Effort {
    fn on(kind: AdapterKind) -> Effort {
        match kind {
            // Enough to see that all of it runs.
            AdapterKind::Software => Effort { bodies: 16, samples: 1 },
            _ => Effort { bodies: 1 << 16, samples: 3 },
        }
    }
}

/// Of the sweep that is measured.
pub const SWEEP_ACCURACY: f64 = 0.01;

/// How often a batch is cut anew by the time of the one before, at most.
const CUTS: usize = 4;

/// The kernels of bodies, on the topology that most bodies of `cases` have at a mesh level, those repeated until the
/// batch is full.
pub fn body_kernels(
    choice: GpuChoice,
    cases: &[DesignCase],
    level: usize,
) -> Result<Vec<KernelTime>, GpuError> {
    let GpuChoice { device: gpu, precision } = choice;
    let Some((space, joints)) = commonest_space(cases, level, choice) else { return Ok(Vec::new()) };
    let requests = joints.iter().flat_map(|(_, plan)| [plan.pin, plan.plate]).collect();
    let bodies = DistinctBodies::new(requests);
    // Of equally many bodies those with larger meshes, so that every run measures the same.
    let size = |group: &BodyGroup| (group.slots.len(), mesh_size(&bodies.of(group)[0], level).unknowns);
    let Some(group) = bodies.groups.iter().max_by_key(|group| size(group)) else {
        return Ok(Vec::new());
    };
    let (key, requests, bodies) = (&group.key, &bodies.requests[group.slots.clone()], bodies.of(group));
    let trials = TrialKernels::new(gpu, precision, INVOCATIONS, space.terms)?;
    let mut library = NearFieldLibrary::default();
    library.prepare(requests.iter().flat_map(|request| NearFieldKeys::of(request).around));
    let kernels = Kernels::new(gpu, precision, INVOCATIONS)?;
    let group = Group::new(&key.0, requests, kernels.facts(FIRST_GUESS), &trials, &library)?;
    let times = of_bodies(&kernels, &trials, group, &bodies)?;
    Ok(times.into_iter().map(|time| KernelTime { level, ..time }).collect())
}

/// The kernels of contact, on the designs of `cases` whose pressure spaces are alike, their bodies on meshes of a level.
pub fn joint_kernels(
    choice: GpuChoice,
    cases: &[DesignCase],
    level: usize,
) -> Result<Vec<KernelTime>, GpuError> {
    let GpuChoice { device: gpu, precision } = choice;
    let Some((space, joints)) = commonest_space(cases, level, choice) else { return Ok(Vec::new()) };
    let (DistinctBodies { requests, .. }, design_slots) = distinct(&joints);
    let mut library = BodyLibrary::default();
    library.solve(&requests);
    let trials = TrialKernels::new(gpu, precision, INVOCATIONS, space.terms)?;
    let slots = Slots::new(&trials, requests.len())?;
    let known: Vec<(u32, &PressureCompliance)> =
        (0..).zip(&requests).map(|(slot, request)| (slot, &**library.compliance(&request.key()))).collect();
    slots.write(&known)?;
    let device_joints: Vec<DeviceJoint> =
        joints.iter().zip(design_slots).map(|((case, _), slots)| DeviceJoint::new(case, slots)).collect();
    let space = library.space(space);
    let contact = |limit| Contact::new(&trials, space, &slots, &device_joints, limit);
    let times = of_joints(&trials, contact, &requests, &device_joints, level)?;
    Ok(times.into_iter().map(|time| KernelTime { level, ..time }).collect())
}

/// The designs of the commonest pressure space with their plans, as many as have room for their slots.
fn commonest_space<'a>(
    cases: &'a [DesignCase],
    level: usize,
    choice: GpuChoice,
) -> Option<(SpaceKey, Vec<(&'a DesignCase, JointPlan)>)> {
    let mut by_space: HashMap<SpaceKey, Vec<(&DesignCase, JointPlan)>> = HashMap::new();
    for case in cases.iter().filter(|case| loads_in_contact(case).next().is_some()) {
        let plan = JointPlan::new(case, MethodChoice::Fe, SWEEP_ACCURACY, level).ok()?;
        by_space.entry(plan.pin.space).or_default().push((case, plan));
    }
    let (space, mut joints) =
        by_space.into_iter().max_by_key(|(space, joints)| (joints.len(), space.terms))?;
    let slot = slot_size(space.terms) as u64 * choice.precision.wide_bytes();
    let room = choice.device.facts.limits.bound_buffer() / (4 * slot);
    joints.truncate(room as usize);
    Some((space, joints))
}

/// As many bodies as the planner gives. The guess that a sweep begins with may be off by orders: the batch is cut by the
/// time of a dispatch until that changes little.
fn planned_batch(
    kernels: &Kernels,
    group: &Group,
    numbers: &[Vec<f64>],
    pcg: &Stage,
) -> Result<Batch, GpuError> {
    let gpu = kernels.gpu;
    let plenty = vec![group.counts; Effort::on(gpu.facts.kind).bodies];
    let plan = |facts: &KernelFacts| match batches(&plenty, facts, &gpu.facts.limits) {
        Ok(planned) => Ok(planned[0].clone()),
        Err(error) => {
            let (adapter, problem) = (gpu.facts.name.clone(), error.to_string());
            Err(GpuError::Failed { adapter, what: "planning", problem })
        }
    };
    let mut facts = group.facts;
    let mut batch = plan(&facts)?;
    for _ in 0..CUTS {
        let count = batch.bodies.len();
        let systems = SystemBatch::new(kernels, &group.layout.systems, count)?;
        systems.assemble(&group.layout, &repeated(numbers, count))?;
        let Rounds { narrow, start, solve, .. } =
            gpu.checked("timing", || systems.rounds(pcg, &kernels.precision.settings(), batch.iterations))?;
        let before: Vec<Pass> = narrow.iter().chain([&start]).map(Dispatch::pass).collect();
        run(gpu, &before, 1)?;
        let taken = run(gpu, &[solve.pass()], 1)?;
        facts = adapted(&facts, &batch, Duration::from_secs_f64(taken));
        batch = plan(&facts)?;
        if batch.bodies.len().abs_diff(count) <= count / 10 {
            break;
        }
    }
    Ok(batch)
}

/// The numbers of so many bodies.
fn repeated(numbers: &[Vec<f64>], count: usize) -> Vec<f64> {
    numbers.iter().cycle().take(count).flatten().copied().collect()
}

/// The kernels from a body's numbers to its slot.
fn of_bodies(
    kernels: &Kernels,
    trials: &TrialKernels,
    group: Group,
    bodies: &[Body],
) -> Result<Vec<KernelTime>, GpuError> {
    let Kernels { gpu, precision, .. } = *kernels;
    let effort = Effort::on(gpu.facts.kind);
    let Group { layout, shared, .. } = &group;
    let numbers: Vec<Vec<f64>> = bodies.iter().map(|body| layout.body_numbers(body)).collect();
    let settings = precision.settings();
    let pcg = kernels.pcg(SystemBatch::new(kernels, &layout.systems, 1)?.on_chip())?;
    let batch = planned_batch(kernels, &group, &numbers, &pcg)?;
    let count = batch.bodies.len();
    let systems = SystemBatch::new(kernels, &layout.systems, count)?;
    let numbers = repeated(&numbers, count);
    let (assembly, _geometry) = gpu.checked("timing", || systems.assembly(layout, &numbers))?;
    let Rounds { narrow, start, solve, refine, settle } =
        gpu.checked("timing", || systems.rounds(&pcg, &settings, batch.iterations))?;
    let sizes = Sizes::of(layout);
    let items = count as u64;
    let of_wide = |kernel, seconds, work| KernelTime {
        kernel,
        precision,
        number_bytes: precision.wide_bytes(),
        level: 0,
        unknowns: sizes.unknowns,
        items,
        seconds,
        work,
        iterations: None,
    };
    let time = |pass: Pass| seconds(gpu, &[pass], effort.samples);
    let mut times = vec![of_wide("assemble", time(assembly.pass())?, sizes.assemble(items, precision))];
    if let Some(narrow) = &narrow {
        times.push(of_wide("narrow", time(narrow.pass())?, sizes.narrow(items, precision)));
    }

    // With d = 0 nothing is gained, and every repetition does all of its work.
    run(gpu, &[start.pass()], 1)?;
    let refined = of_wide("refine", time(refine.pass())?, sizes.refine(items, precision));

    // The first round, in which nearly all steps are taken: first how many dispatches it needs, then all at once.
    run(gpu, &[start.pass()], 1)?;
    let steps = |states: &[SystemState]| states.iter().map(|state| u64::from(state.iterations)).sum::<u64>();
    let mut states = systems.read_reports()?.states;
    let (mut dispatches, mut taken) = (0, 0.0);
    loop {
        let of_dispatch = run(gpu, &[solve.pass()], 1)?;
        let now = systems.read_reports()?.states;
        if steps(&now) == steps(&states) {
            break;
        }
        (states, dispatches, taken) = (now, dispatches + 1, taken + of_dispatch);
    }
    let mut samples = vec![taken];
    if effort.samples > 1 {
        samples.clear();
        for _ in 0..effort.samples {
            run(gpu, &[start.pass()], 1)?;
            samples.push(run(gpu, &[solve.pass()], dispatches)?);
        }
        samples.sort_by(f64::total_cmp);
    }
    times.push(KernelTime {
        number_bytes: precision.real_bytes(),
        iterations: Some(steps(&states)),
        ..of_wide("pcg", samples[samples.len() / 2], sizes.iterate(&states, batch.iterations, precision))
    });
    times.push(refined);

    run(gpu, &[settle.pass()], 1)?;
    let condensation = gpu.checked("timing", || systems.condensation())?;
    times.push(of_wide("condense", time(condensation.pass())?, sizes.condense(items, precision)));

    let terms = trials.terms as u64;
    let slot = slot_size(trials.terms) as u64 * precision.wide_bytes();
    // As many bodies as have room for their slots.
    let room = count.min((gpu.facts.limits.bound_buffer() / slot) as usize);
    let slots = Slots::new(trials, room)?;
    let own: Vec<Body> = bodies.iter().cycle().take(room).copied().collect();
    let gram = gpu.checked("timing", || slots.gram(&systems, shared, &own, 0))?;
    let work = sizes.gram(terms, room as u64, precision);
    times.push(KernelTime { items: room as u64, ..of_wide("gram", time(gram.pass())?, work) });
    Ok(times)
}

/// The kernels of contact, on joints whose bodies are in their slots.
fn of_joints<'a>(
    trials: &'a TrialKernels<'a>,
    contact: impl Fn(u32) -> Result<Contact<'a>, GpuError>,
    requests: &[BodyRequest],
    joints: &[DeviceJoint],
    level: usize,
) -> Result<Vec<KernelTime>, GpuError> {
    let TrialKernels { gpu, precision, terms, .. } = *trials;
    let limit = evaluation_limit(terms, gpu.facts.kind);
    let whole = contact(limit)?;
    let found = whole.solve()?.iter().filter(|answer| matches!(answer, LoadResponse::Found { .. })).count();
    // A search that is cut short after n evaluations has taken more than n: the sum over n is the count of them all.
    let mut evaluations = found as u64;
    for cut in 1..limit {
        let answers = contact(cut)?.solve()?;
        let unfinished = answers.iter().filter(|answer| **answer == LoadResponse::Unfinished).count() as u64;
        evaluations += unfinished;
        if unfinished == 0 {
            break;
        }
    }
    let coarse = requests.iter().filter(|request| request.fidelity != Fidelity::Mesh { level }).count();
    debug_assert!(joints.iter().all(|joint| joint.slots[2..] != [NO_SLOT; 2]));
    let work = Joints {
        terms: terms as u64,
        designs: joints.len() as u64,
        loads: joints.iter().map(|joint| joint.loads.len() as u64).sum(),
        slots: requests.len() as u64,
        coarse_slots: coarse as u64,
        evaluations,
    };
    let samples = Effort::on(gpu.facts.kind).samples;
    let time = |kernel, pass: Pass, work, iterations| -> Result<KernelTime, GpuError> {
        Ok(KernelTime {
            kernel,
            precision,
            number_bytes: precision.wide_bytes(),
            level,
            unknowns: terms as u64,
            items: joints.len() as u64,
            seconds: seconds(gpu, &[pass], samples)?,
            work,
            iterations,
        })
    };
    // In this order: `find` needs the samples.
    Ok(vec![
        time("contact sample", whole.sample.pass(), work.sample(precision), None)?,
        time("contact find", whole.find.pass(), work.find(precision), Some(evaluations))?,
    ])
}
