//! The exact modes of concentric bodies, with ever more trial pressures; the most of all are the oracle.

use std::time::Instant;

use crate::engine::bodies::BodyLibrary;
use crate::engine::body_request::{BodyRequest, Fidelity};
use crate::engine::spaces::Spaces;
use crate::lab::tradeoff::answer::States;
use crate::lab::tradeoff::choice::{Choice, Family, Scope, Solution};
use crate::lab::tradeoff::joints::{Joints, Terms};
use crate::lab::tradeoff::moving_edge;
use crate::mechanics::body::Body;
use crate::study::design::DesignCase;

pub static FAMILY: Family =
    Family { name: "series", about: "exact modes (series)", parameter: "trial pressures" };

pub fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    [3, 6, 10, 16]
        .map(|terms| {
            family.choice(format!("{terms} terms"), Some(terms as f64), move |cases| {
                solve(Terms::Fixed(terms), Fidelity::Series, cases)
            })
        })
        .into()
}

/// By way of the engine's library of bodies, what is not concentric without an answer to `series`.
pub fn solve(terms: Terms, fidelity: Fidelity, cases: &[DesignCase]) -> Solution {
    solve_bodies(terms, |_| fidelity, cases)
}

/// The same, each body as `fidelity` has it.
pub fn solve_bodies(terms: Terms, fidelity: impl Fn(&Body) -> Fidelity, cases: &[DesignCase]) -> Solution {
    let started = Instant::now();
    let can = |case: &DesignCase| {
        let bodies = [&case.joint.pin, &case.joint.plate].map(|part| case.joint.body(part));
        bodies.iter().all(|body| body.shape.concentric || fidelity(body) != Fidelity::Series)
    };
    let solved: Vec<DesignCase> = cases.iter().filter(|case| can(case)).cloned().collect();
    let joints = Joints::new(&solved, |_, _| ());
    let request = |(body, ()): &(Body, ())| BodyRequest { body: body.clone(), fidelity: fidelity(body) };
    let mut library = BodyLibrary::default();
    library.solve(&joints.bodies.iter().map(request).collect::<Vec<_>>());
    let with_bodies = solved.iter().zip(&joints.of_case).map(|(case, bodies)| {
        let compliance = |number: usize| &library.solved(&request(&joints.bodies[number])).compliance;
        (case, terms.space(&case.joint), bodies.map(compliance))
    });
    let of_spaces = Instant::now();
    let mut spaces = Spaces::default();
    spaces.prepare(with_bodies.clone().flat_map(|(_, key, bodies)| bodies.map(|body| (key, body))));
    let of_spaces = of_spaces.elapsed();
    let mut found =
        with_bodies.map(|(case, key, [pin, plate])| moving_edge::states(case, (key, &spaces), pin, plate));
    let of_case = |case: &DesignCase| {
        let own = if can(case) { found.next() } else { None };
        own.unwrap_or_else(|| vec![None; case.steps.len()])
    };
    let states: States = cases.iter().map(of_case).collect();
    let shared = library.times.shared + of_spaces;
    Solution { states, shared, own: started.elapsed().saturating_sub(shared) }
}
