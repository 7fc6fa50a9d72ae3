//! The edges of the parameter space: every design is right to the accuracy asked, or says that it is not.
//!
//! Designs are drawn far beyond what is built: dR/R2 from 0 and 1e-10 to 0.5, delta/dR from 1e-6 to 1e6, forces down to
//! 1e-12 N, nu from -0.9 to 0.4999, moduli eight decades apart, holes from 1e-6 to 1e6 mm, plates up to 1e4, cores from 0.01 on,
//! walls and ligaments down to a millionth of the radius. A test run draws some thousands; at length:
//!
//! ```text
//! JOINTSWEEP_DRAWS=100000 cargo test --release --test engine extremes:: -- --nocapture
//! ```

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::common::greatest::greatest;
use crate::common::random::Random;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{DesignOutcome, Method, Response};
use jointsweep::internals::engine::status::{Remark, Status};
use jointsweep::internals::mechanics::body::{annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

const DRAWS: usize = 600;

/// Random designs that are asked for.
pub fn asked_draws() -> Option<usize> {
    let text = std::env::var("JOINTSWEEP_DRAWS").ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("JOINTSWEEP_DRAWS={text} is no count")))
}

fn draws() -> usize {
    let draws = asked_draws().unwrap_or(DRAWS);
    assert!(draws >= 500, "so few draws show nothing");
    draws
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

/// Of the radius: one in four is thinner than `least`, down to a millionth.
fn thin(random: &mut Random, least: f64, most: f64) -> f64 {
    if random.unit() < 0.25 { random.log(1e-6, least) } else { random.log(least, most) }
}

fn extreme(random: &mut Random, index: u64) -> DesignCase {
    let hole_radius = random.log(1e-6, 1e6);
    let neat = random.unit() < 0.1;
    let radial_clearance = if neat { 0.0 } else { hole_radius * random.log(1e-10, 0.5) };
    let thickness = random.log(1e-6, 1e6);
    let softer = random.log(1e-2, 1e6);
    let ratio = random.log(1.0, 1e8);
    let moduli = if random.unit() < 0.5 { [softer, softer * ratio] } else { [softer * ratio, softer] };
    let core = if random.unit() < 0.5 { random.log(0.01, 0.95) } else { 1.0 - thin(random, 0.05, 0.9) };
    let wall = if random.unit() < 0.5 { 1.0 + thin(random, 0.02, 1.0) } else { random.log(1.02, 1e4) };
    let part = |random: &mut Random, shape, ratio, youngs_modulus| Part {
        shape,
        parameters: [ratio, 0.0, 0.0],
        support: 0,
        material: Material { youngs_modulus, poissons_ratio: poissons_ratio(random) },
        layers: Default::default(),
        yield_stress: None,
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

/// Designs that are solved, and timed, together.
const TOGETHER: usize = 16;

fn solve(cases: &[DesignCase], method: MethodChoice, accuracy: f64) -> Vec<DesignOutcome> {
    let mut backend = Ladder::new(SolveOptions { accuracy, method });
    let mut slowest = Duration::ZERO;
    let solve = |cases: &[DesignCase]| {
        let started = Instant::now();
        let outcomes = backend.solve(cases);
        slowest = slowest.max(started.elapsed());
        outcomes
    };
    let outcomes = cases.chunks(TOGETHER).flat_map(solve).collect();
    println!("the slowest {TOGETHER} designs took {:.2} s", slowest.as_secs_f64());
    outcomes
}

/// The relative error of the force at the same indentation; where the force is given, by way of the stiffness.
fn error(found: &Response, exact: &Response) -> f64 {
    let offset = found.indentation - exact.indentation;
    greatest([found.force / exact.force - 1.0, offset * exact.tangent_stiffness / exact.force])
}

fn is_sound(response: &Response) -> bool {
    let positive = [response.indentation, response.force, response.tangent_stiffness, response.force_error];
    let known = [response.contact_half_angle, response.peak_pressure, response.energy];
    let all = positive.into_iter().chain(known.map(|value| value.unwrap_or(f64::NAN)));
    all.into_iter().all(|value| value.is_finite() && value > 0.0)
}

/// Shares of the steps, as 10,000 draws had them or more.
struct Seen {
    /// Answered, and compared with an exact answer: nothing warns of either.
    compared: f64,
    /// Refused, in words.
    failed: f64,
    /// Answered with a warning of the accuracy.
    warned: f64,
    /// Of the errors that were compared those below their estimates.
    bounded: f64,
    /// So many designs at most that are off by more than was asked and do not warn, by half of it at most.
    off: usize,
}

/// Four standard deviations of a share among so many designs: other draws, fewer or more, keep within them. Where nearly all or
/// nearly none have it, those of one in a hundred.
fn scatter(share: f64, designs: f64) -> f64 {
    let share = share.clamp(0.01, 0.99);
    4.0 * (share * (1.0 - share) / designs).sqrt()
}

/// Checks every row: it has an answer within the accuracy, or warns, or fails in words; and so many as were seen do each.
fn check(cases: &[DesignCase], found: &[DesignOutcome], exact: &[DesignOutcome], accuracy: f64, seen: &Seen) {
    let mut statuses: BTreeMap<String, usize> = BTreeMap::new();
    let is_of_number = |letter: char| letter.is_ascii_digit() || letter == '.';
    let (mut steps, mut failed, mut warned, mut bounded) = (0, 0, 0, 0);
    let (mut errors, mut wrong) = (Vec::new(), Vec::new());
    assert_eq!((found.len(), exact.len()), (cases.len(), cases.len()));
    for (index, (found, exact)) in found.iter().zip(exact).enumerate() {
        assert_eq!([found.steps.len(), exact.steps.len()], [cases[index].steps.len(); 2]);
        for (found, exact) in found.steps.iter().zip(&exact.steps) {
            steps += 1;
            *statuses.entry(found.status.to_string().replace(is_of_number, "")).or_default() += 1;
            let Some(response) = &found.response else {
                failed += 1;
                assert!(found.status.is_failed(), "{} {:?}", found.status, cases[index]);
                continue;
            };
            assert!(is_sound(response), "{response:?} {:?}", cases[index]);
            // A standard that warns of itself is none.
            let warns = |status: &Status| {
                status.has(Remark::AccuracyNotMet) || status.has(Remark::PressureNotPositive)
            };
            if warns(&found.status) {
                warned += 1;
                continue;
            }
            let Some(exact) = exact.response.filter(|_| !warns(&exact.status)) else { continue };
            assert!(is_sound(&exact), "{exact:?} {:?}", cases[index]);
            let error = error(response, &exact);
            errors.push(error);
            bounded += usize::from(error <= response.force_error);
            assert!(error < 1.5 * accuracy, "{error:.2e} {:?}", cases[index]);
            if error > accuracy {
                println!("{error:.2e} of {:.2e}: {:?}", response.force_error, cases[index]);
                wrong.push(index);
            }
        }
    }
    let compared = errors.len();
    println!(
        "{compared} compared, worst {:.2e}, bounded {:.4}",
        greatest(errors),
        bounded as f64 / compared as f64
    );
    for (status, count) in statuses {
        println!("{count:>8}  {status}");
    }
    wrong.dedup();
    assert!(wrong.len() <= seen.off, "{} of {}: {wrong:?}", wrong.len(), cases.len());
    // Of the two loads of a design one often fares like the other.
    let at_least = |count: usize, all: usize, seen: f64| {
        assert!(
            count as f64 / all as f64 >= seen - scatter(seen, 0.5 * all as f64),
            "{count} of {all}, {seen} seen"
        );
    };
    at_least(compared, steps, seen.compared);
    at_least(bounded, compared, seen.bounded);
    at_least(failed, steps, seen.failed);
    at_least(steps - failed, steps, 1.0 - seen.failed);
    at_least(steps - warned, steps, 1.0 - seen.warned);
}

/// The same where bodies are interpolated, as in a large sweep of such designs: boxes as wide as these are hard to fit.
#[test]
fn interpolated_joints_are_right_or_say_so() {
    let mut random = Random::new(72);
    let cases: Vec<DesignCase> = (0..draws() as u64 / 4).map(|index| extreme(&mut random, index)).collect();
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint.clone()).collect();
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    let of_meshes = Seen { compared: 0.736, failed: 0.231, warned: 0.032, bounded: 0.999, off: 0 };
    // One of 25,000, a nearly incompressible wall at the thin end of a box: 1.3 % where 0.98 % is said.
    let of_series =
        Seen { compared: 0.966, failed: 0.007, warned: 0.027, bounded: 0.999, off: cases.len() / 25_000 };
    for (method, seen) in [(MethodChoice::Fe, of_meshes), (MethodChoice::Auto, of_series)] {
        let options = SolveOptions { accuracy: 0.01, method };
        let plan = InterpolationPlan::new(&options, 300_000, &joints).expect("a fit is worth it");
        let mut backend = Ladder::new(options).interpolating(Some(plan));
        let found: Vec<DesignOutcome> = cases.chunks(1024).flat_map(|cases| backend.solve(cases)).collect();
        let is_interpolated = |outcome: &&DesignOutcome| {
            let mut responses = outcome.steps.iter().filter_map(|step| step.response);
            responses.any(|response| response.method == Method::Interpolated)
        };
        let interpolated = found.iter().filter(is_interpolated).count();
        println!("{interpolated} of {} designs interpolated, {method:?}", cases.len());
        // Seen: 0.175 of either; 0.147 of ten times as many, 0.26 of 25,000.
        let (share, least) =
            (interpolated as f64 / cases.len() as f64, 0.147 - scatter(0.147, cases.len() as f64));
        assert!(share >= least, "{interpolated} designs interpolated");
        check(&cases, &found, &exact, 0.01, &seen);
    }
}

/// Half discs, and blocks whose sides lie anywhere; the judge is the same program at a fifth of the error, where it does not
/// warn of itself.
#[test]
fn half_discs_and_blocks_are_right_or_say_so() {
    let mut random = Random::new(73);
    let side = |random: &mut Random| {
        if random.unit() < 0.5 { 1.0 + thin(random, 0.02, 1.0) } else { random.log(1.02, 300.0) }
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
    let seen = Seen { compared: 0.419, failed: 0.501, warned: 0.031, bounded: 0.999, off: 0 };
    check(&cases, &solve(&cases, MethodChoice::Auto, 0.01), &exact, 0.01, &seen);
}

#[test]
fn concentric_joints_are_right_or_say_so() {
    let mut random = Random::new(71);
    let cases: Vec<DesignCase> = (0..draws() as u64).map(|index| extreme(&mut random, index)).collect();
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    let seen = Seen { compared: 0.737, failed: 0.233, warned: 0.030, bounded: 0.999, off: 0 };
    check(&cases, &solve(&cases, MethodChoice::Fe, 0.01), &exact, 0.01, &seen);
}
