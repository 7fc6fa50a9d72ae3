//! A GPU in each of its precisions, as a sweep uses it: on the mesh level that the accuracy asked for begins with, and
//! further where its own estimate says so.

use std::time::{Duration, Instant};

use crate::engine::backend::choice::GpuChoice;
use crate::engine::backend::gpu::context::{GpuDevice, GpuError};
use crate::engine::backend::gpu::kernels::Precision;
use crate::engine::ladder::Ladder;
use crate::engine::outcome::DesignOutcome;
use crate::lab::tradeoff::answer::State;
use crate::lab::tradeoff::choice::{Choice, Family, Scope, Solution};
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

pub static FAMILY: Family = Family { name: "gpu", about: "GPU, a sweep's own", parameter: "accuracy asked" };

const ACCURACIES: [f64; 2] = [1e-2, 1e-3];

pub fn choices<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    let Some(device) = scope.gpu else { return Vec::new() };
    let precisions = [Precision::F32, Precision::Mixed, Precision::F64];
    let mut choices = Vec::new();
    for precision in precisions.into_iter().filter(|precision| precision.check(&device.facts).is_ok()) {
        for accuracy in ACCURACIES {
            let name = format!("{}, {} %", precision.name(), 100.0 * accuracy);
            choices.push(family.choice(name, Some(accuracy), move |cases| {
                solve(device, precision, accuracy, cases).unwrap_or_else(|_| nothing(cases))
            }));
        }
    }
    choices
}

/// The first solution makes kernels, meshes and near fields ready, the second one only solves.
fn solve(
    device: &GpuDevice,
    precision: Precision,
    accuracy: f64,
    cases: &[DesignCase],
) -> Result<Solution, GpuError> {
    let started = Instant::now();
    let options = SolveOptions { accuracy, method: MethodChoice::Fe };
    let condenser = GpuChoice::new(device, precision).condenser()?;
    let mut ladder = Ladder::new(options).on(Box::new(condenser));
    ladder.solve(cases);
    let first = started.elapsed();
    // Every body anew.
    ladder.library.forget();
    let outcomes = ladder.solve(cases);
    let own = started.elapsed() - first;
    if let Some(lost) = ladder.library.lost() {
        return Err(lost.clone());
    }
    let states = outcomes.iter().map(|outcome: &DesignOutcome| {
        outcome.steps.iter().map(|step| step.response.as_ref().and_then(State::of)).collect()
    });
    Ok(Solution { states: states.collect(), shared: first.saturating_sub(own), own })
}

fn nothing(cases: &[DesignCase]) -> Solution {
    let states = cases.iter().map(|case| vec![None; case.steps.len()]).collect();
    Solution { states, shared: Duration::ZERO, own: Duration::ZERO }
}
