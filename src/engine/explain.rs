//! What a design is solved with, and why: the planner's choice in words, with what was ruled out, an estimated error and
//! time. Nothing is solved here.

use std::collections::BTreeMap;

use crate::engine::accuracy::Estimate;
use crate::engine::accuracy::geometry_error::OutlineError;
use crate::engine::accuracy::known_errors::{KNOWN_LEVELS, columns, known_errors};
use crate::engine::body_request::{BodyRequest, Fidelity, mesh_size};
use crate::engine::cost::MOST_LOOKED_AT;
use crate::engine::expected_contact::ExpectedContact;
use crate::engine::interpolation::fit_plan::{FINEST_ACCURACY, InterpolationPlan, picks};
use crate::engine::joint_scale::JointScale;
use crate::engine::plan::{JointPlan, first_level};
use crate::engine::refusal::Refusal;
use crate::engine::unit_costs::{Time, Unit, body_seconds, design, interpolated_design, joint_seconds, row};
use crate::error::Error;
use crate::study::config::{MethodChoice, Study};
use crate::study::design::DesignCase;

/// What the curve of exact bodies leaves at most, but for beds.
const EXACT: f64 = 3e-5;

/// Why a design is solved as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// In one line.
    pub chosen: String,
    pub why: String,
    /// What each body is solved on.
    pub bodies: Vec<String>,
    /// What was looked at before, cheapest first, and why it was not taken.
    pub ruled_out: Vec<(String, String)>,
    /// Of the force, relative, at most, as far as is known before solving.
    pub error: f64,
    /// Of one core; what a sweep shares is left out.
    pub time: Time,
}

/// Designs that are solved alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Share {
    pub designs: u64,
    /// The first of them, from 0.
    pub example: u64,
    /// Core time of all.
    pub time: Time,
}

/// Explains designs of one study.
pub struct Explainer<'a> {
    study: &'a Study,
    interpolation: Option<InterpolationPlan>,
}

