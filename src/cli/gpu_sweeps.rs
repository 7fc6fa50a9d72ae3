//! Whole sweeps on a GPU or beside it, checked and timed: what `jointsweep bench-gpu` is made of.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Instant, SystemTime};

use jointsweep::Error;
use jointsweep::internals::engine::agreement::worst_difference;
use jointsweep::internals::engine::backend::Counts;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::gpu::context::GpuDevice;
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::question::Asker;
use jointsweep::internals::engine::sweep::{self, Digest, Statistics, SweepOptions};
use jointsweep::internals::lab::gpu::budget::Budget;
use jointsweep::internals::lab::gpu::figures::GpuSweep;
use jointsweep::internals::lab::gpu::measured_sweep::MeasuredSweep;
use jointsweep::internals::output::folder::ResultFolder;
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::study::config::Study;

use super::bench::Scratch;

/// Sweeps that end when the time of all is over.
pub struct TimedSweeps<'a> {
    pub gpu: &'a GpuDevice,
    pub threads: usize,
    pub budget: Budget,
}

/// Forces that were compared, and the worst relative difference.
#[derive(Clone, Copy)]
pub struct Checked {
    pub designs: u64,
    pub worst_difference: f64,
}

impl TimedSweeps<'_> {
    /// Against the processor, whatever the time.
    pub fn checked(
        &self,
        measured: &MeasuredSweep,
        precision: Precision,
        designs: u64,
    ) -> Result<Checked, Error> {
        let study = measured.study(designs, false)?;
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        let gpu = GpuChoice::new(self.gpu, precision);
        let on_gpu = SweepOptions { gpu: Some(gpu), ..self.options() };
        let statistics = self.sweep(&study, &on_gpu, &mut |outcome| {
            found.push(outcome);
            ControlFlow::Continue(())
        })?;
        self.is_measured(&statistics.1, precision)?;
        let in_double = SweepOptions { in_double: true, ..self.options() };
        self.sweep(&study, &in_double, &mut |outcome| {
            expected.push(outcome);
            ControlFlow::Continue(())
        })?;
        let worst_difference =
            worst_difference(&found, &expected, allowed(precision)).map_err(|problem| {
                let (adapter, problem) = (self.gpu.facts.name.clone(), problem.to_string());
                Error::WrongAnswer { adapter, precision: precision.name(), problem }
            })?;
        Ok(Checked { designs, worst_difference })
    }

    fn goes_on(&self) -> ControlFlow<()> {
        if self.budget.is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// A sweep on the GPU whose outcomes nobody keeps; nothing where time runs out.
    pub fn dropped(&self, study: &Study, gpu: GpuChoice) -> Result<Option<GpuSweep>, Error> {
        let kernels = self.gpu.making_kernels();
        let (seconds, statistics) =
            self.sweep(study, &SweepOptions { gpu: Some(gpu), ..self.options() }, &mut |_| self.goes_on())?;
        if statistics.interrupted {
            return Ok(None);
        }
        self.is_measured(&statistics, gpu.precision)?;
        Ok(Some(GpuSweep {
            designs: statistics.designs,
            seconds,
            solves: statistics.solves,
            designs_on_cpu: statistics.designs_on_cpu,
            worst_residual: statistics.worst_residual.unwrap_or(0.0),
            asked: statistics.asked,
            kernels_seconds: (self.gpu.making_kernels() - kernels).as_secs_f64(),
            is_timed: self.gpu.is_timed(),
            stages: statistics
                .stages
                .iter()
                .map(|(name, time)| (name.to_string(), time.as_secs_f64()))
                .collect(),
        }))
    }

    /// Wall time of a sweep on the GPU with its table on disk, s, and the bytes of the table; nothing where time runs out.
    pub fn with_table(&self, study: &Study, gpu: GpuChoice) -> Result<Option<(f64, u64)>, Error> {
        let scratch = Scratch::new()?;
        let folder = ResultFolder::of_run(Some(&scratch.0), study);
        let Some((seconds, _)) = self.written(study, &folder, Some(gpu))? else { return Ok(None) };
        let path: PathBuf = folder.table(study);
        let bytes =
            std::fs::metadata(&path).map_err(|source| Error::Io { action: "read", path, source })?.len();
        Ok(Some((seconds, bytes)))
    }

    /// Wall time of a sweep on the GPU, or the processor, with its answers on disk, s, and what was asked of the GPU; nothing
    /// where time runs out.
    pub fn with_answers(
        &self,
        study: &Study,
        gpu: Option<GpuChoice>,
    ) -> Result<Option<(f64, Counts)>, Error> {
        let scratch = Scratch::new()?;
        self.written(study, &ResultFolder::of_run(Some(&scratch.0), study), gpu)
    }

    fn written(
        &self,
        study: &Study,
        folder: &ResultFolder,
        gpu: Option<GpuChoice>,
    ) -> Result<Option<(f64, Counts)>, Error> {
        let started = Instant::now();
        let conditions = Conditions { gpu, threads: self.threads, started: SystemTime::now(), anew: false };
        let mut recorder = Recorder::new(folder.claim("of bench-gpu")?, study, &conditions)?;
        let sinks = recorder.sinks();
        let asking = sinks.asking();
        let asker = asking.as_ref().map(|asking| asking as &dyn Asker);
        let options = SweepOptions { gpu, asker, ..self.options() };
        let digest = Digest { designs: sinks.portion(), make: &|solved| sinks.rows(solved) };
        let statistics = sweep::run_digested(study, &options, &digest, &mut |rows| {
            recorder.write(&rows)?;
            Ok(self.goes_on())
        })?;
        if statistics.interrupted {
            return Ok(None);
        }
        recorder.finish(&statistics)?;
        let seconds = started.elapsed().as_secs_f64();
        if let Some(gpu) = gpu {
            self.is_measured(&statistics, gpu.precision)?;
        }
        Ok(Some((seconds, statistics.asked)))
    }

    /// Wall time of a sweep on the processor, s; nothing where time runs out.
    pub fn on_cpu(&self, study: &Study) -> Result<Option<f64>, Error> {
        let (seconds, statistics) = self.sweep(study, &self.options(), &mut |_| self.goes_on())?;
        Ok((!statistics.interrupted).then_some(seconds))
    }

    /// Of a sweep on the processor.
    fn options(&self) -> SweepOptions<'static> {
        SweepOptions { threads: self.threads, ..SweepOptions::default() }
    }

    /// Wall time of a sweep, s.
    fn sweep(
        &self,
        study: &Study,
        options: &SweepOptions,
        receive: &mut dyn FnMut(DesignOutcome) -> ControlFlow<()>,
    ) -> Result<(f64, Statistics), Error> {
        let started = Instant::now();
        let statistics = sweep::run(study, options, &mut |outcome| Ok(receive(outcome)))?;
        Ok((started.elapsed().as_secs_f64(), statistics))
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

/// Relative, of the forces: more than `tests/gpu_parity` allows, since other devices round otherwise.
fn allowed(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-4,
        Precision::Mixed => 1e-7,
        Precision::F64 => 1e-9,
    }
}
