//! From designs to outcomes: what each row says of itself, finer meshes where they are needed, and bodies shared by
//! designs, batches and steps without a trace.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::common::draws::{concentric, draw};
use crate::common::greatest::greatest;
use crate::common::random::Random;
use jointsweep::internals::engine::accuracy::Estimate;
use jointsweep::internals::engine::accuracy::Want;
use jointsweep::internals::engine::accuracy::known_errors::KNOWN_LEVELS;
use jointsweep::internals::engine::accuracy::mesh_change::Trust;
use jointsweep::internals::engine::backend::gpu::context::GpuError;
use jointsweep::internals::engine::backend::joints::{BatchedJoint, JointBatch, SolvedJoints};
use jointsweep::internals::engine::backend::{Device, Works};
use jointsweep::internals::engine::body_request::{Fidelity, Group, mesh_size};
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::expected_contact::ExpectedContact;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method, Response, StepOutcome};
use jointsweep::internals::engine::plan::{JointPlan, first_level};
use jointsweep::internals::engine::status::{Remark, Remarks, Status, StatusCounts};
use jointsweep::internals::engine::sweep::{self, Statistics, SweepOptions};
use jointsweep::internals::lab::tradeoff::families::series;
use jointsweep::internals::lab::tradeoff::joints::Terms;
use jointsweep::internals::mechanics::body::{Body, Shape, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::{GradingClass, LEVEL_COUNT};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::mechanics::mesh::RingTopology;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};
use jointsweep::internals::study::layers::Layer;
use std::cell::RefCell;

const STEEL: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };

fn part(shape: &'static Shape, parameters: [f64; 3]) -> Part {
    Part { shape, parameters, support: 0, material: STEEL, layers: Default::default(), yield_stress: None }
}

fn half() -> Part {
    part(&half_disc::SHAPE, [0.0; 3])
}

fn disc() -> Part {
    part(&cored_disc::SHAPE, [0.3, 0.0, 0.0])
}

fn ring(outer_radius_ratio: f64) -> Part {
    part(&annulus::SHAPE, [outer_radius_ratio, 0.0, 0.0])
}

fn joint(pin: Part, plate: Part) -> JointDesign {
    JointDesign {
        idealization: Idealization::PlaneStress,
        hole_radius: 10.0,
        radial_clearance: 0.05,
        thickness: 8.0,
        pin,
        plate,
    }
}

fn case(joint: JointDesign, steps: &[Load]) -> DesignCase {
    DesignCase { index: 0, joint, steps: steps.to_vec().into() }
}

fn alone(case: &DesignCase, method: MethodChoice, accuracy: f64) -> Vec<StepOutcome> {
    Ladder::new(SolveOptions { accuracy, method }).solve(std::slice::from_ref(case)).remove(0).steps
}

fn statuses(joint: JointDesign, method: MethodChoice, accuracy: f64, steps: &[Load]) -> Vec<String> {
    alone(&case(joint, steps), method, accuracy).into_iter().map(|step| step.status.to_string()).collect()
}

/// Twice delta/R2, or twice p0/E, decides, whether it is prescribed or found from a force.
#[test]
fn large_displacements_are_said() {
    let loose = JointDesign { radial_clearance: 0.4, ..joint(disc(), ring(3.0)) };
    let steps = [0.0495, 0.0505].map(Load::Indentation);
    let outcomes = alone(&case(loose.clone(), &steps), MethodChoice::Auto, 0.01);
    for (outcome, expected) in outcomes.iter().zip([0.0099, 0.0101]) {
        let told = outcome.response.and_then(|response| response.linearity_error).unwrap();
        assert!((told / expected - 1.0).abs() < 1e-12, "{told}");
    }
    // Who asks for less is not told of it.
    assert_eq!(statuses(loose.clone(), MethodChoice::Auto, 0.02, &steps), ["ok"; 2]);
    let said: Vec<String> = outcomes.iter().map(|step| step.status.to_string()).collect();
    assert_eq!(said, ["ok", "large displacement"]);
    let forces: Vec<Load> = outcomes.iter().map(|step| Load::Force(step.response.unwrap().force)).collect();
    assert_eq!(statuses(loose, MethodChoice::Auto, 0.01, &forces), said);
}

/// Each remark alone and together, and the row keeps its numbers.
#[test]
fn what_falls_short_is_said() {
    // No mesh gives nine digits.
    let steps = [Load::Indentation(0.01), Load::Indentation(1.0)];
    let outcomes = alone(&case(joint(disc(), ring(2.0)), &steps), MethodChoice::Fe, 1e-9);
    assert_eq!(outcomes[0].status.to_string(), "accuracy not met");
    assert_eq!(outcomes[1].status.to_string(), "large displacement; accuracy not met");
    assert!(outcomes.iter().all(|step| step.response.is_some_and(|response| response.force_error > 1e-9)));
}

