//! `jointsweep sensitivity`: which swept quantities the scatter of a result comes from.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::Args;
use jointsweep::internals::engine::sweep::SweepOptions;
use jointsweep::internals::output::folder::{Permissions, ResultFolder, SENSITIVITY, Verdict};
use jointsweep::internals::output::sensitivity::{Question, load, order, save};
use jointsweep::internals::output::sensitivity_column::SensitivityColumn;
use jointsweep::internals::sensitivity::analysis::{Analysis, Output, OutputIndices, analyse};
use jointsweep::internals::sensitivity::indices::{Estimate, FactorIndices};
use jointsweep::internals::study::config::Study;
use jointsweep::{Error, Status};

use super::arguments::{SettingArgs, thread_count, threads};
use super::progress::Progress;
use super::report::aligned;
use super::{Ending, print, say};

#[derive(Args)]
pub struct SensitivityArgs {
    /// The factors and their ranges, a TOML file: what sweeps there, whatever its [sampling] says
    config: PathBuf,
    /// Columns of results, with or without their unit, or expressions like "force / thickness", with commas between
    /// [default: force_n, or indentation_mm where the force is prescribed]
    #[arg(long, value_name = "COLUMN")]
    of: Vec<String>,
    /// The load step, from 1 [default: the last]
    #[arg(long, value_name = "N")]
    step: Option<u64>,
    /// Samples; each is as many designs as there are factors, and two. Best a power of two
    #[arg(long, value_name = "N", default_value = "1024", value_parser = sample_count)]
    samples: u64,
    /// Other samples
    #[arg(long, value_name = "N", default_value = "0")]
    seed: u64,
    /// Folder of the result [default: out/<config's name>/sensitivity]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Overwrite a result that is there
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

/// Fewer say nothing: intervals come from groups of samples, and there are half a hundred of those then.
const FEWEST_SAMPLES: u64 = 64;

fn sample_count(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| *number >= FEWEST_SAMPLES);
    number.ok_or(format!("a whole number from {FEWEST_SAMPLES} on is needed, best a power of two"))
}

pub fn sensitivity(args: &SensitivityArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let study = args.settings.load(&args.config)?;
    let step = args.step.unwrap_or(study.steps_per_design());
    let study = study.for_sensitivity(args.samples, args.seed, args.step)?;
    let columns = columns(&study, &args.of)?;
    let dir = args.out.clone().unwrap_or_else(|| Path::new("out").join(study.name()).join("sensitivity"));
    let folder = ResultFolder::new(&SENSITIVITY, dir.clone());
    let permissions = Permissions { force: args.force, again: args.force };
    // Other columns, or other samples: only the config is known to be the same.
    if let Verdict::Done(origin) = folder.check(&study, permissions)? {
        return Err(Error::FolderTaken {
            dir,
            occupant: format!("the sensitivities of {}", origin.inputs.path),
        });
    }
    let claim = folder.claim(&format!("of {}", args.config.display()))?;

    let threads = threads(args.threads);
    let options = SweepOptions { threads, notify: Some(&say), ..SweepOptions::default() };
    let mut progress = Progress::new(0, study.design_count(), args.quiet);
    let analysis = analyse_columns(&study, &columns, &options, &mut progress);
    progress.finish();
    let analysis = analysis?;
    let question = Question { columns: &columns, step, seed: args.seed, threads, started };
    save(&study, &question, &analysis, &claim)?;
    if !args.quiet {
        print(&summary(&study, &columns, &analysis, &dir))?;
    }
    let is_whole = analysis.outputs.iter().all(|output| output.left_out == 0);
    Ok(if is_whole { Ending::Complete } else { Ending::SomeDesignsFailed })
}

/// Those that are named, or what answers the load.
fn columns(study: &Study, names: &[String]) -> Result<Vec<SensitivityColumn>, Error> {
    let load = study.loads()[0];
    if names.is_empty() {
        return Ok(vec![SensitivityColumn::answering(load)?]);
    }
    let mut columns: Vec<SensitivityColumn> = Vec::new();
    for text in names.iter().flat_map(|list| entries(list)) {
        let column = SensitivityColumn::read(text.trim(), load)?;
        if columns.iter().any(|other| other.name == column.name) {
            return Err(Error::Asked { problem: format!("`{}`: it is named twice", column.name) });
        }
        columns.push(column);
    }
    Ok(columns)
}

/// What stands between the commas of a list; those in brackets belong to functions.
fn entries(list: &str) -> Vec<&str> {
    let mut depth = 0_i64;
    let is_end = |c: char| {
        depth += i64::from(c == '(') - i64::from(c == ')');
        c == ',' && depth <= 0
    };
    list.split(is_end).collect()
}

fn analyse_columns(
    study: &Study,
    columns: &[SensitivityColumn],
    options: &SweepOptions,
    progress: &mut Progress,
) -> Result<Analysis, Error> {
    let values: Vec<_> = columns.iter().map(|column| |outcome: &_| column.value(outcome)).collect();
    let outputs: Vec<Output> =
        columns.iter().zip(&values).map(|(column, value)| Output { name: &column.name, value }).collect();
    analyse(study, &outputs, options, &mut || progress.advance(1))
}

fn summary(study: &Study, columns: &[SensitivityColumn], analysis: &Analysis, dir: &Path) -> String {
    let factors = study.factors();
    let mut text = String::new();
    for (column, output) in columns.iter().zip(&analysis.outputs) {
        text += &table(&factors, column, &load(study), output);
        text.push('\n');
    }
    let Analysis { samples, designs, statuses, .. } = analysis;
    _ = writeln!(text, "{samples} samples of {} factors, {designs} designs", factors.len());
    for (status, count) in statuses.by_text() {
        if status != Status::OK.to_string() {
            _ = writeln!(text, "{count} designs: {status}");
        }
    }
    text += "written:\n";
    for name in ["sensitivity.csv", "sensitivity.svg", "manifest.json"] {
        _ = writeln!(text, "  {}", dir.join(name).display());
    }
    text
}

/// One column: the factor with the greatest total first.
fn table(factors: &[&str], column: &SensitivityColumn, load: &str, output: &OutputIndices) -> String {
    let OutputIndices { mean, standard_deviation, indices, left_out } = output;
    let unit = if column.unit == "-" { String::new() } else { format!(" {}", column.unit) };
    let mut text = format!(
        "{} at {load}: mean {mean:.4e}{unit}, standard deviation {standard_deviation:.4e}{unit}\n",
        column.name
    );
    match indices {
        None => text += "it does not change: there is no variance to share\n",
        Some(indices) => {
            let mut lines = vec![["factor", "first order", "95 %", "total", "95 %"].map(String::from)];
            let interval = |one: Estimate| format!("{} to {}", digits(one.low), digits(one.high));
            for place in order(indices) {
                let FactorIndices { first_order, total } = indices.factors[place];
                let [first, all] = [first_order, total].map(|one| digits(one.value));
                lines.push([factors[place].into(), first, interval(first_order), all, interval(total)]);
            }
            let sum = indices.sum_of_first_orders;
            lines.push(["sum".into(), digits(sum.value), interval(sum), String::new(), String::new()]);
            text += &aligned(&lines);
        }
    }
    if *left_out > 0 {
        _ = writeln!(text, "left out: {left_out} samples with a design that has no {}", column.name);
    }
    text
}

/// Three decimals, and no zero below zero.
fn digits(share: f64) -> String {
    let text = format!("{share:.3}");
    if text == "-0.000" { "0.000".into() } else { text }
}
