//! The points of a table: chosen from the joint's own curve so that the simulator's own rule between them stays
//! within an error.

use crate::engine::joint_curve::JointCurve;
use crate::engine::outcome::{Response, StepOutcome};
use crate::engine::status::Status;
use crate::error::Error;
use crate::output::export::interpolation::{Interpolant, Interpolation, cubic_weights};
use crate::output::export::numbers::rounded;
use crate::output::export::source::{Member, Source};
use crate::study::config::SolveOptions;
use crate::study::design::{JointDesign, Load};

/// Force and stiffness over indentation, for one clearance or several.
#[derive(Clone, Debug)]
pub struct Table {
    /// mm, ascending.
    pub clearances: Vec<f64>,
    /// mm, ascending, from 0 on.
    pub indentations: Vec<f64>,
    /// N, for each clearance.
    pub forces: Vec<Vec<f64>>,
    /// dF/d delta, N/mm, for each clearance: zero at 0, where the slope falls like 1/ln.
    pub stiffnesses: Vec<Vec<f64>>,
}

/// What is true of a table, measured against the curve where the table has no points.
#[derive(Clone, Debug)]
pub struct Quality {
    /// Relative to the force, from the first point above 0 on: the worst of the rules.
    pub of_force: f64,
    /// Relative to the stiffness, of Hermite's rule; `None` without it.
    pub of_stiffness: Option<f64>,
    /// Below the first point, relative to the force there.
    pub of_first: f64,
    /// Relative to the force half way between neighbouring clearances; `None` for one clearance.
    pub between: Option<f64>,
    /// Places where it was measured.
    pub places: usize,
    /// Largest of the curve.
    pub force_error: f64,
    /// At the largest indentation.
    pub linearity_error: Option<f64>,
    pub methods: Vec<&'static str>,
}

/// How a format goes from one clearance to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    Linear,
    /// The cubic through four neighbours, over ln(clearance) where none is zero.
    Cubic,
}

impl Table {
    /// The variable of `Between::Cubic`.
    pub fn over_logarithm(&self) -> bool {
        self.clearances[0] > 0.0
    }

    /// Force at a clearance between the table's, given those at its own.
    fn across(&self, between: Between, clearance: f64, force: impl Fn(usize) -> f64) -> f64 {
        let (first, weights) = match between {
            Between::Linear => {
                let above = self.clearances.partition_point(|own| *own <= clearance);
                let left = above.saturating_sub(1).min(self.clearances.len() - 2);
                let [low, high] = [self.clearances[left], self.clearances[left + 1]];
                let share = (clearance - low) / (high - low);
                (left, vec![1.0 - share, share])
            }
            Between::Cubic if self.over_logarithm() => {
                let nodes: Vec<f64> = self.clearances.iter().map(|clearance| clearance.ln()).collect();
                cubic_weights(&nodes, clearance.ln())
            }
            Between::Cubic => cubic_weights(&self.clearances, clearance),
        };
        weights.iter().enumerate().map(|(i, weight)| weight * force(first + i)).sum()
    }
}

/// The most points of an axis.
pub const MOST_POINTS: usize = 400;

/// The first point above zero, over the last.
const FIRST: f64 = 1e-6;

/// Places where curves are asked: every fourth may become a point, the other even ones choose them, and the odd
/// ones, which nothing has seen, measure what was reached.
const PLACES: usize = 2400;

/// Points at the start.
const SPARSEST: usize = 8;

/// What choosing aims at, of what is asked.
const AIM: f64 = 0.8;

/// The stiffness of Hermite's rule may be off by so many times the force.
const OF_STIFFNESS: f64 = 3.0;

/// A row of the result and the curve made again may differ by so many times their errors.
const AGREEMENT: f64 = 3.0;

/// A curve at the places.
struct Samples {
    force: Vec<f64>,
    stiffness: Vec<f64>,
}

/// Shares of the first point where the table is measured below it.
const BELOW: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

/// What many curves had at worst.
#[derive(Default)]
struct Worst {
    force_error: f64,
    linearity_error: Option<f64>,
    methods: Vec<&'static str>,
}

