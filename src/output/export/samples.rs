//! Forces and stiffnesses of the joint's own curve, as a table asks for them: against the support, and only where the
//! curve has an answer that agrees with the result's rows.

use crate::engine::joint_curve::JointCurve;
use crate::engine::outcome::{Response, StepOutcome};
use crate::engine::status::Status;
use crate::engine::threads::common_pool;
use crate::error::Error;
use crate::output::export::numbers::rounded;
use crate::output::export::source::{Member, Source, refuse};
use crate::output::travel::Travel;
use crate::study::config::SolveOptions;
use crate::study::design::{JointDesign, Load};

/// A row of the result and the curve made again may differ by so many times their errors.
const AGREEMENT: f64 = 3.0;

/// Of Newton's rule; it doubles the digits with each.
const NEWTON_STEPS: usize = 30;

/// A curve at some indentations.
pub struct Samples {
    /// N.
    pub force: Vec<f64>,
    /// dF/d delta, N/mm.
    pub stiffness: Vec<f64>,
}

/// What many curves had at worst.
#[derive(Default)]
pub struct Worst {
    pub force_error: f64,
    pub linearity_error: Option<f64>,
    pub methods: Vec<&'static str>,
}

/// The force that the ring's mean motion is taken off for at the end of the range: the least of the designs.
pub fn reached_force(source: &Source) -> Result<f64, Error> {
    if source.ring_compliance == 0.0 {
        return Ok(0.0);
    }
    let mut least = f64::INFINITY;
    for member in &source.members {
        let curve = solved(&member.joint, source.solve, None)?;
        least = least.min(answer(&curve, member.travel().load(source.end))?.force);
    }
    Ok(least)
}

/// Where the press fits open, over what the table is over.
pub fn openings(source: &Source) -> Result<Vec<f64>, Error> {
    let mut openings = Vec::new();
    for member in source.members.iter().filter(|member| member.joint.is_press_fit()) {
        let curve = solved(&member.joint, source.solve, None)?;
        if let Some(opening) = curve.opening() {
            let force = answer(&curve, Load::Offset(opening))?.force;
            openings.push(opening - source.ring_compliance * force);
        }
    }
    Ok(openings)
}

fn solved(joint: &JointDesign, solve: SolveOptions, before: Option<JointCurve>) -> Result<JointCurve, Error> {
    let what = || format!("radial_clearance {} mm", joint.radial_clearance);
    common_pool()?;
    JointCurve::after(before, joint, solve)
        .map_err(|failure| Error::Export { what: what(), problem: failure.to_string() })
}

fn answer(curve: &JointCurve, load: Load) -> Result<Response, Error> {
    let step = curve.answers(&[load]).pop();
    let (response, status) = step.map_or((None, None), |step| (step.response, Some(step.status)));
    match response {
        Some(response) => Ok(response),
        None => {
            let status = status.map_or(String::new(), |status| status.to_string());
            refuse(load.to_string(), format!("{status}: end the range before it (`--up-to`)"))
        }
    }
}

/// Solves joints one after the other; those that share their bodies cost little.
pub struct Solver<'a> {
    source: &'a Source,
    curve: Option<JointCurve>,
    pub worst: Worst,
    allow_warned: bool,
}

