//! The designs whose curves are drawn: named ones, or a handful spread over the sweep; their curves made again.

use super::laws::{DrawnLaw, calibrated, published};
use super::sample::{Row, SampledDesign};
use super::scan::Scan;
use super::tallies::Value;
use crate::engine::outcome::Response;
use crate::joint::{Curve, Joint};
use crate::output::chart::axis::range;
use crate::output::chart::text::number;
use crate::output::travel::Travel;
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
    pub travel: Travel,
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

/// Whether curves are drawn on logarithmic axes; not those of press fits, which begin in a straight line through zero.
pub fn is_log(chosen: &[Chosen]) -> bool {
    let answered = || chosen.iter().flat_map(|one| one.answered());
    let ratio = |values: Vec<f64>| {
        let (low, high) = range(values.into_iter()).unwrap_or((1.0, 1.0));
        if low > 0.0 { high / low } else { 1.0 }
    };
    let loads = ratio(answered().map(|row| row.way).collect());
    let ends = ratio(chosen.iter().filter_map(|one| one.design.last()).map(|(row, _)| row.force).collect());
    let widths = ratio(chosen.iter().filter_map(|one| one.design.last()).map(|(row, _)| row.way).collect());
    let has_press_fits = chosen.iter().any(|one| one.design.joint.is_press_fit());
    !has_press_fits && (loads >= LOG_FROM || ends >= LOG_FROM || widths >= LOG_FROM)
}

impl Chosen {
    pub fn answered(&self) -> impl Iterator<Item = Row> {
        self.design.rows.iter().filter(|row| row.answer.is_some()).copied()
    }

    pub fn name(&self) -> String {
        format!("design {}", self.design.number)
    }

    /// The pin's way and the force along the curve; from the rows where there is no curve.
    pub fn points(&self) -> Vec<(f64, f64)> {
        if self.curve.is_empty() {
            return self.answered().map(|row| (row.way, row.force)).collect();
        }
        self.curve.iter().map(|response| (self.travel.of(response), response.force)).collect()
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
            travel: scan.travel,
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
        Some(row.force / row.way).filter(|secant| secant.is_finite())
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
            let low = if log { first.way } else { 0.0 };
            self.curve = responses(&curve, self.travel, (low, last.way), log);
            let pressure = curve.pressure(self.travel.load(last.way), PRESSURE_POINTS);
            self.pressure = pressure.unwrap_or_default();
            for point in &mut self.pressure {
                point.0 = point.0.to_degrees();
            }
        }
        // Judged where the rows are.
        let mut points = self.points();
        let joint = &self.design.joint;
        let indentation = |way: f64| self.travel.indentation(way, joint);
        points.iter_mut().for_each(|point| point.0 = indentation(point.0));
        points.retain(|point| point.0 >= 0.999 * indentation(first.way) && point.0 > 0.0 && point.1 > 0.0);
        let positive = self.answered().map(|row| indentation(row.way)).filter(|value| *value > 0.0);
        if let Some(working) = range(positive).filter(|_| !joint.is_press_fit()) {
            (self.laws, self.why_recommended) = calibrated(joint, working, options);
        }
        let others = published(joint, &points);
        self.laws.extend(others);
        problem.map_or(Ok(()), Err)
    }
}

/// Along the curve up to `high`, mm: evenly in the logarithm, or denser where it begins.
fn responses(curve: &Curve, travel: Travel, (low, high): (f64, f64), log: bool) -> Vec<Response> {
    let at = |i: usize| {
        let share = i as f64 / POINTS as f64;
        if log && low > 0.0 { low * (high / low).powf(share) } else { high * share * share }
    };
    // Press fits begin with contact all around, the others with none.
    let is_closed = curve.joint().design().is_press_fit();
    let mut ways: Vec<f64> = (0..=POINTS).map(at).filter(|value| *value > 0.0 || is_closed).collect();
    ways.dedup();
    let loads: Vec<Load> = ways.into_iter().map(|way| travel.load(way)).collect();
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
