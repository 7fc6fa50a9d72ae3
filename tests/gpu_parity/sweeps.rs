//! Whole designs on a device and on the processor.

use std::ops::ControlFlow;
use std::sync::Mutex;

use jointsweep::internals::engine::accuracy::single_precision::OF_SINGLES;
use jointsweep::internals::engine::backend::choice::{GpuChoice, joints_in};
use jointsweep::internals::engine::backend::device_solver::DeviceSolver;
use jointsweep::internals::engine::backend::joints::SolvedJoints;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method};
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, Load, Part};

use super::*;
use crate::common::draws::{concentric, disc_in_block, draw, half_disc_in_annulus};
use crate::common::random::Random;

fn on_device(
    gpu: &GpuDevice,
    precision: Precision,
    options: SolveOptions,
    cases: &[DesignCase],
) -> Vec<DesignOutcome> {
    by(DeviceSolver::Auto, gpu, precision, options, cases)
}

fn by(
    solver: DeviceSolver,
    gpu: &GpuDevice,
    precision: Precision,
    options: SolveOptions,
    cases: &[DesignCase],
) -> Vec<DesignOutcome> {
    let condenser = GpuChoice { solver, ..GpuChoice::new(gpu, precision) }.condenser().unwrap();
    // Joints as on a device that is no software.
    let condenser = condenser.solving_joints(joints_in(precision));
    let mut ladder = Ladder::new(options).in_double().on(Box::new(condenser));
    let outcomes = ladder.solve(cases);
    assert_eq!(ladder.library.lost(), None);
    outcomes
}

/// A device makes the kernels that a solver needs, and no others: each takes its time, and may be one too many for a driver.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn solvers_make_their_own_kernels() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let cases = draw(51, 4, concentric);
    for (solver, expected) in [
        (DeviceSolver::Auto, vec!["assemble", "eliminate", "joints"]),
        (DeviceSolver::Pcg, vec!["assemble", "condense", "joints", "pcg", "refine", "works"]),
    ] {
        let own = Adapters::enumerate().open(AdapterChoice::Named("")).unwrap();
        by(solver, &own, Precision::F32, options, &cases);
        assert_eq!(own.made_kernels().into_iter().collect::<Vec<_>>(), expected);
    }
}

/// The greatest relative difference of the forces and indentations, and how many steps have them; all else must be alike.
fn compare(found: &[DesignOutcome], expected: &[DesignOutcome], backend: BackendKind) -> (f64, usize) {
    let mut differences = Vec::new();
    // Steps without load have zeros on both sides.
    let relative = |a: f64, b: f64| if a == b { 0.0 } else { a / b - 1.0 };
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.case.index, expected.case.index);
        assert_eq!(found.backend, backend, "{:?}", found.case);
        assert_eq!(found.steps.len(), expected.steps.len());
        for (found, expected) in found.steps.iter().zip(&expected.steps) {
            let (Some(a), Some(b)) = (found.response, expected.response) else {
                assert_eq!(found, expected);
                continue;
            };
            assert_eq!((a.method, &found.status), (b.method, &expected.status));
            differences.push(greatest([relative(a.force, b.force), relative(a.indentation, b.indentation)]));
        }
    }
    let count = differences.len();
    (greatest(differences), count)
}

/// By how much the errors of found forces are greater than those of expected ones, in the median: single ones also differ by
/// trial pressures and half angles.
fn more_error(found: &[DesignOutcome], expected: &[DesignOutcome]) -> f64 {
    let errors = |outcomes: &[DesignOutcome]| -> Vec<f64> {
        let steps = outcomes.iter().flat_map(|outcome| &outcome.steps);
        steps.filter_map(|step| step.response).map(|response| response.force_error).collect()
    };
    let mut more: Vec<f64> = errors(found).iter().zip(errors(expected)).map(|(a, b)| a - b).collect();
    more.sort_by(f64::total_cmp);
    more[more.len() / 2]
}

/// Of conjugate gradients; seen: 7.4e-6, 1.5e-11 and 4.6e-10. Elimination in f64 leaves 1e-13.
fn allowed(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 3.2e-5,
        Precision::F64 => 5.1e-11,
        Precision::Mixed => 1e-9,
    }
}

