//! The forces of a joint at measured indentations, and their derivatives by what is fitted.
//!
//! A measured indentation u holds the zero offset u0, the descent delta of the pin and what a support of compliance C gives way:
//! u - u0 = delta + C F with F = f(delta), the joint's own curve.

use crate::calibrate::least_squares::Problem;
use crate::calibrate::unknown::Unknown;
use crate::engine::outcome::{Response, StepOutcome};
use crate::engine::status::Status;
use crate::error::Error;
use crate::joint::{Curve, Joint, Options};
use crate::study::design::{JointDesign, Load};
use crate::study::measured::MeasuredPoint;

/// A joint with what is around it in the measurement.
#[derive(Clone, Debug)]
pub struct Setup {
    pub joint: JointDesign,
    /// C, mm/N.
    pub support_compliance: f64,
    /// u0, mm.
    pub zero_offset: f64,
}

impl Setup {
    pub fn get(&self, unknown: Unknown) -> f64 {
        let mut setup = self.clone();
        *setup.slot(unknown)
    }

    pub fn slot(&mut self, unknown: Unknown) -> &mut f64 {
        match unknown {
            Unknown::SupportCompliance => &mut self.support_compliance,
            Unknown::ZeroOffset => &mut self.zero_offset,
            Unknown::PlateYoungsModulus => &mut self.joint.plate.material.youngs_modulus,
            Unknown::PinYoungsModulus => &mut self.joint.pin.material.youngs_modulus,
            Unknown::RadialClearance => &mut self.joint.radial_clearance,
        }
    }

    /// The joint's curve, after that of another setup: bodies that both have are not solved again.
    pub fn curve_after(&self, before: Option<Curve>, options: Options) -> Result<Curve, Error> {
        Joint::try_from(self.joint.clone())?.curve_after(before, options)
    }

    /// What the joint answers at measured indentations; an error where there is no answer. Before first touch there is nothing.
    pub fn answers(&self, curve: &Curve, indentations: &[f64]) -> Result<Vec<Option<StepOutcome>>, Error> {
        let reach: Vec<f64> = indentations.iter().map(|indentation| indentation - self.zero_offset).collect();
        let touching: Vec<usize> = (0..reach.len()).filter(|place| reach[*place] > 0.0).collect();
        let mut descents: Vec<f64> = touching.iter().map(|place| reach[*place]).collect();
        let mut steps = Vec::new();
        for _ in 0..MOST_NEWTON_STEPS {
            let loads: Vec<Load> = descents.iter().map(|descent| Load::Indentation(*descent)).collect();
            steps = curve.answers(&loads)?;
            if self.support_compliance == 0.0 {
                break;
            }
            let mut greatest_change: f64 = 0.0;
            for ((place, descent), step) in touching.iter().zip(&mut descents).zip(&steps) {
                // Without an answer where the support does not give way at all: the descent is less.
                let change = match step.response {
                    None => 0.5 * *descent,
                    Some(response) => {
                        let excess = *descent + self.support_compliance * response.force - reach[*place];
                        let slope = 1.0 + self.support_compliance * response.tangent_stiffness;
                        if slope <= 0.0 {
                            return Err(no_answer(
                                "the support compliance is negative beyond the joint's own",
                            ));
                        }
                        excess / slope
                    }
                };
                let next = (*descent - change).max(1e-3 * *descent);
                greatest_change = greatest_change.max((next / *descent - 1.0).abs());
                *descent = next;
            }
            if greatest_change < NEWTON_TOLERANCE {
                break;
            }
        }
        let mut answers = vec![None; indentations.len()];
        for ((place, step), descent) in touching.into_iter().zip(steps).zip(descents) {
            if step.response.is_none() {
                let Status::Failed(failure) = step.status else { return Err(no_answer("no state")) };
                return Err(no_answer(&format!("at an indentation of {descent} mm: {failure}")));
            }
            answers[place] = Some(step);
        }
        Ok(answers)
    }

    /// Forces at measured indentations, N.
    pub fn forces(&self, curve: &Curve, indentations: &[f64]) -> Result<Vec<f64>, Error> {
        let answers = self.answers(curve, indentations)?;
        let force = |step: StepOutcome| step.response.map_or(0.0, |response| response.force);
        Ok(answers.into_iter().map(|step| step.map_or(0.0, force)).collect())
    }
}

/// Newton's method squares the error, and the force is a convex function of the indentation: five steps are the rule.
const MOST_NEWTON_STEPS: usize = 60;
/// Relative change of the descent.
const NEWTON_TOLERANCE: f64 = 1e-12;

fn no_answer(problem: &str) -> Error {
    Error::Calibration { problem: problem.to_string() }
}

struct Solved {
    scaled: Vec<f64>,
    setup: Setup,
    /// Of each point; `None` before first touch.
    responses: Vec<Option<Response>>,
}

/// Measured points against a setup whose unknowns are scaled: logarithms of what is positive, the others over a typical size.
pub struct Fit<'a> {
    start: Setup,
    unknowns: &'a [Unknown],
    options: Options,
    indentations: Vec<f64>,
    points: &'a [MeasuredPoint],
    /// Of an indentation and of a compliance in the measurement.
    scale: [f64; 2],
    /// The last setup that was solved: derivatives are asked where residuals were.
    last: Option<Solved>,
    /// The last curve: the next one needs its bodies.
    curve: Option<Curve>,
    /// Why the last setup had no answer.
    pub problem: Option<Error>,
}

