//! `jointsweep bench-gpu`: one command that tells whether a GPU is right, how fast it is, and how far from what it can do.
//! It needs the program and a Vulkan driver, nothing else.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::agreement::worst_difference;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::gpu::context::{
    AdapterChoice, AdapterKind, Adapters, GpuDevice, GpuError,
};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::gpu::speed::preferred_precision;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::sweep::{self, Digest, Statistics, SweepOptions};
use jointsweep::internals::lab::gpu::benchmark::{Asked, GpuBenchmark};
use jointsweep::internals::lab::gpu::figures::{GpuSweep, PrecisionRow, ScalingRow};
use jointsweep::internals::lab::gpu::measure::{SWEEP_ACCURACY, body_kernels};
use jointsweep::internals::lab::gpu::roofline::{Peaks, peaks};
use jointsweep::internals::output::folder::ResultFolder;
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

use super::arguments::{count, thread_count, threads};
use super::backend::PrecisionChoice;
use super::bench::Scratch;
use super::gpu_summary::{summary, told};
use super::report::duration;
use super::{Ending, backend, print, say};

#[derive(Args)]
pub struct BenchGpuArgs {
    /// The GPU whose name or driver holds this, software too [default: the best GPU]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Only these numbers [default: f32, and mixed and f64 where the GPU has them]
    #[arg(long, value_enum)]
    precision: Option<PrecisionChoice>,
    /// Designs of the largest sweep
    #[arg(long, value_name = "N", default_value = "1000000", value_parser = count::<u64>)]
    most: u64,
    /// Folder of the figures [default: results/<adapter's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads of the processor [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
}

/// Designs that are all different, solved on meshes at 1 %.
const SWEEP: &str = include_str!("../../configs/random.toml");
const SWEEP_PATH: &str = "configs/random.toml";
const SWEEP_COUNT: &str = "count  = 10000";

/// A size that takes longer is the last one.
const PATIENCE: Duration = Duration::from_secs(120);

/// Sweeps that are done several times, in each precision, should not take longer.
const SHORT: Duration = Duration::from_secs(20);

/// The smallest of the sizes, each ten times the one before.
const SMALLEST: u64 = 100;

/// How much is measured.
struct Effort {
    checked: u64,
    /// Of each sweep in each precision at most, and how often; the median counts.
    designs: u64,
    runs: usize,
    /// Whose bodies the kernels get.
    kernel_designs: u64,
    /// Meshes of the kernels: that of a sweep at 1 %, and one of 0.1 %.
    levels: &'static [usize],
    most_on_cpu: u64,
    remark: Option<&'static str>,
}

impl Effort {
    fn on(kind: AdapterKind, most: u64) -> Effort {
        match kind {
            AdapterKind::Software => Effort {
                checked: most.min(10),
                designs: 10,
                runs: 1,
                kernel_designs: 64,
                levels: &[1],
                most_on_cpu: 100_000,
                remark: Some(
                    "software: fewer designs are checked and measured, once each, small batches; no speed",
                ),
            },
            _ => Effort {
                checked: 1000,
                designs: 100_000,
                runs: 3,
                kernel_designs: 8192,
                levels: &[1, 3],
                most_on_cpu: 100_000,
                remark: None,
            },
        }
    }
}

/// What all measurements share.
struct Bench<'a> {
    gpu: &'a GpuDevice,
    threads: usize,
    effort: Effort,
}

