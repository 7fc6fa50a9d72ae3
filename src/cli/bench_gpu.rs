//! `jointsweep bench-gpu`: one command that tells whether a GPU is right, how fast it is, and how far from what it can do.
//! It needs the program and a Vulkan driver, nothing else.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, AdapterKind, Adapters, GpuError};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::joints::SolvedJoints;
use jointsweep::internals::lab::gpu::benchmark::{Asked, GpuBenchmark};
use jointsweep::internals::lab::gpu::budget::Budget;
use jointsweep::internals::lab::gpu::figures::{AnswersRow, GpuSweep, PrecisionRow, ScalingRow};
use jointsweep::internals::lab::gpu::measure::{KernelTime, SWEEP_ACCURACY, body_kernels, joint_kernel};
use jointsweep::internals::lab::gpu::measured_sweep::{MeasuredSweep, SWEEPS};
use jointsweep::internals::lab::gpu::roofline::{Peaks, peaks};
use jointsweep::internals::output::folder::{GPU_BENCHMARK, Permissions, ResultFolder};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

use super::arguments::{count, thread_count, threads};
use super::backend::PrecisionChoice;
use super::gpu_summary::{summary, told};
use super::gpu_sweeps::{Checked, TimedSweeps};
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
    /// Overwrite figures of other sizes, or another result
    #[arg(long)]
    force: bool,
    /// Time that all of it may take, like 8min or 90s: the most important figures come first, and what there is no time for is left out
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    budget: Option<Duration>,
    /// Threads of the processor [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
}

/// The sweep that checks, and that each precision is timed with.
const FIRST: MeasuredSweep = SWEEPS[0];

/// Designs that a check begins with.
const FEW_CHECKED: u64 = 10;

/// No kernel is timed where less time is left.
const FOR_KERNELS: Duration = Duration::from_secs(60);

/// A size that takes longer is the last one.
const PATIENCE: Duration = Duration::from_secs(120);

/// Sweeps that are done several times, in each precision, should not take longer.
const SHORT: Duration = Duration::from_secs(20);

/// So many times the designs of the largest sweep are interpolated, with answers instead of a table.
const MANY_ANSWERS: u64 = 100;

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
    /// Of the largest sweep of each kind but the first.
    most_of_others: u64,
    most_of_answers: u64,
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
                most_of_others: most.min(10),
                most_of_answers: most.min(100),
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
                most_on_cpu: 1_000_000,
                most_of_others: most.min(100_000),
                most_of_answers: most.saturating_mul(MANY_ANSWERS),
                remark: None,
            },
        }
    }
}

/// What all measurements share.
struct Bench<'a> {
    sweeps: TimedSweeps<'a>,
    effort: Effort,
}

pub fn bench_gpu(args: &BenchGpuArgs) -> Result<Ending, Error> {
    let (started, opened) = (SystemTime::now(), Instant::now());
    let choice = args.adapter.as_deref().map_or(AdapterChoice::Best, AdapterChoice::Named);
    backend::quiet_driver();
    let gpu = Adapters::enumerate().open(choice).map_err(into_error)?.timed();
    let precisions: Vec<Precision> = match args.precision {
        Some(asked) => vec![asked.into()],
        None if gpu.facts.features.f64 => vec![Precision::F32, Precision::Mixed, Precision::F64],
        None => vec![Precision::F32],
    };
    precisions.iter().try_for_each(|precision| precision.check(&gpu.facts)).map_err(into_error)?;
    let best =
        if precisions.len() == 1 { precisions[0] } else { Precision::preferred(&gpu.facts, SWEEP_ACCURACY) };
    let threads = threads(args.threads);
    let most = args.most;
    let budget = Budget::new(args.budget.map(|budget| budget.saturating_sub(opened.elapsed())));
    let sweeps = TimedSweeps { gpu: &gpu, threads, budget };
    let bench = Bench { sweeps, effort: Effort::on(gpu.facts.kind, most) };
    let study = FIRST.study(most, false)?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(folder_name(&gpu.facts.name)));
    let folder = ResultFolder::new(&GPU_BENCHMARK, out);
    // Times are measured anew.
    folder.check(&study, Permissions { force: args.force, again: true })?;
    say(&format!("{}, {}", gpu.facts.name, gpu.facts.driver));

    // Nothing is written before all precisions have been found right.
    let checks = precisions.iter().map(|precision| bench.check(*precision, precisions.len()));
    let checks = checks.collect::<Result<Vec<Checked>, Error>>()?;
    let asked = Asked {
        most,
        precisions: precisions.iter().map(|precision| precision.name()).collect(),
        scaling_precision: best.name(),
        checked_designs: checks.iter().map(|check| check.designs).min().unwrap_or(0),
        kernel_designs: bench.effort.kernel_designs,
        runs: bench.effort.runs,
        most_on_cpu: bench.effort.most_on_cpu,
        threads,
        budget_seconds: args.budget.map(|budget| budget.as_secs_f64()),
        remark: bench.effort.remark,
    };
    let claim = folder.claim("of `jointsweep bench-gpu`")?;
    let mut files = GpuBenchmark::create(claim, &gpu.facts, asked, &study, started)?;
    match bench.measure(&mut files, &precisions, &checks, best, most) {
        Ok(text) => {
            files.finish()?;
            print(&text)?;
            say(&format!("the figures are in {}", folder.dir().display()));
            Ok(Ending::Complete)
        }
        Err(error) => {
            files.fail(&error);
            Err(error)
        }
    }
}