/// What a table is to be good for.
#[derive(Clone, Copy, Debug)]
pub struct Wish<'a> {
    pub rules: &'a [Interpolation],
    pub between: Between,
    /// Between points, mm.
    pub least_step: f64,
    /// Relative to the force.
    pub error: f64,
}

/// The first point above zero has at least so many least steps below it, so that the next ones may be that close.
const LEAST_STEPS: f64 = 12.0;

/// A table of some designs, good for every one of the rules to a relative error.
pub fn tabulate(
    source: &Source,
    Wish { rules, between, least_step, error }: Wish,
    allow_warned: bool,
) -> Result<(Table, Quality), Error> {
    let end = up(source.end - source.ring_compliance * reached_force(source)?);
    let first = FIRST.max(LEAST_STEPS * least_step / end);
    if first > 0.25 {
        let problem = format!(
            "{} mm is too short a range for this format, whose points are at least {least_step} mm apart",
            rounded(end, 6)
        );
        return refuse("range", problem);
    }
    let mut places: Vec<f64> =
        (0..=PLACES).map(|i| rounded(end * first.powf(1.0 - i as f64 / PLACES as f64), 6)).collect();
    places[PLACES] = end;
    let mut solver = Solver { source, curve: None, worst: Worst::default(), allow_warned };
    let (mut curves, mut below) = (Vec::new(), Vec::new());
    // Below the first place, in front of the others.
    let asked: Vec<f64> = BELOW.iter().map(|share| share * places[0]).chain(places.iter().copied()).collect();
    for member in &source.members {
        let mut curve = solver.sample(&member.joint, Some(member), &asked)?;
        below.push(curve.force.drain(..BELOW.len()).collect::<Vec<f64>>());
        curve.stiffness.drain(..BELOW.len());
        curves.push(curve);
    }
    let points = choose(&places, &curves, rules, least_step, error)?;
    let clearances = source.members.iter().map(|member| member.joint.radial_clearance).collect();
    let (table, mut quality) = measured(clearances, &places, &curves, &points, rules);
    for rule in rules {
        for (interpolant, truth) in table.interpolants(*rule).iter().zip(&below) {
            for (place, force) in asked.iter().zip(truth) {
                let off = (interpolant.at(*place).0 - force).abs() / interpolant.at(places[0]).0;
                quality.of_first = quality.of_first.max(off);
            }
        }
    }
    if table.clearances.len() > 1 {
        let mut worst = 0.0_f64;
        for pair in source.members.windows(2) {
            let [low, high] = [pair[0].joint.radial_clearance, pair[1].joint.radial_clearance];
            let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
            let joint = JointDesign { radial_clearance: middle, ..pair[0].joint };
            // A third of the places, the first of them odd.
            let some: Vec<usize> = (1..PLACES).step_by(9).collect();
            let asked: Vec<f64> = some.iter().map(|i| places[*i]).collect();
            let truth = solver.sample(&joint, None, &asked)?;
            for rule in rules {
                let interpolants = table.interpolants(*rule);
                for (place, force) in asked.iter().zip(&truth.force) {
                    let found = table.across(between, middle, |i| interpolants[i].at(*place).0);
                    worst = worst.max((found / force - 1.0).abs());
                }
            }
        }
        quality.between = Some(worst);
    }
    quality.force_error = solver.worst.force_error;
    quality.linearity_error = solver.worst.linearity_error;
    quality.methods = solver.worst.methods;
    Ok((table, quality))
}

/// With nine digits, not below the value.
fn up(value: f64) -> f64 {
    let near = rounded(value, 9);
    if near >= value { near } else { rounded(value * (1.0 + 1e-8), 9) }
}

/// The force that the ring's mean motion is taken off for at the end of the range: the least of the designs.
fn reached_force(source: &Source) -> Result<f64, Error> {
    if source.ring_compliance == 0.0 {
        return Ok(0.0);
    }
    let mut least = f64::INFINITY;
    for member in &source.members {
        let curve = solved(&member.joint, source.solve, None)?;
        let (response, _) = answer(&curve, Load::Indentation(source.end))?;
        least = least.min(response.force);
    }
    Ok(least)
}

