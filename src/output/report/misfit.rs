//! How far laws are from the joints' own curves.

use super::Report;
use super::chosen::{Chosen, is_log};
use super::html::{Cell, charts, figure, paragraph, section as html_section, table};
use super::laws::DrawnLaw;
use crate::error::shortened_to;
use crate::output::chart::text::{number, percent};
use crate::output::chart::{Axis, LineChart, Marking, Series};

/// Laws that are drawn.
const MOST_DRAWN: usize = 5;
/// Characters of a formula.
const LONGEST_FORMULA: usize = 400;
/// A misfit beyond this is off the chart.
const MOST_SHOWN: f64 = 100.0;

pub fn section(report: &Report) -> String {
    let with: Vec<&Chosen> = report.chosen.iter().filter(|one| !one.laws.is_empty()).collect();
    if with.is_empty() {
        return String::new();
    }
    let mut content = String::new();
    if with.iter().any(|one| one.laws.iter().any(|law| law.calibrated)) {
        content += &paragraph(
            "Laws calibrated to each joint\u{2019}s own curve, for simulators that take a formula: the greatest misfit of \
             their force, each over its own range. The command \u{201c}jointsweep laws\u{201d} writes them with their \
             constants to laws.csv.",
        );
        content += &misfits(&with, true);
        content += &formulas(&with);
    }
    let textbook = paragraph(
        "Textbook laws, which know neither the plate\u{2019}s size nor how it is held: the greatest misfit of their force \
         between the first and the last row of a design. \u{201c}ends\u{201d}: from that indentation on the law has no \
         force.",
    ) + &misfits(&with, false);
    let figures: Vec<String> =
        representative(&with).into_iter().filter_map(|one| chart(one, &report.chosen)).collect();
    html_section("Laws", &(content + &charts(&figures) + &textbook))
}

/// A row a law, a column a design.
fn misfits(with: &[&Chosen], calibrated: bool) -> String {
    let mut names: Vec<&str> = Vec::new();
    for law in with.iter().flat_map(|one| &one.laws).filter(|law| law.calibrated == calibrated) {
        if !names.contains(&law.name.as_str()) {
            names.push(&law.name);
        }
    }
    let mut head = vec!["law".to_string()];
    head.extend(with.iter().map(|one| one.name()));
    let cell = |one: &Chosen, name: &str| {
        let law = one.laws.iter().find(|law| law.name == name && law.calibrated == calibrated);
        Cell::Number(match law {
            None => "\u{2013}".into(),
            Some(law) if law.worst_misfit.is_infinite() => end(law, one),
            Some(law) if law.recommended => format!("\u{2713} {}", percent(law.worst_misfit, 2)),
            Some(law) => percent(law.worst_misfit, 2),
        })
    };
    let row = |name: &&str| -> Vec<Cell> {
        [Cell::Words(name.to_string())].into_iter().chain(with.iter().map(|one| cell(one, name))).collect()
    };
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    table(&head, &names.iter().map(row).collect::<Vec<_>>())
}

/// The recommended law of each design as text.
fn formulas(with: &[&Chosen]) -> String {
    let row = |one: &&Chosen| {
        let law = one.laws.iter().find(|law| law.recommended)?;
        let why = one.why_recommended.unwrap_or_default();
        Some(vec![
            Cell::Key(one.place, one.design.number.to_string()),
            Cell::Words(format!("{}: {why}", law.name)),
            Cell::Code(shortened_to(&law.formula, LONGEST_FORMULA)),
        ])
    };
    let rows: Vec<Vec<Cell>> = with.iter().filter_map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    let about = "The recommended law (\u{2713}) of each design: F in N, d the indentation in mm.";
    paragraph(about) + &table(&["design", "law", "formula"], &rows)
}

/// Where a law ends before the rows do.
fn end(law: &DrawnLaw, one: &Chosen) -> String {
    let has_force = |point: &&(f64, f64)| (law.force)(point.0).is_finite();
    let points = one.points();
    match points.iter().take_while(has_force).last() {
        Some((indentation, _)) => format!("ends at {} mm", number(*indentation, 2)),
        None => "\u{2013}".into(),
    }
}

/// The softest and the stiffest, or the only one.
fn representative<'a>(with: &[&'a Chosen]) -> Vec<&'a Chosen> {
    match with {
        [] => Vec::new(),
        [one] => vec![one],
        [first, .., last] => vec![first, last],
    }
}

fn chart(one: &Chosen, chosen: &[Chosen]) -> Option<String> {
    let points = one.points();
    // Beside calibrated laws the others are off the chart.
    let calibrated = one.laws.iter().any(|law| law.calibrated);
    let mut laws: Vec<_> = one.laws.iter().filter(|law| law.calibrated == calibrated).collect();
    laws.sort_by(|a, b| b.recommended.cmp(&a.recommended).then(a.worst_misfit.total_cmp(&b.worst_misfit)));
    let series: Vec<Series> = laws
        .into_iter()
        .take(MOST_DRAWN)
        .enumerate()
        .map(|(place, law)| {
            let misfit = |&(way, force): &(f64, f64)| {
                let indentation = one.travel.indentation(way, &one.design.joint);
                (way, 100.0 * ((law.force)(indentation) / force - 1.0))
            };
            let marking = if law.calibrated { Marking::Line } else { Marking::Dashed };
            let misfits = points.iter().map(misfit).filter(|point| point.1.is_finite()).collect();
            let name = if law.recommended { format!("{} (recommended)", law.name) } else { law.name.clone() };
            Series::new(name, place, marking, misfits)
        })
        .filter(|series| series.points.len() > 1)
        .collect();
    let xs = || series.iter().flat_map(|one| one.points.iter().map(|point| point.0));
    let ys =
        series.iter().flat_map(|one| one.points.iter().map(|point| point.1.clamp(-MOST_SHOWN, MOST_SHOWN)));
    let label = one.travel.label();
    let x = if is_log(chosen) { Axis::log(&label, xs()) } else { Axis::from_zero(&label, xs()) };
    let y = Axis::from_zero("misfit of the force, %", ys);
    if series.is_empty() {
        return None;
    }
    let caption = format!("Misfit of laws, {}", one.name());
    let chart = LineChart { title: caption.clone(), x, y, series, limits: Vec::new() };
    Some(figure(&caption, "", &chart.svg()))
}
