//! Joints that a device solves from the numbers of their bodies on, and the processor's answers to the same designs.

use std::ops::ControlFlow;

use jointsweep::internals::engine::accuracy::Want;
use jointsweep::internals::engine::backend::Counts;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::joints::SolvedJoints;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method};
use jointsweep::internals::engine::question::counted::Verdict;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;
use jointsweep::internals::output::sinks::Sinks;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::DesignCase;

use super::joints::{compare, concentric_and_mild, designs, rows};
use super::watched::{Given, Watching};
use super::*;
use crate::common::draws::{concentric, disc_in_block, half_disc_in_annulus};

/// The outcomes of designs on a device, what that was given, and what was asked of it.
fn on(gpu: &GpuDevice, options: SolveOptions, cases: &[DesignCase]) -> (Vec<DesignOutcome>, Given, Counts) {
    solving(SolvedJoints::All, gpu, options, cases, cases.len())
}

/// By a device that solves these joints, so many designs at a time.
fn solving(
    joints: SolvedJoints,
    gpu: &GpuDevice,
    options: SolveOptions,
    cases: &[DesignCase],
    together: usize,
) -> (Vec<DesignOutcome>, Given, Counts) {
    let watching = Watching { joints, leaves_bodies: false };
    let (outcomes, given, counts) =
        watching.solve(gpu, Ladder::new(options).in_double(), cases.chunks(together));
    (outcomes.concat(), given, counts)
}

/// By bodies of the same device, their contact being the processor's.
fn by_works(gpu: &GpuDevice, options: SolveOptions, cases: &[DesignCase]) -> Vec<DesignOutcome> {
    let (outcomes, given, _) = solving(SolvedJoints::None, gpu, options, cases, cases.len());
    assert!(given.whole.is_empty() && given.long > 0);
    outcomes
}

fn on_device(outcomes: &[DesignOutcome]) -> usize {
    outcomes.iter().filter(|outcome| outcome.backend == BackendKind::Gpu).count()
}

/// Every kind of plate, bodies on meshes and exact pins in blocks, by works that stay on the device and by those that come back.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn whole_joints_are_those_of_the_processor() {
    for (name, accuracy, method, cases) in [
        ("concentric", 1e-2, MethodChoice::Fe, designs(101, count(100, 400), concentric)),
        ("concentric, 0.1 %", 1e-3, MethodChoice::Fe, designs(105, count(60, 200), concentric)),
        ("half disc in annulus", 1e-2, MethodChoice::Fe, designs(102, count(60, 200), half_disc_in_annulus)),
        ("disc in block", 1e-2, MethodChoice::Fe, designs(103, count(60, 200), disc_in_block)),
        ("exact disc in block", 1e-2, MethodChoice::Auto, designs(104, count(60, 200), disc_in_block)),
    ] {
        let options = SolveOptions { accuracy, method };
        let expected = by_works(device(), options, &cases);
        let (found, given, _) = on(device(), options, &cases);
        let (few, ..) = on(device(), options, &cases[..40]);
        let (worst, on_device) = compare(&found, &expected, Method::Fe);
        let shown = worst.map(|worst| format!("{worst:.1e}")).join(" ");
        println!("{name}: {on_device} of {} on the device, {given:?}, {shown}", cases.len());
        // The first time nearly all, of those that are asked again the fewest.
        let joints = given.whole[0].map_or(0, |[_, joints]| joints);
        assert!(
            joints * 10 > 8 * cases.len() && given.whole.iter().all(Option::is_some),
            "{name}: {given:?}"
        );
        assert!(on_device * 10 > 8 * cases.len(), "{name}: {on_device}");
        assert!(greatest(worst) < 6e-5, "{name}: {shown}");
        // However many there are at a time.
        assert_eq!(rows(&few), rows(&found[..40]), "{name}");
    }
}

