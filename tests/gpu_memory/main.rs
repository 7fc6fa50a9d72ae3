//! A device that runs out of memory in the middle of a sweep. Alone in its file, because it takes memory from the whole
//! process.

#[path = "../common"]
mod common {
    pub mod random;
    #[allow(dead_code, reason = "only concentric joints are drawn here")]
    pub mod draws;
}

use std::ops::Range;
use std::path::Path;

use common::draws;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::device_solver::DeviceSolver;
use jointsweep::internals::engine::backend::gpu::calibration::{INDENTATIONS, MeasuredJoint};
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters, GpuDevice, GpuError};
use jointsweep::internals::engine::backend::gpu::elimination::Elimination;
use jointsweep::internals::engine::backend::gpu::front::FrontLayout;
use jointsweep::internals::engine::backend::gpu::front_topology::{FrontTopology, Job};
use jointsweep::internals::engine::backend::gpu::joint_kernel::JointKernel;
use jointsweep::internals::engine::backend::gpu::kernels::{Kernels, Making, Precision};
use jointsweep::internals::engine::backend::gpu::layout::MeshLayout;
use jointsweep::internals::engine::backend::joints::{ENDED, STATE_NUMBERS, SolvedJoints};
use jointsweep::internals::engine::body_request::mesh_class;
use jointsweep::internals::engine::interpolation::drawn_on_device::Drawing;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::BackendKind;
use jointsweep::internals::engine::question::Asker;
use jointsweep::internals::engine::question::counted::Counted;
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;
use jointsweep::internals::mechanics::body::{Body, annulus};
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::output::sinks::Sinks;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};
use rlimit::Resource;

/// Software Vulkan takes its memory from the process, which may have no more than it has and some.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_device_without_memory_loses_no_design() {
    let gpu = Adapters::enumerate().open(AdapterChoice::Named("llvmpipe")).unwrap();
    elimination_goes_on_with_smaller_buffers(&gpu);
    joints_go_on_in_smaller_flights(&gpu);
    drawn_designs_go_on_in_smaller_flights(&gpu);
    iteration_is_left_to_the_processor(&gpu);
}

/// A batch that is refused comes in several smaller ones, with the same works.
fn elimination_goes_on_with_smaller_buffers(gpu: &GpuDevice) {
    let kernels = Kernels::new(gpu, Precision::F64, 64, Making::Trusted).unwrap();
    let plate = |index: usize| Body {
        shape: &annulus::SHAPE,
        parameters: [2.9 + 1e-4 * index as f64, 0.0, 0.0],
        support: 0,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStress,
        lining: Default::default(),
        all_around: false,
    };
    let bodies: Vec<Body> = (0..MANY).map(plate).collect();
    let class = mesh_class(&bodies[0], 0);
    let grading = class.grading(bodies[0].shape.end_angle);
    let mesh = MeshLayout::new(&bodies[0], &grading).unwrap();
    let front = FrontLayout::new(&bodies[0], &grading, &RingModes::of(&class), &mesh);
    let topology = FrontTopology::new(&kernels, &mesh, &front).unwrap().unwrap();
    let job = |bodies: &[Body]| {
        let numbers = bodies.iter().flat_map(|body| mesh.body_numbers(body)).collect();
        Job { topology: topology.clone(), numbers }
    };
    let condense = |elimination: &mut Elimination, bodies: &[Body]| {
        elimination.condense(&kernels, vec![job(bodies)]).unwrap().remove(0)
    };
    let mut elimination = Elimination::default();
    let few = bodies.chunks(100).flat_map(|bodies| condense(&mut elimination, bodies));
    let expected: Vec<_> = few.collect();
    assert_eq!(elimination.halved(), 0);
    // One that takes software for a large GPU asks for room for all bodies at once.
    let mut elimination = Elimination::at_pace(1e-12);
    let (soft, hard) = rlimit::getrlimit(Resource::AS).unwrap();
    let own: u64 = topology.body_bytes().iter().sum();
    let left = MANY as u64 * own / 4;
    rlimit::setrlimit(Resource::AS, virtual_memory() + left, hard).unwrap();
    // Behind a batch that the device has already.
    elimination.begin(&kernels, vec![job(&bodies[..100])]).unwrap();
    elimination.begin(&kernels, vec![job(&bodies)]).unwrap();
    assert!(elimination.finish(&kernels).unwrap().remove(0) == expected[..100]);
    let found = elimination.finish(&kernels).unwrap().remove(0);
    // Works that are to stay on the device do not, and are asked for again.
    let mut keeping = Elimination::at_pace(1e-12);
    assert!(keeping.keep(&kernels, &[job(&bodies)]).unwrap().is_none() && keeping.halved() > 0);
    let kept = keeping.keep(&kernels, &[job(&bodies[..100])]).unwrap().unwrap();
    assert_eq!(kept.places.len(), 100);
    rlimit::setrlimit(Resource::AS, soft, hard).unwrap();
    assert!(elimination.halved() > 0, "{:?}", elimination.counts);
    assert!(found == expected && found.iter().all(Option::is_some));
}

