//! How far laws are from the joints' own curves.

use super::Report;
use super::chosen::{Chosen, is_log};
use super::html::{Cell, charts, figure, paragraph, section as html_section, table};
use super::laws::DrawnLaw;
use crate::output::chart::text::{number, percent};
use crate::output::chart::{Axis, LineChart, Marking, Series};

/// Laws that are drawn.
const MOST_DRAWN: usize = 6;
/// A misfit beyond this is off the chart.
const MOST_SHOWN: f64 = 100.0;

pub fn section(report: &Report) -> String {
    let with: Vec<&Chosen> = report.chosen.iter().filter(|one| !one.laws.is_empty()).collect();
    if with.is_empty() {
        return String::new();
    }
    let mut names: Vec<&str> = Vec::new();
    for law in with.iter().flat_map(|one| &one.laws) {
        if !names.contains(&law.name.as_str()) {
            names.push(&law.name);
        }
    }
    let mut head = vec!["law".to_string()];
    head.extend(with.iter().map(|one| one.name()));
    let rows: Vec<Vec<Cell>> = names
        .iter()
        .map(|name| {
            let mut cells = vec![Cell::Words(name.to_string())];
            cells.extend(with.iter().map(|one| {
                let law = one.laws.iter().find(|law| law.name == *name);
                Cell::Number(match law {
                    None => "\u{2013}".into(),
                    Some(law) if law.worst_misfit.is_infinite() => end(law, one),
                    Some(law) if law.recommended => format!("{}, recommended", percent(law.worst_misfit, 2)),
                    Some(law) => percent(law.worst_misfit, 2),
                })
            }));
            cells
        })
        .collect();
    let calibrated = with.iter().flat_map(|one| &one.laws).any(|law| law.calibrated);
    let mut text = String::from(
        "The greatest misfit of each law's force between the first and the last row of a design, against the joint's own curve. ",
    );
    if calibrated {
        text += "Calibrated laws have their constants from this curve; the others are textbook laws, which know neither the \
                 plate's size nor how it is held. ";
    } else {
        text += "These are textbook laws; they know neither the plate's size nor how it is held. ";
    }
    text += "\u{201c}ends\u{201d}: from that indentation on the law has no force.";
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let figures: Vec<String> =
        representative(&with).into_iter().filter_map(|one| chart(one, &report.chosen)).collect();
    html_section("Laws", &(paragraph(&text) + &table(&head, &rows) + &charts(&figures)))
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
            let misfit = |&(indentation, force): &(f64, f64)| {
                (indentation, 100.0 * ((law.force)(indentation) / force - 1.0))
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
    let x = if is_log(chosen) {
        Axis::log("indentation, mm", xs())
    } else {
        Axis::from_zero("indentation, mm", xs())
    };
    let y = Axis::from_zero("misfit of the force, %", ys);
    if series.is_empty() {
        return None;
    }
    let caption = format!("Misfit of laws, {}", one.name());
    let chart = LineChart { title: caption.clone(), x, y, series, limits: Vec::new() };
    Some(figure(&caption, "", &chart.svg()))
}