/// Of designs whose first attempt is not good enough the kernel that counts rows says what they want, as the processor does of the states: the next
/// attempt at them is their second one.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_counted_designs_want_is_known() {
    let watching = Watching { joints: SolvedJoints::All, leaves_bodies: false };
    for (sweep, least) in [(SWEEPS[1], 40), (SWEEPS[2], 40)] {
        let study = sweep.answers(300, false).unwrap();
        let cases: Vec<DesignCase> = study.cases().unwrap().map(Result::unwrap).collect();
        let sinks = Sinks::of(&study);
        let asking = sinks.asking().unwrap();
        let ladder = || Ladder::new(study.solve).in_double();
        let (expected, of_all, _) = watching.ask(device(), ladder(), |ladder| ladder.solve(&cases));
        let count_and_solve = |ladder: &mut Ladder| -> Vec<DesignOutcome> {
            let counting = ladder.begin_count(cases.clone()).ok().unwrap();
            let (_, left) = ladder.finish_count(&study, counting).unwrap().unwrap();
            let is_wanting = |(_, verdict): &(DesignCase, Verdict)| verdict.want() != Want::Nothing;
            let wanting: Vec<(DesignCase, Verdict)> = left.into_iter().filter(is_wanting).collect();
            let (cases, verdicts): (Vec<DesignCase>, Vec<Verdict>) = wanting.into_iter().unzip();
            let answers = ladder.answers_beyond(&cases, |place| verdicts[place].want());
            cases.into_iter().zip(answers).map(|(case, answer)| DesignOutcome::new(case, answer)).collect()
        };
        let (found, given, _) = watching.ask(device(), ladder().asked_by(Some(&asking)), count_and_solve);
        println!("{}, {}: {} want more, {given:?}, {of_all:?}", sweep.scene, sweep.accuracy, found.len());
        let first = |given: &Given| given.whole[0].map_or(0, |[_, joints]| joints);
        assert_eq!((first(&given), first(&of_all)), (300, 300));
        // No attempt more, and all that the second one had but for those that had no state.
        let [seconds, all] = [&given, &of_all].map(|given| given.whole[1].map_or(0, |[_, joints]| joints));
        assert_eq!(given.whole.len(), of_all.whole.len());
        assert!(
            found.len() >= least && seconds <= all && all - seconds <= of_all.long / 2,
            "{seconds} {all}"
        );
        for outcome in &found {
            let of_all = &expected[outcome.case.index as usize];
            assert_eq!(outcome.case.index, of_all.case.index);
            assert_eq!(outcome.steps, of_all.steps, "{:?}", outcome.case);
        }
    }
}

/// Where a device has no room for the bodies of all designs that it is to count, it counts fewer at a time.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn counted_designs_come_in_parts_where_room_is_short() {
    let study = SWEEPS[0].answers(1400, false).unwrap();
    let cases: Vec<DesignCase> = study.cases().unwrap().map(Result::unwrap).collect();
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let mut small = device().clone();
    small.facts.limits.binding_bytes = 600_000;
    let watching = Watching { joints: SolvedJoints::All, leaves_bodies: false };
    let ladder = Ladder::new(study.solve).asked_by(Some(&asking));
    let (counted, given, _) = watching.ask(&small, ladder, |ladder| {
        let counting = ladder.begin_count(cases).ok().unwrap();
        ladder.finish_count(&study, counting).unwrap().unwrap().0.designs
    });
    println!("{counted} counted, {given:?}");
    assert!(given.whole[0].is_none() && given.whole[1].is_some() && given.whole.len() == 3, "{given:?}");
    assert!(counted > 1200, "{counted}");
}

