//! What `[reduce]` has found: statistics, the best rows, a Pareto front and histograms, from their files.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::html::{Cell, charts, figure, remark, section as html_section, table};
use crate::output::chart::text::number;
use crate::output::chart::{Axis, LineChart, Marking, Series, Spacing};
use crate::output::schema::table_columns;
use crate::study::columns::Extras;

/// Lines of a file that are read, points of a front that are drawn, places of a ranking and columns that are shown.
const MOST_LINES: usize = 100_000;
const MOST_POINTS: usize = 2000;
const MOST_PLACES: usize = 10;
const MOST_COLUMNS: usize = 12;
/// Histograms and rankings that are shown.
const MOST_SHOWN: usize = 12;
/// Bytes of a file that are read: the files of a run are far smaller.
const LARGEST: u64 = 64 << 20;

/// The lines of a file with the names of its columns.
struct Lines {
    header: csv::StringRecord,
    lines: Vec<csv::StringRecord>,
}

impl Lines {
    /// `None` where there is no such file, or none that can be read.
    fn read(dir: &Path, name: &str) -> Option<Lines> {
        let file = File::open(dir.join(name)).ok()?;
        let mut reader = csv::Reader::from_reader(BufReader::new(file).take(LARGEST));
        let header = reader.headers().ok()?.clone();
        let lines = reader.records().map_while(Result::ok).take(MOST_LINES).collect();
        Some(Lines { header, lines })
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|own| own == name)
    }

    /// The cell of a line; empty where there is none.
    fn cell<'a>(&self, line: &'a csv::StringRecord, name: &str) -> &'a str {
        self.place(name).and_then(|place| line.get(place)).unwrap_or_default()
    }

    fn number(&self, line: &csv::StringRecord, name: &str) -> Option<f64> {
        self.cell(line, name).parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// The different values of a column, in the order of the file.
    fn different(&self, name: &str) -> Vec<&str> {
        let mut different: Vec<&str> = Vec::new();
        for line in &self.lines {
            let cell = self.cell(line, name);
            if different.last() != Some(&cell) && !different.contains(&cell) && different.len() < MOST_SHOWN {
                different.push(cell);
            }
        }
        different
    }
}

/// Empty where the folder holds no answers.
pub fn section(dir: &Path) -> String {
    let read = |name| Lines::read(dir, name);
    let mut figures: Vec<String> = read("histogram.csv").map(|lines| histograms(&lines)).unwrap_or_default();
    figures.extend(read("pareto.csv").map(|lines| fronts(&lines)).unwrap_or_default());
    let mut content = read("statistics.csv").map(|lines| statistics(&lines)).unwrap_or_default();
    if !figures.is_empty() {
        content += &charts(&figures);
    }
    content += &read("best.csv").map(|lines| rankings(&lines)).unwrap_or_default();
    if content.is_empty() { content } else { html_section("Answers", &content) }
}

/// A number of a file with five digits.
fn short(cell: &str) -> String {
    cell.parse::<f64>().map_or(cell.to_string(), |value| number(value, 5))
}

/// A row a quantity, a column a statistic.
fn statistics(lines: &Lines) -> String {
    let mut names: Vec<&str> = Vec::new();
    for line in &lines.lines {
        let name = lines.cell(line, "statistic");
        if !names.contains(&name) && names.len() < 60 {
            names.push(name);
        }
    }
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let quantities: Vec<&str> = lines.lines.iter().map(|line| lines.cell(line, "of")).collect();
    for block in lines.lines.chunk_by(|a, b| lines.cell(a, "of") == lines.cell(b, "of")) {
        let of = lines.cell(&block[0], "of");
        let unit = block.iter().map(|line| lines.cell(line, "unit")).find(|unit| *unit != "-");
        let value = |name: &&str| {
            let line = block.iter().find(|line| lines.cell(line, "statistic") == *name);
            Cell::Number(line.map_or(String::new(), |line| short(lines.cell(line, "value"))))
        };
        let name = unit.map_or(of.to_string(), |unit| format!("{of}, {unit}"));
        rows.push(std::iter::once(Cell::Words(name)).chain(names.iter().map(value)).collect());
    }
    if quantities.is_empty() {
        return String::new();
    }
    let spoken: Vec<String> = names.iter().map(|name| name.replace('_', " ")).collect();
    let head: Vec<&str> = std::iter::once("quantity").chain(spoken.iter().map(String::as_str)).collect();
    table(&head, &rows)
}