/// Bodies that no mesh carries are refused by name, at once; what has exact modes needs none.
#[test]
fn bodies_beyond_what_meshes_carry_are_refused() {
    let said = |plate: Part, method: MethodChoice| {
        let said = statuses(joint(disc(), plate), method, 0.01, &[0.02, 0.03].map(Load::Indentation));
        assert_eq!(said[0], said[1]);
        said[0].to_string()
    };
    let thin = "the thinnest that meshes carry is";
    assert_eq!(
        said(part(&block::SHAPE, [1.02, 5.0, 5.0]), MethodChoice::Auto),
        format!("failed: the thinnest ligament of the block is 2 % of the radius; {thin} 5 %")
    );
    assert_eq!(
        said(part(&block::SHAPE, [5.0, 1.0 + 3e-9, 5.0]), MethodChoice::Auto),
        format!("failed: the thinnest ligament of the block is 3e-7 % of the radius; {thin} 5 %")
    );
    assert_eq!(
        said(ring(1.0001), MethodChoice::Fe),
        format!(
            "failed: the wall of the annulus is 0.01 % of the radius; {thin} 2 %; method auto needs no mesh for it"
        )
    );
    assert_eq!(
        said(part(&block::SHAPE, [5.0, 1e300, 5.0]), MethodChoice::Auto),
        "failed: the block is 1e300 times as large as the hole; the largest that meshes carry is 1000000 times"
    );
    assert_eq!(said(ring(1e300), MethodChoice::Auto), "ok");
    assert_eq!(said(ring(1.0001), MethodChoice::Auto), "ok");
}

fn no_contact() -> Status {
    Status::Answered(Remarks::of(&[(true, Remark::NoContact)]))
}

/// Loads that close no gap are answered by no force, and rows say so; a neat fit and a press fit at rest touch.
#[test]
fn a_gap_that_stays_open_is_remarked_on() {
    let loads =
        [Load::Offset(0.0), Load::Offset(0.005), Load::Offset(0.006), Load::Force(0.0), Load::Force(10.0)];
    let of_clearance = |radial_clearance: f64, loads: &[Load], method| {
        let joint = JointDesign { radial_clearance, ..joint(disc(), ring(2.0)) };
        let steps = alone(&case(joint, loads), method, 0.01);
        steps.iter().map(|step| step.status.to_string()).collect::<Vec<_>>()
    };
    let open = ["no contact", "no contact", "ok", "no contact", "ok"];
    assert_eq!(of_clearance(0.005, &loads, MethodChoice::Auto), open);
    let law = "plate extent not modelled";
    let open = open.map(|said| if said == "ok" { law.to_string() } else { format!("{law}; {said}") });
    assert_eq!(of_clearance(0.005, &loads, MethodChoice::ClosedForm), open);
    assert_eq!(of_clearance(0.0, &loads, MethodChoice::Auto), ["ok"; 5]);
    assert_eq!(of_clearance(-0.005, &loads, MethodChoice::Auto), ["ok"; 5]);
}

/// A step that fails leaves the others as they are, and every step stays in its place.
#[test]
fn a_failed_step_leaves_the_others() {
    let [fine, nothing, wide] = [0.05, 0.0, 50.0].map(Load::Indentation);
    let joint = joint(half(), ring(1.2));
    let expected = alone(&case(joint.clone(), &[fine]), MethodChoice::Auto, 0.01).remove(0);
    let outcomes = alone(&case(joint, &[wide, nothing, fine, wide, fine]), MethodChoice::Auto, 0.01);
    // A half disc's contact ends short of its held face, at 1.54 rad.
    let refused = outcomes[0].clone();
    assert_eq!(refused.status.to_string(), "failed: contact wider than 88 deg");
    let unloaded = outcomes[1].clone();
    assert_eq!(
        (&unloaded.status, unloaded.response.map(|response| response.force)),
        (&no_contact(), Some(0.0))
    );
    assert_eq!(outcomes, [refused.clone(), unloaded, expected.clone(), refused, expected]);
}

#[test]
fn series_refuses_what_it_has_no_modes_of() {
    let plate = part(&block::SHAPE, [2.0, 3.0, 2.0]);
    for joint in [joint(disc(), plate.clone()), joint(half(), ring(2.0)), joint(half(), plate)] {
        let said = statuses(joint, MethodChoice::Series, 0.01, &[Load::Indentation(0.05), Load::Force(0.0)]);
        assert_eq!(said, ["failed: series needs a rigid-core pin in an annulus"; 2]);
    }
}

/// The rows say what they were made with, and how well: exact compliances to what their interpolation leaves.
#[test]
fn methods_are_told_with_their_errors() {
    let told = |joint, method| {
        let outcome = alone(&case(joint, &[Load::Indentation(0.05)]), method, 0.01).remove(0);
        outcome.response.map(|response| (response.method, response.force_error)).unwrap()
    };
    let concentric = joint(disc(), ring(2.0));
    // At 1 % `auto` takes fewer trial pressures.
    for (method, most) in [(MethodChoice::Series, 1e-5), (MethodChoice::Auto, 2e-5)] {
        let (method, error) = told(concentric.clone(), method);
        assert!(method == Method::Series && (1e-8..most).contains(&error), "{error:e}");
    }
    // One mesh makes a row of finite elements.
    for (joint, method) in [(concentric, MethodChoice::Fe), (joint(half(), ring(2.0)), MethodChoice::Auto)] {
        let (method, error) = told(joint, method);
        assert!(method == Method::Fe && (1e-5..1e-2).contains(&error), "{error:e}");
    }
}

