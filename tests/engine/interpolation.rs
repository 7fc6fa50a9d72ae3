//! Interpolation across bodies: right to the accuracy asked where it is used, left to the meshes where it is not, and the
//! same in every batch, order and thread.

use std::path::Path;

use crate::common::greatest::greatest;
use crate::common::random::Random;
use jointsweep::internals::engine::bodies::BodyLibrary;
use jointsweep::internals::engine::interpolation::family::coordinates;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{DesignOutcome, Method};
use jointsweep::internals::engine::spaces::{SpaceKey, Spaces};
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::mechanics::body::{Shape, Side, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::compliance::body_fit::{FitScratch, NEGLIGIBLE};
use jointsweep::internals::mechanics::compliance::pressure_space::JointCompliance;
use jointsweep::internals::mechanics::contact::outlines::Outlines;
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

/// Of the sweeps that the designs drawn here stand for.
const COUNT: u64 = 1_000_000;

/// From a range, often one of its ends.
fn often_an_end(random: &mut Random, from: f64, to: f64) -> f64 {
    match (random.unit() * 8.0) as u32 {
        0 => from,
        1 => to,
        _ => random.linear(from, to),
    }
}

fn often_an_end_log(random: &mut Random, from: f64, to: f64) -> f64 {
    often_an_end(random, from.ln(), to.ln()).exp().clamp(from, to)
}

fn part(random: &mut Random, shape: &'static Shape, parameters: [f64; 3], support: usize) -> Part {
    let youngs_modulus = random.log(1e3, 5e5);
    let poissons_ratio = often_an_end(random, 0.1, 0.45);
    Part {
        shape,
        parameters,
        support,
        material: Material { youngs_modulus, poissons_ratio },
        layers: Default::default(),
        yield_stress: None,
    }
}

fn disc_in_ring(random: &mut Random) -> [Part; 2] {
    let core = often_an_end(random, 0.05, 0.6);
    let ratio = often_an_end_log(random, 1.25, 50.0);
    [
        part(random, &cored_disc::SHAPE, [core, 0.0, 0.0], 0),
        part(random, &annulus::SHAPE, [ratio, 0.0, 0.0], 0),
    ]
}

fn half_disc_in_ring(random: &mut Random) -> [Part; 2] {
    let ratio = often_an_end_log(random, 1.5, 20.0);
    [part(random, &half_disc::SHAPE, [0.0; 3], 0), part(random, &annulus::SHAPE, [ratio, 0.0, 0.0], 0)]
}

fn disc_in_block(random: &mut Random) -> [Part; 2] {
    let core = often_an_end(random, 0.05, 0.6);
    let ratios = [(); 3].map(|()| often_an_end_log(random, 1.5, 6.0));
    let support = (random.unit() * 2.0) as usize;
    [part(random, &cored_disc::SHAPE, [core, 0.0, 0.0], 0), part(random, &block::SHAPE, ratios, support)]
}

type Shapes = fn(&mut Random) -> [Part; 2];

fn draw(seed: u64, count: u64, shapes: Shapes) -> Vec<DesignCase> {
    let mut random = Random::new(seed);
    let one = |index| {
        let hole_radius = random.log(1.0, 1000.0);
        let radial_clearance = hole_radius * random.log(1e-6, 0.03);
        let steps = (0..3).map(|step| {
            let delta = radial_clearance * random.log(0.01, 30.0);
            // The force that Johnson's law would have at about this indentation.
            if step < 2 { Load::Indentation(delta) } else { Load::Force(500.0 * delta) }
        });
        let steps = steps.collect();
        let [pin, plate] = shapes(&mut random);
        let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
        let joint = JointDesign { idealization, hole_radius, radial_clearance, thickness: 1.0, pin, plate };
        DesignCase { index, joint, steps }
    };
    (0..count).map(one).collect()
}

fn plan(options: SolveOptions, cases: &[DesignCase]) -> Option<InterpolationPlan> {
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint.clone()).collect();
    InterpolationPlan::new(&options, COUNT, &joints)
}

fn interpolating(options: SolveOptions, cases: &[DesignCase]) -> Ladder<'static> {
    Ladder::new(options).interpolating(Some(plan(options, cases).expect("so many designs are worth a fit")))
}

/// Forces, or indentations, and everything else to the last bit.
fn bits(outcomes: &[DesignOutcome]) -> Vec<(u64, Vec<String>)> {
    let of_design = |outcome: &DesignOutcome| {
        (outcome.case.index, outcome.steps.iter().map(|step| format!("{step:?}")).collect())
    };
    outcomes.iter().map(of_design).collect()
}