/// A batch whose rows are counted is one wait, and the device has the next one meanwhile.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn counted_batches_are_one_wait_each_with_the_next_one_on_the_device() {
    let study = SWEEPS[0].answers(180, false).unwrap();
    let cases: Vec<DesignCase> = study.cases().unwrap().map(Result::unwrap).collect();
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let watching = Watching { joints: SolvedJoints::All, leaves_bodies: false };
    let ladder = Ladder::new(study.solve).asked_by(Some(&asking));
    let (counted, given, counts) = watching.ask(device(), ladder, |ladder| {
        let (mut begun, mut counted) = (None, 0);
        for batch in cases.chunks(60).map(<[DesignCase]>::to_vec).map(Some).chain([None]) {
            let next = batch.map(|batch| ladder.begin_count(batch).ok().unwrap());
            if let Some(before) = std::mem::replace(&mut begun, next) {
                counted += ladder.finish_count(&study, before).unwrap().unwrap().0.designs;
            }
        }
        counted
    });
    println!("{counted} counted, {given:?} {counts:?}");
    assert!(counted > 140 && given.whole.len() == 3 && given.whole.iter().all(Option::is_some), "{given:?}");
    assert_eq!((counts.waits, counts.waits_with_work), (3, 2));
}

/// Bodies and joints of a batch that takes no longer than a submission may are one submission, whether states come back or rows are counted.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_small_batch_is_one_submission() {
    let study = SWEEPS[0].answers(8, false).unwrap();
    let cases: Vec<DesignCase> = study.cases().unwrap().map(Result::unwrap).collect();
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let watching = Watching { joints: SolvedJoints::All, leaves_bodies: false };
    let ladder = Ladder::new(study.solve).asked_by(Some(&asking));
    let (_, given, counted) = watching.ask(device(), ladder, |ladder| {
        for cases in cases.chunks(4) {
            let begun = ladder.begin_count(cases.to_vec()).ok().unwrap();
            ladder.finish_count(&study, begun).unwrap().unwrap();
        }
    });
    println!("{given:?} {counted:?}");
    assert_eq!(given.whole, [Some([8, 4]); 2]);
    assert_eq!((counted.submits, counted.waits), (2, 2));
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let cases = designs(111, 12, concentric_and_mild);
    let (_, given, counts) = solving(SolvedJoints::All, device(), options, &cases[..4], 4);
    println!("{given:?} {counts:?}");
    let begun = given.whole.iter().flatten().count() as u64;
    assert!(begun > 0 && given.long == 0, "{given:?}");
    assert_eq!(counts.submits, begun);
}

/// A portion is waited for once, and of its bodies nothing comes back.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_portion_is_one_wait() {
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    // All are good enough at once.
    let is_narrow = |case: &DesignCase| case.joint.radial_clearance < 0.04 * case.joint.hole_radius;
    let cases = designs(111, 300, concentric_and_mild);
    let cases: Vec<DesignCase> = cases.into_iter().filter(is_narrow).take(200).collect();
    let (found, given, counts) = solving(SolvedJoints::All, device(), options, &cases, 40);
    println!("{given:?} {counts:?}");
    let joints = |whole: &Option<[usize; 2]>| whole.is_some_and(|[_, joints]| joints == 40);
    assert!(on_device(&found) == 200 && given.whole.iter().all(joints) && given.long == 0, "{given:?}");
    assert_eq!((given.whole.len(), counts.waits), (5, 5));
    let loads: usize = cases.iter().map(|case| case.steps.len()).sum();
    // A number of the curve and eleven a load, and what tells that bodies are there.
    assert!(counts.bytes_down <= (4 * (200 + 11 * loads) + 5 * 256) as u64, "{counts:?} {loads}");
}