/// Johnson's law is per thickness; the row is for the joint. Rounding.
#[test]
fn the_closed_form_is_for_the_whole_joint() {
    let whole = joint(disc(), ring(2.0));
    let thin = JointDesign { thickness: 1.0, ..whole.clone() };
    let at = |joint, load| {
        let outcome = alone(&case(joint, &[load]), MethodChoice::ClosedForm, 0.01).remove(0);
        outcome.response.unwrap()
    };
    let (a, b) = (at(whole.clone(), Load::Indentation(0.01)), at(thin, Load::Indentation(0.01)));
    assert!((a.force / b.force / 8.0 - 1.0).abs() < 1e-14);
    assert!((a.tangent_stiffness / b.tangent_stiffness / 8.0 - 1.0).abs() < 1e-14);
    assert!((at(whole, Load::Force(a.force)).indentation / 0.01 - 1.0).abs() < 1e-12);
}

/// The coarsest mesh that can be as good as asked: for the accuracies people ask for, and not beyond the last.
#[test]
fn the_accuracy_decides_where_to_begin() {
    let levels = [0.05, 0.01, 5e-3, 3e-3, 1e-3, 3e-4, 1e-4, 1e-9].map(first_level);
    assert_eq!(levels, [1, 1, 1, 2, 2, 3, 4, LEVEL_COUNT - 1]);
    for accuracy in [0.05, 0.01, 3e-3, 1e-3, 3e-4, 1e-4] {
        let level = first_level(accuracy);
        // A mesh may settle where it begins, and a coarser one is given up for a reason.
        assert!(Trust::Full.error(level, 0.0) < accuracy);
        assert!(level == 1 || Trust::Full.error(level, 0.0) <= Trust::Full.error(level - 1, 0.0));
    }
}

/// Where a level is known to be good enough it is taken alone, and so are finer ones as long as they are known; where nothing is
/// known two meshes tell.
#[test]
fn what_is_known_of_a_mesh_saves_the_second() {
    let loads = [Load::Indentation(0.05)];
    let cheapest = |joint: &JointDesign, accuracy| {
        let plan = JointPlan::cheapest(&case(joint.clone(), &loads), MethodChoice::Auto, accuracy).unwrap();
        (plan.clone(), plan.requests().count())
    };
    let half_disc = joint(half(), ring(2.0));
    let (plan, requests) = cheapest(&half_disc, 0.01);
    assert_eq!((plan.estimate, plan.level, requests), (Estimate::Known, 0, 2));
    let ladder: Vec<_> = std::iter::successors(Some(plan), JointPlan::finer)
        .map(|plan| (plan.level, plan.estimate == Estimate::Known, plan.requests().count()))
        .collect();
    let known = (0..KNOWN_LEVELS).map(|level| (level, true, 2));
    assert_eq!(ladder, known.chain([(LEVEL_COUNT - 1, false, 3)]).collect::<Vec<_>>());
    // No mesh is known to be as good; two tell.
    let (plan, requests) = cheapest(&half_disc, 1e-9);
    assert_eq!((plan.estimate, requests), (Estimate::Change(Trust::Full), 3));
    assert!(plan.level == first_level(1e-9));
    // Both bodies exact.
    let (plan, requests) = cheapest(&joint(disc(), ring(2.0)), 1e-9);
    assert_eq!((plan.estimate, requests), (Estimate::Exact, 2));
    assert!(plan.finer().is_none());
    // A body that takes a thousandth of the work may be a hundred times worse.
    let mut soft_plate = half_disc.clone();
    soft_plate.plate.material.youngs_modulus *= 1e-3;
    let levels = [half_disc.clone(), soft_plate].map(|joint| cheapest(&joint, 1e-4).0.level);
    assert_eq!(levels, [4, 0]);
    // So may the stiffer body of a joint that touches hardly at all.
    let narrow =
        JointPlan::cheapest(&case(half_disc.clone(), &[Load::Indentation(1e-4)]), MethodChoice::Auto, 1.9e-4);
    assert_eq!((narrow.unwrap().level, cheapest(&half_disc, 1.9e-4).0.level), (1, 2));
    // A nearly incompressible body is not known.
    let mut soft = half_disc;
    soft.idealization = Idealization::PlaneStrain;
    soft.pin.material.poissons_ratio = 0.495;
    assert_eq!(cheapest(&soft, 0.1).0.estimate, Estimate::Change(Trust::Wary));
}

/// The thinner of the two bodies decides, and whether the contact may be wide; both answer to the same pressures.
#[test]
fn thin_bodies_get_more_trial_pressures() {
    let core = |ratio| part(&cored_disc::SHAPE, [ratio, 0.0, 0.0]);
    for (pin, plate, terms) in [
        (disc(), ring(2.0), 10),
        (half(), ring(1.3), 16),
        (core(0.8), ring(3.0), 16),
        (disc(), ring(1.1), 24),
        (core(0.9), ring(3.0), 24),
        (core(0.8), ring(1.1), 24),
    ] {
        let fewer = |choices: [usize; 3]| choices[(terms - 10) / 6];
        // The radial clearance is 0.05 mm.
        let [narrow, wide] =
            [0.05, 2.0].map(|load| case(joint(pin.clone(), plate.clone()), &[Load::Indentation(load)]));
        for (accuracy, of_narrow, of_wide) in [
            (1e-5, terms, terms),
            (1e-3, fewer([6, 6, 16]), fewer([10, 10, 16])),
            (0.01, fewer([6, 6, 10]), fewer([6, 6, 10])),
        ] {
            for (case, terms) in [(&narrow, of_narrow), (&wide, of_wide)] {
                let plan = JointPlan::new(case, MethodChoice::Fe, accuracy, 1).unwrap();
                assert_eq!(plan.space.terms, terms);
            }
        }
    }
}