pub fn bench_gpu(args: &BenchGpuArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let choice = args.adapter.as_deref().map_or(AdapterChoice::Best, AdapterChoice::Named);
    backend::quiet_driver();
    let gpu = Adapters::enumerate().open(choice).map_err(into_error)?;
    let precisions: Vec<Precision> = match args.precision {
        Some(asked) => vec![asked.into()],
        None if gpu.facts.features.f64 => vec![Precision::F32, Precision::Mixed, Precision::F64],
        None => vec![Precision::F32],
    };
    precisions.iter().try_for_each(|precision| precision.check(&gpu.facts)).map_err(into_error)?;
    let best = if precisions.len() == 1 {
        precisions[0]
    } else {
        preferred_precision(&gpu, SWEEP_ACCURACY).map_err(into_error)?
    };
    let threads = threads(args.threads);
    let most = args.most;
    let bench = Bench { gpu: &gpu, threads, effort: Effort::on(gpu.facts.kind, most) };
    say(&format!("{}, {}", gpu.facts.name, gpu.facts.driver));

    // Nothing is written before all precisions have been found right.
    let differences = precisions.iter().map(|precision| bench.check(*precision));
    let differences = differences.collect::<Result<Vec<f64>, Error>>()?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(folder_name(&gpu.facts.name)));
    let asked = Asked {
        most,
        precisions: precisions.iter().map(|precision| precision.name()).collect(),
        scaling_precision: best.name(),
        checked_designs: bench.effort.checked,
        kernel_designs: bench.effort.kernel_designs,
        runs: bench.effort.runs,
        most_on_cpu: bench.effort.most_on_cpu,
        threads,
        remark: bench.effort.remark,
    };
    let mut files = GpuBenchmark::create(&out, &gpu.facts, asked, &study(most)?, started)?;
    match bench.measure(&mut files, &precisions, &differences, best, most) {
        Ok(text) => {
            files.finish()?;
            print(&text)?;
            say(&format!("the figures are in {}", out.display()));
            Ok(Ending::Complete)
        }
        Err(error) => {
            files.fail(&error);
            Err(error)
        }
    }
}

