//! What must hold for every joint, whatever its numbers: scaling, energy, the slope of the curve, order and threads.

use std::ops::ControlFlow;

use crate::common::greatest::greatest;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{DesignOutcome, Response};
use jointsweep::internals::mechanics::body::{Shape, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

const STEEL: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
const ALUMINIUM: Material = Material { youngs_modulus: 70e3, poissons_ratio: 0.34 };

fn part(shape: &'static Shape, parameters: [f64; 3], material: Material) -> Part {
    Part { shape, parameters, support: 0, material, layers: Default::default(), yield_stress: None }
}

fn joint(pin: Part, plate: Part) -> JointDesign {
    JointDesign {
        idealization: Idealization::PlaneStrain,
        hole_radius: 10.0,
        radial_clearance: 0.05,
        thickness: 8.0,
        pin,
        plate,
    }
}

/// One joint of each kind: exact, half exact, meshed.
fn joints() -> [(JointDesign, MethodChoice); 3] {
    let disc = part(&cored_disc::SHAPE, [0.2, 0.0, 0.0], STEEL);
    let ring = part(&annulus::SHAPE, [2.5, 0.0, 0.0], ALUMINIUM);
    let half = part(&half_disc::SHAPE, [0.0; 3], STEEL);
    let block = part(&block::SHAPE, [2.0, 3.0, 1.8], ALUMINIUM);
    [
        (joint(disc.clone(), ring.clone()), MethodChoice::Series),
        (joint(half, ring), MethodChoice::Auto),
        (joint(disc, block), MethodChoice::Fe),
    ]
}

fn solve(joint: &JointDesign, method: MethodChoice, steps: Vec<Load>) -> Vec<Response> {
    let case = DesignCase { index: 0, joint: joint.clone(), steps: steps.into() };
    let outcomes = Ladder::new(SolveOptions { accuracy: 0.01, method }).solve(&[case]);
    outcomes[0].steps.iter().map(|step| step.response.unwrap_or_else(|| panic!("{}", step.status))).collect()
}

fn at(joint: &JointDesign, method: MethodChoice, load: Load) -> Response {
    solve(joint, method, vec![load])[0]
}

const INDENTATIONS: [f64; 4] = [1e-4, 3e-3, 0.05, 1.0];

/// The relative deviation, which must be within the tolerance.
#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) -> f64 {
    let deviation = (found / expected - 1.0).abs();
    assert!(deviation <= tolerance, "{what}: {found} instead of {expected}");
    deviation
}

/// F' = k_t. Exact compliances: what the difference quotient leaves. Meshes: the mesh's arc is not the exact one, so
/// the discrete F and k_t differ by a share of the error of F.
#[test]
fn tangent_stiffness_is_the_slope_of_the_force() {
    let mut worst = [0.0_f64; 2];
    for (joint, method) in joints() {
        // Seen: 2.3e-7 and 2.3e-4.
        let tolerance = if method == MethodChoice::Series { 3e-7 } else { 3e-4 };
        for delta in INDENTATIONS {
            let step = 1e-4 * delta;
            let loads = [delta - step, delta, delta + step].map(Load::Indentation).to_vec();
            let [low, middle, high] = solve(&joint, method, loads)[..] else { unreachable!() };
            let slope = (high.force - low.force) / (2.0 * step);
            let deviation =
                assert_close(middle.tangent_stiffness, slope, tolerance, &format!("{method:?} at {delta}"));
            let worst = &mut worst[usize::from(method != MethodChoice::Series)];
            *worst = worst.max(deviation);
        }
    }
    println!("dF/d delta less k_t: series {:.2e}, meshes {:.2e}", worst[0], worst[1]);
}