/// A plate that takes more of the work than its modulus lets foresee: where that decides, its design climbs, alone, and comes to
/// what it would have come to from the level above.
#[test]
fn finer_meshes_are_taken_where_they_are_needed() {
    let slender = joint(disc(), part(&block::SHAPE, [1.5, 6.0, 1.5]));
    let mut stiff = slender.clone();
    stiff.plate.material.youngs_modulus *= 100.0;
    let [slender, stiff] = [slender, stiff].map(|joint| case(joint, &[1e-3, 0.2].map(Load::Indentation)));
    let worst = |steps: &[StepOutcome]| greatest(steps.iter().map(|step| step.response.unwrap().force_error));
    let plan = |case: &DesignCase, accuracy| JointPlan::cheapest(case, MethodChoice::Auto, accuracy).unwrap();
    let foreseen = plan(&slender, 0.01).foreseen_error(&ExpectedContact::of(&slender)).unwrap();
    let found = worst(&alone(&slender, MethodChoice::Auto, 0.01));
    assert!(found > 1.05 * foreseen, "{found} {foreseen}");
    // The estimate has a part of the curve, too, which finer meshes do not lessen.
    let accuracy = foreseen + 0.1 * (found - foreseen);
    assert_eq!([accuracy, 0.99 * foreseen].map(|accuracy| plan(&slender, accuracy).level), [0, 1]);
    // In company that is content with the first mesh.
    let options = SolveOptions { accuracy, method: MethodChoice::Auto };
    let outcomes = Ladder::new(options).solve(&[stiff.clone(), slender.clone(), stiff.clone()]);
    let climbed = &outcomes[1].steps;
    assert!(
        climbed.iter().all(|step| !step.status.has(Remark::AccuracyNotMet)) && worst(climbed) <= accuracy
    );
    assert_eq!(*climbed, alone(&slender, MethodChoice::Auto, 0.99 * foreseen));
    for index in [0, 2] {
        assert_eq!(outcomes[index].steps, alone(&stiff, MethodChoice::Auto, 0.01));
    }
}

/// Bodies of all shapes that differ in any one respect, in one batch: nothing of one reaches the others.
#[test]
fn a_batch_is_what_its_designs_are_alone() {
    let mut random = Random::new(11);
    let mut cases = Vec::new();
    for index in 0..18 {
        let mut plate = match index % 3 {
            0 => ring(random.log(1.2, 20.0)),
            _ => part(&block::SHAPE, [(); 3].map(|()| random.log(1.3, 8.0))),
        };
        plate.material =
            Material { youngs_modulus: random.log(1e4, 1e6), poissons_ratio: random.linear(-0.5, 0.49) };
        let pin = if index % 2 == 0 { half() } else { disc() };
        let joint = JointDesign { idealization: Idealization::ALL[index / 2 % 2], ..joint(pin, plate) };
        cases.push(case(joint.clone(), &[Load::Indentation(random.log(1e-3, 0.3))]));
        // The same but for one of: the pin and with it the widest contact, support, idealization, one ratio, nu.
        let mut other = joint;
        match index % 6 {
            0 => other.pin = disc(),
            1 => other.plate.support = 1,
            2 | 3 => other.idealization = Idealization::ALL[1 - index / 2 % 2],
            4 => other.plate.parameters[2] *= 1.5,
            _ => other.plate.material.poissons_ratio = 0.1,
        }
        cases.push(case(other, &cases[cases.len() - 1].steps.clone()));
    }
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let outcomes = Ladder::new(options).solve(&cases);
    assert_eq!(outcomes.len(), 36);
    for (index, (outcome, case)) in outcomes.iter().zip(&cases).enumerate() {
        assert_eq!(outcome.steps, alone(case, MethodChoice::Fe, 0.01), "design {index}: {case:?}");
    }
    // Control: all are answered, and what differs between the two of a pair shows.
    let force = |outcome: &DesignOutcome| outcome.steps[0].response.unwrap().force;
    for (index, pair) in outcomes.chunks_exact(2).enumerate() {
        assert_ne!(force(&pair[0]), force(&pair[1]), "pair {index}");
    }
}

/// More bodies than are kept, some of each batch known from the one before, the first ones asked for again at the end.
#[test]
fn forgetting_bodies_changes_nothing() {
    const BATCH: usize = 500;
    let design = |index: usize| {
        let pin = part(&cored_disc::SHAPE, [0.1 + 1e-4 * (index / 7) as f64, 0.0, 0.0]);
        case(joint(pin, ring(1.5 + 1e-3 * index as f64)), &[Load::Indentation(0.02)])
    };
    let mut backend = Ladder::new(SolveOptions { accuracy: 0.01, method: MethodChoice::Series });
    for start in (0..6000).step_by(BATCH - 150).chain([0]) {
        let outcomes = backend.solve(&(start..start + BATCH).map(design).collect::<Vec<_>>());
        assert_eq!(outcomes.len(), BATCH);
        for (index, outcome) in (start..).zip(&outcomes).step_by(BATCH - 1) {
            assert_eq!(outcome.steps, alone(&design(index), MethodChoice::Series, 0.01), "design {index}");
            assert_eq!(outcome.steps[0].status, Status::OK);
        }
    }
}

