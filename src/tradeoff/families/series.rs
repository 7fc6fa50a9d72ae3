//! The exact modes of concentric bodies, with ever more trial pressures; the most of all are the oracle.

use std::time::Instant;

use crate::engine::bodies::BodyLibrary;
use crate::engine::request::{BodyRequest, Fidelity, SpaceKey};
use crate::mechanics::body::Body;
use crate::study::design::DesignCase;
use crate::tradeoff::choice::{Choice, Family, Scope, Solution};
use crate::tradeoff::joints::{Joints, Terms};
use crate::tradeoff::moving_edge;
use crate::tradeoff::state::States;

pub static FAMILY: Family =
    Family { name: "series", about: "exact modes (series)", parameter: "trial pressures", choices };

fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
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
    let joints = Joints::new(&solved, |joint| terms.space(joint));
    let request = |(body, space): (Body, SpaceKey)| BodyRequest { body, fidelity: fidelity(&body), space };
    let mut library = BodyLibrary::default();
    library.solve(&joints.bodies.iter().copied().map(request).collect::<Vec<_>>());
    let mut found = solved.iter().zip(&joints.of_case).map(|(case, bodies)| {
        let [pin, plate] = bodies.map(|number| request(joints.bodies[number]));
        let compliance = |request: &BodyRequest| library.compliance(&request.key());
        moving_edge::states(case, library.space(pin.space), compliance(&pin), compliance(&plate))
    });
    let of_case = |case: &DesignCase| {
        let own = if can(case) { found.next() } else { None };
        own.unwrap_or_else(|| vec![None; case.steps.len()])
    };
    let states: States = cases.iter().map(of_case).collect();
    let shared = library.times.shared;
    Solution { states, shared, own: started.elapsed().saturating_sub(shared) }
}