/// Bodies that many joints have in common go to the device once, and so do joints that many designs have in common.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn bodies_in_common_are_given_once() {
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let mut cases = designs(121, 60, concentric);
    let first = cases[1].clone();
    for (index, case) in cases.iter_mut().enumerate() {
        let (steps, clearance) = (case.steps.clone(), case.joint.radial_clearance / case.joint.hole_radius);
        let [joint, plate] = [&mut case.joint, &mut first.joint.clone()];
        let plate = (index % 2 == 0).then(|| plate.plate.clone());
        joint.idealization = first.joint.idealization;
        joint.pin = first.joint.pin.clone();
        joint.plate = plate.unwrap_or_else(|| joint.plate.clone());
        joint.hole_radius = first.joint.hole_radius;
        joint.radial_clearance = clearance * joint.hole_radius;
        case.steps = steps;
    }
    // Every fourth design is that before it but for its load.
    for index in (3..60).step_by(4) {
        cases[index].joint = cases[index - 1].joint.clone();
    }
    let expected = by_works(device(), options, &cases);
    let (found, given, _) = on(device(), options, &cases);
    let (worst, on_device) = compare(&found, &expected, Method::Fe);
    println!("{given:?} {on_device} {worst:?}");
    let Some([bodies, joints]) = given.whole[0] else { panic!("{given:?}") };
    // One pin, and a plate of its own for every fourth design at most, beside the one that half of them have.
    assert!(bodies <= 1 + 1 + 15 && bodies > 10, "{given:?}");
    assert!(joints <= 45 && joints > 35, "{given:?}");
    assert!(on_device > 50 && greatest(worst) < 6e-5, "{on_device} {worst:?}");
}

/// What rounding in f32 spoils, what the device has no kernel for and what it has no room for is the processor's, and no design is lost.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_is_left_goes_the_long_way() {
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let mut cases = designs(131, 100, disc_in_block);
    // All on their base, some of them soft, and one clearance is too wide for the kernel.
    cases.iter_mut().for_each(|case| case.joint.plate.support = 0);
    cases[1].joint.radial_clearance = 0.1 * cases[1].joint.hole_radius;
    let expected = by_works(device(), options, &cases);
    let (found, given, _) = on(device(), options, &cases);
    let (worst, _) = compare(&found, &expected, Method::Fe);
    println!("{given:?}, {worst:?}");
    assert!(greatest(worst) < 6e-5, "{worst:?}");
    let answers = |all: &[DesignOutcome]| -> Vec<bool> {
        all.iter().flat_map(|outcome| &outcome.steps).map(|step| step.response.is_some()).collect()
    };
    assert_eq!(answers(&found), answers(&expected));
    // With those that are asked for again on a finer mesh: 2 where nobody looks at what rounding has spoilt.
    assert!(given.long > 30 && given.long < 100, "{given:?}");
    // Devices without room for all tables together, and for some tables and meshes at all.
    let cases = designs(132, 200, concentric);
    for (bytes, least) in [(700_000, 190), (100_000, 20)] {
        let mut small = device().clone();
        small.facts.limits.binding_bytes = bytes;
        let expected = by_works(&small, options, &cases);
        let (found, given, _) = on(&small, options, &cases);
        let (worst, here) = compare(&found, &expected, Method::Fe);
        println!("{here} of {} on the device of {bytes} bytes, {given:?}, {worst:?}", cases.len());
        assert!(greatest(worst) < 6e-5 && here >= least, "{here} {worst:?}");
    }
}

/// Crews side by side find the rows of one thread, in their order.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn crews_find_the_same_rows() {
    let designs = count(800, 3000);
    let study = SWEEPS[0].study(designs, false).unwrap();
    let choice = GpuChoice { joints: SolvedJoints::All, ..GpuChoice::new(device(), Precision::F32) };
    let by = |threads: usize| {
        let options = SweepOptions { threads, gpu: Some(choice), ..SweepOptions::default() };
        let mut outcomes = Vec::new();
        let statistics = sweep::run(&study, &options, &mut |outcome| {
            outcomes.push(outcome);
            Ok(ControlFlow::Continue(()))
        });
        assert_eq!(statistics.unwrap().fallback, None);
        outcomes
    };
    let (alone, crews) = (by(1), by(8));
    println!("{} of {} on the device", on_device(&crews), crews.len());
    assert!(crews.len() as u64 == designs && on_device(&crews) as u64 > designs - designs / 30);
    assert!(rows(&crews) == rows(&alone) && crews.iter().map(|outcome| outcome.case.index).eq(0..designs));
}
