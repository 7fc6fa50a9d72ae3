//! Force, stiffness and contact angle of the chosen designs.

use super::chosen::{Chosen, inputs_in_words, is_log};
use super::html::{self, Cell, charts, figure};
use super::sample::{Answer, Row};
use super::{Report, laws::DrawnLaw};
use crate::engine::outcome::Response;
use crate::output::chart::text::number;
use crate::output::chart::{Axis, LineChart, Marking, Series};

/// The most rows of a design that are drawn as points.
const MOST_POINTS: usize = 40;
/// Of laws over curves: the last one, which the first designs do not have.
const LAW_COLOUR: usize = crate::output::chart::style::COLOURS - 1;
/// Values that reach further than this are drawn on a logarithmic axis.
const LOG_FROM: f64 = 30.0;

pub fn section(report: &Report) -> String {
    let chosen = &report.chosen;
    let mut content = html::paragraph(&introduction(report));
    content += &key(report);
    let log = is_log(chosen);
    let curves = [
        Quantity {
            caption: "Force",
            unit: "N",
            name: "force",
            of_response: |response| response.force,
            of_row: |row| row.force,
        },
        Quantity {
            caption: "Tangent stiffness",
            unit: "N/mm",
            name: "tangent stiffness",
            of_response: |response| response.tangent_stiffness,
            of_row: |row| row.answer.map_or(f64::NAN, |answer| answer.stiffness),
        },
        Quantity {
            caption: "Contact half angle",
            unit: "deg",
            name: "contact half angle",
            of_response: |response| response.contact_half_angle.map_or(f64::NAN, f64::to_degrees),
            of_row: |row| row.answer.map_or(f64::NAN, |answer| answer.half_angle),
        },
        Quantity {
            caption: "Peak pressure",
            unit: "MPa",
            name: "peak pressure",
            of_response: |response| response.peak_pressure.unwrap_or(f64::NAN),
            of_row: |row| row.answer.map_or(f64::NAN, |answer| answer.peak_pressure),
        },
    ];
    let figures: Vec<String> = curves.iter().filter_map(|quantity| quantity.figure(chosen, log)).collect();
    if figures.is_empty() {
        content += &html::paragraph("None of these designs has a row with an answer, so there is no curve.");
    }
    html::section("Curves", &(content + &charts(&figures)))
}

fn introduction(report: &Report) -> String {
    let count = report.chosen.len();
    let which = if report.named {
        "The designs that were asked for"
    } else if count as u64 == report.scan.designs {
        "All designs of the sweep"
    } else {
        "Designs spread over the sweep, from the softest to the stiffest by force over indentation under their last load"
    };
    let mut text = format!("{which}. Lines are the joint's own curve, circles the rows of the table");
    let calibrated = |one: &Chosen| one.laws.iter().any(|law| law.calibrated && law.recommended);
    if report.chosen.iter().any(calibrated) {
        text += ", grey dashes the law that is recommended for each joint";
    }
    text + "."
}

/// Which colour is which design, and what tells it from the others: a column a design.
fn key(report: &Report) -> String {
    let chosen = &report.chosen;
    let head = [Cell::Words("design".into())].into_iter();
    let head: Vec<Cell> =
        head.chain(chosen.iter().map(|one| Cell::Key(one.place, one.design.number.to_string()))).collect();
    let mut rows = Vec::new();
    let mut add = |name: String, values: Vec<String>| {
        let cells = [Cell::Words(name)].into_iter().chain(values.into_iter().map(Cell::Number));
        rows.push(cells.collect::<Vec<_>>());
    };
    let inputs: Vec<Vec<(String, String)>> =
        chosen.iter().map(|one| inputs_in_words(&report.scan, &one.design)).collect();
    for place in 0..inputs.first().map_or(0, Vec::len) {
        let name = inputs[0][place].0.clone();
        add(name, inputs.iter().filter_map(|one| one.get(place)).map(|(_, value)| value.clone()).collect());
    }
    let last = |value: fn(&Row, &Answer) -> f64| -> Vec<String> {
        let cell = |one: &Chosen| one.design.last().map(|(row, answer)| value(&row, &answer));
        chosen
            .iter()
            .map(|one| cell(one).map_or_else(|| "\u{2013}".into(), |value| number(value, 4)))
            .collect()
    };
    add(format!("last {}", report.scan.travel.label()), last(|row, _| row.way));
    add("force there, N".into(), last(|row, _| row.force));
    add("tangent stiffness there, N/mm".into(), last(|_, answer| answer.stiffness));
    let failed = |one: &Chosen| one.design.failed;
    if chosen.iter().any(|one| failed(one) > 0) {
        add("rows without an answer".into(), chosen.iter().map(|one| failed(one).to_string()).collect());
    }
    let mut html = html::table_of(&head, &rows);
    for one in chosen {
        if let Some(problem) = &one.problem {
            html +=
                &html::remark(&format!("Design {} has no curve of its own: {problem}.", one.design.number));
        }
    }
    html
}