/// Of the steps that both sides answer and that have a load.
struct Compared {
    steps: usize,
    /// Steps that one side or both have no answer to.
    unanswered: usize,
    /// Of the interpolated steps: errors of the force, their estimates, and errors of the stiffness.
    force: Vec<f64>,
    estimate: Vec<f64>,
    stiffness: Vec<f64>,
}

fn compare(found: &[DesignOutcome], exact: &[DesignOutcome]) -> Compared {
    let (mut steps, mut unanswered) = (0, 0);
    let (mut force, mut estimate, mut stiffness) = (Vec::new(), Vec::new(), Vec::new());
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(exact) {
        assert_eq!(found.steps.len(), exact.steps.len());
        for (found, exact) in found.steps.iter().zip(&exact.steps) {
            let (Some(found), Some(exact)) = (found.response, exact.response) else {
                // At the widest contact there may be, either side may find it a little wider.
                let half_angle = found.response.or(exact.response).and_then(|one| one.contact_half_angle);
                assert!(half_angle.is_none_or(|angle| angle > 1.5), "{} {}", found.status, exact.status);
                unanswered += 1;
                continue;
            };
            if exact.force == 0.0 {
                continue;
            }
            steps += 1;
            if found.method == Method::Interpolated {
                let of_force = (found.force / exact.force - 1.0).abs();
                // Where the force is given, by way of the stiffness.
                let offset = (found.indentation - exact.indentation).abs();
                force.push(greatest([of_force, offset * exact.tangent_stiffness / exact.force]));
                estimate.push(found.force_error);
                stiffness.push(found.tangent_stiffness / exact.tangent_stiffness - 1.0);
            }
        }
    }
    Compared { steps, unanswered, force, estimate, stiffness }
}

/// What a comparison is held to, as docs/verification.md has it: so far above it an error may be by `MARGIN`.
struct Seen {
    accuracy: f64,
    /// Of the steps, interpolated.
    share: f64,
    /// Steps with a load, and those of them that are not answered.
    steps: usize,
    unanswered: usize,
    /// The worst of the force and of the stiffness, relative.
    force: f64,
    stiffness: f64,
    /// Mean estimate over mean error.
    excess: f64,
}

/// Above what was seen: room for other roundings, not for a worse fit.
const MARGIN: f64 = 1.3;

/// More than this an estimate is not over the error, in the mean.
const MOST_EXCESS: f64 = 11.0;

fn check(what: &str, found: &[DesignOutcome], exact: &[DesignOutcome], seen: &Seen) {
    let Compared { steps, unanswered, force, estimate, stiffness } = compare(found, exact);
    let share = force.len() as f64 / steps as f64;
    let bounded = force.iter().zip(&estimate).filter(|(error, estimate)| error <= estimate).count() as f64
        / force.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let excess = mean(&estimate) / mean(&force);
    let [worst_force, worst_estimate, worst_stiffness] =
        [&force, &estimate, &stiffness].map(|all| greatest(all.iter().copied()));
    println!(
        "{what}: {steps} steps and {unanswered} unanswered, {share:.4} interpolated; force mean {:.1e} worst {worst_force:.1e}, \
         bounded {bounded:.4}, estimate/error {excess:.1}; stiffness worst {worst_stiffness:.1e}",
        mean(&force),
    );
    assert!(
        unanswered <= seen.unanswered && steps + unanswered == seen.steps,
        "{what}: {steps} {unanswered}"
    );
    // The rest are contacts at the end of a curve, and designs whose estimate is above the accuracy.
    assert!(share > seen.share, "{what}: {share}");
    // What outlines leave is told beside what is asked.
    assert!(
        worst_force <= seen.accuracy && worst_estimate <= 1.2 * seen.accuracy,
        "{what}: {worst_force:e} {worst_estimate:e}"
    );
    assert!(worst_force <= MARGIN * seen.force, "{what}: {worst_force:e}");
    assert!(worst_stiffness <= MARGIN * seen.stiffness, "{what}: {worst_stiffness:e}");
    assert!(excess <= MARGIN * seen.excess && excess < MOST_EXCESS, "{what}: {excess}");
    // Seen: 0.9963 at the least.
    assert!(bounded >= 0.98, "{what}: {bounded}");
}