/// Joints that are refused all at once come in several flights, with the same states.
fn joints_go_on_in_smaller_flights(gpu: &GpuDevice) {
    let joint = MeasuredJoint::new();
    let mut kernel = JointKernel::new(Making::Trusted);
    // Many more loads that have no state, which takes room and no time.
    let mut indentations = INDENTATIONS.to_vec();
    indentations.resize(MANY_LOADS, f64::NAN);
    kernel.begin(gpu, &joint.batch(1, &indentations)).unwrap();
    let expected = kernel.finish(gpu).unwrap();
    // A search that has come to its end says so.
    let ended = expected[1..].chunks(STATE_NUMBERS).filter(|state| state[0] == ENDED).count();
    assert_eq!((expected.len(), ended), (1 + MANY_LOADS * STATE_NUMBERS, 10));
    assert_eq!(kernel.halved(), 0);
    let (few, many) = (joint.batch(10, &indentations), joint.batch(MANY_JOINTS, &indentations));
    // Up and twice down, each with a quarter of room to spare. A fifth of that is too little for a third of the joints, and enough for a
    // sixth, and for what wgpu writes them by: where that is refused, it loses the device. What is found is here, too.
    let found_bytes = MANY_JOINTS * size_of_val(&expected[..]);
    let of_device = (4 * many.numbers.count() + 2 * found_bytes) * 5 / 4;
    let (soft, hard) = rlimit::getrlimit(Resource::AS).unwrap();
    let allowed = virtual_memory() + (found_bytes + of_device * 22 / 100) as u64;
    rlimit::setrlimit(Resource::AS, allowed, hard).unwrap();
    // Behind others that the device has already.
    kernel.begin(gpu, &few).unwrap();
    kernel.begin(gpu, &many).unwrap();
    let found = [kernel.finish(gpu).unwrap(), kernel.finish(gpu).unwrap()];
    rlimit::setrlimit(Resource::AS, soft, hard).unwrap();
    assert!(kernel.halved() > 0, "{:?}", kernel.counts);
    assert_eq!(found.each_ref().map(Vec::len), [10, MANY_JOINTS].map(|count| count * expected.len()));
    assert!(found.iter().flat_map(|found| found.chunks(expected.len())).all(|own| own == expected));
}

