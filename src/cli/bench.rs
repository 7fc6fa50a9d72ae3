//! `jointsweep bench`: whole runs of sweeps, each in a process of its own, so that its start counts too.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Instant, SystemTime};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::processor_pace::measured_pace;
use jointsweep::internals::engine::unit_costs::Pace;
use jointsweep::internals::lab::benchmark::{BenchmarkManifest, Measurement, Run, figures};
use jointsweep::internals::output::folder::MANIFEST;
use jointsweep::internals::output::whole_file::create_dir;
use jointsweep::internals::study::config::Study;
use serde_json::Value;

use super::arguments::{count, thread_count, threads};
use super::report::{aligned, duration};
use super::{Ending, print, say};

#[derive(Args)]
pub struct BenchArgs {
    /// The sweeps to run [default: those of configs/liu2007.toml and configs/random.toml that are here]
    #[arg(value_name = "CONFIG")]
    configs: Vec<PathBuf>,
    /// Runs of each that are measured, after one that is not
    #[arg(long, value_name = "N", default_value = "5", value_parser = count::<usize>)]
    runs: usize,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Folder of the figures
    #[arg(long, value_name = "DIR", default_value = "out/bench")]
    out: PathBuf,
    /// Overwrite the figures that are there
    #[arg(long)]
    force: bool,
}

/// What is measured when nothing is named.
const DEFAULT: [&str; 2] = ["configs/liu2007.toml", "configs/random.toml"];

pub fn bench(args: &BenchArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let configs = configs(&args.configs)?;
    let studies = configs.iter().map(|config| Study::load(config)).collect::<Result<Vec<_>, _>>()?;
    let threads = threads(args.threads);
    let runs = args.runs;
    let manifest = BenchmarkManifest::new(&studies, threads, runs, started);
    if !args.force && figures(&args.out).iter().any(|path| path.exists()) {
        return Err(Error::FolderTaken { dir: args.out.clone(), occupant: "figures of a benchmark".into() });
    }

    let folder = Scratch::new()?;
    let mut measurements = Vec::new();
    for (config, study) in configs.iter().zip(&studies) {
        let pace = measured_pace();
        let forecast = (cost::estimate(study)?.time.at(pace), pace);
        let mut measurement = measure(config, forecast, threads, &folder.0)?;
        // The first run warms the caches and is not counted.
        measurement.runs.clear();
        for _ in 0..runs {
            measurement.runs.extend(measure(config, forecast, threads, &folder.0)?.runs);
        }
        say(&format!("{}: {runs} runs", config.display()));
        measurements.push(measurement);
    }
    manifest.save(&args.out, &measurements)?;
    print(&table(&measurements))?;
    Ok(Ending::Complete)
}

/// The configs named, or those of the default list that are here.
fn configs(named: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    if !named.is_empty() {
        return Ok(named.to_vec());
    }
    let here: Vec<PathBuf> = DEFAULT.iter().map(PathBuf::from).filter(|path| path.exists()).collect();
    if here.is_empty() { Err(Error::NothingToMeasure { looked_for: DEFAULT.join(", ") }) } else { Ok(here) }
}

/// One run of `jointsweep run`, which was foreseen to take so many seconds at a pace.
fn measure(
    config: &Path,
    (forecast, pace): (f64, Pace),
    threads: usize,
    folder: &Path,
) -> Result<Measurement, Error> {
    let failed = |problem: String| Error::MeasuredRun { config: config.into(), problem };
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(program);
    command.arg("run").arg(config).arg("--out").arg(folder);
    command.args(["--threads", &threads.to_string(), "--quiet", "--force", "--again"]).stdin(Stdio::null());
    let started = Instant::now();
    let output = command.output().map_err(|error| failed(error.to_string()))?;
    let process_seconds = started.elapsed().as_secs_f64();
    // Designs that fail are part of what is measured.
    if !matches!(output.status.code(), Some(0 | 2)) {
        return Err(failed(String::from_utf8_lossy(&output.stderr).trim().to_string()));
    }

    let read = |name: &str| {
        let path = folder.join(name);
        std::fs::read(&path).map_err(|source| Error::Io { action: "read", path, source })
    };
    let manifest: Value =
        serde_json::from_slice(&read(MANIFEST)?).map_err(|error| failed(error.to_string()))?;
    let count = |name: &str| manifest["counts"][name].as_u64().unwrap_or(0);
    let stages = manifest["stage_seconds"].as_object().into_iter().flatten();
    let run = Run {
        process_seconds,
        command_seconds: manifest["wall_seconds"].as_f64().unwrap_or(0.0),
        processor_seconds: manifest["processor_seconds"].as_f64(),
        peak_memory_bytes: manifest["peak_memory_bytes"].as_u64(),
        stage_seconds: stages.map(|(name, time)| (name.clone(), time.as_f64().unwrap_or(0.0))).collect(),
    };
    Ok(Measurement {
        config: config.into(),
        designs: count("designs"),
        rows: count("rows"),
        distinct_bodies: count("distinct_bodies"),
        forecast,
        pace,
        table_bytes: manifest["files"][0]["bytes"].as_u64().unwrap_or(0),
        runs: vec![run],
    })
}

/// A folder for results that nobody reads again.
pub(super) struct Scratch(pub(super) PathBuf);

impl Scratch {
    pub(super) fn new() -> Result<Scratch, Error> {
        let path = std::env::temp_dir().join(format!("jointsweep-bench-{}", std::process::id()));
        create_dir(&path)?;
        Ok(Scratch(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What a person wants to see of the measurements.
fn table(measurements: &[Measurement]) -> String {
    let mut lines = vec![
        [
            "config",
            "designs",
            "rows",
            "bodies",
            "median",
            "min",
            "max",
            "designs/s",
            "rows/s",
            "processor",
            "foreseen",
            "memory",
            "table",
        ]
        .map(String::from),
    ];
    let megabytes = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
    for measurement in measurements {
        let Some(time) = measurement.process_seconds() else { continue };
        let rate = |count: u64| format!("{:.0}", count as f64 / time.median);
        lines.push([
            measurement.config.display().to_string(),
            measurement.designs.to_string(),
            measurement.rows.to_string(),
            measurement.distinct_bodies.to_string(),
            duration(time.median),
            duration(time.min),
            duration(time.max),
            rate(measurement.designs),
            rate(measurement.rows),
            measurement.processor_seconds().map_or("?".into(), |time| duration(time.median)),
            duration(measurement.forecast),
            measurement.peak_memory_bytes().map_or("?".into(), megabytes),
            megabytes(measurement.table_bytes),
        ]);
    }
    let mut text = aligned(&lines);
    for measurement in measurements {
        text +=
            &format!("\n{}: time by stage, summed over the threads, medians\n", measurement.config.display());
        for (stage, time) in measurement.stages() {
            text += &format!("  {stage:<32}{}\n", duration(time.median));
        }
    }
    text
}