impl Bench<'_> {
    /// The worst relative difference of the forces from the processor's, none of it above what is allowed.
    fn check(&self, precision: Precision) -> Result<f64, Error> {
        let study = study(self.effort.checked)?;
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        let statistics = self.sweep(&study, Some(precision), &mut |outcome| found.push(outcome))?.1;
        self.sweep(&study, None, &mut |outcome| expected.push(outcome))?;
        let worst = worst_difference(&found, &expected, allowed(precision)).map_err(|problem| {
            let (adapter, problem) = (self.gpu.facts.name.clone(), problem.to_string());
            Error::WrongAnswer { adapter, precision: precision.name(), problem }
        })?;
        say(&format!(
            "{}: {} designs are the processor's to {worst:.1e} ({} of them it solved itself)",
            precision.name(),
            statistics.designs,
            statistics.designs_on_cpu
        ));
        Ok(worst)
    }

    fn measure(
        &self,
        files: &mut GpuBenchmark,
        precisions: &[Precision],
        differences: &[f64],
        best: Precision,
        most: u64,
    ) -> Result<String, Error> {
        let mut peaks_of = vec![peaks(self.gpu, Precision::F32).map_err(into_error)?];
        if self.gpu.facts.features.f64 {
            peaks_of.push(peaks(self.gpu, Precision::F64).map_err(into_error)?);
        }
        for Peaks { precision, operations, bytes, .. } in &peaks_of {
            let (operations, bytes) = (1e-9 * operations, 1e-9 * bytes);
            say(&format!("peaks, {}: {operations:.0} GFLOP/s, {bytes:.0} GB/s", precision.name()));
        }
        files.save_peaks(&peaks_of)?;

        let cases =
            study(self.effort.kernel_designs)?.cases()?.collect::<Result<Vec<DesignCase>, Error>>()?;
        let is_software = self.gpu.facts.kind == AdapterKind::Software;
        let kernel_precisions = if is_software { &[best] } else { precisions };
        let mut kernels = Vec::new();
        for &precision in kernel_precisions {
            let choice = GpuChoice::new(self.gpu, precision);
            for &level in self.effort.levels {
                kernels.extend(body_kernels(choice, &cases, level).map_err(into_error)?);
                say(&format!("kernels of bodies, {}, mesh level {level}", precision.name()));
            }
        }
        files.save_kernels(&kernels, &peaks_of)?;

        let mut scaling = Vec::new();
        for designs in sizes(most) {
            let started = Instant::now();
            scaling.push(self.size(files, best, designs)?);
            files.save_scaling(&scaling)?;
            if started.elapsed() > PATIENCE && designs < most {
                let remark = format!(
                    "{designs} designs took {}: no larger sweeps",
                    duration(started.elapsed().as_secs_f64())
                );
                say(&remark);
                files.remark(remark);
                break;
            }
        }
        let designs = self.precision_designs(&scaling);
        let mut rows = Vec::new();
        for (precision, difference) in precisions.iter().zip(differences) {
            rows.push(self.precision(*precision, designs, *difference)?);
        }
        files.save_precisions(&rows)?;
        Ok(summary(self.gpu, &rows, &scaling, &kernels, &peaks_of))
    }

    /// As many designs as were done in a short time.
    fn precision_designs(&self, scaling: &[ScalingRow]) -> u64 {
        let sweeps = scaling.iter().map(|row| &row.sweep).filter(|sweep| sweep.seconds < SHORT.as_secs_f64());
        sweeps.map(|sweep| sweep.designs).max().unwrap_or(SMALLEST).min(self.effort.designs)
    }

    /// The run of the median time.
    fn precision(
        &self,
        precision: Precision,
        designs: u64,
        worst_difference: f64,
    ) -> Result<PrecisionRow, Error> {
        let study = study(designs)?;
        let mut sweeps = (0..self.effort.runs)
            .map(|_| self.dropped(&study, precision))
            .collect::<Result<Vec<GpuSweep>, Error>>()?;
        sweeps.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let sweep = sweeps.swap_remove(self.effort.runs / 2);
        say(&format!("{}: {}", precision.name(), told(&sweep)));
        let checked = self.effort.checked;
        Ok(PrecisionRow { precision: precision.name(), sweep, checked, worst_difference })
    }

    fn size(
        &self,
        files: &mut GpuBenchmark,
        precision: Precision,
        designs: u64,
    ) -> Result<ScalingRow, Error> {
        let study = study(designs)?;
        let sweep = self.dropped(&study, precision)?;
        let with_table = match self.with_table(&study, precision) {
            Ok(figures) => Some(figures),
            // The temporary folder may be small; all else is still worth knowing.
            Err(error @ Error::Io { .. }) => {
                files.remark(format!("{designs} designs without a table: {error}"));
                None
            }
            Err(error) => return Err(error),
        };
        let cpu_seconds = if designs <= self.effort.most_on_cpu {
            Some(self.sweep(&study, None, &mut drop)?.0)
        } else {
            None
        };
        say(&told(&sweep));
        Ok(ScalingRow { precision: precision.name(), sweep, with_table, cpu_seconds })
    }

    /// A sweep on the GPU whose outcomes nobody keeps.
    fn dropped(&self, study: &Study, precision: Precision) -> Result<GpuSweep, Error> {
        let (seconds, statistics) = self.sweep(study, Some(precision), &mut drop)?;
        Ok(GpuSweep {
            designs: statistics.designs,
            seconds,
            solves: statistics.solves,
            designs_on_cpu: statistics.designs_on_cpu,
            worst_residual: statistics.worst_residual.unwrap_or(0.0),
            stages: statistics
                .stages
                .iter()
                .map(|(name, time)| (name.to_string(), time.as_secs_f64()))
                .collect(),
        })
    }

    /// Wall time of a sweep on the GPU with its table on disk, s, and the bytes of the table.
    fn with_table(&self, study: &Study, precision: Precision) -> Result<(f64, u64), Error> {
        let scratch = Scratch::new()?;
        let folder = ResultFolder::of_run(Some(&scratch.0), study);
        let gpu = Some(GpuChoice::new(self.gpu, precision));
        let started = Instant::now();
        let conditions = Conditions { gpu, threads: self.threads, started: SystemTime::now() };
        let mut recorder = Recorder::new(folder.claim("of bench-gpu")?, study, &conditions)?;
        let options = SweepOptions { threads: self.threads, gpu, ..SweepOptions::default() };
        let sinks = recorder.sinks();
        let digest = Digest { designs: sinks.portion(), make: &|outcomes| sinks.rows(outcomes) };
        let statistics = sweep::run_digested(study, &options, &digest, &mut |rows| {
            recorder.write(&rows)?;
            Ok(ControlFlow::Continue(()))
        })?;
        recorder.finish(&statistics)?;
        let seconds = started.elapsed().as_secs_f64();
        self.is_measured(&statistics, precision)?;
        let path: PathBuf = folder.table(study);
        let bytes =
            std::fs::metadata(&path).map_err(|source| Error::Io { action: "read", path, source })?.len();
        Ok((seconds, bytes))
    }

    /// Wall time of a sweep, s; on the processor without a precision. A GPU that gives up is an error.
    fn sweep(
        &self,
        study: &Study,
        precision: Option<Precision>,
        receive: &mut dyn FnMut(DesignOutcome),
    ) -> Result<(f64, Statistics), Error> {
        let gpu = precision.map(|precision| GpuChoice::new(self.gpu, precision));
        let options = SweepOptions { threads: self.threads, gpu, ..SweepOptions::default() };
        let started = Instant::now();
        let statistics = sweep::run(study, &options, &mut |outcome| {
            receive(outcome);
            Ok(ControlFlow::Continue(()))
        })?;
        let seconds = started.elapsed().as_secs_f64();
        if let Some(precision) = precision {
            self.is_measured(&statistics, precision)?;
        }
        Ok((seconds, statistics))
    }

    /// Whether the GPU has computed what it is measured by.
    fn is_measured(&self, statistics: &Statistics, precision: Precision) -> Result<(), Error> {
        let problem = match &statistics.fallback {
            Some(problem) => problem.clone(),
            None if statistics.designs_on_cpu == statistics.designs => {
                "the processor had to solve every design".to_string()
            }
            None => return Ok(()),
        };
        let adapter = self.gpu.facts.name.clone();
        Err(Error::NotMeasured { adapter, precision: precision.name(), problem })
    }
}

