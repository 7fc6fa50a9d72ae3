//! What each kernel takes, on batches as large as the planner makes them: times, with the work that was done in them.

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use crate::engine::backend::choice::GpuChoice;
use crate::engine::backend::gpu::batch::{Batch, KernelFacts, TARGET, adapted, batches};
use crate::engine::backend::gpu::calibration::{INDENTATIONS, MeasuredJoint};
use crate::engine::backend::gpu::context::{AdapterKind, GpuDevice, GpuError};
use crate::engine::backend::gpu::dispatch::{Dispatch, Pass};
use crate::engine::backend::gpu::elimination::Elimination;
use crate::engine::backend::gpu::front::FrontLayout;
use crate::engine::backend::gpu::front_topology::{FrontTopology, Job};
use crate::engine::backend::gpu::joint_kernel::JointKernel;
use crate::engine::backend::gpu::joint_load::Placed;
use crate::engine::backend::gpu::kernels::{Kernels, Making, Precision, Stage};
use crate::engine::backend::gpu::layout::MeshLayout;
use crate::engine::backend::gpu::solver::{INVOCATIONS, Topology};
use crate::engine::backend::gpu::stages::{Rounds, SystemBatch};
use crate::engine::backend::gpu::system_layout::SystemState;
use crate::engine::backend::joints::{Amplitudes, DeviceBody};
use crate::engine::body_request::{BodyRequest, TopologyKey, mesh_size};
use crate::engine::plan::JointPlan;
use crate::engine::processor_pace::LEVEL;
use crate::engine::spaces::SpaceKey;
use crate::lab::gpu::roofline::seconds;
use crate::lab::gpu::speed::run;
use crate::lab::gpu::work::{FrontMoves, Inner, JointSizes, Sizes, Work};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::body_fit::NEGLIGIBLE;
use crate::mechanics::compliance::pressure_space::Tilt;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::solve::band::PRODUCT_OPERATIONS;
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
    /// Bodies of the batch.
    pub items: u64,
    /// Median, s: of elimination and joints by the device's own clock where it has one, else the wall time from submission to end.
    pub seconds: f64,
    pub work: Work,
    /// Where that is counted.
    pub inner: Option<Inner>,
    /// Steps of all systems in `pcg`.
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
    let GpuChoice { device: gpu, precision, .. } = choice;
    let requests: Vec<BodyRequest> = cases
        .iter()
        .filter_map(|case| JointPlan::new(case, MethodChoice::Fe, SWEEP_ACCURACY, level).ok())
        .flat_map(|plan| [plan.pin, plan.plate])
        .collect();
    let mut groups: BTreeMap<u64, (TopologyKey, Vec<Body>)> = BTreeMap::new();
    let mut known: HashMap<TopologyKey, u64> = HashMap::new();
    for request in requests {
        let key = TopologyKey::of(&request);
        let number = known.len() as u64;
        let number = *known.entry(key.clone()).or_insert(number);
        groups.entry(number).or_insert((key, Vec::new())).1.push(request.body);
    }
    // Of equally many bodies those with larger meshes, so that every run measures the same.
    let size = |bodies: &[Body]| (bodies.len(), mesh_size(&bodies[0], level).unknowns);
    let Some((key, bodies)) = groups.into_values().max_by_key(|(_, bodies)| size(bodies)) else {
        return Ok(Vec::new());
    };
    let kernels = Kernels::new(gpu, precision, INVOCATIONS, Making::Trusted)?;
    let topology = Topology::new(&kernels, &key, &bodies[0])?;
    let mut times: Vec<KernelTime> =
        eliminated(&kernels, &topology.layout, &key, &bodies)?.into_iter().collect();
    times.extend(of_bodies(&kernels, topology, &bodies)?);
    Ok(times.into_iter().map(|time| KernelTime { level, ..time }).collect())
}

