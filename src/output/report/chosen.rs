//! The designs whose curves are drawn: named ones, or a handful spread over the sweep; their curves made again.

use super::laws::{DrawnLaw, calibrated, published};
use super::sample::{Row, SampledDesign};
use super::scan::Scan;
use super::tallies::Value;
use crate::engine::outcome::Response;
use crate::joint::{Curve, Joint};
use crate::output::chart::axis::range;
use crate::output::chart::text::number;
use crate::study::config::SolveOptions;
use crate::study::design::Load;

/// How many are chosen where none is named.
const HANDFUL: usize = 5;
/// Points of a curve.
const POINTS: usize = 120;
const PRESSURE_POINTS: usize = 80;
/// Loads or forces that are further apart than this are drawn on logarithmic axes.
const LOG_FROM: f64 = 30.0;

/// A design with all that is drawn of it.
pub struct Chosen {
    pub design: SampledDesign,
    /// Its colour.
    pub place: usize,
    /// From the joint's own curve; empty where it has none.
    pub curve: Vec<Response>,
    /// Angle, deg, and pressure, MPa, at the last answered load.
    pub pressure: Vec<(f64, f64)>,
    /// Calibrated ones first.
    pub laws: Vec<DrawnLaw>,
    pub why_recommended: Option<&'static str>,
    /// Why there is no curve of its own.
    pub problem: Option<String>,
}

/// Whether curves are drawn on logarithmic axes.
pub fn is_log(chosen: &[Chosen]) -> bool {
    let answered = || chosen.iter().flat_map(|one| one.answered());
    let ratio = |values: Vec<f64>| {
        let (low, high) = range(values.into_iter()).unwrap_or((1.0, 1.0));
        if low > 0.0 { high / low } else { 1.0 }
    };
    let loads = ratio(answered().map(|row| row.indentation).collect());
    let ends = ratio(chosen.iter().filter_map(|one| one.design.last()).map(|(row, _)| row.force).collect());
    let widths =
        ratio(chosen.iter().filter_map(|one| one.design.last()).map(|(row, _)| row.indentation).collect());
    loads >= LOG_FROM || ends >= LOG_FROM || widths >= LOG_FROM
}

impl Chosen {
    pub fn answered(&self) -> impl Iterator<Item = Row> {
        self.design.rows.iter().filter(|row| row.answer.is_some()).copied()
    }

    pub fn name(&self) -> String {
        format!("design {}", self.design.number)
    }

    /// Indentation and force along the curve; from the rows where there is no curve.
    pub fn points(&self) -> Vec<(f64, f64)> {
        if self.curve.is_empty() {
            return self.answered().map(|row| (row.indentation, row.force)).collect();
        }
        self.curve.iter().map(|response| (response.indentation, response.force)).collect()
    }
}

/// `named` designs, or a handful by their stiffness under the largest load.
pub fn choose(scan: &Scan, named: &[u64], options: SolveOptions) -> Vec<Chosen> {
    let designs: Vec<SampledDesign> = if named.is_empty() {
        spread(scan)
    } else {
        named.iter().filter_map(|number| scan.named.get(number).cloned()).collect()
    };
    let mut chosen: Vec<Chosen> = designs
        .into_iter()
        .enumerate()
        .map(|(place, design)| Chosen {
            design,
            place,
            curve: Vec::new(),
            pressure: Vec::new(),
            laws: Vec::new(),
            why_recommended: None,
            problem: None,
        })
        .collect();
    let log = is_log(&chosen);
    for one in &mut chosen {
        if let Err(problem) = one.solve(options, log) {
            one.problem = Some(problem);
        }
    }
    chosen
}

/// Evenly over the order of F/delta under the last load: as good an order of forces where indentations are asked as of
/// indentations where forces are.
fn spread(scan: &Scan) -> Vec<SampledDesign> {
    let secant = |design: &SampledDesign| {
        let row = design.last()?.0;
        Some(row.force / row.indentation).filter(|secant| secant.is_finite())
    };
    let mut ordered: Vec<(f64, &SampledDesign)> =
        scan.sample.iter().filter_map(|design| Some((secant(design)?, design))).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.number.cmp(&b.1.number)));
    let count = ordered.len().min(HANDFUL);
    let place = |i: usize| if count < 2 { 0 } else { i * (ordered.len() - 1) / (count - 1) };
    let mut designs: Vec<SampledDesign> = (0..count).map(|i| ordered[place(i)].1.clone()).collect();
    if designs.is_empty() {
        // All have failed: their rows say why.
        designs.extend(scan.sample.first().cloned());
    }
    designs
}

impl Chosen {
    /// Makes the curve, the pressure and the laws; an error says in words why there is no curve.
    fn solve(&mut self, options: SolveOptions, log: bool) -> Result<(), String> {
        let Some((last, _)) = self.design.last() else {
            return Err(self.design.failure.clone().unwrap_or_else(|| "no row has an answer".into()));
        };
        let first = self.answered().next().unwrap_or(last);
        let own = Joint::try_from(self.design.joint.clone()).and_then(|joint| joint.curve(options));
        let (own, problem) = match own {
            Ok(curve) => (Some(curve), None),
            Err(error) => (None, Some(error.to_string())),
        };
        if let Some(curve) = own {
            let low = if log { first.indentation } else { 0.0 };
            self.curve = responses(&curve, low, last.indentation, log);
            let pressure = curve.pressure(Load::Indentation(last.indentation), PRESSURE_POINTS);
            self.pressure = pressure.unwrap_or_default();
            for point in &mut self.pressure {
                point.0 = point.0.to_degrees();
            }
        }
        // Judged where the rows are.
        let mut points = self.points();
        points.retain(|point| point.0 >= 0.999 * first.indentation && point.0 > 0.0 && point.1 > 0.0);
        let positive = self.answered().map(|row| row.indentation).filter(|value| *value > 0.0);
        if let Some(working) = range(positive) {
            (self.laws, self.why_recommended) = calibrated(&self.design.joint, working, options);
        }
        self.laws.extend(published(&self.design.joint, &points));
        problem.map_or(Ok(()), Err)
    }
}

/// Along the curve up to `high`, mm: evenly in the logarithm, or denser where it begins.
fn responses(curve: &Curve, low: f64, high: f64, log: bool) -> Vec<Response> {
    let at = |i: usize| {
        let share = i as f64 / POINTS as f64;
        if log && low > 0.0 { low * (high / low).powf(share) } else { high * share * share }
    };
    let mut indentations: Vec<f64> = (0..=POINTS).map(at).filter(|value| *value > 0.0).collect();
    indentations.dedup();
    let loads: Vec<Load> = indentations.into_iter().map(Load::Indentation).collect();
    let answers = curve.answers(&loads).unwrap_or_default();
    answers.into_iter().filter_map(|step| step.response).collect()
}

/// What tells a design from others: its varied inputs in words.
pub fn inputs_in_words(scan: &Scan, design: &SampledDesign) -> Vec<(String, String)> {
    let varied = scan.inputs.iter().zip(&design.inputs).filter(|(input, _)| input.varies());
    varied
        .map(|(input, value)| {
            let unit = if input.unit == "-" { String::new() } else { format!(", {}", input.unit) };
            let value = match value {
                Value::Number(value) => number(*value, 4),
                Value::Word(word) => word.clone(),
                Value::Empty => "\u{2013}".into(),
            };
            (format!("{}{unit}", input.name), value)
        })
        .collect()
}
