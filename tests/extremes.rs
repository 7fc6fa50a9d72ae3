//! The edges of the parameter space: every design is right to the accuracy asked, or says that it is not.
//!
//! Designs are drawn far beyond what is built: dR/R2 from 0 and 1e-10 to 0.5, delta/dR from 1e-6 to 1e6, forces down to
//! 1e-12 N, nu from -0.9 to 0.4999, moduli eight decades apart, holes from 1e-6 to 1e6 mm, plates from 1.02 to 1e4, cores
//! from 0.01 to 0.95. A test run draws some thousands; at length:
//!
//! ```text
//! JOINTSWEEP_DRAWS=100000 cargo test --release --test extremes -- --nocapture
//! ```

#[path = "common/random.rs"]
mod random;

use std::collections::BTreeMap;

use jointsweep::engine::backend::cpu::CpuBackend;
use jointsweep::engine::interpolation::plan::InterpolationPlan;
use jointsweep::engine::outcome::{DesignOutcome, Method, Response};
use jointsweep::mechanics::body::{annulus, block, cored_disc, half_disc};
use jointsweep::mechanics::material::{Idealization, Material};
use jointsweep::study::config::{MethodChoice, SolveOptions};
use jointsweep::study::design::{DesignCase, JointDesign, Load, Part};
use random::Random;

const DRAWS: usize = 2000;

fn draws() -> usize {
    let asked = std::env::var("JOINTSWEEP_DRAWS").ok();
    asked.map_or(DRAWS, |text| text.parse().unwrap_or_else(|_| panic!("JOINTSWEEP_DRAWS={text} is no count")))
}

/// Half of them at the ends of the range.
fn poissons_ratio(random: &mut Random) -> f64 {
    match (random.unit() * 6.0) as u32 {
        0 => 0.5 - random.log(1e-4, 0.1),
        1 => -0.9 + random.log(1e-4, 0.1),
        2 => 0.0,
        _ => random.linear(-0.9, 0.4999),
    }
}

fn extreme(random: &mut Random, index: u64) -> DesignCase {
    let hole_radius = random.log(1e-6, 1e6);
    let neat = random.unit() < 0.1;
    let radial_clearance = if neat { 0.0 } else { hole_radius * random.log(1e-10, 0.5) };
    let thickness = random.log(1e-6, 1e6);
    let softer = random.log(1e-2, 1e6);
    let ratio = random.log(1.0, 1e8);
    let moduli = if random.unit() < 0.5 { [softer, softer * ratio] } else { [softer * ratio, softer] };
    let core = if random.unit() < 0.5 { random.log(0.01, 0.95) } else { 1.0 - random.log(0.05, 0.9) };
    let wall = if random.unit() < 0.5 { random.log(0.02, 1.0) + 1.0 } else { random.log(1.02, 1e4) };
    let part = |random: &mut Random, shape, ratio, youngs_modulus| Part {
        shape,
        parameters: [ratio, 0.0, 0.0],
        support: 0,
        material: Material { youngs_modulus, poissons_ratio: poissons_ratio(random) },
    };
    let pin = part(random, &cored_disc::SHAPE, core, moduli[0]);
    let plate = part(random, &annulus::SHAPE, wall, moduli[1]);
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let joint = JointDesign { idealization, hole_radius, radial_clearance, thickness, pin, plate };
    let over = radial_clearance.max(1e-10 * hole_radius);
    let steps = (0..2).map(|_| {
        if random.unit() < 0.6 {
            Load::Indentation(over * random.log(1e-6, 1e6))
        } else {
            // From next to nothing to the limit of small strain.
            Load::Force((softer * thickness * hole_radius).max(1e-11) * random.log(1e-12, 0.3))
        }
    });
    let steps = steps.collect();
    DesignCase { index, joint, steps }
}

fn solve(cases: &[DesignCase], method: MethodChoice, accuracy: f64) -> Vec<DesignOutcome> {
    let mut backend = CpuBackend::new(SolveOptions { accuracy, method });
    cases.chunks(1024).flat_map(|cases| backend.solve(cases)).collect()
}

/// The relative error of the force at the same indentation; where the force is given, by way of the stiffness.
fn error(found: &Response, exact: &Response) -> f64 {
    let of_force = (found.force / exact.force - 1.0).abs();
    let offset = (found.indentation - exact.indentation).abs();
    of_force.max(offset * exact.tangent_stiffness / exact.force)
}

fn is_sound(response: &Response) -> bool {
    let positive = [response.indentation, response.force, response.tangent_stiffness, response.force_error];
    let known = [response.contact_half_angle, response.peak_pressure, response.energy];
    let all = positive.into_iter().chain(known.map(|value| value.unwrap_or(f64::NAN)));
    all.into_iter().all(|value| value.is_finite() && value > 0.0)
}