/// A neat hole holds the pin from the first micrometre: without load there is no force, but there is a stiffness.
#[test]
fn no_load_on_a_neat_fit_is_no_force() {
    let neat = JointDesign { radial_clearance: 0.0, ..joint(half(), ring(2.0)) };
    for load in [Load::Indentation(0.0), Load::Force(0.0)] {
        let outcome = alone(&case(neat.clone(), &[load]), MethodChoice::Auto, 0.01).remove(0);
        let Response { force, indentation, tangent_stiffness, method, .. } = outcome.response.unwrap();
        assert_eq!((force, indentation, method), (0.0, 0.0, Method::Fe));
        assert!(tangent_stiffness > 0.0);
        assert_eq!(outcome.status, Status::OK);
    }
}

const STUDY: &str = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = "0.05 mm"
thickness = ["8 mm", "9 mm"]
[joint.pin]
model = "rigid-midplane"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = [2.0, 3.0]
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[load]
indentation = ["0.01 mm", "0.1 mm", "1 mm"]
[solve]
method = "fe"
accuracy = "1 %"
"#;

/// Four designs of three bodies and three steps: what is told before the run, and counted in it.
#[test]
fn a_sweep_counts_its_designs_bodies_and_rows() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("counted.toml");
    std::fs::write(&path, STUDY).unwrap();
    let study = Study::load(&path).unwrap();
    let estimate = cost::estimate(&study).unwrap();
    assert_eq!((estimate.designs, estimate.rows, estimate.distinct_bodies), (4, 12, 3));
    let joint = joint(half(), half());
    let bodies = [half(), ring(2.0), ring(3.0)].map(|part| joint.body(&part));
    // On the mesh that is known to be good enough, and no other.
    assert_eq!(estimate.unknowns, bodies.iter().map(|body| mesh_size(body, 0).unknowns).sum::<u64>());

    let statuses = RefCell::new(StatusCounts::default());
    let run = |most: u64| -> Statistics {
        let mut received = 0;
        sweep::run(&study, &SweepOptions { threads: 2, ..Default::default() }, &mut |outcome| {
            assert_eq!((outcome.case.index, outcome.steps.len()), (received, 3));
            received += 1;
            outcome.steps.iter().for_each(|step| statuses.borrow_mut().add(&step.status));
            Ok(if received == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })
        .unwrap()
    };
    let whole = run(u64::MAX);
    assert_eq!((whole.designs, whole.steps, whole.distinct_bodies, whole.interrupted), (4, 12, 3, false));
    let part = run(3);
    assert_eq!((part.designs, part.steps, part.interrupted), (3, 9, true));
    // Of both runs.
    let expected = [("large displacement".to_string(), 14), ("ok".to_string(), 7)];
    assert_eq!(statuses.borrow().by_text(), expected.into());
    // Broken off after the last there is nothing left to interrupt.
    assert!(!run(4).interrupted);
}

/// Of more designs than are looked at some stand for all, whether bodies are all different or come again and again.
#[test]
fn a_large_sweep_is_estimated_by_some_of_its_designs() {
    let random = include_str!("../../configs/random.toml");
    assert!(random.contains("count  = 10000"));
    let estimate = |text: String| {
        cost::estimate(&Study::from_text(std::path::Path::new("sweep.toml"), text).unwrap()).unwrap()
    };
    let of = |count: u64| estimate(random.replace("count  = 10000", &format!("count = {count}")));
    let [few, all, more, most] = [30_000, 60_000, 600_000, 1_000_000_000].map(of);
    assert_eq!((all.looked_at, all.distinct_bodies), (60_000, 120_000));
    for estimate in [more, most] {
        assert!(estimate.looked_at < 70_000 && estimate.rows == 10 * estimate.designs, "{estimate:?}");
        // As much more as from the first to the second, whose designs were looked at one by one.
        let times = (estimate.designs - all.designs) as f64 / (all.designs - few.designs) as f64;
        for (name, of) in [
            ("seconds", (|estimate: &cost::Estimate| estimate.time.seconds()) as fn(&cost::Estimate) -> f64),
            ("unknowns", |estimate| estimate.unknowns as f64),
            ("distinct bodies", |estimate| estimate.distinct_bodies as f64),
        ] {
            let expected = of(&all) + times * (of(&all) - of(&few));
            let found = of(&estimate);
            assert!(
                (found / expected - 1.0).abs() < 0.03,
                "{name} of {}: {found} {expected}",
                estimate.designs
            );
        }
    }
    let ranges = [
        ("\"0.05 mm\"", "{ from = \"0.01 mm\", to = \"0.1 mm\", count = 1000 }"),
        ("[2.0, 3.0]", "{ from = 2, to = 3, count = 250 }"),
    ];
    let grid = ranges.iter().fold(STUDY.to_string(), |text, (one, many)| {
        assert!(text.contains(one), "{one}");
        text.replacen(one, many, 1)
    });
    let again = estimate(grid);
    assert_eq!((again.designs, again.distinct_bodies), (500_000, 251));
    assert!(again.looked_at < 70_000 && again.time.seconds() < 0.05 * most.time.seconds(), "{again:?}");
}