/// A thousand random designs of each kind of plate, no two bodies alike, eliminated.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_thousand_random_designs_of_each_kind() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    for (name, cases) in [
        ("concentric", draw(71, 1000, concentric)),
        ("half disc in annulus", draw(72, 1000, half_disc_in_annulus)),
        ("disc in block", draw(73, 1000, disc_in_block)),
    ] {
        let expected = Ladder::new(options).in_double().solve(&cases);
        for (precision, _) in precisions() {
            // Of the two in f64 by elimination one is enough: they have the same kernels.
            let designs = if precision == Precision::F64 { 100 } else { 1000 };
            let (cases, expected) = (&cases[..designs], &expected[..designs]);
            let found = by(DeviceSolver::Eliminate, device(), precision, options, cases);
            let (worst, count) = compare(&found, expected, BackendKind::Gpu);
            println!("{name}, {precision:?}: {count} forces, {worst:.1e}");
            let is_single = precision == Precision::F32;
            assert!(
                10 * count > 9 * designs && worst < if is_single { OF_SINGLES } else { 1e-11 },
                "{name}, {precision:?}: {count} {worst:e}"
            );
            // And errors say so.
            let said = more_error(&found, expected);
            let least = if is_single { OF_SINGLES } else { 0.0 };
            assert!((said - least).abs() < 0.02 * OF_SINGLES, "{name}, {precision:?}: {said:e}");
        }
    }
}

/// The error of bodies that are deeper than any that was measured is told by coarser meshes; what f32 leaves comes on top.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn unmeasured_bodies_say_their_rounding() {
    let too_wide = |random: &mut Random| {
        let (mut pin, mut ring) = concentric(random);
        (pin.parameters[0], ring.parameters[0]) = (1e-3, 400.0);
        (pin, ring)
    };
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let cases = draw(75, 300, too_wide);
    let expected = Ladder::new(options).in_double().solve(&cases);
    let found = by(DeviceSolver::Eliminate, device(), Precision::F32, options, &cases);
    // Some round too much for a device.
    let on_device = |(found, _): &(DesignOutcome, DesignOutcome)| found.backend == BackendKind::Gpu;
    let (found, expected): (Vec<_>, Vec<_>) = found.into_iter().zip(expected).filter(on_device).unzip();
    let (worst, count) = compare(&found, &expected, BackendKind::Gpu);
    let said = more_error(&found, &expected);
    println!("{count} forces, {worst:.1e}, {said:.2e} more is said");
    assert!(count > 100 && worst < OF_SINGLES, "{count} {worst:e}");
    assert!((said / OF_SINGLES - 1.0).abs() < 0.2, "{said:e}");
}

/// By conjugate gradients random designs of few pins and plates, each with a clearance, moduli and a load of its own.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn random_designs_of_few_bodies_by_iteration() {
    let (bodies, designs) = (count(8, 20), count(300, 1000));
    let drawn = draw(21, bodies, concentric);
    let mut random = Random::new(22);
    // Each in the plane state that it was drawn in.
    let mut pick = |of: Idealization| {
        let of: Vec<&DesignCase> = drawn.iter().filter(|case| case.joint.idealization == of).collect();
        of[(random.unit() * of.len() as f64) as usize].joint.clone()
    };
    let cases: Vec<DesignCase> = draw(23, designs, concentric)
        .into_iter()
        .map(|mut case| {
            let joint = &mut case.joint;
            let (pin, plate) = (pick(joint.idealization).pin, pick(joint.idealization).plate);
            joint.pin = Part { material: with_ratio(joint.pin.clone(), pin.clone()), ..pin };
            joint.plate = Part { material: with_ratio(joint.plate.clone(), plate.clone()), ..plate };
            case
        })
        .collect();
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let expected = Ladder::new(options).in_double().solve(&cases);
    // Negative control: forces of another mesh are not those of this one.
    let finer = Ladder::new(SolveOptions { accuracy: 1e-3, ..options }).in_double().solve(&cases[..50]);
    let force = |outcome: &DesignOutcome| outcome.steps[0].response.unwrap().force;
    let other = greatest(expected[..50].iter().zip(&finer).map(|(a, b)| force(a) / force(b) - 1.0));
    assert!(finer.len() == 50 && other > 3.0 * allowed(Precision::F32), "{other:e}");
    for (precision, _) in precisions() {
        let found = by(DeviceSolver::Pcg, device(), precision, options, &cases);
        let (worst, count) = compare(&found, &expected, BackendKind::Gpu);
        println!("{precision:?}: {count} forces, {worst:.1e}");
        assert!(count as u64 == designs && worst < allowed(precision), "{precision:?}: {count} {worst:e}");
    }
}