/// Checks every row, and gives how many had numbers that nobody warned of, the worst error of those, and the designs
/// whose error is above `accuracy`.
fn check(
    cases: &[DesignCase],
    found: &[DesignOutcome],
    exact: &[DesignOutcome],
    accuracy: f64,
) -> Vec<usize> {
    let mut statuses: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut compared, mut worst, mut bounded) = (0, 0.0_f64, 0);
    let mut wrong = Vec::new();
    for (index, (found, exact)) in found.iter().zip(exact).enumerate() {
        for (found, exact) in found.steps.iter().zip(&exact.steps) {
            *statuses.entry(&found.status).or_default() += 1;
            let Some(response) = &found.response else {
                assert!(found.status.starts_with("failed: "), "{} {:?}", found.status, cases[index]);
                continue;
            };
            assert!(is_sound(response), "{response:?} {:?}", cases[index]);
            // A standard that warns of itself is none.
            let warns = |status: &str| status.contains("accuracy not met") || status.contains("not positive");
            let exact = exact.response.filter(|_| !warns(&found.status) && !warns(&exact.status));
            let Some(exact) = exact else { continue };
            compared += 1;
            let error = error(response, &exact);
            bounded += usize::from(error <= response.force_error);
            worst = worst.max(error);
            if error > accuracy {
                println!("{error:.2e} of {:.2e}: {:?}", response.force_error, cases[index]);
                wrong.push(index);
            }
        }
    }
    println!("{compared} compared, worst {worst:.2e}, bounded {:.4}", bounded as f64 / compared as f64);
    for (status, count) in statuses {
        println!("{count:>8}  {status}");
    }
    wrong
}

/// The same where bodies are interpolated, as in a large sweep of such designs: boxes as wide as these are hard to fit.
#[test]
fn interpolated_joints_are_right_or_say_so() {
    let mut random = Random::new(72);
    let cases: Vec<DesignCase> = (0..draws() as u64 / 4).map(|index| extreme(&mut random, index)).collect();
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint).collect();
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    for method in [MethodChoice::Fe, MethodChoice::Auto] {
        let options = SolveOptions { accuracy: 0.01, method };
        let plan = InterpolationPlan::new(&options, 300_000, &joints).expect("a fit is worth it");
        let mut backend = CpuBackend::interpolating(options, plan);
        let found: Vec<DesignOutcome> = cases.chunks(1024).flat_map(|cases| backend.solve(cases)).collect();
        let interpolated = |outcome: &&DesignOutcome| {
            let mut responses = outcome.steps.iter().filter_map(|step| step.response);
            responses.any(|response| response.method == Method::Interpolated)
        };
        println!("{} designs interpolated, {method:?}", found.iter().filter(interpolated).count());
        let wrong = check(&cases, &found, &exact, 0.01);
        assert!(wrong.is_empty(), "{} of {}", wrong.len(), cases.len());
    }
}

/// Half discs, and blocks whose sides lie anywhere; the judge is the same program at a fifth of the error, where it does not
/// warn of itself.
#[test]
fn half_discs_and_blocks_are_right_or_say_so() {
    let mut random = Random::new(73);
    let side = |random: &mut Random| {
        if random.unit() < 0.5 { 1.0 + random.log(0.02, 1.0) } else { random.log(1.02, 300.0) }
    };
    let one = |index: u64| {
        let mut case = extreme(&mut random, index);
        if index.is_multiple_of(2) {
            let pin = &mut case.joint.pin;
            (pin.shape, pin.parameters) = (&half_disc::SHAPE, [0.0; 3]);
        }
        if !index.is_multiple_of(4) {
            let plate = &mut case.joint.plate;
            let sides = [side(&mut random), side(&mut random), side(&mut random)];
            (plate.shape, plate.parameters, plate.support) =
                (&block::SHAPE, sides, (random.unit() * 2.0) as usize);
        }
        case
    };
    let cases: Vec<DesignCase> = (0..draws() as u64 / 20).map(one).collect();
    let exact = solve(&cases, MethodChoice::Auto, 2e-3);
    let wrong = check(&cases, &solve(&cases, MethodChoice::Auto, 0.01), &exact, 0.01);
    assert!(wrong.is_empty(), "{} of {}", wrong.len(), cases.len());
}

#[test]
fn concentric_joints_are_right_or_say_so() {
    let mut random = Random::new(71);
    let cases: Vec<DesignCase> = (0..draws() as u64).map(|index| extreme(&mut random, index)).collect();
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    let wrong = check(&cases, &solve(&cases, MethodChoice::Fe, 0.01), &exact, 0.01);
    assert!(wrong.is_empty(), "{} of {}", wrong.len(), cases.len());
}