struct Quantity {
    caption: &'static str,
    name: &'static str,
    unit: &'static str,
    of_response: fn(&Response) -> f64,
    of_row: fn(&Row) -> f64,
}

impl Quantity {
    fn figure(&self, chosen: &[Chosen], log: bool) -> Option<String> {
        let (mut series, mut laws) = (Vec::new(), Vec::new());
        for one in chosen {
            let mut curve: Vec<(f64, f64)> = one
                .curve
                .iter()
                .map(|response| (one.travel.of(response), (self.of_response)(response)))
                .collect();
            let rows: Vec<(f64, f64)> = one.answered().map(|row| (row.way, (self.of_row)(&row))).collect();
            if curve.is_empty() {
                curve = rows.clone();
            }
            curve.retain(|point| point.1.is_finite());
            if curve.is_empty() {
                continue;
            }
            if !log && curve[0].0 > 0.0 && !one.curve.is_empty() {
                curve.insert(0, (0.0, 0.0));
            }
            series.push(Series::new(one.name(), one.place, Marking::Line, curve));
            let stride = rows.len().div_ceil(MOST_POINTS).max(1);
            let points = rows.iter().rev().step_by(stride).copied().collect();
            series.push(Series::new("", one.place, Marking::Points, points));
            // Over the curve, as far as both can be seen.
            if self.unit == "N" {
                let drawn = one.laws.iter().filter(|law| law.calibrated && law.recommended);
                laws.extend(drawn.map(|law| dashes(law, one)));
            }
        }
        if let Some(first) = laws.first_mut() {
            first.name = "recommended law".into();
        }
        series.extend(laws);
        let (unit, factor) =
            readable(self.unit, series.iter().flat_map(|one| one.points.iter().map(|p| p.1)));
        for point in series.iter_mut().flat_map(|one| &mut one.points) {
            point.1 *= factor;
        }
        let xs = || series.iter().flat_map(|one| one.points.iter().map(|point| point.0));
        let ys = || series.iter().flat_map(|one| one.points.iter().map(|point| point.1));
        let name = format!("{}, {unit}", self.name);
        let far = crate::output::chart::axis::range(ys().filter(|y| *y > 0.0))
            .is_some_and(|(low, high)| high / low > LOG_FROM);
        // Angles end at 90 degrees: their axis is always linear.
        let y = if log && far && self.unit != "deg" {
            Axis::log(&name, ys())
        } else {
            Axis::from_zero(&name, ys())
        };
        let travel = chosen.first()?.travel;
        let label = travel.label();
        let x = if log { Axis::log(&label, xs()) } else { Axis::from_zero(&label, xs()) };
        if series.is_empty() {
            return None;
        }
        let caption = format!("{} against {}", self.caption, travel.name());
        let chart = LineChart { title: caption.clone(), x, y, series, limits: Vec::new() };
        Some(figure(&caption, "", &chart.svg()))
    }
}

/// A unit whose numbers are short, and what values are multiplied by.
pub fn readable(unit: &str, values: impl Iterator<Item = f64>) -> (String, f64) {
    let greatest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    match unit {
        "N" | "N/mm" if greatest >= 2e7 => (unit.replacen('N', "MN", 1), 1e-6),
        "N" | "N/mm" if greatest >= 2e4 => (unit.replacen('N', "kN", 1), 1e-3),
        "MPa" if greatest >= 2e4 => ("GPa".into(), 1e-3),
        _ => (unit.into(), 1.0),
    }
}

fn dashes(law: &DrawnLaw, one: &Chosen) -> Series {
    let force = |way: f64| (law.force)(one.travel.indentation(way, &one.design.joint));
    let points = one.points().into_iter().map(|(way, _)| (way, force(way)));
    Series::new("", LAW_COLOUR, Marking::Dashed, points.filter(|point| point.1.is_finite()).collect())
}