#[test]
fn concentric_joints_meet_the_accuracy_against_series() {
    let cases = draw(11, 2000, disc_in_ring);
    let series = SolveOptions { accuracy: 1e-2, method: MethodChoice::Series };
    let exact = Ladder::new(series).solve(&cases);
    for (method, accuracy, share, force, stiffness, excess) in [
        (MethodChoice::Fe, 1e-2, 0.99, 1.4e-3, 1.5e-3, 5.8),
        (MethodChoice::Auto, 1e-2, 0.99, 1.5e-3, 1.6e-3, 9.9),
        (MethodChoice::Fe, 3e-3, 0.99, 1.5e-3, 1.4e-3, 5.3),
        (MethodChoice::Auto, 3e-3, 0.99, 1.5e-3, 1.5e-3, 6.8),
        (MethodChoice::Fe, 1e-3, 0.99, 5.1e-4, 5.2e-4, 5.3),
        (MethodChoice::Auto, 1e-3, 0.9, 6.5e-4, 7.5e-4, 7.0),
    ] {
        let options = SolveOptions { accuracy, method };
        let found = interpolating(options, &cases).solve(&cases);
        let seen = Seen { accuracy, share, steps: 6000, unanswered: 0, force, stiffness, excess };
        check(&format!("disc in ring, {method:?} at {accuracy}"), &found, &exact, &seen);
    }
}

/// Where no series exists, meshes at a tenth of the accuracy are the judge.
#[test]
fn other_shapes_meet_the_accuracy_against_finer_meshes() {
    let accuracy = 1e-2;
    let of_blocks = Seen {
        accuracy,
        share: 0.98,
        steps: 1200,
        unanswered: 0,
        force: 4.2e-3,
        stiffness: 4.3e-3,
        excess: 10.1,
    };
    let of_half_discs = Seen {
        accuracy,
        share: 0.98,
        steps: 1200,
        unanswered: 4,
        force: 4.1e-3,
        stiffness: 4.2e-3,
        excess: 9.2,
    };
    let shapes: [(&str, Shapes, Seen); 2] = [
        ("disc in block", disc_in_block, of_blocks),
        ("half disc in ring", half_disc_in_ring, of_half_discs),
    ];
    for (name, shapes, seen) in shapes {
        let cases = draw(12, 400, shapes);
        let options = SolveOptions { accuracy, method: MethodChoice::Auto };
        let exact = Ladder::new(SolveOptions { accuracy: 1e-3, ..options }).solve(&cases);
        let found = interpolating(options, &cases).solve(&cases);
        check(name, &found, &exact, &seen);
    }
}

/// Where it is known what a mesh is worth, no coarser one is solved to tell it: each of the 141 blocks held out once, beside
/// 481 samples, or 873 or 1453 of higher degrees. Farther away than any block that was measured it is not known.
#[test]
fn what_is_known_of_meshes_spares_coarser_ones() {
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Auto };
    let solved = |farthest: f64| -> Vec<u64> {
        let mut cases = draw(16, 300, disc_in_block);
        cases[0].joint.plate.parameters = [farthest; 3];
        let mut backend = interpolating(options, &cases);
        backend.solve(&cases[..1]);
        let interpolation = backend.interpolation.unwrap();
        let of_blocks = interpolation.fits().filter(|family| family.fit.polynomials.ranges.len() == 4);
        of_blocks.map(|family| family.solved).collect()
    };
    let known = solved(6.0);
    assert!(
        known.len() == 2 && known.iter().all(|solved| [481, 873, 1453].contains(&(solved - 141))),
        "{known:?}"
    );
    let unknown = solved(15.0);
    assert!(unknown.iter().any(|solved| *solved >= 481 + 2 * 141), "{unknown:?}");
}

/// Whole or in pieces, forwards or backwards, on one thread or on several: each design has one answer.
#[test]
fn batches_order_and_threads_change_nothing() {
    let cases = draw(13, 600, disc_in_ring);
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let outcomes = interpolating(options, &cases).solve(&cases);
    // Seen: all of 1800.
    assert!(steps_by(&outcomes, Method::Interpolated) > 1790);
    let whole = bits(&outcomes);
    let mut pieces = Vec::new();
    let mut backend = interpolating(options, &cases);
    // Designs from the end come first, by themselves.
    for piece in cases.chunks(7).rev() {
        pieces.push(bits(&backend.solve(piece)));
    }
    pieces.reverse();
    assert_eq!(pieces.concat(), whole);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let outcomes = pool.install(|| interpolating(options, &cases).solve(&cases));
        assert_eq!(bits(&outcomes), whole, "{threads} threads");
    }
}