impl Bench<'_> {
    /// As many designs as there is time for, none of whose forces is off by more than is allowed.
    fn check(&self, precision: Precision, precisions: usize) -> Result<Checked, Error> {
        let started = Instant::now();
        let few = self.sweeps.checked(&FIRST, precision, self.effort.checked.min(FEW_CHECKED))?;
        let forecast = started.elapsed().as_secs_f64() * self.effort.checked as f64 / few.designs as f64;
        // Other precisions come after it, and then all that is measured.
        let is_all = few.designs == self.effort.checked;
        let checked = if is_all || !self.sweeps.budget.bears(2.0 * forecast * precisions as f64) {
            few
        } else {
            self.sweeps.checked(&FIRST, precision, self.effort.checked)?
        };
        let Checked { designs, worst_difference } = checked;
        say(&format!(
            "{}: {designs} designs are the processor's to {worst_difference:.1e}",
            precision.name()
        ));
        Ok(checked)
    }

    fn measure(
        &self,
        files: &mut GpuBenchmark,
        precisions: &[Precision],
        checks: &[Checked],
        best: Precision,
        most: u64,
    ) -> Result<String, Error> {
        let mut peaks_of = vec![peaks(self.sweeps.gpu, Precision::F32).map_err(into_error)?];
        if self.sweeps.gpu.facts.features.f64 {
            peaks_of.push(peaks(self.sweeps.gpu, Precision::F64).map_err(into_error)?);
        }
        for Peaks { precision, operations, bytes, cached_bytes, workgroup_bytes, .. } in &peaks_of {
            let [operations, bytes, cached, own] =
                [operations, bytes, cached_bytes, workgroup_bytes].map(|rate| 1e-9 * rate);
            say(&format!(
                "peaks, {}: {operations:.0} GFLOP/s, {bytes:.0} GB/s of memory, {cached:.0} of its cache, {own:.0} of workgroups' own",
                precision.name()
            ));
        }
        files.save_peaks(&peaks_of)?;

        let mut scaling = Vec::new();
        let [first, others @ ..] = &SWEEPS;
        self.sizes(files, &mut scaling, *first, best, most)?;
        self.answers(files, GpuChoice::new(self.sweeps.gpu, best), most)?;
        let rows = self.precisions(files, &scaling, precisions, checks)?;
        let kernels = self.kernels(files, &peaks_of, precisions, best)?;
        for measured in others {
            self.sizes(files, &mut scaling, *measured, best, self.effort.most_of_others)?;
        }
        Ok(summary(self.sweeps.gpu, &rows, &scaling, &kernels, &peaks_of))
    }

    /// Every size of a sweep that there is time for.
    fn sizes(
        &self,
        files: &mut GpuBenchmark,
        scaling: &mut Vec<ScalingRow>,
        measured: MeasuredSweep,
        precision: Precision,
        most: u64,
    ) -> Result<(), Error> {
        let MeasuredSweep { scene, accuracy, solver, .. } = measured;
        let called = format!("{scene}, {accuracy}, {}", solver.name());
        let mut before: Option<(u64, f64)> = None;
        for designs in sizes(most) {
            let forecast = before.map_or(0.0, |(known, taken)| taken * designs as f64 / known as f64);
            let is_long = before.is_some_and(|(_, taken)| taken > PATIENCE.as_secs_f64());
            let started = Instant::now();
            let row = if is_long || !self.sweeps.budget.bears(forecast) {
                None
            } else {
                self.size(files, measured, precision, designs)?
            };
            let Some(row) = row else {
                let foreseen = if forecast > 0.0 {
                    format!(", which would take {}", duration(forecast))
                } else {
                    String::new()
                };
                self.left_out(files, &format!("{called}: {designs} designs and more{foreseen}"));
                break;
            };
            say(&format!("{called}: {}", told(&row.sweep)));
            before = Some((designs, started.elapsed().as_secs_f64()));
            scaling.push(row);
            files.save_scaling(scaling)?;
        }
        Ok(())
    }

    /// With answers instead of a table, condensed and then interpolated: every size that there is time for.
    fn answers(&self, files: &mut GpuBenchmark, gpu: GpuChoice, most: u64) -> Result<(), Error> {
        let mut rows: Vec<AnswersRow> = Vec::new();
        for (is_interpolated, bodies, most) in
            [(false, "condensed", most), (true, "interpolated", self.effort.most_of_answers)]
        {
            let mut before: Option<(u64, f64)> = None;
            for designs in sizes(most) {
                let forecast = before.map_or(0.0, |(known, taken)| taken * designs as f64 / known as f64);
                let is_long = before.is_some_and(|(_, taken)| taken > PATIENCE.as_secs_f64());
                let budget = &self.sweeps.budget;
                let is_in_time = !is_long && !budget.is_over() && budget.bears(forecast);
                let study = FIRST.answers(designs, is_interpolated)?;
                let answered = is_in_time.then(|| self.sweeps.with_answers(&study, Some(gpu))).transpose()?;
                let Some((gpu_seconds, asked)) = answered.flatten() else {
                    self.left_out(files, &format!("answers to {designs} designs and more, {bodies}"));
                    break;
                };
                let is_for_cpu = designs <= self.effort.most_on_cpu;
                let on_cpu =
                    is_for_cpu.then(|| self.sweeps.with_answers(&study, None)).transpose()?.flatten();
                let cpu_seconds = on_cpu.map(|(seconds, _)| seconds);
                say(&format!("answers to {designs} designs, {bodies}: {}", duration(gpu_seconds)));
                before = Some((designs, gpu_seconds));
                let is_timed = gpu.device.is_timed();
                rows.push(AnswersRow { is_interpolated, designs, gpu_seconds, cpu_seconds, asked, is_timed });
                files.save_answers(&rows)?;
            }
        }
        Ok(())
    }

    fn left_out(&self, files: &mut GpuBenchmark, what: &str) {
        let remark = format!("no time for {what}");
        say(&remark);
        files.remark(remark);
    }

    /// Each precision on as many designs as were done in a short time.
    fn precisions(
        &self,
        files: &mut GpuBenchmark,
        scaling: &[ScalingRow],
        precisions: &[Precision],
        checks: &[Checked],
    ) -> Result<Vec<PrecisionRow>, Error> {
        let runs = (self.effort.runs * precisions.len()) as f64;
        let sweeps = scaling.iter().map(|row| &row.sweep);
        let short = sweeps.filter(|sweep| {
            sweep.seconds < SHORT.as_secs_f64() && self.sweeps.budget.bears(runs * sweep.seconds)
        });
        let mut rows = Vec::new();
        if let Some(designs) = short.map(|sweep| sweep.designs).max() {
            let designs = designs.min(self.effort.designs);
            for (precision, checked) in precisions.iter().zip(checks) {
                rows.extend(self.precision(*precision, designs, *checked)?);
            }
        }
        if rows.len() < precisions.len() {
            self.left_out(files, "sweeps in each precision");
        }
        files.save_precisions(&rows)?;
        Ok(rows)
    }

    /// The run of the median time; nothing where time runs out.
    fn precision(
        &self,
        precision: Precision,
        designs: u64,
        checked: Checked,
    ) -> Result<Option<PrecisionRow>, Error> {
        let study = FIRST.study(designs, false)?;
        let gpu = GpuChoice::new(self.sweeps.gpu, precision);
        let sweeps =
            (0..self.effort.runs).map(|_| self.sweeps.dropped(&study, gpu)).collect::<Result<Vec<_>, _>>()?;
        let Some(mut sweeps) = sweeps.into_iter().collect::<Option<Vec<GpuSweep>>>() else { return Ok(None) };
        sweeps.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let sweep = sweeps.swap_remove(self.effort.runs / 2);
        say(&format!("{}: {}", precision.name(), told(&sweep)));
        let Checked { designs: checked, worst_difference } = checked;
        Ok(Some(PrecisionRow { precision: precision.name(), sweep, checked, worst_difference }))
    }

    /// Each kernel of both solvers, alone.
    fn kernels(
        &self,
        files: &mut GpuBenchmark,
        peaks_of: &[Peaks],
        precisions: &[Precision],
        best: Precision,
    ) -> Result<Vec<KernelTime>, Error> {
        let study = FIRST.study(self.effort.kernel_designs, false)?;
        let cases = study.cases()?.collect::<Result<Vec<DesignCase>, Error>>()?;
        let is_software = self.sweeps.gpu.facts.kind == AdapterKind::Software;
        let precisions = if is_software { &[best] } else { precisions };
        let mut kernels = Vec::new();
        for &precision in precisions {
            for &level in self.effort.levels {
                let called = format!("kernels of bodies, {}, mesh level {level}", precision.name());
                if self.sweeps.budget.left().is_some_and(|left| left < FOR_KERNELS) {
                    self.left_out(files, &called);
                    continue;
                }
                let choice = GpuChoice::new(self.sweeps.gpu, precision);
                kernels.extend(body_kernels(choice, &cases, level).map_err(into_error)?);
                say(&called);
            }
        }
        let is_in_time = self.sweeps.budget.left().is_none_or(|left| left >= FOR_KERNELS);
        if is_in_time && precisions.contains(&Precision::F32) {
            kernels.push(joint_kernel(self.sweeps.gpu).map_err(into_error)?);
            say("kernel of joints");
        }
        files.save_kernels(&kernels, peaks_of)?;
        Ok(kernels)
    }

    /// Nothing where time runs out.
    fn size(
        &self,
        files: &mut GpuBenchmark,
        measured: MeasuredSweep,
        precision: Precision,
        designs: u64,
    ) -> Result<Option<ScalingRow>, Error> {
        let study = measured.study(designs, false)?;
        let gpu = GpuChoice { solver: measured.solver, ..GpuChoice::new(self.sweeps.gpu, precision) };
        let Some(sweep) = self.sweeps.dropped(&study, gpu)? else { return Ok(None) };
        let with_table = match self.sweeps.with_table(&study, gpu) {
            Ok(figures) => figures,
            // The temporary folder may be small; all else is still worth knowing.
            Err(error @ Error::Io { .. }) => {
                files.remark(format!("{designs} designs without a table: {error}"));
                None
            }
            Err(error) => return Err(error),
        };
        let interpolated = measured.study(designs, true)?;
        let on_cpu = |study: &Study| -> Result<Option<f64>, Error> {
            if designs > self.effort.most_on_cpu {
                return Ok(None);
            }
            self.sweeps.on_cpu(study)
        };
        Ok(Some(ScalingRow {
            measured,
            precision: precision.name(),
            sweep,
            with_table,
            cpu_seconds: on_cpu(&study)?,
            cpu_interpolated_seconds: on_cpu(&interpolated)?,
            gpu_interpolated_seconds: match gpu.joints {
                SolvedJoints::None => None,
                _ => self.sweeps.dropped(&interpolated, gpu)?.map(|sweep| sweep.seconds),
            },
        }))
    }
}

fn into_error(error: GpuError) -> Error {
    Error::Adapter { problem: error.to_string() }
}

/// A time above zero, like 8min or 90 s.
fn time(text: &str) -> Result<Duration, String> {
    let refused = || "a time is needed, like 90s, 8min or 1h".to_string();
    let unit = text.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(refused)?;
    let (number, unit) = text.split_at(unit);
    let seconds = match unit {
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(refused()),
    };
    let number: f64 = number.trim().parse().map_err(|_| refused())?;
    let time = Duration::try_from_secs_f64(number * seconds).map_err(|_| refused())?;
    if time.is_zero() { Err(refused()) } else { Ok(time) }
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
