//! What computes: the processor, or a GPU with the processor behind it.

pub mod cpu;
pub mod gpu;

use std::time::Duration;

use cpu::CpuBackend;
use gpu::context::GpuError;

use crate::engine::interpolation::plan::InterpolationPlan;
use crate::engine::outcome::DesignOutcome;
use crate::study::config::SolveOptions;
use crate::study::design::DesignCase;

/// Solves batches of designs, and may be lost.
pub trait Backend: Send {
    /// Outcomes of `cases`, in their order. After an error nothing may be asked of it again.
    fn solve(&mut self, cases: &[DesignCase]) -> Result<Vec<DesignOutcome>, GpuError>;

    /// Where the time went, in the order the stages run.
    fn stages(&self) -> Vec<(&'static str, Duration)>;

    /// The greatest true residual of an iteration that an outcome rests on.
    fn worst_residual(&self) -> f64;

    /// Columns of rings that were solved for by iteration.
    fn solves(&self) -> u64;
}

/// The processor, and before it, as long as it lasts, what else there is.
pub struct Solver<'a> {
    cpu: CpuBackend,
    accelerator: Option<Box<dyn Backend + 'a>>,
    /// Whether the accelerator was given up: it is only asked what it has done.
    is_given_up: bool,
}

/// Designs that the processor solves at a time: enough to fill the lanes of many topologies, few enough to stay small.
pub const CPU_BATCH: usize = 1024;

impl<'a> Solver<'a> {
    /// With the processor alone.
    pub fn on_cpu(options: SolveOptions) -> Solver<'a> {
        Solver { cpu: CpuBackend::new(options), accelerator: None, is_given_up: false }
    }

    /// With the processor alone, which interpolates bodies where there is a plan for it.
    pub fn interpolating(options: SolveOptions, plan: Option<InterpolationPlan>) -> Solver<'a> {
        let cpu = match plan {
            Some(plan) => CpuBackend::interpolating(options, plan),
            None => CpuBackend::new(options),
        };
        Solver { cpu, accelerator: None, is_given_up: false }
    }

    /// With `accelerator`, and the processor should it be lost.
    pub fn with(accelerator: Box<dyn Backend + 'a>, options: SolveOptions) -> Solver<'a> {
        Solver { accelerator: Some(accelerator), ..Solver::on_cpu(options) }
    }

    /// Outcomes of `cases`, in their order, and why the accelerator was given up if it was. A batch is handed over whole
    /// or not at all, so giving up loses no design and none is met twice.
    pub fn solve(&mut self, cases: &[DesignCase]) -> (Vec<DesignOutcome>, Option<GpuError>) {
        let mut reason = None;
        if let Some(accelerator) = self.accelerator.as_mut().filter(|_| !self.is_given_up) {
            match accelerator.solve(cases) {
                Ok(outcomes) => return (outcomes, None),
                Err(error) => reason = Some(error),
            }
            self.is_given_up = true;
        }
        (cases.chunks(CPU_BATCH).flat_map(|cases| self.cpu.solve(cases)).collect(), reason)
    }

    /// The greatest true residual that an outcome of the accelerator rests on.
    pub fn worst_residual(&self) -> Option<f64> {
        self.accelerator.as_ref().map(|accelerator| accelerator.worst_residual())
    }

    /// Columns of rings that the accelerator has solved for by iteration.
    pub fn solves(&self) -> u64 {
        self.accelerator.as_ref().map_or(0, |accelerator| accelerator.solves())
    }

    /// Where the time went, summed over threads of the processor.
    pub fn stages(&self) -> Vec<(&'static str, Duration)> {
        let mut stages = self.accelerator.as_ref().map_or(Vec::new(), |accelerator| accelerator.stages());
        add_stages(&mut stages, self.cpu.stages());
        stages
    }
}

/// Adds times to the stages of the same name, or as new ones.
fn add_stages(stages: &mut Vec<(&'static str, Duration)>, more: Vec<(&'static str, Duration)>) {
    for (name, time) in more {
        match stages.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += time,
            None => stages.push((name, time)),
        }
    }
}
