//! `sweep.csv` and `sweep.manifest.json`: what whole runs of sweeps took, and on what machine.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Serialize;

use crate::engine::unit_costs::Pace;
use crate::error::Error;
use crate::output::host::{Host, Program, seconds_since, utc};
use crate::output::manifest;
use crate::output::manifest_parts::Config;
use crate::output::whole_file;
use crate::study::config::Study;

/// One run in a process of its own.
#[derive(Clone, Debug)]
pub struct Run {
    /// From the start of the process to its end.
    pub process_seconds: f64,
    /// From the start of the command to its manifest: the same without loading and ending the process.
    pub command_seconds: f64,
    /// Time of all processors; other programs on the machine hardly change it.
    pub processor_seconds: Option<f64>,
    pub peak_memory_bytes: Option<u64>,
    /// Time by stage, summed over the threads, in the order of the stages.
    pub stage_seconds: Vec<(String, f64)>,
}

/// All runs of one config.
#[derive(Clone, Debug)]
pub struct Measurement {
    pub config: PathBuf,
    pub designs: u64,
    pub rows: u64,
    pub distinct_bodies: u64,
    /// Core time that was foreseen, s,
    pub forecast: f64,
    /// for the pace that the machine had just before.
    pub pace: Pace,
    pub table_bytes: u64,
    pub runs: Vec<Run>,
}

/// The least, the median and the greatest of a figure over the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    pub min: f64,
    pub median: f64,
    pub max: f64,
}

impl Spread {
    /// `None` without values. Of an even count the lower of the two middle ones.
    fn of(values: impl IntoIterator<Item = f64>) -> Option<Spread> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let middle = values.len().checked_sub(1)? / 2;
        Some(Spread { min: values[0], median: values[middle], max: values[values.len() - 1] })
    }
}

impl Measurement {
    pub fn process_seconds(&self) -> Option<Spread> {
        Spread::of(self.runs.iter().map(|run| run.process_seconds))
    }

    pub fn command_seconds(&self) -> Option<Spread> {
        Spread::of(self.runs.iter().map(|run| run.command_seconds))
    }

    pub fn processor_seconds(&self) -> Option<Spread> {
        Spread::of(self.runs.iter().filter_map(|run| run.processor_seconds))
    }

    /// Of the run that needed most.
    pub fn peak_memory_bytes(&self) -> Option<u64> {
        self.runs.iter().filter_map(|run| run.peak_memory_bytes).max()
    }

    /// The stages with their times.
    pub fn stages(&self) -> Vec<(String, Spread)> {
        let names = self.runs.first().map_or(&[][..], |run| &run.stage_seconds);
        let of_stage = |stage: &str| {
            let times = self.runs.iter().flat_map(|run| &run.stage_seconds);
            Spread::of(times.filter(|(name, _)| name == stage).map(|(_, seconds)| *seconds))
        };
        names.iter().filter_map(|(name, _)| Some((name.clone(), of_stage(name)?))).collect()
    }
}

/// How it was measured.
#[derive(Clone, Debug, Serialize)]
pub struct BenchmarkManifest {
    #[serde(flatten)]
    program: Program,
    threads: usize,
    /// Measured runs of each config, after one that is not.
    runs: usize,
    configs: Vec<Config>,
    started_utc: String,
    wall_seconds: f64,
    host: Host,
    #[serde(skip)]
    started: SystemTime,
}

impl BenchmarkManifest {
    pub fn new(studies: &[Study], threads: usize, runs: usize, started: SystemTime) -> BenchmarkManifest {
        BenchmarkManifest {
            program: Program::CURRENT,
            threads,
            runs,
            configs: studies.iter().map(Config::of).collect(),
            started_utc: utc(started),
            wall_seconds: 0.0,
            host: Host::current(),
            started,
        }
    }

    /// Writes both files into `dir`, the manifest last.
    pub fn save(mut self, dir: &Path, measurements: &[Measurement]) -> Result<(), Error> {
        whole_file::create_dir(dir)?;
        let [table, conditions] = figures(dir);
        whole_file::write_whole(&table, text(measurements).as_bytes())?;
        self.wall_seconds = seconds_since(self.started);
        manifest::write(&self, &conditions)
    }
}

/// The files of a benchmark in a folder, the manifest last.
pub fn figures(dir: &Path) -> [PathBuf; 2] {
    ["sweep.csv", "sweep.manifest.json"].map(|name| dir.join(name))
}

/// One row a config; times of stages are medians. A figure that the system does not tell is an empty cell.
fn text(measurements: &[Measurement]) -> String {
    let mut header = "config,designs,rows,distinct_bodies,process_min_s,process_median_s,process_max_s,\
                      command_median_s,designs_per_s,rows_per_s,processor_median_s,forecast_core_s,pace_in_lanes,pace_others,peak_memory_bytes,table_bytes"
        .to_string();
    let stages = measurements.first().map(Measurement::stages).unwrap_or_default();
    for (stage, _) in &stages {
        header += &format!(",{}_core_s", stage.replace(' ', "_"));
    }
    let mut text = header + "\n";
    for measurement in measurements {
        let Measurement { config, forecast, pace, designs, rows, distinct_bodies, table_bytes, .. } =
            measurement;
        let (Some(process), Some(command)) = (measurement.process_seconds(), measurement.command_seconds())
        else {
            continue;
        };
        let rate = |count: u64| count as f64 / process.median;
        let processor = measurement.processor_seconds().map_or(String::new(), |s| format!("{:.4}", s.median));
        let memory = measurement.peak_memory_bytes().map_or(String::new(), |bytes| bytes.to_string());
        text += &format!(
            "{},{designs},{rows},{distinct_bodies},{:.4},{:.4},{:.4},{:.4},{:.0},{:.0},{processor},{forecast:.4},{:.3},{:.3},{memory},{table_bytes}",
            cell(&config.display().to_string()),
            process.min,
            process.median,
            process.max,
            command.median,
            rate(*designs),
            rate(*rows),
            pace.in_lanes,
            pace.others,
        );
        let own = measurement.stages();
        for (stage, _) in &stages {
            let time = own.iter().find(|(name, _)| name == stage);
            text += &time.map_or(",".to_string(), |(_, spread)| format!(",{:.4}", spread.median));
        }
        text.push('\n');
    }
    text
}

/// A text as a cell: only a path can ask for quotes here.
fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(process_seconds: f64, stage: f64) -> Run {
        Run {
            process_seconds,
            command_seconds: 0.5 * process_seconds,
            processor_seconds: Some(3.0 * process_seconds),
            peak_memory_bytes: Some((1e6 * process_seconds) as u64),
            stage_seconds: vec![("near fields".into(), stage), ("table".into(), 0.25)],
        }
    }

    #[test]
    fn rates_are_those_of_the_median_process() {
        let measurement = Measurement {
            config: "a, b.toml".into(),
            designs: 100,
            rows: 1000,
            distinct_bodies: 7,
            forecast: 3.5,
            pace: Pace { in_lanes: 4.0, others: 2.0 },
            table_bytes: 12_345,
            runs: vec![run(4.0, 3.0), run(1.0, 1.0), run(2.0, 2.0)],
        };
        let text = text(&[measurement]);
        let (header, row) = text.trim_end().split_once('\n').unwrap();
        assert!(header.ends_with("table_bytes,near_fields_core_s,table_core_s"), "{header}");
        assert_eq!(
            row,
            "\"a, b.toml\",100,1000,7,1.0000,2.0000,4.0000,1.0000,50,500,6.0000,3.5000,4.000,2.000,4000000,12345,2.0000,0.2500"
        );
    }
}