fn refuse<T>(what: impl Into<String>, problem: impl Into<String>) -> Result<T, Error> {
    Err(Error::Export { what: what.into(), problem: problem.into() })
}

fn solved(joint: &JointDesign, solve: SolveOptions, before: Option<JointCurve>) -> Result<JointCurve, Error> {
    let curve = match before {
        Some(curve) => curve.into_other(joint, solve),
        None => JointCurve::new(joint, solve),
    };
    let what = || format!("radial_clearance {} mm", joint.radial_clearance);
    curve.map_err(|failure| Error::Export { what: what(), problem: failure.to_string() })
}

fn answer(curve: &JointCurve, load: Load) -> Result<(Response, Status), Error> {
    let step = curve.answers(&[load]).pop();
    match step.and_then(|step| step.response.map(|response| (response, step.status))) {
        Some(found) => Ok(found),
        None => {
            let status = step.map_or(String::new(), |step| step.status.to_string());
            refuse(load.to_string(), format!("{status}: end the range before it (`up-to`)"))
        }
    }
}

/// Solves joints one after the other; those that share their bodies cost little.
struct Solver<'a> {
    source: &'a Source,
    curve: Option<JointCurve>,
    worst: Worst,
    allow_warned: bool,
}

impl Solver<'_> {
    /// A joint's curve at indentations from the reference; `member` is what the result has of it.
    fn sample(
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
        let loads: Vec<Load> = indentations.iter().map(|delta| Load::Indentation(*delta)).collect();
        let rows = member.into_iter().flat_map(|member| &member.rows);
        let first =
            rows.filter_map(|row| row.indentation).filter(|row| *row > 0.0).fold(f64::INFINITY, f64::min);
        let respond = |(step, delta): (StepOutcome, &f64)| {
            let is_refused = step.status != Status::OK && *delta >= first && !self.allow_warned;
            match step.response {
                Some(response) if !is_refused => Ok(response),
                found => {
                    let way_out =
                        if found.is_some() { ", or take it all the same (`allow-warned`)" } else { "" };
                    let what = format!(
                        "radial_clearance {} mm, indentation {delta} mm",
                        curve.joint().radial_clearance
                    );
                    refuse(what, format!("{}: end the range before it (`up-to`){way_out}", step.status))
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
        let loads: Vec<Load> =
            inside.iter().map(|(_, indentation, _)| Load::Indentation(*indentation)).collect();
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

/// Of Newton's rule; it doubles the digits with each.
const NEWTON_STEPS: usize = 30;

/// Indices of places that become points: halves segments until all rules are good on all curves.
fn choose(
    places: &[f64],
    curves: &[Samples],
    rules: &[Interpolation],
    least_step: f64,
    error: f64,
) -> Result<Vec<usize>, Error> {
    let too_many = || {
        let percent = 100.0 * error;
        let problem = format!("{percent} % needs more than {MOST_POINTS} points: ask for a larger error");
        Error::Export { what: "error".into(), problem }
    };
    let too_close = || {
        let percent = 100.0 * error;
        let problem = format!(
            "{percent} % needs points closer than {least_step} mm, which this format does not take: ask for a larger error"
        );
        Error::Export { what: "error".into(), problem }
    };
    let mut aim = AIM * error;
    loop {
        let mut points: Vec<usize> = (0..=SPARSEST).map(|i| i * PLACES / SPARSEST).collect();
        loop {
            let mut bad = vec![false; points.len() - 1];
            let off = |i: usize, force: f64, slope: f64| {
                if i.is_multiple_of(2) && force.max(slope / OF_STIFFNESS) > aim {
                    bad[points.partition_point(|point| *point < i) - 1] = true;
                }
            };
            deviations(places, curves, rules, &points, off);
            if !bad.contains(&true) {
                break;
            }
            let mut finer = vec![points[0]];
            for (pair, is_bad) in points.windows(2).zip(bad) {
                let middle = (pair[0] + pair[1]) / 8 * 4;
                if is_bad && middle == pair[0] {
                    return Err(too_many());
                }
                let steps = [places[middle] - places[pair[0]], places[pair[1]] - places[middle]];
                if is_bad && steps.into_iter().any(|step| step < least_step) {
                    return Err(too_close());
                }
                finer.extend(is_bad.then_some(middle));
                finer.push(pair[1]);
            }
            points = finer;
            // With zero and the gap's.
            if points.len() + 3 > MOST_POINTS {
                return Err(too_many());
            }
        }
        let mut worst = 0.0_f64;
        deviations(places, curves, rules, &points, |i, force, slope| {
            if i % 2 == 1 {
                worst = worst.max(force).max(slope / OF_STIFFNESS);
            }
        });
        if worst <= error {
            return Ok(points);
        }
        aim *= 0.5;
    }
}

/// Tells the relative deviations of force and (of Hermite's rule) stiffness at every place that is no point.
fn deviations(
    places: &[f64],
    curves: &[Samples],
    rules: &[Interpolation],
    points: &[usize],
    mut tell: impl FnMut(usize, f64, f64),
) {
    for curve in curves {
        let (x, y, slopes) = with_gap(places, curve, points);
        for rule in rules {
            let interpolant = Interpolant::new(*rule, &x, &y, &slopes);
            for i in (0..places.len()).filter(|i| points.binary_search(i).is_err()) {
                let (force, slope) = interpolant.at(places[i]);
                let of_slope = match rule {
                    Interpolation::Hermite => (slope / curve.stiffness[i] - 1.0).abs(),
                    _ => 0.0,
                };
                tell(i, (force / curve.force[i] - 1.0).abs(), of_slope);
            }
        }
    }
}

/// Rows of the gap, zero and the points, as they are written.
fn with_gap(places: &[f64], curve: &Samples, points: &[usize]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let end = places[places.len() - 1];
    let at = |values: &[f64]| -> Vec<f64> { points.iter().map(|i| rounded(values[*i], 9)).collect() };
    let x = [-end, -0.5 * end, 0.0].into_iter().chain(points.iter().map(|i| places[*i])).collect();
    let y = [0.0; 3].into_iter().chain(at(&curve.force)).collect();
    let slopes = [0.0; 3].into_iter().chain(at(&curve.stiffness)).collect();
    (x, y, slopes)
}

fn measured(
    clearances: Vec<f64>,
    places: &[f64],
    curves: &[Samples],
    points: &[usize],
    rules: &[Interpolation],
) -> (Table, Quality) {
    let (mut of_force, mut of_stiffness, mut count) = (0.0_f64, 0.0_f64, 0);
    deviations(places, curves, rules, points, |i, force, slope| {
        if i % 2 == 1 {
            of_force = of_force.max(force);
            of_stiffness = of_stiffness.max(slope);
            count += 1;
        }
    });
    let rows = |values: fn(&Samples) -> &[f64]| -> Vec<Vec<f64>> {
        let row = |curve: &Samples| {
            let own = points.iter().map(|i| rounded(values(curve)[*i], 9));
            std::iter::once(0.0).chain(own).collect()
        };
        curves.iter().map(row).collect()
    };
    let table = Table {
        clearances,
        indentations: std::iter::once(0.0).chain(points.iter().map(|i| places[*i])).collect(),
        forces: rows(|curve| &curve.force),
        stiffnesses: rows(|curve| &curve.stiffness),
    };
    let quality = Quality {
        of_force,
        of_stiffness: rules.contains(&Interpolation::Hermite).then_some(of_stiffness),
        of_first: 0.0,
        between: None,
        places: count,
        force_error: 0.0,
        linearity_error: None,
        methods: Vec::new(),
    };
    (table, quality)
}

impl Table {
    /// Of each clearance.
    pub fn interpolants(&self, rule: Interpolation) -> Vec<Interpolant<'_>> {
        let of = |i: usize| Interpolant::new(rule, &self.indentations, &self.forces[i], &self.stiffnesses[i]);
        (0..self.clearances.len()).map(of).collect()
    }
}
