//! What was asked and what came of it, in a paragraph and a row of figures.

use super::curves::readable;
use super::html::facts;
use super::scan::Scan;
use super::tallies::{Extremes, Input};
use super::{Report, html};
use crate::output::chart::text::{escaped, number, percent, plural};
use crate::study::columns::Column;

pub fn section(report: &Report) -> String {
    let scan = &report.scan;
    let mut html = format!("<header>\n<h1>{}</h1>\n", escaped(&report.title));
    html += &html::paragraph(&sentence(report));
    html += "</header>\n";
    let span = |extremes: &Extremes, unit: &str| extremes.range().map(|range| with_unit(range, unit));
    let mut all = vec![
        ("designs", scan.designs.to_string()),
        ("rows with an answer", format!("{} of {}", scan.answered, scan.rows)),
    ];
    let mut add = |name, value: Option<String>| all.extend(value.map(|value| (name, value)));
    add("force", span(&scan.force, "N"));
    add("tangent stiffness", span(&scan.stiffness, "N/mm"));
    add("peak pressure", span(&scan.peak_pressure, "MPa"));
    add("largest force_error", scan.force_error.extremes.greatest.map(|(error, _)| percent(error, 3)));
    html + &facts(&all)
}

/// "834.4 N to 38.32 kN", or one quantity: each with the unit that suits it.
fn with_unit((low, high): (f64, f64), unit: &str) -> String {
    let (from, to) = (readable(unit, [low].into_iter()), readable(unit, [high].into_iter()));
    if from.0 == to.0 {
        return format!("{} {}", span((low * to.1, high * to.1)), to.0);
    }
    format!("{} {} to {} {}", number(low * from.1, 4), from.0, number(high * to.1, 4), to.0)
}

/// "834.4 to 38320", or one number.
pub fn span((low, high): (f64, f64)) -> String {
    let (from, to) = (number(low, 4), number(high, 4));
    if from == to { from } else { format!("{from} to {to}") }
}

/// Which kinds of fit there are.
fn what_is_pressed(scan: &Scan) -> &'static str {
    let name = Column::RadialClearance.name();
    let clearance = scan.inputs.iter().find(|input| input.column == name).and_then(|input| input.range);
    match clearance {
        Some((_, high)) if high < 0.0 => "A pin in a press fit is loaded across",
        Some((low, _)) if low < 0.0 => "A pin in a hole, with clearance or in a press fit, is loaded across",
        _ => "A pin is pressed into a hole with clearance",
    }
}

fn sentence(report: &Report) -> String {
    let scan = &report.scan;
    let steps = match scan.steps {
        (least, most) if least == most => plural(most, "load step", "load steps"),
        (least, most) => format!("{least} to {most} load steps"),
    };
    let load = match report.asked.load {
        Some("force") => scan.force.range().map(|range| format!(", at forces of {} N", span(range))),
        _ => scan.way.range().map(|range| format!(", at {}s of {} mm", scan.travel.name(), span(range))),
    };
    let mut text = format!(
        "{}: {} with {steps} each{}. ",
        what_is_pressed(scan),
        plural(scan.designs, "design", "designs"),
        load.unwrap_or_default(),
    );
    let (varied, fixed): (Vec<&Input>, Vec<&Input>) = scan.inputs.iter().partition(|input| input.varies());
    if !varied.is_empty() {
        let all: Vec<String> = varied.iter().map(|input| varied_in_words(input)).collect();
        text += &format!("What varies: {}. ", listed(&all));
    }
    let all: Vec<String> = fixed.iter().filter_map(|input| fixed_in_words(input)).collect();
    if !all.is_empty() {
        let beginning = if varied.is_empty() { "The joint" } else { "The same in all" };
        text += &format!("{beginning}: {}. ", listed(&all));
    }
    let solve = report.asked.solve;
    text += &format!("Asked was an accuracy of {} of the force", percent(solve.accuracy, 3));
    if solve.method.name() != "auto" {
        text += &format!(", by the method {}", solve.method.name());
    }
    text += ". ";
    let failed = scan.rows - scan.answered;
    text += &match (failed, scan.remarked) {
        (0, 0) => "Every row has an answer, and none has a remark.".to_string(),
        (0, remarked) => format!("Every row has an answer; {} a remark.", have(remarked)),
        (failed, 0) => format!("{} no answer; below is why.", have(failed)),
        (failed, remarked) => {
            format!("{} no answer, {} a remark; below is why.", have(failed), have(remarked))
        }
    };
    text
}

fn have(rows: u64) -> String {
    format!("{} {}", plural(rows, "row", "rows"), if rows == 1 { "has" } else { "have" })
}

fn unit(input: &Input) -> String {
    if input.unit == "-" { String::new() } else { format!(" {}", input.unit) }
}

fn varied_in_words(input: &Input) -> String {
    let mut parts = Vec::new();
    if let Some((low, high)) = input.range {
        let count = if input.many_numbers { "many".into() } else { input.numbers.len().to_string() };
        let (low, high) = (number(low, 4), number(high, 4));
        let values = match input.numbers.len() {
            1 => format!("{low}{}", unit(input)),
            2 => format!("{low} and {high}{}", unit(input)),
            _ => format!("{count} values from {low} to {high}{}", unit(input)),
        };
        parts.push(values);
    }
    parts.extend(input.words.iter().cloned());
    if input.has_empty {
        parts.push("none".into());
    }
    format!("{} ({})", input.name, parts.join(", "))
}

fn fixed_in_words(input: &Input) -> Option<String> {
    if let Some((value, _)) = input.range {
        return Some(format!("{} {}{}", input.name, number(value, 6), unit(input)));
    }
    input.words.first().map(|word| format!("{} {word}", input.name))
}

/// "a, b and c".
fn listed(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
