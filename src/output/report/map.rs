//! The sweep over its two widest axes.

use std::collections::BTreeMap;

use super::Report;
use super::curves::readable;
use super::html::{charts, figure, paragraph, section as html_section};
use super::sample::{Row, SampledDesign};
use super::tallies::{Input, Value};
use crate::output::chart::text::number;
use crate::output::chart::{Axis, Cell, MapAxis, MapChart, Spacing};

/// Values that are told apart on an axis; more are put into as many bins.
const MOST_CELLS: usize = 24;
const FEWEST_CELLS: usize = 5;
const DESIGNS_A_CELL: f64 = 8.0;

/// What is laid along an axis.
enum Along {
    /// By its place in `Scan::inputs`.
    Input(usize),
    /// The load that was asked.
    Load { is_force: bool },
}

/// An axis with what tells the cell of a value.
struct Grid {
    axis: MapAxis,
    cells: Cells,
}

enum Cells {
    Numbers(Vec<f64>),
    Words(Vec<String>),
    Bins(Axis, usize),
}

pub fn section(report: &Report) -> String {
    let mut axes = widest(&report.scan.inputs);
    axes.truncate(2);
    let steps = report.scan.steps.1;
    let asked_force = report.asked.load == Some("force");
    if axes.len() < 2 && steps > 1 && !axes.is_empty() {
        axes.push(Along::Load { is_force: asked_force });
    }
    let [x, y] = &axes[..] else { return String::new() };
    let by_row = matches!(y, Along::Load { .. });
    let (Some(x_grid), Some(y_grid)) = (grid(report, x), grid(report, y)) else { return String::new() };
    // Of each cell: stiffnesses and forces of what has an answer.
    let mut found: BTreeMap<(usize, usize), Vec<[f64; 2]>> = BTreeMap::new();
    for design in &report.scan.sample {
        let mut add = |value: Option<[f64; 2]>, load: f64| {
            let cell = |along: &Along, grid: &Grid| match along {
                Along::Input(place) => grid.cell(&design.inputs[*place]),
                Along::Load { .. } => grid.cell(&Value::Number(load)),
            };
            if let (Some(column), Some(row)) = (cell(x, &x_grid), cell(y, &y_grid)) {
                found.entry((column, row)).or_default().extend(value);
            }
        };
        if by_row {
            for row in &design.rows {
                let load = if asked_force { row.force } else { row.way };
                add(row.answer.map(|answer| [answer.stiffness, row.force]), load);
            }
        } else {
            let last = design.rows.last().and_then(|row| Some([row.answer?.stiffness, row.force]));
            add(last, f64::NAN);
        }
    }
    let second = if asked_force && by_row { None } else { Some((1, "force", "N")) };
    let maps: Vec<String> = [Some((0, "tangent stiffness", "N/mm")), second]
        .into_iter()
        .flatten()
        .filter(|(which, ..)| *which == 0 || !asked_force)
        .map(|(which, name, unit)| map(&x_grid, &y_grid, &found, which, name, unit))
        .collect();
    let total = report.scan.designs;
    let sampled = report.scan.sample.len() as u64;
    let of = if sampled < total {
        format!("{sampled} of the {total} designs, evenly taken")
    } else {
        "all designs".into()
    };
    let what = if by_row { "each load step" } else { "the last load step" };
    let mut text = format!(
        "Over {} and {}, at {what}, of {of}.",
        x_grid.axis.name.split(',').next().unwrap_or_default(),
        y_grid.axis.name.split(',').next().unwrap_or_default()
    );
    if !by_row {
        text += " These two inputs reach furthest in the sweep.";
    }
    let crowded = found.values().any(|values| values.len() > 1);
    if crowded {
        text += " A cell has the median of its designs, whatever their other inputs.";
    }
    if found.values().any(Vec::is_empty) {
        text += " A cross stands where no design has an answer there.";
    }
    html_section("The sweep", &(paragraph(&text) + &charts(&maps)))
}

fn map(
    x: &Grid,
    y: &Grid,
    found: &BTreeMap<(usize, usize), Vec<[f64; 2]>>,
    which: usize,
    name: &str,
    unit: &str,
) -> String {
    let medians: Vec<((usize, usize), Option<f64>, usize)> =
        found.iter().map(|(at, values)| (*at, median(values, which), values.len())).collect();
    let (unit, factor) = readable(unit, medians.iter().filter_map(|cell| cell.1));
    let cells = medians
        .into_iter()
        .map(|((column, row), value, count)| {
            let value = value.map(|value| value * factor);
            let about = match value {
                None => "no answer".to_string(),
                Some(value) if count == 1 => format!("{} {unit}", number(value, 4)),
                Some(value) => format!("{} {unit}, the median of {count}", number(value, 4)),
            };
            Cell { column, row, value, about }
        })
        .collect();
    let mut letters = name.chars();
    let caption: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    let chart = MapChart {
        title: caption.clone(),
        x: x.axis.clone(),
        y: y.axis.clone(),
        value_name: format!("{name}, {unit}"),
        cells,
    };
    figure(&caption, "", &chart.svg())
}

fn median(values: &[[f64; 2]], which: usize) -> Option<f64> {
    let mut sorted: Vec<f64> =
        values.iter().map(|value| value[which]).filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        count if count % 2 == 1 => Some(sorted[middle]),
        _ => Some(0.5 * (sorted[middle - 1] + sorted[middle])),
    }
}

