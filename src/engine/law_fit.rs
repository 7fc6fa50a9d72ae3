//! Laws for the designs of a sweep: each joint is sampled over the range of laws, whatever its own loads are, and fitted.

use rayon::prelude::*;

use crate::engine::ladder::Ladder;
use crate::engine::outcome::{Answer, DesignLaws, DesignOutcome, StepOutcome};
use crate::mechanics::laws::calibrated::samples::sampled_at;
use crate::mechanics::laws::calibrated::{
    FittedLaw, Sample, Samples, Sizes, fitted_laws, power, recommended,
};
use crate::mechanics::material::effective_modulus;
use crate::study::design::{DesignCase, Load};

/// Over the clearance: large enough that the fit is neat.
const LARGE: f64 = 1e7;

/// The loads that laws of a design are told by, the last of them ever larger, where it works between two indentations, mm.
pub fn law_case(case: &DesignCase, (low, high): (f64, f64)) -> DesignCase {
    let joint = &case.joint;
    let clearance = joint.radial_clearance;
    let steps = if joint.is_neat() {
        vec![Load::Indentation(high)]
    } else {
        let sampled = sampled_at((low / clearance, high / clearance));
        sampled.chain([LARGE]).map(|ratio| Load::Indentation(ratio * clearance)).collect()
    };
    DesignCase { index: case.index, joint: joint.clone(), steps: steps.into() }
}

/// The least and the greatest indentation that was answered, mm.
pub fn working_range(steps: &[StepOutcome]) -> Option<(f64, f64)> {
    let responses = steps.iter().filter_map(|step| step.response);
    range_of(responses.map(|response| response.indentation))
}

/// The least and the greatest of those above 0.
pub fn range_of(indentations: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = indentations
        .filter(|indentation| *indentation > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    (high > 0.0).then_some((low, high))
}

/// The laws of a design from the answer to its `law_case`.
pub fn laws_of(case: &DesignCase, answer: &Answer, (low, high): (f64, f64)) -> DesignLaws {
    let joint = &case.joint;
    let missing = DesignLaws::missing;
    let Some((last, sampled)) = answer.steps.split_last() else { return missing("no load") };
    let stiffness =
        effective_modulus(&joint.pin.contact_material(), &joint.plate.contact_material(), joint.idealization)
            * joint.thickness;
    let stiffness_of_large_loads = last.response.map(|response| response.tangent_stiffness);
    let clearance = joint.radial_clearance;
    if joint.is_neat() {
        let Some(slope) = stiffness_of_large_loads else { return missing("no answer") };
        return DesignLaws { stiffness_of_large_loads, ..of_neat_fit(slope, stiffness, (low, high)) };
    }
    let sizes = Sizes { radial_clearance: clearance, stiffness };
    let states = sampled.iter().map_while(|step| step.response).map(|response| Sample {
        x: response.indentation / clearance,
        y: response.force / (stiffness * clearance),
        exponent: response.tangent_stiffness * response.indentation / response.force,
    });
    let Some(samples) = Samples::new(sizes, states, (low / clearance, high / clearance)) else {
        return missing("too few states");
    };
    let laws = fitted_laws(&samples);
    DesignLaws {
        recommended: recommended(&laws, &samples),
        laws,
        stiffness_of_large_loads,
        small_load_constant: Some(samples.small_load_constant()),
        missing: None,
    }
}

/// A neat fit has the same slope under any load: a power law with the exponent 1, its length 1 mm.
fn of_neat_fit(slope: f64, stiffness: f64, range: (f64, f64)) -> DesignLaws {
    let law = FittedLaw {
        law: &power::LAW,
        constants: vec![slope / stiffness, 1.0],
        sizes: Sizes { radial_clearance: 1.0, stiffness },
        range,
        force_misfit: [0.0; 2],
        stiffness_misfit: [0.0; 2],
    };
    let recommended = Some((0, "a neat fit is linear"));
    DesignLaws { laws: vec![law], recommended, ..DesignLaws::default() }
}

/// Fits laws for outcomes. Their bodies are those that were just solved.
pub fn add_laws(ladder: &mut Ladder, outcomes: &mut [DesignOutcome]) {
    let designs: Vec<_> =
        outcomes.iter().map(|outcome| (&outcome.case, working_range(&outcome.steps))).collect();
    let laws = laws_of_all(ladder, &designs);
    for (outcome, laws) in outcomes.iter_mut().zip(laws) {
        outcome.laws = Some(Box::new(laws));
    }
}

/// The laws of designs, each with the least and the greatest indentation at work, mm, where it has any answer.
pub fn laws_of_all<'a>(
    ladder: &mut Ladder,
    designs: &[(&'a DesignCase, Option<(f64, f64)>)],
) -> Vec<DesignLaws> {
    let with_laws = |(case, working): &(&'a DesignCase, Option<(f64, f64)>)| {
        (*case, working.filter(|_| !case.joint.is_press_fit()))
    };
    let designs: Vec<_> = designs.iter().map(with_laws).collect();
    let asked: Vec<DesignCase> =
        designs.iter().filter_map(|(case, working)| working.map(|working| law_case(case, working))).collect();
    let mut answers = ladder.answers(&asked).into_iter();
    let answers: Vec<Option<(Answer, (f64, f64))>> = designs
        .iter()
        .map(|(_, working)| working.and_then(|working| Some((answers.next()?, working))))
        .collect();
    let of_design = |((case, _), answer): (&(&DesignCase, _), Option<(Answer, _)>)| match answer {
        Some((answer, working)) => laws_of(case, &answer, working),
        None if case.joint.is_press_fit() => {
            DesignLaws::missing("laws are of the indentation of joints with clearance")
        }
        None => DesignLaws::missing("no answer under load"),
    };
    designs.par_iter().zip(answers).map(of_design).collect()
}