/// Young's modulus of the one, Poisson's ratio of the other.
fn with_ratio(own: Part, shape: Part) -> jointsweep::internals::mechanics::material::Material {
    jointsweep::internals::mechanics::material::Material {
        youngs_modulus: own.material.youngs_modulus,
        poissons_ratio: shape.material.poissons_ratio,
    }
}

/// Every shape and method, several steps, loads of both kinds, steps without load, and designs that climb to finer
/// meshes, in every precision.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn designs_of_every_kind_in_every_precision() {
    let mut cases: Vec<DesignCase> =
        [draw(31, 6, concentric), draw(32, 6, half_disc_in_annulus), draw(33, 6, disc_in_block)].concat();
    for (index, case) in (0..).zip(&mut cases) {
        case.index = index;
        let Load::Indentation(delta) = case.steps[0] else { unreachable!("as they are drawn") };
        let force = case.joint.thickness * case.joint.plate.material.youngs_modulus * delta;
        case.steps = vec![
            Load::Indentation(0.0),
            Load::Indentation(delta),
            Load::Force(0.1 * force),
            Load::Indentation(2.0 * delta),
        ]
        .into();
        if index % 5 == 0 {
            case.joint.radial_clearance = 0.0;
        }
    }
    // Answers that come from the processor and from the device; four steps fail on both sides.
    for (method, accuracy, answers) in
        [(MethodChoice::Auto, 3e-3, [24, 44]), (MethodChoice::Fe, 0.01, [0, 68])]
    {
        let options = SolveOptions { accuracy, method };
        let expected = Ladder::new(options).in_double().solve(&cases);
        for (precision, _) in precisions() {
            let found = on_device(device(), precision, options, &cases);
            // What `auto` needs no mesh for stays with the processor.
            let exact = |outcome: &DesignOutcome| {
                let methods = outcome.steps.iter().filter_map(|step| step.response).map(|r| r.method);
                methods.into_iter().any(|method| method == Method::Series)
            };
            let (of_cpu, of_gpu): (Vec<usize>, Vec<usize>) =
                (0..cases.len()).partition(|&index| exact(&expected[index]));
            assert_eq!(
                [of_cpu.len(), of_gpu.len()],
                if method == MethodChoice::Fe { [0, 18] } else { [6, 12] }
            );
            // Half discs whose contact would reach their face fail on both sides, in the same words.
            let failed = |outcome: &DesignOutcome| outcome.steps.iter().any(|step| step.response.is_none());
            assert!(of_gpu.iter().any(|&index| failed(&expected[index])));
            let groups = [(of_cpu, BackendKind::Cpu, answers[0]), (of_gpu, BackendKind::Gpu, answers[1])];
            for (indices, backend, answers) in groups.into_iter().filter(|(indices, ..)| !indices.is_empty())
            {
                let of = |all: &[DesignOutcome]| indices.iter().map(|i| all[*i].clone()).collect::<Vec<_>>();
                let (worst, count) = compare(&of(&found), &of(&expected), backend);
                println!("{method:?} {precision:?}: {count} answers of {backend:?}, {worst:.1e}");
                assert!(
                    count == answers && worst < allowed(precision),
                    "{method:?} {precision:?}: {worst:e}"
                );
            }
        }
    }
}

/// What the device cannot hold the processor condenses, and batches of one body give the same bits.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_the_device_cannot_hold_the_processor_solves() {
    let cases = draw(41, 4, half_disc_in_annulus);
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let expected = Ladder::new(options).in_double().solve(&cases);
    let mut small = device().clone();
    // Not even for the mesh of one body.
    small.facts.limits.binding_bytes = 2_000;
    let found = on_device(&small, Precision::F32, options, &cases);
    assert_eq!(compare(&found, &expected, BackendKind::Cpu), (0.0, 4));
    let all = on_device(device(), Precision::F32, options, &cases);
    let (worst, count) = compare(&all, &expected, BackendKind::Gpu);
    assert!(count == 4 && worst > 0.0 && worst < allowed(Precision::F32), "{count} {worst:e}");
    small.facts.limits.binding_bytes = 1_000_000;
    let found = on_device(&small, Precision::F32, options, &cases);
    assert_eq!(compare(&found, &all, BackendKind::Gpu), (0.0, 4));
}