/// Designs that the device draws come in smaller flights, too, and are counted as those of small batches are.
fn drawn_designs_go_on_in_smaller_flights(gpu: &GpuDevice) {
    // Many loads take more room than time.
    let text = SWEEPS[0]
        .answers(1_000_000, true)
        .unwrap()
        .source_text()
        .replace("count = 10, spacing", "count = 100, spacing");
    let study = Study::from_text(Path::new("drawn.toml"), text).unwrap();
    assert_eq!(study.steps_per_design(), 100);
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let drawing = Drawing::of(&study, asking.question()).unwrap();
    let choice = GpuChoice { joints: SolvedJoints::Interpolated, ..GpuChoice::new(gpu, Precision::F32) };
    let ladder = || {
        let ladder = Ladder::new(study.solve).interpolating(InterpolationPlan::of_study(&study));
        ladder.asked_by(Some(&asking)).on(Box::new(choice.condenser().unwrap()))
    };
    let counted = |ladder: &mut Ladder, numbers: Range<u64>| {
        let counting = ladder.begin_drawn(&drawing, numbers).unwrap();
        ladder.finish_count(&study, counting).unwrap().unwrap().0
    };
    let submits = |ladder: &Ladder| ladder.library.device().unwrap().counts().submits;
    let mut few = ladder();
    let mut expected = Counted::none(asking.question());
    (0..MANY_DRAWN).step_by(500).for_each(|first| expected.merge(&counted(&mut few, first..first + 500)));
    let mut many = ladder();
    counted(&mut many, 0..64);
    let before = submits(&many);
    // Flights of half of them take 80 MB each, two at a time. wgpu takes memory in blocks of 128 MB, of which there may be one more.
    let allowed = virtual_memory() + (160 << 20);
    let (soft, hard) = rlimit::getrlimit(Resource::AS).unwrap();
    rlimit::setrlimit(Resource::AS, allowed, hard).unwrap();
    let begun = many.begin_drawn(&drawing, 0..MANY_DRAWN);
    rlimit::setrlimit(Resource::AS, soft, hard).unwrap();
    assert_eq!(many.library.lost(), None);
    rlimit::setrlimit(Resource::AS, allowed, hard).unwrap();
    let found = many.finish_count(&study, begun.unwrap()).unwrap().unwrap().0;
    rlimit::setrlimit(Resource::AS, soft, hard).unwrap();
    assert_eq!(many.library.lost(), None);
    assert!(submits(&many) > before + 2, "{:?}", many.library.device().unwrap().counts());
    assert!(found.designs > MANY_DRAWN * 9 / 10);
    let of = |counted: &Counted| (counted.designs, counted.rows, counted.kept_rows, counted.forces);
    assert_eq!(of(&found), of(&expected));
}

const MANY_DRAWN: u64 = 20_000;

/// In two flights, if there is the memory.
const MANY_LOADS: usize = 1000;
const MANY_JOINTS: usize = 2000;

/// Some that the device takes in one dispatch, if it has the memory.
const MANY: usize = 8000;

/// A large batch of conjugate gradients is refused, the processor solves it, and no design is lost.
fn iteration_is_left_to_the_processor(gpu: &GpuDevice) {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let few = draws::draw(31, 8, draws::concentric);
    // Plates of one topology, which none of the first has met: batches as large as the first guess of their time makes them. Pins
    // are all alike, since the device would iterate on them first.
    let mut many = draws::draw(32, 2000, draws::concentric);
    for (index, case) in many.iter_mut().enumerate() {
        let joint = &mut case.joint;
        joint.idealization = Idealization::PlaneStrain;
        joint.pin = few[0].joint.pin.clone();
        joint.plate.parameters[0] = 2.9 + 1e-4 * index as f64;
    }
    let condenser =
        GpuChoice { solver: DeviceSolver::Pcg, ..GpuChoice::new(gpu, Precision::F64) }.condenser().unwrap();
    let mut ladder = Ladder::new(options).on(Box::new(condenser));
    // All kernels are made, all threads started.
    let before = ladder.solve(&few);
    assert_eq!(ladder.library.lost(), None);
    assert_eq!(before.len(), few.len());
    assert!(before.iter().all(|outcome| outcome.backend == BackendKind::Gpu));

    let allowed = virtual_memory() + MEMORY_LEFT;
    rlimit::setrlimit(Resource::AS, allowed, allowed).unwrap();
    let outcomes = ladder.solve(&many);
    let reason = ladder.library.lost();
    println!("{reason:?}");
    let Some(GpuError::OutOfMemory { what, problem, .. }) = reason else { panic!("{reason:?}") };
    assert!(problem.to_lowercase().contains("memory"), "{what}: {problem}");
    assert_eq!(outcomes.len(), many.len());
    for (outcome, case) in outcomes.iter().zip(&many) {
        assert_eq!((outcome.case.index, outcome.backend), (case.index, BackendKind::Cpu));
        assert!(outcome.steps.iter().all(|step| step.response.is_some()), "{outcome:?}");
    }
}

/// Enough for the processor, bytes, and less than the device asks for a batch of these bodies.
const MEMORY_LEFT: u64 = 100 << 20;

/// Bytes of address space that this process has.
fn virtual_memory() -> u64 {
    let sizes = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: u64 = sizes.split_whitespace().next().unwrap().parse().unwrap();
    pages * 4096
}
