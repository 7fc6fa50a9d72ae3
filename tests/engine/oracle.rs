//! Finite elements against the exact `series`, and against themselves on the finest mesh where there is no series.
//!
//! What is seen stands in docs/verification.md; run with `--nocapture` to see it again.

use crate::common::draws::{concentric, disc_in_block, draw, half_disc_in_annulus};
use crate::common::length::count;
use crate::common::random::Random;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, Part};

/// Above what was seen: room for other roundings of the meshes' choice, not for a worse mesh.
const MARGIN: f64 = 1.3;

/// Designs drawn for the comparison with `series`.
const COUNT: u64 = 300;

fn solve(cases: &[DesignCase], method: MethodChoice, accuracy: f64) -> Vec<Option<Response>> {
    let outcomes = Ladder::new(SolveOptions { accuracy, method }).solve(cases);
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
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(exact) {
        let (Some(found), Some(exact)) = (found, exact) else { continue };
        errors.force.push((found.force / exact.force - 1.0).abs());
        errors.stiffness.push((found.tangent_stiffness / exact.tangent_stiffness - 1.0).abs());
        let [found_angle, angle] = [found, exact].map(|response| response.contact_half_angle.unwrap());
        errors.half_angle.push((found_angle - angle).abs().to_degrees());
        errors.estimate.push(found.force_error);
    }
    errors
}

/// The value below which a share of the values lies.
fn quantile(values: &[f64], share: f64) -> f64 {
    assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
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

/// What a comparison is held to, as docs/verification.md has it: so far above it an error may be by `MARGIN`.
struct Seen {
    accuracy: f64,
    /// Median, 95 % and worst, relative.
    force: [f64; 3],
    /// deg.
    half_angle: [f64; 3],
    /// The worst, relative.
    stiffness: f64,
    /// Mean estimate over mean error.
    excess: f64,
}

const SHARES: [f64; 3] = [0.5, 0.95, 1.0];

fn hold(what: &str, errors: &Errors, seen: &Seen) {
    let quantiles = |values: &[f64]| SHARES.map(|share| quantile(values, share));
    let (force, half_angle) = (quantiles(&errors.force), quantiles(&errors.half_angle));
    let (stiffness, bounded) = (quantile(&errors.stiffness, 1.0), bounded(errors));
    let excess = mean(&errors.estimate) / mean(&errors.force);
    let line = |[median, most, worst]: [f64; 3]| format!("{median:.1e} / {most:.1e} / {worst:.1e}");
    println!(
        "{what} at {:.1} %, {} rows: median / 95 % / worst of force {}, half angle {} deg, worst stiffness {stiffness:.1e}; \
         bounded {bounded:.4}, estimate/error {excess:.1}",
        100.0 * seen.accuracy,
        errors.force.len(),
        line(force),
        line(half_angle),
    );
    let what = format!("{what} at {}", seen.accuracy);
    assert!(force[2] <= seen.accuracy, "{what}: {force:?}");
    for (found, seen) in
        force.into_iter().chain(half_angle).zip(seen.force.into_iter().chain(seen.half_angle))
    {
        assert!(found <= MARGIN * seen, "{what}: {found:e} where {seen:e} was seen");
    }
    assert!(stiffness <= MARGIN * seen.stiffness, "{what}: {stiffness:e}");
    // Seen: all.
    assert!(bounded >= 0.99, "{what}: {bounded}");
    assert!(excess <= MARGIN * seen.excess, "{what}: {excess}");
}

#[test]
fn finite_elements_meet_the_accuracy_against_series() {
    let cases = draw(1, COUNT, concentric);
    let exact = solve(&cases, MethodChoice::Series, 0.01);
    assert!(exact.iter().all(Option::is_some), "series has an answer for every design");
    for seen in [
        Seen {
            accuracy: 1e-2,
            force: [7.8e-5, 7.9e-4, 2.7e-3],
            half_angle: [7.4e-3, 0.091, 0.33],
            stiffness: 3.2e-3,
            excess: 8.7,
        },
        Seen {
            accuracy: 3e-3,
            force: [7.8e-5, 7.9e-4, 1.3e-3],
            half_angle: [2.5e-3, 0.072, 0.11],
            stiffness: 1.5e-3,
            excess: 7.0,
        },
        Seen {
            accuracy: 1e-3,
            force: [5.8e-5, 2.3e-4, 3.7e-4],
            half_angle: [9.1e-4, 5.3e-3, 0.019],
            stiffness: 3.8e-4,
            excess: 5.9,
        },
    ] {
        let found = solve(&cases, MethodChoice::Fe, seen.accuracy);
        assert!(found.iter().all(Option::is_some), "finite elements have an answer for every design");
        let errors = compare(&found, &exact);
        hold("fe against series", &errors, &seen);
        // The project's limit of the half angle is 0.5 deg, its aim 0.2 deg, which holds from 0.3 % on.
        let half_angle = if seen.accuracy > 3e-3 { 0.5 } else { 0.2 };
        assert!(quantile(&errors.half_angle, 1.0) <= half_angle);
        assert!(quantile(&errors.stiffness, 1.0) <= seen.accuracy.max(4e-3));
        assert!(mean(&errors.estimate) < 10.0 * mean(&errors.force));
    }
}

/// Where no series exists, the finest mesh is the judge; its own estimated error is well below what is asked.
#[test]
fn half_discs_meet_the_accuracy_against_the_finest_mesh() {
    let seen = [
        Seen {
            accuracy: 1e-2,
            force: [3.3e-4, 8.6e-4, 2.1e-3],
            half_angle: [7.2e-3, 0.075, 0.15],
            stiffness: 5.2e-3,
            excess: 6.3,
        },
        Seen {
            accuracy: 3e-3,
            force: [2.5e-4, 7.4e-4, 1.2e-3],
            half_angle: [4.7e-3, 0.064, 0.11],
            stiffness: 2.5e-3,
            excess: 6.7,
        },
    ];
    against_the_finest_mesh("half disc in annulus", half_disc_in_annulus, seen);
}

#[test]
fn blocks_meet_the_accuracy_against_the_finest_mesh() {
    let seen = [
        Seen {
            accuracy: 1e-2,
            force: [2.6e-4, 2.8e-3, 6.8e-3],
            half_angle: [6.9e-3, 0.17, 0.47],
            stiffness: 7.0e-3,
            excess: 5.7,
        },
        Seen {
            accuracy: 3e-3,
            force: [1.7e-4, 9.9e-4, 2.3e-3],
            half_angle: [3.5e-3, 0.072, 0.21],
            stiffness: 2.2e-3,
            excess: 6.6,
        },
    ];
    against_the_finest_mesh("disc in block", disc_in_block, seen);
}

fn against_the_finest_mesh(name: &str, shapes: fn(&mut Random) -> (Part, Part), all: [Seen; 2]) {
    // The finest mesh takes long.
    let designs = count(110, 150);
    let cases = draw(2, designs, shapes);
    let finest = solve(&cases, MethodChoice::Fe, 1e-5);
    for seen in all {
        let errors = compare(&solve(&cases, MethodChoice::Fe, seen.accuracy), &finest);
        // A half disc's contact may not reach its held face: a few wide contacts are refused.
        assert!(errors.force.len() as u64 >= designs * 98 / 100, "{name}: {} rows", errors.force.len());
        hold(name, &errors, &seen);
    }
}