/// Nearly incompressible bodies in plane strain are beyond f32: no system of theirs reaches its goal, and the processor condenses
/// them.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_f32_cannot_solve_the_processor_does() {
    let mut cases = draw(61, 1, concentric);
    for case in &mut cases {
        let joint = &mut case.joint;
        joint.idealization = Idealization::PlaneStrain;
        joint.pin.material.poissons_ratio = 0.49999;
        joint.plate.material.poissons_ratio = 0.49999;
    }
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let expected = Ladder::new(options).in_double().solve(&cases);
    let found = on_device(device(), Precision::F32, options, &cases);
    assert_eq!(compare(&found, &expected, BackendKind::Cpu), (0.0, 1));
}

/// A device that is lost in the middle of a sweep: its batch and all after it come from the processor, whole.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_device_that_is_lost_loses_no_design() {
    lose_a_device(DeviceSolver::Eliminate, SolvedJoints::None);
    lose_a_device(DeviceSolver::Eliminate, SolvedJoints::All);
    lose_a_device(DeviceSolver::Pcg, SolvedJoints::None);
}

/// The same of crews that have the device in common: what it has not done is the processor's, and that is said once.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_device_that_many_crews_lose_loses_no_design() {
    let study = SWEEPS[0].study(4000, false).unwrap();
    let own = Adapters::enumerate().open(AdapterChoice::Named("")).unwrap();
    let told = Mutex::new(Vec::new());
    let notify = |line: &str| told.lock().unwrap().push(line.to_string());
    let joints = SolvedJoints::All;
    let gpu = Some(GpuChoice { joints, ..GpuChoice::new(&own, Precision::F32) });
    let options = SweepOptions { threads: 8, gpu, notify: Some(&notify), ..SweepOptions::default() };
    let mut met: Vec<(u64, BackendKind)> = Vec::new();
    let statistics = sweep::run(&study, &options, &mut |outcome| {
        assert!(outcome.steps.iter().all(|step| step.response.is_some()), "design {}", outcome.case.index);
        met.push((outcome.case.index, outcome.backend));
        if met.len() == 500 {
            own.device.destroy();
        }
        Ok(ControlFlow::Continue(()))
    })
    .unwrap();
    assert!(met.iter().map(|(index, _)| *index).eq(0..4000));
    let of = |kind: BackendKind| met.iter().filter(|(_, backend)| *backend == kind).count();
    println!("{} on the device, {} not", of(BackendKind::Gpu), of(BackendKind::Cpu));
    assert!(of(BackendKind::Gpu) >= 500 && of(BackendKind::Cpu) > 0);
    assert!(statistics.fallback.is_some());
    let told = told.into_inner().unwrap();
    assert!(told.len() == 1 && told[0].lines().count() == 1, "{told:?}");
}

fn lose_a_device(solver: DeviceSolver, joints: SolvedJoints) {
    let cases = draw(51, 6, concentric);
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let expected = Ladder::new(options).in_double().solve(&cases);
    // Not the one that the other tests share.
    let own = Adapters::enumerate().open(AdapterChoice::Named("")).unwrap();
    let choice = GpuChoice { solver, joints, ..GpuChoice::new(&own, Precision::F32) };
    let condenser = choice.condenser().unwrap();
    let mut ladder = Ladder::new(options).in_double().on(Box::new(condenser));
    let first = ladder.solve(&cases[..2]);
    assert_eq!(ladder.library.lost(), None);
    let (worst, count) = compare(&first, &expected[..2], BackendKind::Gpu);
    assert!(worst < allowed(Precision::F32) && count == 2, "{worst:e} {count}");
    let done = ladder.library.device().map(|device| (device.solves(), device.worst_residual()));
    let is_iterated = solver == DeviceSolver::Pcg;
    assert!(done.is_some_and(|(solves, residual)| (solves > 0 && residual > 0.0) == is_iterated), "{done:?}");
    own.device.destroy();
    let second = ladder.solve(&cases[2..4]);
    let lost = ladder.library.lost().cloned();
    println!("{lost:?}");
    assert!(
        matches!(&lost, Some(error @ GpuError::Lost { .. }) if error.to_string().lines().count() == 1),
        "{lost:?}"
    );
    assert_eq!(compare(&second, &expected[2..4], BackendKind::Cpu), (0.0, 2));
    let third = ladder.solve(&cases[4..]);
    assert_eq!(ladder.library.lost(), lost.as_ref());
    assert_eq!(compare(&third, &expected[4..], BackendKind::Cpu), (0.0, 2));
    // What it has done is still told.
    assert_eq!(ladder.library.device().map(|device| (device.solves(), device.worst_residual())), done);
    assert!(ladder.stages().iter().any(|(name, time)| name.ends_with("GPU") && !time.is_zero()));
}