const CONFIG: &str = r#"
[joint]
idealization = "plane-stress"
hole_radius = { from = "5 mm", to = "100 mm" }
radial_clearance = "0.05 mm"
thickness = "1 mm"
[joint.pin]
model = "rigid-core"
youngs_modulus = "210 GPa"
poissons_ratio = { from = 0.1, to = 0.45 }
[joint.plate]
model = "annulus"
outer_radius_ratio = { from = 1.5, to = 20 }
youngs_modulus = "70 GPa"
poissons_ratio = { from = 0.1, to = 0.45 }
[load]
indentation = ["0 mm", "0.01 mm", "0.1 mm"]
[sampling]
method = "latin-hypercube"
count = 6000
[solve]
method = "fe"
"#;

fn study(more: &str) -> Study {
    Study::from_text(Path::new("sweep.toml"), format!("{CONFIG}{more}")).unwrap()
}

fn steps_by(outcomes: &[DesignOutcome], method: Method) -> usize {
    let steps = outcomes.iter().flat_map(|outcome| &outcome.steps);
    steps.filter(|step| step.response.is_some_and(|response| response.method == method)).count()
}

fn run(study: &Study, threads: usize) -> Vec<DesignOutcome> {
    let mut outcomes = Vec::new();
    let options = SweepOptions { threads, ..SweepOptions::default() };
    sweep::run(study, &options, &mut |outcome| {
        outcomes.push(outcome);
        Ok(std::ops::ControlFlow::Continue(()))
    })
    .unwrap();
    outcomes
}

/// A sweep decides by itself: it is large enough here, and the config may forbid it. Any part of the study, solved with the
/// study's plan, has the answers of the whole.
#[test]
fn a_study_decides_for_all_of_its_designs() {
    let study = study("");
    let whole = run(&study, 1);
    // Seen: all of 18,000.
    assert!(steps_by(&whole, Method::Interpolated) > 17_900);
    // In one crew, and in four that share their fits.
    assert_eq!(bits(&run(&study, 2)), bits(&whole));
    assert_eq!(bits(&run(&study, 8)), bits(&whole));
    let part: Vec<DesignCase> = study.cases().unwrap().skip(4321).take(50).map(Result::unwrap).collect();
    let plan = InterpolationPlan::of_study(&study).unwrap();
    let alone = Ladder::new(study.solve).sharing(study.in_common()).interpolating(Some(plan)).solve(&part);
    assert_eq!(bits(&alone), bits(&whole[4321..4371]));

    let meshes = self::study("interpolation = \"off\"\n");
    assert!(InterpolationPlan::of_study(&meshes).is_none());
    let found = run(&meshes, 2);
    assert_eq!(steps_by(&found, Method::Fe), 18_000);
    let seen = Seen {
        accuracy: 1e-2,
        share: 0.99,
        steps: 12_000,
        unanswered: 0,
        force: 5.2e-4,
        stiffness: 6.7e-4,
        excess: 5.4,
    };
    check("a study", &whole, &found, &seen);
}

/// Nor do wide clearances, whose outlines are told to second order, make a difference.
#[test]
fn wide_clearances_are_interpolated_as_well() {
    let mut random = Random::new(18);
    let mut cases = draw(18, 1000, disc_in_ring);
    for DesignCase { joint, steps, .. } in &mut cases {
        joint.radial_clearance = joint.hole_radius * random.log(0.01, 0.08);
        *steps = [0.05, 0.5, 3.0].map(|ratio| Load::Indentation(ratio * joint.radial_clearance)).into();
    }
    let exact = Ladder::new(SolveOptions { accuracy: 1e-4, method: MethodChoice::Series }).solve(&cases);
    let found =
        interpolating(SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe }, &cases).solve(&cases);
    let Compared { steps, force, estimate, .. } = compare(&found, &exact);
    let bounded = force.iter().zip(&estimate).filter(|(error, estimate)| error <= estimate).count();
    println!(
        "{} of {steps} interpolated, {bounded} bounded, worst {:.1e}",
        force.len(),
        greatest(force.iter().copied())
    );
    assert!(steps > 2900 && force.len() * 100 > 98 * steps, "{} of {steps}", force.len());
    assert!(bounded * 100 >= 99 * force.len() && greatest(force.iter().copied()) < 4e-3, "{bounded}");
}