impl Solver<'_> {
    pub fn new(source: &Source, allow_warned: bool) -> Solver<'_> {
        Solver { source, curve: None, worst: Worst::default(), allow_warned }
    }

    /// A joint's curve at indentations from the reference; `member` is what the result has of it.
    pub fn sample(
        &mut self,
        joint: &JointDesign,
        member: Option<&Member>,
        places: &[f64],
    ) -> Result<Samples, Error> {
        let curve = solved(joint, self.source.solve, self.curve.take())?;
        if let Some(member) = member {
            self.compare(&curve, member)?;
        }
        let compliance = self.source.ring_compliance;
        // Against the support: by Newton's rule, indentation - compliance F(indentation) = place.
        let mut support = places.to_vec();
        for _ in 0..NEWTON_STEPS {
            if compliance == 0.0 {
                break;
            }
            let responses = self.respond(&curve, &support, None)?;
            let mut largest = 0.0_f64;
            for ((own, place), found) in support.iter_mut().zip(places).zip(&responses) {
                let off = place - (*own - compliance * found.force);
                let step = off / (1.0 - compliance * found.tangent_stiffness);
                largest = largest.max((step / *own).abs());
                *own += step;
            }
            if largest < 1e-12 {
                break;
            }
        }
        let responses = self.respond(&curve, &support, member)?;
        self.note(&responses);
        let stiffness = |found: &Response| 1.0 / (1.0 / found.tangent_stiffness - compliance);
        self.curve = Some(curve);
        Ok(Samples {
            force: responses.iter().map(|found| found.force).collect(),
            stiffness: responses.iter().map(stiffness).collect(),
        })
    }

    /// Remarks are refused where the result has rows, from the first of them on.
    fn respond(
        &self,
        curve: &JointCurve,
        indentations: &[f64],
        member: Option<&Member>,
    ) -> Result<Vec<Response>, Error> {
        let travel = Travel::of_force(curve.joint());
        let loads: Vec<Load> = indentations.iter().map(|delta| travel.load(*delta)).collect();
        let rows = member.into_iter().flat_map(|member| &member.rows);
        let first =
            rows.filter_map(|row| row.indentation).filter(|row| *row > 0.0).fold(f64::INFINITY, f64::min);
        let respond = |(step, delta): (StepOutcome, &f64)| {
            let is_refused = step.status != Status::OK && *delta >= first && !self.allow_warned;
            match step.response {
                Some(response) if !is_refused => Ok(response),
                found => {
                    let way_out =
                        if found.is_some() { ", or take it all the same (`--allow-warned`)" } else { "" };
                    let what = format!(
                        "radial_clearance {} mm, {} {delta} mm",
                        curve.joint().radial_clearance,
                        travel.name()
                    );
                    refuse(what, format!("{}: end the range before it (`--up-to`){way_out}", step.status))
                }
            }
        };
        curve.answers(&loads).into_iter().zip(indentations).map(respond).collect()
    }

    fn note(&mut self, responses: &[Response]) {
        let worst = &mut self.worst;
        worst.force_error = responses.iter().map(|found| found.force_error).fold(worst.force_error, f64::max);
        if let Some(last) = responses.last() {
            worst.linearity_error =
                worst.linearity_error.into_iter().chain(last.linearity_error).reduce(f64::max);
            if !worst.methods.contains(&last.method.name()) {
                worst.methods.push(last.method.name());
            }
        }
    }

    /// Refuses a result whose rows this program would not write.
    fn compare(&self, curve: &JointCurve, member: &Member) -> Result<(), Error> {
        let answered = member.rows.iter().filter_map(|row| Some((row, row.indentation?, row.force?)));
        let inside: Vec<_> = answered
            .filter(|(_, indentation, _)| *indentation > 0.0 && *indentation <= self.source.end)
            .collect();
        let loads: Vec<Load> = inside.iter().map(|(_, way, _)| member.travel().load(*way)).collect();
        for ((row, indentation, force), step) in inside.into_iter().zip(curve.answers(&loads)) {
            let own = row.force_error.unwrap_or(0.0) + self.source.solve.accuracy;
            let is_near = |found: Response| {
                (found.force - force).abs() <= AGREEMENT * (own + found.force_error) * force
            };
            if !step.response.is_some_and(is_near) {
                let found = match step.response {
                    Some(response) => format!("{} N", rounded(response.force, 6)),
                    None => step.status.to_string(),
                };
                let problem = format!(
                    "its row at {indentation} mm says {force} N, its curve made again {found}: run the config again"
                );
                return refuse(format!("design {}", member.design), problem);
            }
        }
        Ok(())
    }
}
