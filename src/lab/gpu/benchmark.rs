//! What a GPU was measured to do: `precisions.csv`, `scaling.csv`, `answers.csv`, `kernels.csv` and `peaks.csv`, with `manifest.json`.

use std::time::SystemTime;

use serde::Serialize;

use crate::engine::backend::gpu::context::{AdapterFacts, DeviceFeatures, DeviceLimits};
use crate::engine::backend::gpu::solver::INVOCATIONS;
use crate::error::Error;
use crate::lab::gpu::figures::{
    AnswersRow, PrecisionRow, ScalingRow, answers, kernels, peaks, precisions, scaling,
};
use crate::lab::gpu::measure::KernelTime;
use crate::lab::gpu::roofline::Peaks;
use crate::output::claim::Claim;
use crate::output::folder::MANIFEST;
use crate::output::host::{Host, seconds_since, utc};
use crate::output::manifest;
use crate::output::manifest_parts::{FileEntry, State};
use crate::output::texts::{self, Beginning};
use crate::study::config::Study;

pub const PRECISIONS: &str = "precisions.csv";
pub const SCALING: &str = "scaling.csv";
pub const ANSWERS: &str = "answers.csv";
pub const KERNELS: &str = "kernels.csv";
pub const PEAKS: &str = "peaks.csv";

#[derive(Clone, Debug, Serialize)]
struct Adapter {
    name: String,
    kind: String,
    driver: String,
    limits: Limits,
    features: Features,
}

#[derive(Clone, Debug, Serialize)]
struct Limits {
    binding_bytes: u64,
    buffer_bytes: u64,
    workgroups_per_dimension: u32,
    workgroup_bytes: u32,
    invocations_per_workgroup: u32,
    storage_buffers: u32,
}

#[derive(Clone, Debug, Serialize)]
struct Features {
    f64: bool,
    subgroups: bool,
    timestamps: bool,
}

impl Adapter {
    fn of(facts: &AdapterFacts) -> Adapter {
        let DeviceLimits {
            binding_bytes,
            buffer_bytes,
            workgroups_per_dimension,
            workgroup_bytes,
            invocations_per_workgroup,
            storage_buffers,
        } = facts.limits;
        let DeviceFeatures { f64, subgroups, timestamps } = facts.features;
        Adapter {
            name: facts.name.clone(),
            kind: facts.kind.to_string(),
            driver: facts.driver.clone(),
            limits: Limits {
                binding_bytes,
                buffer_bytes,
                workgroups_per_dimension,
                workgroup_bytes,
                invocations_per_workgroup,
                storage_buffers,
            },
            features: Features { f64, subgroups, timestamps },
        }
    }
}

/// What was asked, as far as the adapter does not say it.
#[derive(Clone, Debug, Serialize)]
pub struct Asked {
    /// Designs of the largest sweep.
    pub most: u64,
    pub precisions: Vec<&'static str>,
    /// Precision of `scaling.csv`.
    pub scaling_precision: &'static str,
    /// Designs of each check, and those whose bodies the kernels get.
    pub checked_designs: u64,
    pub kernel_designs: u64,
    /// Runs of each sweep of `precisions.csv`; the median counts.
    pub runs: usize,
    /// The largest sweep that the processor is timed with.
    pub most_on_cpu: u64,
    pub threads: usize,
    /// Time that all of it may take, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget_seconds: Option<f64>,
    /// What is smaller than usual, and why.
    pub remark: Option<&'static str>,
}

#[derive(Clone, Debug, Serialize)]
struct Manifest {
    #[serde(flatten)]
    beginning: Beginning,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    adapter: Adapter,
    /// Invocations of a workgroup.
    workgroup_size: u32,
    asked: Asked,
    files: Vec<FileEntry>,
    /// What was left out, and why.
    remarks: Vec<String>,
    started_utc: String,
    wall_seconds: f64,
    host: Host,
}

/// The folder of a benchmark. Each file is written when its figures are complete, and has its own name when all are: what was there before stays
/// until then.
pub struct GpuBenchmark {
    claim: Claim,
    manifest: Manifest,
    started: SystemTime,
}

impl GpuBenchmark {
    /// In a folder that is this process's own, whose unfinished benchmark is gone then.
    pub fn create(
        claim: Claim,
        facts: &AdapterFacts,
        asked: Asked,
        study: &Study,
        started: SystemTime,
    ) -> Result<GpuBenchmark, Error> {
        claim.remove_others(std::iter::empty())?;
        let mut beginning = Beginning::of(study, "bench-gpu");
        beginning.state = State::Incomplete;
        let manifest = Manifest {
            beginning,
            error: None,
            adapter: Adapter::of(facts),
            workgroup_size: INVOCATIONS,
            asked,
            files: Vec::new(),
            remarks: Vec::new(),
            started_utc: utc(started),
            wall_seconds: 0.0,
            host: Host::current(),
        };
        let mut benchmark = GpuBenchmark { claim, manifest, started };
        benchmark.save_manifest()?;
        Ok(benchmark)
    }

    pub fn remark(&mut self, remark: String) {
        self.manifest.remarks.push(remark);
    }

    pub fn save_precisions(&mut self, rows: &[PrecisionRow]) -> Result<(), Error> {
        self.save(PRECISIONS, precisions(rows))
    }

    pub fn save_scaling(&mut self, rows: &[ScalingRow]) -> Result<(), Error> {
        self.save(SCALING, scaling(rows))
    }

    pub fn save_answers(&mut self, rows: &[AnswersRow]) -> Result<(), Error> {
        self.save(ANSWERS, answers(rows))
    }

    pub fn save_kernels(&mut self, times: &[KernelTime], peaks: &[Peaks]) -> Result<(), Error> {
        self.save(KERNELS, kernels(times, peaks))
    }

    pub fn save_peaks(&mut self, rows: &[Peaks]) -> Result<(), Error> {
        self.save(PEAKS, peaks(rows))
    }

    /// All figures are there that there was time for.
    pub fn finish(mut self) -> Result<(), Error> {
        self.manifest.beginning.state = State::Complete;
        self.save_manifest()?;
        self.claim.publish()
    }

    /// An error ended the benchmark; the files that are there are whole.
    pub fn fail(mut self, error: &Error) {
        self.manifest.beginning.state = State::Failed;
        self.manifest.error = Some(error.to_string());
        // There is a first error to tell.
        let _ = self.save_manifest();
    }

    fn save(&mut self, name: &str, text: String) -> Result<(), Error> {
        let files = texts::write(&self.claim, [(name, text)])?;
        self.manifest.files.retain(|file| file.path != name);
        self.manifest.files.extend(files);
        self.save_manifest()
    }

    fn save_manifest(&mut self) -> Result<(), Error> {
        self.manifest.wall_seconds = seconds_since(self.started);
        manifest::write(&self.manifest, &self.claim.partial(MANIFEST))
    }
}