/// What smaller arcs of the hole change of a plate is a polynomial of the clearance, and beyond it found point by point.
#[test]
fn plates_are_moved_to_the_holes_arcs() {
    let cases = draw(3, 60, disc_in_ring);
    let plan = plan(SolveOptions { accuracy: 1e-3, method: MethodChoice::Fe }, &cases).unwrap();
    let (mut library, mut spaces) = (BodyLibrary::default(), Spaces::default());
    let (family, budget) =
        plan.families.iter().find(|(family, _)| family.example.shape.side == Side::Plate).unwrap();
    let mut fit = family.fit(1e-3, *budget, &mut library, &mut spaces).unwrap();
    let keys: Vec<SpaceKey> = SpaceKey::of_fits_of_thick_walls(false, 1e-2).collect();
    fit.prepare(keys.iter().copied(), &mut spaces);
    let mut scratch = FitScratch::default();
    let (mut compared, mut worst) = (0, 0.0_f64);
    for case in &cases {
        let body = case.joint.body(&case.joint.plate);
        let point = coordinates(&body);
        for key in keys.iter().copied().filter(|_| fit.contains(&body, &point)) {
            let (rows, space) = (fit.rows(key).unwrap(), spaces.get(key));
            let mut part = |outlines: &Outlines| {
                fit.fit.coefficients().sums(0.0, &mut [fit.begin((&body, &point), &mut scratch)]);
                rows.sums(NEGLIGIBLE, &mut [fit.weigh((&body, 1.0), outlines, &mut scratch)]);
                let part = fit.part((&body, 1.0), outlines, space, &mut scratch);
                JointCompliance { values: part.values.into_owned().into(), ..part }
            };
            let own = part(&Outlines::ALIKE);
            let size = greatest(own.values.iter().map(|value| value.abs()));
            let mut expected = Vec::new();
            for clearance in [0.0, 1e-5, 1e-3, 0.007, 0.03, 0.05, 0.051, 0.2] {
                let outlines = Outlines::new(clearance);
                space.to_hole(&own, &outlines, &mut expected);
                let moved = part(&outlines);
                assert_eq!(moved.even, own.even);
                let errors =
                    moved.values.iter().zip(&expected).map(|(found, expected)| (found - expected).abs());
                worst = worst.max(greatest(errors) / size);
                compared += 1;
            }
        }
    }
    println!("{compared} plates, worst {worst:.1e}");
    assert!(compared > 500 && worst < 3e-6, "{compared} {worst}");
}

/// No fit for few bodies, for methods and accuracies that leave no room, and for bodies that no mesh is trusted with.
#[test]
fn a_fit_that_costs_more_than_it_saves_is_not_made() {
    let cases = draw(14, 300, disc_in_ring);
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint.clone()).collect();
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let is_planned = |options: SolveOptions, count: u64, joints: &[JointDesign]| {
        InterpolationPlan::new(&options, count, joints).is_some()
    };
    assert!(is_planned(options, COUNT, &joints));
    assert!(!is_planned(options, 300, &joints));
    assert!(!is_planned(SolveOptions { method: MethodChoice::Series, ..options }, COUNT, &joints));
    assert!(!is_planned(SolveOptions { accuracy: 1e-4, ..options }, COUNT, &joints));
    assert!(!is_planned(options, COUNT, &[]));
    let with = |change: fn(&mut JointDesign)| {
        let mut joints = joints.clone();
        joints.iter_mut().for_each(change);
        is_planned(options, COUNT, &joints)
    };
    assert!(!with(|joint| {
        joint.idealization = Idealization::PlaneStrain;
        joint.pin.material.poissons_ratio = 0.49;
    }));
    assert!(!with(|joint| joint.plate.parameters[0] = 1.1));
}

/// A design that the box does not hold, or a kind of body that was not looked at, is solved as without interpolation.
#[test]
fn designs_outside_are_left_to_the_meshes() {
    let cases = draw(15, 600, disc_in_ring);
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let mut outside = cases[..40].to_vec();
    for (index, case) in outside.iter_mut().enumerate() {
        match index % 4 {
            0 => case.joint.plate.parameters[0] = 80.0,
            1 => case.joint.pin.parameters[0] = 0.7,
            2 => case.joint.pin.material.poissons_ratio = 0.05,
            _ => case.joint.plate.material.poissons_ratio = -0.3,
        }
    }
    let found = interpolating(options, &cases).solve(&outside);
    let expected = Ladder::new(options).solve(&outside);
    assert_eq!(steps_by(&expected, Method::Fe), 120);
    assert_eq!(bits(&found), bits(&expected));
}
