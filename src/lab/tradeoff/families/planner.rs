//! What a sweep does by itself, by the accuracy it is asked for: where the planner's own choice lies among all others.

use std::time::Instant;

use crate::engine::ladder::Ladder;
use crate::lab::tradeoff::answer::{State, States};
use crate::lab::tradeoff::choice::{Choice, Family, Scope, Solution};
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

pub static FAMILY: Family =
    Family { name: "planner", about: "the planner (method auto)", parameter: "accuracy asked" };

const ACCURACIES: [f64; 4] = [0.1, 1e-2, 1e-3, 1e-4];

pub fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    let choice = |accuracy: f64| {
        let name = format!("auto, {} %", 100.0 * accuracy);
        family.choice(name, Some(accuracy), move |cases| solve(accuracy, cases))
    };
    ACCURACIES.into_iter().map(choice).collect()
}

/// Each body by itself: interpolation would need the whole sweep, of which these are a few designs.
pub fn solve(accuracy: f64, cases: &[DesignCase]) -> Solution {
    let started = Instant::now();
    let mut ladder = Ladder::new(SolveOptions { accuracy, method: MethodChoice::Auto });
    let outcomes = ladder.solve(cases);
    let elapsed = started.elapsed();
    let states: States = outcomes
        .iter()
        .map(|outcome| outcome.steps.iter().map(|step| State::of(step.response.as_ref()?)).collect())
        .collect();
    let shared = ladder.shared_time();
    Solution { states, shared, own: elapsed.saturating_sub(shared) }
}