/// Of a batch that is eliminated; without a clock on the device with assembly, the way up and down, and the wait. Nothing where the mesh is
/// too fine for it.
fn eliminated(
    kernels: &Kernels,
    mesh: &MeshLayout,
    key: &TopologyKey,
    bodies: &[Body],
) -> Result<Option<KernelTime>, GpuError> {
    let Kernels { gpu, precision, .. } = *kernels;
    let front = FrontLayout::new(&bodies[0], &key.grading(&bodies[0]), &RingModes::of(&key.class), mesh);
    let products = front.tile_products();
    let (entered, panels) = (front.entered_tiles(), front.panel_tiles());
    let Some(topology) = FrontTopology::new(kernels, mesh, &front)? else { return Ok(None) };
    let effort = Effort::on(gpu.facts.kind);
    let numbers: Vec<Vec<f64>> = bodies.iter().map(|body| mesh.body_numbers(body)).collect();
    let mut elimination = Elimination::default();
    let mut condense = |count: usize| -> Result<[f64; 2], GpuError> {
        let job = Job { topology: topology.clone(), numbers: repeated(&numbers, count) };
        let (started, before) = (Instant::now(), elimination.eliminating);
        elimination.condense(kernels, vec![job])?;
        let (wall, own) = (started.elapsed(), elimination.eliminating - before);
        Ok([wall, if gpu.is_timed() { own } else { wall }].map(|time| time.as_secs_f64()))
    };
    // The first batch makes kernels and buffers; then they grow until one takes long.
    let mut count = effort.bodies.min(PACING);
    condense(count)?;
    while count < effort.bodies && condense(count)?[0] < LONG * TARGET.as_secs_f64() {
        count = effort.bodies.min(GROWTH * count);
    }
    let mut seconds =
        (0..effort.samples).map(|_| Ok(condense(count)?[1])).collect::<Result<Vec<_>, GpuError>>()?;
    seconds.sort_by(f64::total_cmp);
    let items = count as u64;
    let [_, values, states, fronts, _, works] = topology.body_bytes();
    let moves = FrontMoves { entered, panels, products, is_on_chip: topology.front.is_on_chip };
    Ok(Some(KernelTime {
        kernel: "elimination",
        precision,
        number_bytes: precision.wide_bytes(),
        level: 0,
        unknowns: Sizes::of(mesh).unknowns,
        items,
        seconds: seconds[seconds.len() / 2],
        work: Work {
            operations: items * products * PRODUCT_OPERATIONS,
            // A front in storage is written and read.
            bytes: items * (values + states + works + 2 * fronts),
        },
        inner: Some(moves.inner(items, precision)),
        iterations: None,
    }))
}

/// The kernel of joints, ten loads each; without a clock on the device with the way up and down, and the wait.
pub fn joint_kernel(gpu: &GpuDevice) -> Result<KernelTime, GpuError> {
    let (joint, effort) = (MeasuredJoint::new(), Effort::on(gpu.facts.kind));
    let mut kernel = JointKernel::new(Making::Trusted);
    let batch = joint.batch(effort.bodies, &INDENTATIONS);
    let mut seconds = Vec::new();
    for sample in 0..=effort.samples {
        let (started, before) = (Instant::now(), kernel.counts.busy);
        kernel.begin(gpu, &batch)?;
        kernel.finish(gpu)?;
        // The first one makes the kernel and its tables.
        if sample > 0 {
            let taken = if gpu.is_timed() { kernel.counts.busy - before } else { started.elapsed() };
            seconds.push(taken.as_secs_f64());
        }
    }
    seconds.sort_by(f64::total_cmp);
    let ((SpaceKey { terms, nodes, .. }, _), items) = (joint.space(), batch.joints.len() as u64);
    let bytes = 4 * batch.numbers.count() as u64 / items + size_of::<Placed>() as u64;
    let sizes = JointSizes {
        terms: terms as u64,
        nodes: nodes as u64,
        rows: summed_rows(&joint) as u64,
        loads: batch.joints[0].load_count.into(),
        bytes: bytes + 4 * batch.joints[0].found() as u64,
    };
    Ok(KernelTime {
        kernel: "joints",
        precision: Precision::F32,
        number_bytes: Precision::F32.wide_bytes(),
        level: LEVEL,
        unknowns: (terms * nodes) as u64,
        items,
        seconds: seconds[seconds.len() / 2],
        work: sizes.work(items),
        inner: Some(sizes.inner(items)),
        iterations: None,
    })
}