/// The count of unknowns is told without a mesh; supports are few.
#[test]
fn unknowns_are_those_of_the_mesh() {
    let layer = |thickness| Layer::new(thickness, STEEL);
    let lined = part(&block::SHAPE, [2.0, 3.0, 1.6]).with_layers(&[layer(0.1), layer(2.0)]).unwrap();
    for body in [half(), disc(), ring(2.0), part(&block::SHAPE, [2.0, 3.0, 1.6]), lined] {
        let body = joint(half(), half()).body(&body);
        for level in 1..4 {
            let class = GradingClass::of(&body, ElementKind::Quad8, level);
            let mesh = RingTopology::new(&body, &class.grading(body.shape.end_angle));
            let told = mesh_size(&body, level).unknowns as f64;
            let excess = told / mesh.unknown_count as f64 - 1.0;
            assert!((-0.1..0.25).contains(&excess), "{} level {level}: {excess}", body.shape.name);
        }
    }
}

/// Condenses as the processor does, and gives up at a call.
#[derive(Default)]
struct GivesUp {
    /// Of `begin` and `finish` together, from 0; never where there is none.
    at: Option<u32>,
    calls: u32,
    begun: VecDeque<Works>,
    /// That were begun and not finished.
    most_begun: Arc<AtomicUsize>,
    /// Bodies.
    asked: Arc<AtomicUsize>,
}

impl GivesUp {
    fn at(call: u32) -> GivesUp {
        GivesUp { at: Some(call), ..GivesUp::default() }
    }

    fn call(&mut self) -> Result<(), GpuError> {
        self.calls += 1;
        assert!(self.at.is_none_or(|at| self.calls <= at + 1), "asked again after it gave up");
        if self.at == Some(self.calls - 1) { Err(GpuError::NoAdapter) } else { Ok(()) }
    }
}

impl Device for GivesUp {
    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        self.call()?;
        assert!(groups.iter().all(|(key, _)| !key.class.is_lined()), "devices know no layers");
        let condense = |(key, requests): &Group| {
            let bodies: Vec<Body> = requests.iter().map(|request| request.body.clone()).collect();
            let plan = CondensationPlan::new(&bodies[0], key.grading(&bodies[0]), RingModes::of(&key.class));
            let mut works: Vec<_> = plan.condense(&bodies).into_iter().map(Some).collect();
            // The last of each group is left to the processor.
            if let Some(last) = works.last_mut() {
                *last = None;
            }
            works
        };
        self.begun.push_back(groups.iter().map(condense).collect());
        self.asked.fetch_add(groups.iter().map(|(_, requests)| requests.len()).sum(), Ordering::Relaxed);
        self.most_begun.fetch_max(self.begun.len(), Ordering::Relaxed);
        Ok(())
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        self.call()?;
        Ok(self.begun.pop_front().expect("something was begun"))
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        vec![("its own", Duration::from_secs(1))]
    }

    fn worst_residual(&self) -> f64 {
        1e-5
    }

    fn solves(&self) -> u64 {
        7
    }
}

/// Finds no states of joints, or is lost when it is given them, or when it is asked for them.
struct FindsNone {
    condenser: GivesUp,
    lost: Lost,
    asked: Arc<AtomicUsize>,
    found: VecDeque<Vec<f32>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Lost {
    Never,
    OnTheWayUp,
    OnTheWayDown,
}

impl Device for FindsNone {
    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        self.condenser.begin(groups)
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        self.condenser.finish()
    }

    fn solves_joints(&self) -> SolvedJoints {
        SolvedJoints::All
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        self.asked.fetch_add(batch.joints.len(), Ordering::Relaxed);
        self.found.push_back(vec![0.0; batch.joints.iter().map(BatchedJoint::found).sum()]);
        if self.lost == Lost::OnTheWayUp { Err(GpuError::NoAdapter) } else { Ok(()) }
    }

    fn finish_joints(&mut self) -> Result<Vec<f32>, GpuError> {
        let found = self.found.pop_front().expect("something was begun");
        if self.lost == Lost::OnTheWayDown { Err(GpuError::NoAdapter) } else { Ok(found) }
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        Vec::new()
    }

    fn worst_residual(&self) -> f64 {
        0.0
    }

    fn solves(&self) -> u64 {
        0
    }
}

