//! `sensitivity.csv`, `sensitivity.svg` and their manifest: which factors the scatter of columns comes from.

use std::time::SystemTime;

use serde::Serialize;

use crate::engine::status::StatusCounts;
use crate::error::Error;
use crate::output::chart::{Axis, Bar, BarChart, BarGroup, BarPanel};
use crate::output::claim::Claim;
use crate::output::host::{seconds_since, utc};
use crate::output::manifest_parts::FileEntry;
use crate::output::number::rounded_cell as cell;
use crate::output::sensitivity_column::SensitivityColumn;
use crate::output::table::push_text;
use crate::output::texts::{self, Beginning};
use crate::sensitivity::analysis::{Analysis, OutputIndices};
use crate::sensitivity::indices::{CONFIDENCE, Estimate, FactorIndices, Indices, RESAMPLES};
use crate::study::config::Study;

/// What was asked, beside the config.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    pub columns: &'a [SensitivityColumn],
    /// From 1.
    pub step: u64,
    pub seed: u64,
    pub threads: usize,
    pub started: SystemTime,
}

/// What was asked, and how much there is to say of it.
#[derive(Clone, Debug, Serialize)]
struct SensitivityManifest {
    #[serde(flatten)]
    beginning: Beginning,
    files: Vec<FileEntry>,
    factors: Vec<String>,
    /// From 1.
    step: u64,
    load: String,
    samples: u64,
    designs: u64,
    seed: u64,
    /// Mean of the intervals, and draws of their bootstrap.
    confidence: f64,
    resamples: usize,
    columns: Vec<ColumnSummary>,
    /// Designs by what became of them.
    statuses: std::collections::BTreeMap<String, u64>,
    threads: usize,
    started_utc: String,
    wall_seconds: f64,
}

#[derive(Clone, Debug, Serialize)]
struct ColumnSummary {
    column: String,
    mean: f64,
    standard_deviation: f64,
    /// Absent where the column does not change.
    sum_of_first_orders: Option<f64>,
    samples_left_out: u64,
}

/// Writes everything into the folder, the manifest last.
pub fn save(study: &Study, question: &Question, analysis: &Analysis, claim: &Claim) -> Result<(), Error> {
    let files = [
        ("sensitivity.csv", rows(study, question, analysis)),
        ("sensitivity.svg", picture(study, question, analysis)),
    ];
    let files = texts::write(claim, files)?;
    let statuses: &StatusCounts = &analysis.statuses;
    let columns = question.columns.iter().zip(&analysis.outputs).map(|(column, output)| ColumnSummary {
        column: column.name.to_string(),
        mean: output.mean,
        standard_deviation: output.standard_deviation,
        sum_of_first_orders: output.indices.as_ref().map(|indices| indices.sum_of_first_orders.value),
        samples_left_out: output.left_out,
    });
    let manifest = SensitivityManifest {
        beginning: Beginning::of(study, "sensitivity"),
        files,
        factors: study.factors().into_iter().map(String::from).collect(),
        step: question.step,
        load: load(study),
        samples: analysis.samples,
        designs: analysis.designs,
        seed: question.seed,
        confidence: CONFIDENCE,
        resamples: RESAMPLES,
        columns: columns.collect(),
        statuses: statuses.by_text(),
        threads: question.threads,
        started_utc: utc(question.started),
        wall_seconds: seconds_since(question.started),
    };
    texts::publish(claim, &manifest)
}

/// The only load step, in words.
pub fn load(study: &Study) -> String {
    study.loads().first().map(ToString::to_string).unwrap_or_default()
}

/// A row for each column and factor; empty cells where the column does not change.
fn rows(study: &Study, question: &Question, analysis: &Analysis) -> String {
    let mut text =
        "column,step,factor,first_order,first_order_low,first_order_high,total,total_low,total_high\n"
            .to_string();
    for (column, output) in question.columns.iter().zip(&analysis.outputs) {
        for (place, factor) in study.factors().into_iter().enumerate() {
            let cells = match &output.indices {
                Some(Indices { factors, .. }) => {
                    let FactorIndices { first_order, total } = factors[place];
                    [first_order, total]
                        .map(|Estimate { value, low, high }| [value, low, high].map(cell).join(","))
                }
                None => [String::from(",,"), String::from(",,")],
            };
            text += &format!("{},{},{factor},{}\n", csv_cell(&column.name), question.step, cells.join(","));
        }
    }
    text
}

/// An expression may have commas in it.
fn csv_cell(text: &str) -> String {
    let mut cell = Vec::new();
    push_text(&mut cell, text);
    String::from_utf8_lossy(&cell).into_owned()
}

/// The places of the factors, the greatest total first.
pub fn order(indices: &Indices) -> Vec<usize> {
    let mut order: Vec<usize> = (0..indices.factors.len()).collect();
    let total = |place: usize| indices.factors[place].total.value;
    order.sort_by(|&one, &other| total(other).total_cmp(&total(one)));
    order
}

fn picture(study: &Study, question: &Question, analysis: &Analysis) -> String {
    let factors = study.factors();
    let bar = |Estimate { value, low, high }: Estimate| Bar { value, whisker: [low, high] };
    let groups = |output: &OutputIndices| match &output.indices {
        None => Vec::new(),
        Some(indices) => {
            let group = |place: usize| {
                let FactorIndices { first_order, total } = indices.factors[place];
                BarGroup { name: factors[place].into(), bars: vec![bar(first_order), bar(total)] }
            };
            order(indices).into_iter().map(group).collect()
        }
    };
    let panels: Vec<BarPanel> = question
        .columns
        .iter()
        .zip(&analysis.outputs)
        .map(|(column, output)| {
            let remark = if output.indices.is_none() { ": does not change" } else { "" };
            BarPanel {
                heading: format!("{} at {}{remark}", column.name, load(study)),
                groups: groups(output),
            }
        })
        .collect();
    let ends = panels.iter().flat_map(|panel| &panel.groups).flat_map(|group| &group.bars);
    let values: Vec<f64> = ends.flat_map(|bar| [bar.value, bar.whisker[0], bar.whisker[1]]).collect();
    BarChart {
        title: study.title().into(),
        x: Axis::from_zero("share of the variance, with 95 % intervals", values.into_iter()),
        series: vec!["first order: the factor alone".into(), "total: with all others".into()],
        panels,
    }
    .alone()
}