/// How many rows of both bodies the kernel adds: those that add more than a share of what the first one does.
fn summed_rows(joint: &MeasuredJoint) -> usize {
    let (_, space) = joint.space();
    let joint = joint.joint();
    let clearance = joint.outlines.radial_clearance as f32;
    let of_body = |(body, tilt): (&DeviceBody, Tilt)| {
        let Amplitudes::Modes(members, compliance) = body.amplitudes else { return 0 };
        let mut amplitudes = body.infinite.map(|number| number as f32).to_vec();
        members.amplitudes(compliance, tilt, &mut amplitudes);
        let powers = (0..members.orders()).map(|power| clearance.powi(power as i32));
        let weights = powers.flat_map(|power| amplitudes.iter().map(move |amplitude| power * amplitude));
        let rows = members.rows(space);
        let added: Vec<f32> = weights.zip(rows.sizes()).map(|(weight, size)| weight.abs() * size).collect();
        added.iter().filter(|own| **own > NEGLIGIBLE * added[0]).count()
    };
    joint.bodies.iter().zip(joint.tilts()).map(of_body).sum()
}

/// Bodies of the first batch, how many times as many the next one has, and the share of a dispatch's time that is long enough.
const PACING: usize = 64;
const GROWTH: usize = 8;
const LONG: f64 = 0.2;

/// As many bodies as the planner gives. The guess that a sweep begins with may be off by orders: the batch is cut by the
/// time of a dispatch until that changes little.
fn planned_batch(
    kernels: &Kernels,
    topology: &Topology,
    numbers: &[Vec<f64>],
    pcg: &Stage,
) -> Result<Batch, GpuError> {
    let gpu = kernels.gpu;
    let plenty = vec![topology.counts; Effort::on(gpu.facts.kind).bodies];
    let plan = |facts: &KernelFacts| match batches(&plenty, facts, &gpu.facts.limits) {
        Ok(planned) => Ok(planned[0].clone()),
        Err(error) => {
            let (adapter, problem) = (gpu.facts.name.clone(), error.to_string());
            Err(GpuError::Failed { adapter, what: "planning", problem })
        }
    };
    let mut facts = topology.facts;
    let mut batch = plan(&facts)?;
    for _ in 0..CUTS {
        let count = batch.bodies.len();
        let systems = SystemBatch::new(kernels, &topology.layout.systems, count)?;
        systems.assemble(&topology.layout, &repeated(numbers, count))?;
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

/// The kernels from a body's numbers to its works.
fn of_bodies(kernels: &Kernels, topology: Topology, bodies: &[Body]) -> Result<Vec<KernelTime>, GpuError> {
    let Kernels { gpu, precision, .. } = *kernels;
    let effort = Effort::on(gpu.facts.kind);
    let Topology { layout, loads, .. } = &topology;
    let numbers: Vec<Vec<f64>> = bodies.iter().map(|body| layout.body_numbers(body)).collect();
    let settings = precision.settings();
    let pcg = kernels.pcg(SystemBatch::new(kernels, &layout.systems, 1)?.on_chip())?;
    let batch = planned_batch(kernels, &topology, &numbers, &pcg)?;
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
        inner: None,
        iterations: None,
    };
    let time = |pass: Pass| seconds(gpu, &[pass], effort.samples);
    let mut times = vec![KernelTime {
        inner: Some(sizes.assemble_inner(items, precision)),
        ..of_wide("assemble", time(assembly.pass())?, sizes.assemble(items, precision))
    }];
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
        inner: Some(sizes.iterate_inner(&states, systems.on_chip().vectors, precision)),
        ..of_wide("pcg", samples[samples.len() / 2], sizes.iterate(&states, batch.iterations, precision))
    });
    times.push(refined);

    run(gpu, &[settle.pass()], 1)?;
    let condensation = gpu.checked("timing", || systems.condensation())?;
    times.push(of_wide("condense", time(condensation.pass())?, sizes.condense(items, precision)));

    let works = systems.works_buffer(loads)?;
    times.push(of_wide(
        "works",
        time(works.dispatch.pass())?,
        sizes.works([loads.count(), loads.pushes()].map(|count| count as u64), items, precision),
    ));
    Ok(times)
}