/// dU/d delta = F: the strain energy is the work done. Both are of one pressure, so it holds closer.
#[test]
fn energy_is_the_work_of_the_force() {
    let mut worst = [0.0_f64; 2];
    for (joint, method) in joints() {
        // Seen: 2.0e-9, of the polynomials between nodes, and 5e-6.
        let tolerance = if method == MethodChoice::Series { 2.6e-9 } else { 7e-6 };
        for delta in INDENTATIONS {
            let step = 1e-4 * delta;
            let loads = [delta - step, delta, delta + step].map(Load::Indentation).to_vec();
            let [low, middle, high] = solve(&joint, method, loads)[..] else { unreachable!() };
            let slope = (high.energy.unwrap() - low.energy.unwrap()) / (2.0 * step);
            let deviation = assert_close(middle.force, slope, tolerance, &format!("{method:?} at {delta}"));
            let worst = &mut worst[usize::from(method != MethodChoice::Series)];
            *worst = worst.max(deviation);
        }
    }
    println!("dU/d delta less F: series {:.2e}, meshes {:.2e}", worst[0], worst[1]);
}

/// A force found from an indentation leads back to it. The search ends at 1e-11 of the load.
#[test]
fn loading_by_force_undoes_loading_by_indentation() {
    for (joint, method) in joints() {
        for clearance in [joint.radial_clearance, 0.0] {
            let joint = JointDesign { radial_clearance: clearance, ..joint.clone() };
            for delta in INDENTATIONS {
                let pressed = at(&joint, method, Load::Indentation(delta));
                let loaded = at(&joint, method, Load::Force(pressed.force));
                assert_close(loaded.indentation, delta, 1e-9, &format!("{method:?}, dR = {clearance}"));
                assert_close(loaded.peak_pressure.unwrap(), pressed.peak_pressure.unwrap(), 1e-9, "p0");
            }
        }
    }
}

/// F/(E t dR) depends on delta/dR and dR/R2 alone. Rounding of the scaled inputs, amplified by the search's tolerance.
#[test]
fn lengths_moduli_and_thickness_scale() {
    let scaled = |material: Material, factor: f64| Material {
        youngs_modulus: material.youngs_modulus * factor,
        ..material
    };
    for (joint, method) in joints() {
        let here = at(&joint, method, Load::Indentation(0.02));
        let (length, modulus, thickness) = (250.0, 1e-3, 7.0);
        let mut other = joint.clone();
        other.hole_radius *= length;
        other.radial_clearance *= length;
        other.thickness *= thickness;
        other.pin.material = scaled(joint.pin.material, modulus);
        other.plate.material = scaled(joint.plate.material, modulus);
        let there = at(&other, method, Load::Indentation(0.02 * length));
        assert_close(there.force, here.force * length * modulus * thickness, 1e-9, "force");
        assert_close(
            there.tangent_stiffness,
            here.tangent_stiffness * modulus * thickness,
            1e-9,
            "stiffness",
        );
        assert_close(there.peak_pressure.unwrap(), here.peak_pressure.unwrap() * modulus, 1e-9, "pressure");
        let energy = here.energy.unwrap() * length * length * modulus * thickness;
        assert_close(there.energy.unwrap(), energy, 1e-9, "energy");
    }
}

/// A neat fit keeps its arc: force, stiffness and pressure are proportional to the indentation.
#[test]
fn a_neat_fit_is_linear() {
    for (joint, method) in joints() {
        let neat = JointDesign { radial_clearance: 0.0, ..joint };
        let one = at(&neat, method, Load::Indentation(0.001));
        let hundred = at(&neat, method, Load::Indentation(0.1));
        assert_close(hundred.force, 100.0 * one.force, 1e-9, "force");
        assert_close(
            hundred.contact_half_angle.unwrap(),
            one.contact_half_angle.unwrap(),
            1e-9,
            "half angle",
        );
        assert_close(one.tangent_stiffness, one.force / 0.001, 1e-8, "stiffness");
        let nothing = at(&neat, method, Load::Indentation(0.0));
        assert_eq!((nothing.force, nothing.energy), (0.0, Some(0.0)));
        assert_close(nothing.tangent_stiffness, one.tangent_stiffness, 1e-9, "stiffness without load");
    }
}

