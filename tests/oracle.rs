//! Finite elements against the exact `series`, and against themselves on the finest mesh where there is no series.
//!
//! What is seen stands in docs/verification.md; run with `--nocapture` to see it again.

#[path = "common/draws.rs"]
mod draws;
#[path = "common/random.rs"]
mod random;

use draws::{concentric, disc_in_block, draw, half_disc_in_annulus};
use jointsweep::engine::backend::cpu::CpuBackend;
use jointsweep::engine::outcome::Response;
use jointsweep::study::config::{MethodChoice, SolveOptions};
use jointsweep::study::design::{DesignCase, Part};
use random::Random;

/// Designs drawn for the comparison with `series`, and for each with the finest mesh, which takes longer.
const COUNT: u64 = 300;
const COUNT_FINEST: u64 = 150;

fn solve(cases: &[DesignCase], method: MethodChoice, accuracy: f64) -> Vec<Option<Response>> {
    let outcomes = CpuBackend::new(SolveOptions { accuracy, method }).solve(cases);
    outcomes.into_iter().map(|outcome| outcome.steps[0].response).collect()
}

/// Errors of one comparison: force and stiffness relative, half angle in degrees, and the estimate of the first.
struct Errors {
    force: Vec<f64>,
    stiffness: Vec<f64>,
    half_angle: Vec<f64>,
    estimate: Vec<f64>,
}

fn compare(found: &[Option<Response>], exact: &[Option<Response>]) -> Errors {
    let mut errors = Errors { force: vec![], stiffness: vec![], half_angle: vec![], estimate: vec![] };
    for (found, exact) in found.iter().zip(exact) {
        let (Some(found), Some(exact)) = (found, exact) else { continue };
        errors.force.push((found.force / exact.force - 1.0).abs());
        errors.stiffness.push((found.tangent_stiffness / exact.tangent_stiffness - 1.0).abs());
        let angles = found.contact_half_angle.zip(exact.contact_half_angle);
        errors.half_angle.push(angles.map_or(f64::NAN, |(found, exact)| (found - exact).abs().to_degrees()));
        errors.estimate.push(found.force_error);
    }
    errors
}

/// The value below which a share of the values lies.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Share of the forces whose error is below its estimate.
fn bounded(errors: &Errors) -> f64 {
    let below =
        errors.force.iter().zip(&errors.estimate).filter(|(error, estimate)| error <= estimate).count();
    below as f64 / errors.force.len() as f64
}

fn report(what: &str, errors: &Errors) {
    let line = |values: &[f64]| {
        let [median, most, worst] = [0.5, 0.95, 1.0].map(|share| quantile(values, share));
        format!("{median:.1e} / {most:.1e} / {worst:.1e}")
    };
    println!(
        "{what}: median / 95 % / worst of force {}, stiffness {}, half angle {} deg; bounded {:.3}, estimate/error {:.1}",
        line(&errors.force),
        line(&errors.stiffness),
        line(&errors.half_angle),
        bounded(errors),
        mean(&errors.estimate) / mean(&errors.force),
    );
}

#[test]
fn finite_elements_meet_the_accuracy_against_series() {
    let cases = draw(1, COUNT, concentric);
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    assert!(exact.iter().all(Option::is_some), "series has an answer for every design");
    // Half angle: the project's limit is 0.5 deg, its aim 0.2 deg, which holds from 0.3 % on.
    for (accuracy, half_angle) in [(1e-2, 0.5), (3e-3, 0.2), (1e-3, 0.1)] {
        let found = solve(&cases, MethodChoice::Fe, accuracy);
        assert!(found.iter().all(Option::is_some), "finite elements have an answer for every design");
        let errors = compare(&found, &exact);
        report(&format!("fe at {:.1} % against series", 100.0 * accuracy), &errors);
        assert!(quantile(&errors.force, 1.0) <= accuracy);
        assert!(quantile(&errors.stiffness, 1.0) <= accuracy.max(4e-3));
        assert!(quantile(&errors.half_angle, 1.0) <= half_angle);
        assert!(bounded(&errors) >= 0.95);
        assert!(mean(&errors.estimate) < 12.0 * mean(&errors.force));
    }
}

/// Where no series exists, the finest mesh is the judge; its own estimated error is well below what is asked.
#[test]
fn other_shapes_meet_the_accuracy_against_the_finest_mesh() {
    for (name, shapes) in [
        ("half disc in annulus", half_disc_in_annulus as fn(&mut Random) -> (Part, Part)),
        ("disc in block", disc_in_block),
    ] {
        let cases = draw(2, COUNT_FINEST, shapes);
        let finest = solve(&cases, MethodChoice::Fe, 1e-5);
        for accuracy in [1e-2, 3e-3] {
            let found = solve(&cases, MethodChoice::Fe, accuracy);
            let errors = compare(&found, &finest);
            report(&format!("{name} at {:.1} %", 100.0 * accuracy), &errors);
            // A half disc's contact may not reach its held face: a few wide contacts are refused.
            assert!(errors.force.len() as u64 >= COUNT_FINEST * 97 / 100);
            assert!(quantile(&errors.force, 0.99) <= accuracy);
            assert!(quantile(&errors.half_angle, 0.95) <= 1.0);
            assert!(bounded(&errors) >= 0.95);
            // What a level is known to be worth bounds 99 of 100, so it is well above most.
            assert!(mean(&errors.estimate) < 20.0 * mean(&errors.force));
        }
    }
}