fn histograms(lines: &Lines) -> Vec<String> {
    let numbers = lines.different("histogram");
    numbers.iter().filter_map(|number| histogram(lines, number)).collect()
}

fn histogram(lines: &Lines, own: &str) -> Option<String> {
    let all: Vec<_> = lines.lines.iter().filter(|line| lines.cell(line, "histogram") == own).collect();
    let first = all.first()?;
    let (of, unit) = (lines.cell(first, "of"), lines.cell(first, "unit"));
    let mut points = Vec::new();
    let mut end = 0.0;
    let mut outside = 0.0;
    for line in &all {
        let count = lines.number(line, "count")?;
        match (lines.number(line, "from"), lines.number(line, "to")) {
            (Some(from), Some(to)) => {
                points.push((from, count));
                end = to;
            }
            _ => outside += count,
        }
    }
    let &(start, _) = points.first()?;
    let (second, last) = (points.get(1).map_or(end, |point| point.0), points.last()?.0);
    points.push((end, 0.0));
    if end <= start {
        return None;
    }
    // Bins of equal ratio grow.
    let spacing =
        if start > 0.0 && end - last > 1.5 * (second - start) { Spacing::Log } else { Spacing::Linear };
    let name = if unit == "-" { of.to_string() } else { format!("{of}, {unit}") };
    let x = Axis { name, spacing, low: start, high: end };
    let y = Axis::from_zero("rows", points.iter().map(|point| point.1));
    let series = vec![Series::new("", 0, Marking::Bars, points)];
    let caption = format!("How many rows have which {of}");
    let note = if outside > 0.0 { format!("{outside} rows lie outside") } else { String::new() };
    let chart = LineChart { title: caption.clone(), x, y, series, limits: Vec::new() };
    Some(figure(&caption, &note, &chart.svg()))
}

/// The first quantity against each of the others.
fn fronts(lines: &Lines) -> Vec<String> {
    let quantities: Vec<&str> = lines.header.iter().take_while(|name| *name != "step").take(3).collect();
    let Some((first, others)) = quantities.split_first() else { return Vec::new() };
    let stride = lines.lines.len().div_ceil(MOST_POINTS).max(1);
    let chart = |other: &&str| {
        let point = |line| Some((lines.number(line, other)?, lines.number(line, first)?));
        let points: Vec<(f64, f64)> = lines.lines.iter().step_by(stride).filter_map(point).collect();
        if points.is_empty() {
            return None;
        }
        let x = Axis::from_zero(other, points.iter().map(|point| point.0));
        let y = Axis::from_zero(first, points.iter().map(|point| point.1));
        let series = vec![Series::new("", 0, Marking::Points, points)];
        let caption = "Pareto front".to_string();
        let note = format!("{} rows that no other row beats", lines.lines.len());
        let chart = LineChart { title: caption.clone(), x, y, series, limits: Vec::new() };
        Some(figure(&caption, &note, &chart.svg()))
    };
    others.iter().filter_map(chart).collect()
}

/// Of each ranking the first places, with the columns that tell their rows apart.
fn rankings(lines: &Lines) -> String {
    let same = |a: &csv::StringRecord, b: &csv::StringRecord| {
        ["by", "order"].into_iter().all(|name| lines.cell(a, name) == lines.cell(b, name))
    };
    let columns = table_columns(Extras::MOST);
    let mut text = String::new();
    for all in lines.lines.chunk_by(same).take(MOST_SHOWN) {
        let shown = &all[..all.len().min(MOST_PLACES)];
        let (by, unit) = (lines.cell(&shown[0], "by"), lines.cell(&shown[0], "unit"));
        let differs =
            |name: &str| shown.iter().any(|line| lines.cell(line, name) != lines.cell(&shown[0], name));
        let names = columns.iter().map(|column| &*column.name);
        let told: Vec<&str> =
            names.filter(|name| *name == "design" || differs(name)).take(MOST_COLUMNS).collect();
        let row = |line: &csv::StringRecord| -> Vec<Cell> {
            let cells = ["rank", "value"].iter().chain(&told);
            cells.map(|name| Cell::Number(short(lines.cell(line, name)))).collect()
        };
        let value = if unit == "-" { "value".to_string() } else { format!("value, {unit}") };
        let head: Vec<&str> = ["rank", &value].into_iter().chain(told.iter().copied()).collect();
        text += &remark(&format!(
            "The {} values of {by}, {} of {}",
            lines.cell(&shown[0], "order"),
            shown.len(),
            all.len()
        ));
        text += &table(&head, &shown.iter().map(row).collect::<Vec<_>>());
    }
    text
}