impl<'a> Fit<'a> {
    pub fn new(
        start: Setup,
        unknowns: &'a [Unknown],
        options: Options,
        points: &'a [MeasuredPoint],
    ) -> Fit<'a> {
        let greatest = |of: fn(&MeasuredPoint) -> f64| points.iter().map(of).fold(0.0, f64::max);
        let indentation = greatest(|point| point.indentation.abs()).max(f64::MIN_POSITIVE);
        let force = greatest(|point| point.force).max(f64::MIN_POSITIVE);
        Fit {
            start,
            unknowns,
            options,
            indentations: points.iter().map(|point| point.indentation).collect(),
            points,
            scale: [indentation, indentation / force],
            last: None,
            curve: None,
            problem: None,
        }
    }

    /// The scaled unknowns of the start.
    pub fn scaled_start(&self) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| self.scaled(*unknown, self.start.get(*unknown))).collect()
    }

    /// What one scaled unit is in the unknown's own, at a value; `None` for logarithms.
    fn unit(&self, unknown: Unknown) -> Option<f64> {
        match unknown {
            Unknown::ZeroOffset => Some(self.scale[0]),
            Unknown::SupportCompliance => Some(self.scale[1]),
            _ => None,
        }
    }

    fn scaled(&self, unknown: Unknown, value: f64) -> f64 {
        self.unit(unknown).map_or_else(|| value.ln(), |unit| value / unit)
    }

    pub fn value(&self, unknown: Unknown, scaled: f64) -> f64 {
        self.unit(unknown).map_or_else(|| scaled.exp(), |unit| scaled * unit)
    }

    pub fn setup(&self, scaled: &[f64]) -> Setup {
        let mut setup = self.start.clone();
        for (unknown, scaled) in self.unknowns.iter().zip(scaled) {
            *setup.slot(*unknown) = self.value(*unknown, *scaled);
        }
        setup
    }

    fn weight(point: &MeasuredPoint) -> f64 {
        1.0 / point.sigma.unwrap_or(1.0)
    }

    fn solve(&mut self, scaled: &[f64]) -> Result<Vec<f64>, Error> {
        let setup = self.setup(scaled);
        let curve = setup.curve_after(self.curve.take(), self.options)?;
        let answers = setup.answers(&curve, &self.indentations);
        self.curve = Some(curve);
        let answers = answers?;
        let responses: Vec<_> =
            answers.iter().map(|step| step.as_ref().and_then(|step| step.response)).collect();
        let forces =
            responses.iter().map(|response| response.map_or(0.0, |response| response.force)).collect();
        self.last = Some(Solved { scaled: scaled.to_vec(), setup, responses });
        Ok(forces)
    }
}

/// A step of a logarithm, for central differences: their error is of its square.
const STEP: f64 = 1e-3;

impl Problem for Fit<'_> {
    fn residuals(&mut self, scaled: &[f64]) -> Option<Vec<f64>> {
        match self.solve(scaled) {
            Ok(forces) => {
                let of = |(point, force): (&MeasuredPoint, f64)| (force - point.force) * Self::weight(point);
                Some(self.points.iter().zip(forces).map(of).collect())
            }
            Err(error) => {
                self.problem = Some(error);
                None
            }
        }
    }

    /// With the descent delta held, dF = (df + k dw - k F dC)/(1 + k C) for w = u - u0.
    fn derivatives(&mut self, scaled: &[f64]) -> Option<Vec<Vec<f64>>> {
        if self.last.as_ref().is_none_or(|last| last.scaled != scaled) {
            self.solve(scaled).ok()?;
        }
        let mut before = self.curve.take();
        let Solved { setup, responses, .. } = self.last.as_ref()?;
        let loads: Vec<Load> =
            responses.iter().flatten().map(|response| Load::Indentation(response.indentation)).collect();
        let mut columns = Vec::new();
        for unknown in self.unknowns {
            // df of each point in contact, in their order.
            let own: Vec<f64> = match self.unit(*unknown) {
                Some(_) => vec![0.0; loads.len()],
                None => {
                    let mut sides = [1.0, -1.0].into_iter().map(|sign: f64| {
                        let mut moved = setup.clone();
                        *moved.slot(*unknown) *= (sign * STEP).exp();
                        let curve = moved.curve_after(before.take(), self.options).ok()?;
                        let steps = before.insert(curve).answers(&loads).ok()?;
                        steps.into_iter().map(|step| Some(step.response?.force)).collect::<Option<Vec<f64>>>()
                    });
                    let (above, below) = (sides.next()??, sides.next()??);
                    above
                        .into_iter()
                        .zip(below)
                        .map(|(above, below)| (above - below) / (2.0 * STEP))
                        .collect()
                }
            };
            let mut own = own.into_iter();
            let slope = |(point, response): (&MeasuredPoint, &Option<Response>)| {
                let Some(response) = response else { return 0.0 };
                let stiffness = response.tangent_stiffness;
                let change = match unknown {
                    Unknown::ZeroOffset => -stiffness * self.scale[0],
                    Unknown::SupportCompliance => -stiffness * response.force * self.scale[1],
                    _ => own.next().unwrap_or(0.0),
                };
                change / (1.0 + stiffness * setup.support_compliance) * Self::weight(point)
            };
            columns.push(self.points.iter().zip(responses).map(slope).collect());
        }
        self.curve = before;
        Some(columns)
    }
}
