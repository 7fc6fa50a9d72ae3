//! What laws cost: `cargo bench --bench laws`. Fits of one law to the states of a joint, and all of them.

use divan::Bencher;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::{law_case, laws_of};
use jointsweep::internals::engine::outcome::Answer;
use jointsweep::internals::study::design::DesignCase;
use jointsweep::{Dimensions, Idealization, Joint, Material, MethodChoice, Options, Part};

fn main() {
    divan::main();
}

const WORKING: (f64, f64) = (0.001, 0.1);

fn case() -> DesignCase {
    let steel = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
    let joint = Joint::new(
        Dimensions { hole_radius: 10.0, radial_clearance: 0.05, thickness: 8.0 },
        Idealization::PlaneStress,
        Part::new("rigid-core", &[], None, steel).unwrap(),
        Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, steel).unwrap(),
    )
    .unwrap();
    law_case(&DesignCase { index: 0, joint: joint.design().clone(), steps: Vec::new().into() }, WORKING)
}

fn ladder() -> Ladder<'static> {
    Ladder::new(Options { accuracy: 0.01, method: MethodChoice::Auto })
}

/// From the states of one design to its nine laws.
#[divan::bench]
fn nine_laws_fitted(bencher: Bencher) {
    let case = case();
    let answer: Answer = ladder().answers(std::slice::from_ref(&case)).remove(0);
    bencher.bench_local(|| laws_of(&case, &answer, WORKING));
}

/// The states that laws are told by, of a design whose bodies are solved.
#[divan::bench]
fn states_solved(bencher: Bencher) {
    let (case, mut ladder) = (case(), ladder());
    bencher.bench_local(|| ladder.answers(std::slice::from_ref(&case)));
}
