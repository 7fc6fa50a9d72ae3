//! Made-up outcomes of random designs: every kind of row that a table can have, without solving anything.

use jointsweep::internals::engine::outcome::{
    Answer, BackendKind, DesignOutcome, Method, Response, StepOutcome,
};
use jointsweep::internals::engine::status::{Failure, Remark, Remarks, Status};
use jointsweep::internals::study::design::Load;

use super::draws::{concentric, disc_in_block, draw};
use super::random::Random;

pub fn outcomes(seed: u64, count: u64) -> Vec<DesignOutcome> {
    let mut random = Random::new(seed);
    let cases = draw(seed, count, |random| match random.unit() < 0.5 {
        true => concentric(random),
        false => disc_in_block(random),
    });
    cases
        .into_iter()
        .map(|mut case| {
            let loads = 1 + (random.unit() * 3.0) as usize;
            let by_force = random.unit() < 0.3;
            let load = |random: &mut Random| match by_force {
                true => Load::Force(random.log(1.0, 1e5)),
                false => Load::Indentation(random.log(1e-4, 1.0)),
            };
            case.steps = (0..loads).map(|_| load(&mut random)).collect();
            let steps = (0..loads).map(|step| outcome(&mut random, case.steps[step])).collect();
            let backend = if random.unit() < 0.5 { BackendKind::Cpu } else { BackendKind::Gpu };
            DesignOutcome::new(case, Answer { backend, steps })
        })
        .collect()
}

fn outcome(random: &mut Random, load: Load) -> StepOutcome {
    if random.unit() < 0.1 {
        return StepOutcome::failed(Failure::NotAPush);
    }
    let known = |value: f64, random: &mut Random| (random.unit() < 0.9).then_some(value);
    let (indentation, force) = match load {
        Load::Indentation(value) | Load::Offset(value) => (value, random.log(1.0, 1e5)),
        Load::Force(value) => (random.log(1e-4, 1.0), value),
    };
    // Few different pressures, so that there are equal ones.
    let pressure = (random.log(1.0, 1e3) / 10.0).ceil() * 10.0;
    let response = Response {
        indentation,
        offset: indentation,
        force,
        tangent_stiffness: random.log(1e3, 1e6),
        contact_half_angle: known(random.linear(0.0, 1.5), random),
        peak_pressure_angle: Some(0.0),
        peak_pressure: known(pressure, random),
        energy: known(random.log(1e-6, 1e3), random),
        force_error: random.log(1e-6, 1e-1),
        linearity_error: known(random.log(1e-6, 1e-1), random),
        method: [Method::ClosedForm, Method::Series, Method::Interpolated, Method::Fe]
            [(random.unit() * 4.0) as usize],
    };
    let remarks = Remarks::of(&[
        (random.unit() < 0.2, Remark::AccuracyNotMet),
        (random.unit() < 0.2, Remark::LargeDisplacement),
    ]);
    StepOutcome { response: Some(response), status: Status::Answered(remarks) }
}