/// Joints that a device has no states of, or is lost over, are the processor's, to the bit.
#[test]
fn joints_that_a_device_leaves_are_solved() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let cases = draw(11, 60, concentric);
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint.clone()).collect();
    let interpolating = || {
        let plan = InterpolationPlan::new(&options, 1_000_000, &joints);
        assert!(plan.is_some());
        Ladder::new(options).in_double().interpolating(plan)
    };
    let on_meshes = || Ladder::new(options).in_double();
    let rows = |outcomes: Vec<DesignOutcome>| -> Vec<String> {
        outcomes.iter().map(|outcome| format!("{:?}", outcome.steps)).collect()
    };
    let ladders: [&dyn Fn() -> Ladder<'static>; 2] = [&interpolating, &on_meshes];
    for ladder in ladders {
        let expected = rows(ladder().solve(&cases));
        for lost in [Lost::Never, Lost::OnTheWayUp, Lost::OnTheWayDown] {
            let asked = Arc::new(AtomicUsize::new(0));
            let device = FindsNone {
                condenser: GivesUp::default(),
                lost,
                asked: Arc::clone(&asked),
                found: VecDeque::new(),
            };
            let mut ladder = ladder().on(Box::new(device));
            assert_eq!(rows(ladder.solve(&cases)), expected);
            assert!(asked.load(Ordering::Relaxed) > 50, "{asked:?}");
            assert_eq!(ladder.library.lost().is_some(), lost != Lost::Never);
            // It is not asked again once it is lost.
            let before = asked.swap(0, Ordering::Relaxed);
            assert_eq!(rows(ladder.solve(&cases)), expected);
            assert_eq!(asked.load(Ordering::Relaxed), if lost == Lost::Never { before } else { 0 });
        }
    }
}

/// The processor takes over with the batch at hand, and before that what the device leaves: every design once, in order, as
/// without a device.
#[test]
fn a_device_that_gives_up_loses_no_design() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let design = |index: u64| {
        let pin = part(&cored_disc::SHAPE, [0.3 + 1e-3 * index as f64, 0.0, 0.0]);
        let plate = ring(2.0 + 1e-3 * index as f64);
        DesignCase { index, ..case(joint(pin, plate), &[Load::Indentation(0.01)]) }
    };
    let cases: Vec<DesignCase> = (0..8).map(design).collect();
    let mut ladder = Ladder::new(options).in_double().on(Box::new(GivesUp::at(2)));
    assert!(ladder.library.lost().is_none());
    let mut outcomes = ladder.solve(&cases[..4]);
    assert!(ladder.library.lost().is_none());
    outcomes.extend(ladder.solve(&cases[4..6]));
    assert_eq!(ladder.library.lost(), Some(&GpuError::NoAdapter));
    outcomes.extend(ladder.solve(&cases[6..]));
    let expected = Ladder::new(options).in_double().solve(&cases);
    assert_eq!((outcomes.len(), expected.len()), (cases.len(), cases.len()));
    let mut of_device = 0;
    for (index, (outcome, expected)) in outcomes.iter().zip(&expected).enumerate() {
        assert_eq!((outcome.case.index, &outcome.steps), (index as u64, &expected.steps));
        assert_eq!((&outcome.steps[0].status, expected.backend), (&Status::OK, BackendKind::Cpu));
        assert!(index < 4 || outcome.backend == BackendKind::Cpu, "design {index}");
        of_device += usize::from(outcome.backend == BackendKind::Gpu);
    }
    // The four of the first batch share two groups, and each group has one that is left.
    assert_eq!(of_device, 3);
    assert!(ladder.stages().contains(&("its own", Duration::from_secs(1))));
    let device = ladder.library.device().unwrap();
    assert_eq!((device.worst_residual(), device.solves()), (1e-5, 7));
}

/// The device has two portions of a large batch at a time, of which some bodies are the same, and may give up at any call: every design
/// is as without a device.
#[test]
fn two_portions_are_on_the_device_at_a_time() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    // Three portions; of the last most bodies are those of the second one, which the device has then.
    let mut cases = draw(17, 2200, concentric);
    cases.extend_from_within(1100..1500);
    (0..).zip(&mut cases).for_each(|(index, case)| case.index = index);
    let expected = Ladder::new(options).in_double().solve(&cases);
    let mut of_device = Vec::new();
    for at in [Some(1), Some(2), Some(3), Some(4), Some(5), None] {
        let device = GivesUp { at, ..GivesUp::default() };
        let (most_begun, asked) = (Arc::clone(&device.most_begun), Arc::clone(&device.asked));
        let mut ladder = Ladder::new(options).in_double().on(Box::new(device));
        let outcomes = ladder.solve(&cases);
        assert_eq!((ladder.library.lost().is_some(), outcomes.len()), (at.is_some(), cases.len()));
        assert_eq!(most_begun.load(Ordering::Relaxed), if at == Some(1) { 1 } else { 2 });
        for (outcome, expected) in outcomes.iter().zip(&expected) {
            assert_eq!((outcome.case.index, &outcome.steps), (expected.case.index, &expected.steps));
        }
        assert!(asked.load(Ordering::Relaxed) < 2 * 2600, "{asked:?}");
        of_device.push(outcomes.iter().filter(|outcome| outcome.backend == BackendKind::Gpu).count());
    }
    // What was handed over before it gave up stays in use.
    assert!(of_device[..2] == [0, 0] && of_device[2..].is_sorted() && of_device[2] > 500, "{of_device:?}");
}

