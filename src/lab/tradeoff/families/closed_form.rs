//! Every law that gives a force for an indentation. None of them knows the plate's extent.

use std::time::{Duration, Instant};

use crate::lab::tradeoff::answer::State;
use crate::lab::tradeoff::choice::{Choice, Family, Scope, Solution};
use crate::mechanics::laws::{Curve, LAWS, Law};
use crate::study::design::{DesignCase, JointDesign, Load};

pub static FAMILY: Family = Family { name: "closed-form", about: "closed forms", parameter: "" };

pub fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    LAWS.into_iter()
        .map(|law| family.choice(law.name.to_string(), None, move |cases| solve(law, cases)))
        .collect()
}

fn solve(law: &Law, cases: &[DesignCase]) -> Solution {
    let started = Instant::now();
    let states = cases
        .iter()
        .map(|case| {
            let curve = case.joint.pair().and_then(|pair| law.curve(&pair)).ok();
            case.steps.iter().map(|load| state(curve.as_ref()?, &case.joint, *load)).collect()
        })
        .collect();
    Solution { states, shared: Duration::ZERO, own: started.elapsed() }
}

fn state(curve: &Curve, joint: &JointDesign, load: Load) -> Option<State> {
    let thickness = joint.thickness;
    let indentation = match joint.from_first_touch(load) {
        Load::Indentation(0.0) | Load::Force(0.0) => return None,
        Load::Indentation(indentation) | Load::Offset(indentation) => indentation,
        Load::Force(force) => curve.indentation(force / thickness).ok()?,
    };
    State {
        indentation,
        force: thickness * curve.force_per_thickness(indentation).ok()?,
        tangent_stiffness: thickness * curve.tangent_stiffness_per_thickness(indentation).ok()?,
        contact_half_angle: None,
        peak_pressure: None,
        iterations: None,
    }
    .sound()
}