impl<'a> Explainer<'a> {
    pub fn new(study: &'a Study) -> Explainer<'a> {
        Explainer { study, interpolation: InterpolationPlan::of_study(study) }
    }

    /// The whole study by what is chosen, and how many designs tell it: all of them, or some that are spread over it.
    pub fn shares(&self) -> Result<(BTreeMap<String, Share>, u64), Error> {
        let mut shares: BTreeMap<String, Share> = BTreeMap::new();
        let count = self.study.design_count();
        let numbers = picks(count, MOST_LOOKED_AT);
        let looked_at = numbers.len() as u64;
        let of_all = count as f64 / (looked_at as f64).max(1.0);
        for case in self.study.cases_at(numbers)? {
            let case = case?;
            let Explanation { chosen, time, .. } = self.explain(&case);
            let share = shares.entry(chosen).or_insert(Share { example: case.index, ..Share::default() });
            share.designs += 1;
            share.time += time * of_all;
        }
        shares.values_mut().for_each(|share| share.designs = (of_all * share.designs as f64).round() as u64);
        Ok((shares, looked_at))
    }

    pub fn explain(&self, case: &DesignCase) -> Explanation {
        let method = self.study.solve.method;
        let rows = case.steps.len() as f64;
        let mut ruled_out = Vec::new();
        if method == MethodChoice::ClosedForm && Refusal::of_joint(case, method).is_none() {
            let why = "`method = \"closed-form\"` asks for Johnson's law".into();
            let of_rows = Time::of_others(rows * self.row().seconds());
            return without_bodies("closed form", why, ruled_out, 1.0, of_rows);
        }
        let mut rule_out = |what: &str, why: String| ruled_out.push((what.to_string(), why));
        rule_out("closed form", "knows nothing of the plate's extent: right to a factor of two".into());
        if let Some(why) = self.not_interpolated(case) {
            rule_out("interpolation across bodies", why);
        } else {
            let why = "the sweep has so many distinct bodies that fits of their compliances cost less".into();
            let time = Time::of_others(interpolated_design(rows, self.row()).seconds());
            return without_bodies("interpolated", why, ruled_out, self.study.solve.accuracy, time);
        }
        self.explain_bodies(case, ruled_out)
    }

    fn row(&self) -> Unit {
        row(self.study.writes_table())
    }

    /// `None` where the bodies are interpolated.
    fn not_interpolated(&self, case: &DesignCase) -> Option<String> {
        match &self.interpolation {
            Some(plan) if plan.covers(&case.joint) => None,
            _ if case.joint.is_lined() => Some("knows no layers".into()),
            _ if case.joint.is_press_fit() => Some("knows no press fits".into()),
            Some(_) => {
                Some("a body is outside of what is fitted: a thin wall, a singular Poisson's ratio".into())
            }
            None if !self.study.interpolation => Some("`interpolation = \"off\"`".into()),
            None if self.study.solve.method == MethodChoice::Series => {
                Some("`method = \"series\"` is exact".into())
            }
            None if self.study.solve.accuracy < FINEST_ACCURACY => Some("good to 0.1 % at best".into()),
            None => Some(format!("too few distinct bodies in {} designs", self.study.design_count())),
        }
    }

    fn explain_bodies(&self, case: &DesignCase, mut ruled_out: Vec<(String, String)>) -> Explanation {
        let (method, accuracy) = (self.study.solve.method, self.study.solve.accuracy);
        let plan = match JointPlan::cheapest(case, method, accuracy) {
            Ok(plan) => plan,
            Err(refusal) => {
                let why = refusal.to_string();
                return without_bodies("refused", why, ruled_out, f64::INFINITY, Time::default());
            }
        };
        let expected = ExpectedContact::of(case);
        for request in plan.meshed() {
            let name = request.body.shape.name;
            let why = match method {
                MethodChoice::Fe if request.body.shape.concentric => {
                    "`method = \"fe\"` asks for meshes".into()
                }
                _ => format!("has no exact modes for a `{name}`"),
            };
            ruled_out.push((format!("series for the {name}"), why));
        }
        let levels = if plan.estimate == Estimate::Known { plan.level } else { KNOWN_LEVELS };
        let is_meshed = plan.estimate != Estimate::Exact;
        for level in (0..levels).filter(|_| is_meshed) {
            let alone = JointPlan { level, ..plan.clone() };
            ruled_out
                .push((format!("mesh level {level} alone"), not_known_enough(&alone, &expected, accuracy)));
        }
        let (chosen, why, error) = match plan.estimate {
            Estimate::Exact => (
                "series".to_string(),
                "both bodies have exact modes, which cost less than any mesh".into(),
                EXACT.min(accuracy),
            ),
            Estimate::Known => {
                let known = worst_known(&plan, &expected).unwrap_or(f64::INFINITY);
                let foreseen = plan.foreseen_error(&expected).unwrap_or(f64::INFINITY);
                let [narrowest, widest] = plan.chosen_for(&expected).map(f64::to_degrees);
                let half_angles = match narrowest < widest {
                    true => format!("from {narrowest:.0} to {widest:.0}"),
                    false => format!("up to {widest:.0}"),
                };
                let why = format!(
                    "such meshes are known to be within {} at half angles {half_angles} deg; by the moduli an error of {} is \
                     foreseen, and where it turns out worse, finer ones follow",
                    percent(known),
                    percent(foreseen)
                );
                (format!("mesh level {}", plan.level), why, accuracy)
            }
            Estimate::Change(trust) => {
                let (level, first) = (plan.level, first_level(accuracy));
                let why = format!(
                    "the difference of two meshes tells the error of each design; level {first} is the coarsest that is \
                     typically within {}, and where it is not, finer ones follow",
                    percent(accuracy)
                );
                (format!("mesh levels {} and {level}", level - 1), why, accuracy.max(trust.error(level, 0.0)))
            }
        };
        // What is left of the outlines is told beside what is asked where finer meshes cannot make room for it.
        let of_outlines =
            OutlineError::of(&case.joint, &JointScale::of(&case.joint).outlines).at(expected.half_angle);
        let is_beside = plan.estimate == Estimate::Exact || of_outlines > 0.5 * accuracy;
        let error = if is_beside { error + of_outlines } else { error };
        let requests: Vec<BodyRequest> = plan.requests().collect();
        let in_lanes = requests.iter().map(body_seconds).sum::<f64>() + joint_seconds(&plan);
        Explanation {
            chosen,
            why,
            bodies: requests.iter().map(|request| describe(request, plan.space.terms)).collect(),
            ruled_out,
            error,
            time: Time { in_lanes, others: design(case.steps.len() as f64, self.row()).seconds() },
        }
    }
}

/// Of a design whose bodies are not solved.
fn without_bodies(
    chosen: &str,
    why: String,
    ruled_out: Vec<(String, String)>,
    error: f64,
    time: Time,
) -> Explanation {
    Explanation { chosen: chosen.into(), why, bodies: Vec::new(), ruled_out, error, time }
}

/// Of the bodies on meshes the worst where contacts are expected.
fn worst_known(plan: &JointPlan, expected: &ExpectedContact) -> Option<f64> {
    plan.meshed().try_fold(0.0, |worst, request| {
        let known = &known_errors(&request.body, plan.level)?[columns(plan.chosen_for(expected))];
        Some(known.iter().copied().fold(worst, f64::max))
    })
}

fn not_known_enough(plan: &JointPlan, expected: &ExpectedContact, accuracy: f64) -> String {
    match plan.foreseen_error(expected) {
        None => "its error on such bodies was not measured beforehand".into(),
        Some(error) => format!("may be off by {}, {} is asked", percent(error), percent(accuracy)),
    }
}

fn describe(request: &BodyRequest, terms: usize) -> String {
    let name = request.body.shape.name;
    let layers = match request.body.lining.list().len() {
        0 => String::new(),
        1 => " through 1 layer".into(),
        count => format!(" through {count} layers"),
    };
    match request.fidelity {
        Fidelity::Series => {
            format!("{name}: exact modes{layers}, {terms} trial pressures")
        }
        Fidelity::Mesh { level } => {
            let unknowns = mesh_size(&request.body, level).unknowns;
            let layers = if layers.is_empty() { layers } else { format!("{layers} on the processor") };
            format!("{name}: mesh level {level}{layers}, {unknowns} unknowns, {terms} trial pressures")
        }
    }
}

/// A share in percent, with two digits.
pub fn percent(share: f64) -> String {
    let digits = (1 - (100.0 * share).log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{:.digits$}", 100.0 * share);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_told_in_percent() {
        for (share, text) in
            [(0.01, "1 %"), (0.0012, "0.12 %"), (9.5e-3, "0.95 %"), (0.1, "10 %"), (1e-4, "0.01 %")]
        {
            assert_eq!(percent(share), text);
        }
    }
}