/// The inputs that vary, the one that reaches furthest first: by the ratio of its ends.
fn widest(inputs: &[Input]) -> Vec<Along> {
    let reach = |input: &Input| -> Option<f64> {
        if !input.varies() {
            return None;
        }
        match input.range {
            Some((low, high)) if input.has_numbers() && low > 0.0 => Some((high / low).ln()),
            Some((low, high)) if input.has_numbers() => Some((high - low) / high.abs().max(low.abs())),
            // Words are laid out only where numbers do not fill the map.
            _ if input.words.len() > 1 => Some(0.0),
            _ => None,
        }
    };
    let mut all: Vec<(usize, f64)> =
        inputs.iter().enumerate().filter_map(|(place, input)| Some((place, reach(input)?))).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.into_iter().map(|(place, _)| Along::Input(place)).collect()
}

fn grid(report: &Report, along: &Along) -> Option<Grid> {
    match *along {
        Along::Input(place) => {
            let input = &report.scan.inputs[place];
            let unit = if input.unit == "-" { String::new() } else { format!(", {}", input.unit) };
            let name = format!("{}{unit}", input.name);
            if !input.has_numbers() {
                let words: Vec<String> = input.words.iter().take(MOST_CELLS).cloned().collect();
                return Some(Grid::new(name, Cells::Words(words)));
            }
            let few = !input.many_numbers && input.numbers.len() <= MOST_CELLS;
            Some(if few {
                Grid::new(name, Cells::Numbers(input.numbers.clone()))
            } else {
                let of = |design: &SampledDesign| match design.inputs[place] {
                    Value::Number(value) => Some(value),
                    _ => None,
                };
                let values = report.scan.sample.iter().filter_map(of).collect();
                Grid::new(name, bins(input.range?, values))
            })
        }
        Along::Load { is_force } => {
            let of_row = |design: &SampledDesign| -> Vec<f64> {
                let load = |row: &Row| if is_force { row.force } else { row.way };
                design.rows.iter().map(load).collect()
            };
            let mut loads: Vec<f64> =
                report.scan.sample.iter().flat_map(of_row).filter(|load| load.is_finite()).collect();
            loads.sort_by(f64::total_cmp);
            loads.dedup();
            let name = if is_force { "force, N".to_string() } else { report.scan.travel.label() };
            let range = (*loads.first()?, *loads.last()?);
            let cells = if loads.len() <= MOST_CELLS { Cells::Numbers(loads) } else { bins(range, loads) };
            Some(Grid::new(name, cells))
        }
    }
}

/// As many as leave some designs to a cell, spaced so that half of the values are on either side of the middle.
fn bins((low, high): (f64, f64), mut values: Vec<f64>) -> Cells {
    values.sort_by(f64::total_cmp);
    let median = values.get(values.len() / 2).copied().unwrap_or(low);
    let axis = |spacing| Axis { name: String::new(), spacing, low, high };
    let off = |spacing| axis(spacing).share(median).map_or(f64::INFINITY, |share| (share - 0.5).abs());
    let is_log = low > 0.0 && off(Spacing::Log) < off(Spacing::Linear);
    let count = ((values.len() as f64 / DESIGNS_A_CELL).sqrt() as usize).clamp(FEWEST_CELLS, MOST_CELLS);
    Cells::Bins(axis(if is_log { Spacing::Log } else { Spacing::Linear }), count)
}

impl Grid {
    fn new(name: String, cells: Cells) -> Grid {
        let middle = |place: usize| place as f64 + 0.5;
        let (count, labels) = match &cells {
            Cells::Numbers(values) => {
                let labels =
                    values.iter().enumerate().map(|(at, value)| (middle(at), number(*value, 3))).collect();
                (values.len(), labels)
            }
            Cells::Words(words) => {
                (words.len(), words.iter().enumerate().map(|(at, word)| (middle(at), word.clone())).collect())
            }
            Cells::Bins(axis, count) => {
                let place = |value: f64| axis.share(value).map(|share| share * *count as f64);
                let ticks = axis.ticks(6, 400.0, true).into_iter();
                (*count, ticks.filter_map(|(value, label)| Some((place(value)?, label))).collect())
            }
        };
        Grid { axis: MapAxis { name, cells: count, labels }, cells }
    }

    fn cell(&self, value: &Value) -> Option<usize> {
        match (&self.cells, value) {
            (Cells::Numbers(values), Value::Number(value)) => values.iter().position(|own| own == value),
            (Cells::Words(words), Value::Word(word)) => words.iter().position(|own| own == word),
            (Cells::Bins(axis, count), Value::Number(value)) => {
                let share = axis.share(*value).filter(|share| (-1e-9..=1.0 + 1e-9).contains(share))?;
                Some(((share * *count as f64) as usize).min(count - 1))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_of_what_has_an_answer() {
        let values = [[1.0, 10.0], [3.0, f64::NAN], [2.0, 30.0]];
        assert_eq!((median(&values, 0), median(&values, 1)), (Some(2.0), Some(20.0)));
        assert_eq!(median(&[], 0), None);
    }

    #[test]
    fn both_ends_of_a_range_have_a_cell() {
        for range in [(0.001, 10.0), (-0.5, 0.4)] {
            let grid = Grid::new("x".into(), bins(range, vec![range.0; 10_000]));
            assert_eq!(grid.cell(&Value::Number(range.0)), Some(0));
            assert_eq!(grid.cell(&Value::Number(range.1)), Some(MOST_CELLS - 1));
            assert_eq!(grid.cell(&Value::Number(2.0 * range.1)), None);
        }
    }
}