/// A device is asked for bare bodies alone: those with layers are the processor's, in the same batch.
#[test]
fn a_device_leaves_lined_bodies_to_the_processor() {
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let layer = Layer::new(0.1, Material { youngs_modulus: 3e3, poissons_ratio: 0.4 });
    let design = |index: u64| {
        let (pin, plate) = (part(&cored_disc::SHAPE, [0.3, 0.0, 0.0]), ring(2.0 + 0.01 * index as f64));
        let layers: &[Layer] = if index.is_multiple_of(2) { &[layer] } else { &[] };
        let [pin, plate] = [pin, plate].map(|part| part.with_layers(layers).unwrap());
        DesignCase { index, ..case(joint(pin, plate), &[Load::Indentation(0.01)]) }
    };
    let cases: Vec<DesignCase> = (0..6).map(design).collect();
    let mut ladder = Ladder::new(options).in_double().on(Box::new(GivesUp::at(2)));
    let outcomes = ladder.solve(&cases);
    let expected = Ladder::new(options).in_double().solve(&cases);
    assert_eq!((outcomes.len(), expected.len()), (cases.len(), cases.len()));
    for (index, (outcome, expected)) in outcomes.iter().zip(&expected).enumerate() {
        assert_eq!(outcome.steps, expected.steps);
        assert!(outcome.steps[0].response.is_some(), "{}", outcome.steps[0].status);
        assert!(!index.is_multiple_of(2) || outcome.backend == BackendKind::Cpu, "design {index}");
    }
    assert!(outcomes.iter().any(|outcome| outcome.backend == BackendKind::Gpu));
}

/// Where meshes are good enough but trial pressures are not, more of these are taken on the same meshes; without more of them
/// finer meshes, and of exact bodies nothing.
#[test]
fn what_trial_pressures_leave_is_answered_with_more() {
    let plan = |pin, plate, accuracy| {
        JointPlan::cheapest(
            &case(joint(pin, plate), &[Load::Indentation(0.05)]),
            MethodChoice::Auto,
            accuracy,
        )
        .unwrap()
    };
    let rough = plan(half(), ring(2.0), 0.01);
    let sizes = |plan: &JointPlan| (plan.space.terms, plan.space.nodes);
    let next = |plan: &JointPlan, want: Want| plan.next(want).map(|plan| sizes(&plan));
    assert_eq!(sizes(&rough), (6, 24));
    assert_eq!(
        (next(&rough, Want::MoreTerms), next(&rough, Want::MoreNodes)),
        (Some((10, 24)), Some((6, 32)))
    );
    let finer = rough.next(Want::MoreTerms).unwrap();
    assert_eq!((finer.level, finer.estimate), (rough.level, rough.estimate));
    assert!(rough.next(Want::Nothing).is_none());
    let to_the_end = |plan: JointPlan, want: Want| -> Vec<((usize, usize), usize)> {
        let all = std::iter::successors(Some(plan), |plan| plan.next(want));
        all.map(|plan| (sizes(&plan), plan.level)).collect()
    };
    // Of meshes there are finer ones after all trial pressures, and after as many nodes as lessen their noise.
    let level = rough.level;
    let terms = [(6, 24), (10, 24), (16, 24), (24, 24)];
    assert_eq!(
        to_the_end(rough.clone(), Want::MoreTerms)[..5],
        [terms.map(|sizes| (sizes, level)).to_vec(), vec![((24, 24), level + 1)]].concat()
    );
    let nodes = [(6, 24), (6, 32), (6, 48)];
    assert_eq!(
        to_the_end(rough, Want::MoreNodes)[..4],
        [nodes.map(|sizes| (sizes, level)).to_vec(), vec![((6, 48), level + 1)]].concat()
    );
    let exact = plan(disc(), ring(2.0), 0.01);
    let of_sizes =
        |want| to_the_end(exact.clone(), want).into_iter().map(|(sizes, _)| sizes).collect::<Vec<_>>();
    assert_eq!(of_sizes(Want::MoreTerms), terms);
    // Functions of few trial pressures may be rougher than those of more.
    let nodes = [(6, 24), (6, 32), (6, 48), (6, 64), (6, 96), (10, 96), (16, 96), (24, 96)];
    assert_eq!(of_sizes(Want::MoreNodes), nodes);
    assert!(exact.next(Want::FinerMesh).is_none());

    // A wide contact, where what is known of the coarsest mesh leaves a little less room than six trial pressures ask for.
    let plate = part(&block::SHAPE, [3.0, 3.0, 3.0]);
    let wide =
        case(JointDesign { radial_clearance: 1e-3, ..joint(disc(), plate) }, &[Load::Indentation(0.2)]);
    let mesh =
        |body: &Body| if body.shape.concentric { Fidelity::Series } else { Fidelity::Mesh { level: 0 } };
    let [six, ten] = [6, 10].map(|terms| {
        let states = series::solve_bodies(Terms::Fixed(terms), mesh, std::slice::from_ref(&wide)).states;
        states[0][0].unwrap().force
    });
    let all = alone(&wide, MethodChoice::Auto, 0.01)[0].response.unwrap();
    let fewer = alone(&wide, MethodChoice::Auto, (1.0 - 1e-6) * all.force_error)[0].response.unwrap();
    let differences = [all.force / six - 1.0, fewer.force / ten - 1.0, six / ten - 1.0].map(f64::abs);
    // Curves of other counts of nodes: seen 3.4e-7, 2.7e-7 and 1.9e-6.
    assert!(differences[0] < 5e-7 && differences[1] < 5e-7 && differences[2] > 1e-6, "{differences:?}");
}