#[test]
fn no_load_is_no_force() {
    for (joint, method) in joints() {
        for load in [Load::Indentation(0.0), Load::Force(0.0)] {
            let response = at(&joint, method, load);
            let Response { force, indentation, contact_half_angle, peak_pressure, energy, .. } = response;
            assert_eq!((force, indentation, contact_half_angle), (0.0, 0.0, Some(0.0)));
            assert_eq!((peak_pressure, energy), (Some(0.0), Some(0.0)));
        }
    }
}

/// Nearly incompressible bodies in plane strain do not lock: of the 1 % asked the mesh leaves a tenth, and less where nu is
/// below 0.499. Seen against `series`: 5.9e-4 at 0.499.
#[test]
fn nearly_incompressible_bodies_do_not_lock() {
    for poissons_ratio in [0.49, 0.495, 0.499] {
        let mut worst = 0.0_f64;
        let rubber = Material { youngs_modulus: 5.0, poissons_ratio };
        let disc = part(&cored_disc::SHAPE, [0.3, 0.0, 0.0], rubber);
        let ring = part(&annulus::SHAPE, [2.0, 0.0, 0.0], rubber);
        let joint = joint(disc, ring);
        for delta in INDENTATIONS {
            let exact = at(&joint, MethodChoice::Series, Load::Indentation(delta));
            let meshed = at(&joint, MethodChoice::Fe, Load::Indentation(delta));
            let what = format!("nu = {poissons_ratio} at {delta}");
            worst = worst.max(assert_close(meshed.force, exact.force, 8e-4, &what));
        }
        println!("nu {poissons_ratio}: force within {worst:.1e}");
    }
}

/// Bodies that widen when they are pulled are solved as well as others: their near field has nodes of its own.
#[test]
fn auxetic_bodies_meet_the_accuracy() {
    let mut errors = Vec::new();
    for poissons_ratio in [-0.95, -0.85, -0.5, -0.05] {
        let foam = Material { youngs_modulus: 5.0, poissons_ratio };
        let disc = part(&cored_disc::SHAPE, [0.3, 0.0, 0.0], foam);
        let ring = part(&annulus::SHAPE, [2.0, 0.0, 0.0], foam);
        for idealization in Idealization::ALL {
            let joint = JointDesign { idealization, ..joint(disc.clone(), ring.clone()) };
            for delta in INDENTATIONS {
                let [exact, meshed] = [MethodChoice::Series, MethodChoice::Fe]
                    .map(|method| at(&joint, method, Load::Indentation(delta)).force);
                errors.push(meshed / exact - 1.0);
            }
        }
    }
    let worst = greatest(errors);
    println!("auxetic bodies: force within {worst:.1e}");
    // Seen: 1.8e-4.
    assert!(worst < 2.4e-4);
}

/// Outcomes come in design order and are the same to the last bit whatever the threads.
#[test]
fn threads_do_not_change_the_outcomes() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("threads.toml");
    let config = include_str!("../../configs/random.toml").replace("10000", "3000");
    std::fs::write(&path, config).unwrap();
    let study = Study::load(&path).unwrap();
    let run = |threads: usize| -> Vec<DesignOutcome> {
        let mut outcomes = Vec::new();
        let options = jointsweep::internals::engine::sweep::SweepOptions { threads, ..Default::default() };
        let statistics = jointsweep::internals::engine::sweep::run(&study, &options, &mut |outcome| {
            outcomes.push(outcome);
            Ok(ControlFlow::Continue(()))
        });
        assert_eq!(statistics.unwrap().designs, 3000);
        outcomes
    };
    let one = run(1);
    // In one crew, and in four.
    for threads in [3, 8] {
        let others = run(threads);
        assert_eq!((one.len(), others.len()), (3000, 3000));
        for (index, (a, b)) in one.iter().zip(&others).enumerate() {
            assert_eq!((a.case.index, b.case.index), (index as u64, index as u64));
            assert_eq!(a.steps, b.steps, "design {index}");
            assert!(
                a.steps.len() == 10 && a.steps.iter().all(|step| step.response.is_some()),
                "design {index}"
            );
        }
    }
}