fn into_error(error: GpuError) -> Error {
    Error::Adapter { problem: error.to_string() }
}

/// The sweep with so many designs.
fn study(designs: u64) -> Result<Study, Error> {
    let text = SWEEP.replace(SWEEP_COUNT, &format!("count  = {designs}"));
    Study::from_text(Path::new(SWEEP_PATH), text)
}

/// Relative, of the forces: more than `tests/gpu_parity` allows, since other devices round otherwise.
fn allowed(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-4,
        Precision::Mixed => 1e-7,
        Precision::F64 => 1e-9,
    }
}

/// 100, 1,000 and so on, and at last the most.
fn sizes(most: u64) -> Vec<u64> {
    let powers = std::iter::successors(Some(SMALLEST), |size| size.checked_mul(10));
    powers.take_while(|size| *size < most).chain([most]).collect()
}

/// An adapter's name as that of a folder.
fn folder_name(adapter: &str) -> String {
    let words = adapter.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sweep_has_as_many_designs_as_asked() {
        for designs in [1, 100, 1_000_000] {
            assert_eq!(study(designs).unwrap().design_count(), designs);
        }
    }

    #[test]
    fn sizes_end_with_the_most() {
        assert_eq!(sizes(1_000_000), [100, 1000, 10_000, 100_000, 1_000_000]);
        assert_eq!(sizes(2500), [100, 1000, 2500]);
        assert_eq!(sizes(100), [100]);
        assert_eq!(sizes(20), [20]);
    }

    #[test]
    fn folders_are_called_as_adapters_without_signs() {
        assert_eq!(folder_name("NVIDIA H200"), "nvidia-h200");
        assert_eq!(folder_name("llvmpipe (LLVM 15.0.6, 256 bits)"), "llvmpipe-llvm-15-0-6-256-bits");
    }
}
