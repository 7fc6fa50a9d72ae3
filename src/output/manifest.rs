//! `manifest.json`: what was asked, by which program and on what machine, what came of it and how long it took.

use std::path::Path;
use std::time::SystemTime;

use serde::Serialize;
use serde_json::value::RawValue;

use crate::engine::backend::choice::GpuChoice;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::counts::Counts;
use crate::output::host::{Host, Program, peak_memory, processor_seconds, seconds_since, utc};
use crate::output::manifest_parts::{Adapter, Config, FileEntry, Shard, Spent, State, computed_by};
use crate::output::origin::Origin;
use crate::output::schema::{constants_as_json, left_out};
use crate::output::whole_file::{publish, stage_bytes, write_whole};
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

/// How a study is run, as far as the study itself does not say.
#[derive(Clone, Copy)]
pub struct Conditions<'a> {
    /// The GPU that computes; without one the processor does.
    pub gpu: Option<GpuChoice<'a>>,
    pub threads: usize,
    pub started: SystemTime,
    /// Whether it was to begin anew where the study was run before.
    pub anew: bool,
}

#[derive(Clone, Debug, Serialize)]
pub struct Manifest {
    #[serde(flatten)]
    program: Program,
    pub state: State,
    /// Whether an unfinished run was to begin anew: then it goes on when it is to do so once more.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    begun_anew: bool,
    /// Why, when the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    title: String,
    /// Which part of a sweep it is of, where it is of a part only.
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<Shard>,
    /// The bytes of each file's header; only parts say.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    header_bytes: Vec<u64>,
    config: Config,
    designs_file: Option<String>,
    /// Inputs that are the same in all rows and that the table does not have.
    #[serde(skip_serializing_if = "serde_json::Map::is_empty")]
    constants: serde_json::Map<String, serde_json::Value>,
    /// Inputs that are not the same in all rows and that the table does not have.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<String>,
    /// The config and the list of designs as they were read.
    inputs: Vec<FileEntry>,
    /// What the run has made.
    files: Vec<FileEntry>,
    pub backend: &'static str,
    /// The GPU, if one was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<Adapter>,
    precision: &'static str,
    /// Why the GPU was given up, if it was: the processor did the rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fallback: Option<String>,
    /// The greatest |b - K x|/|b| of conjugate gradients that a row of the GPU rests on.
    #[serde(skip_serializing_if = "Option::is_none")]
    worst_residual: Option<f64>,
    pub threads: usize,
    started_utc: String,
    /// How often it was started: once, and once more each time it went on.
    starts: u64,
    /// Of all processes that worked on it.
    pub wall_seconds: f64,
    /// Time of all processors spent on them, where the system tells it.
    pub processor_seconds: Option<f64>,
    /// The most memory the last of them has had at once, where the system tells it.
    pub peak_memory_bytes: Option<u64>,
    pub counts: Counts,
    /// What a reader of the files must know.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    /// What is known so far of answers to `[reduce]`, as long as there are rows to come.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<Box<RawValue>>,
    /// Wall time of each stage in the order they run, summed over threads.
    pub stage_seconds: serde_json::Map<String, serde_json::Value>,
    host: Host,
    #[serde(skip)]
    started: SystemTime,
    /// What the processes before this one took.
    #[serde(skip)]
    before: Spent,
}

/// A manifest's text with a file of the result added to those it vouches for, in the place of one of that name.
pub fn with_file(manifest: &str, name: &str, print: &Fingerprint) -> Option<String> {
    let mut value: serde_json::Value = serde_json::from_str(manifest).ok()?;
    let files = value.get_mut("files")?.as_array_mut()?;
    files.retain(|file| file.get("path").and_then(serde_json::Value::as_str) != Some(name));
    files.push(serde_json::to_value(FileEntry::new(name, print)).ok()?);
    Some(serde_json::to_string_pretty(&value).ok()? + "\n")
}

impl Manifest {
    pub fn new(study: &Study, conditions: &Conditions) -> Manifest {
        Manifest {
            program: Program::CURRENT,
            state: State::Incomplete,
            begun_anew: conditions.anew,
            error: None,
            title: study.title().to_string(),
            part: None,
            header_bytes: Vec::new(),
            config: Config::of(study),
            designs_file: study.designs_file().map(|path| path.display().to_string()),
            constants: constants_as_json(study),
            left_out: left_out(study),
            inputs: FileEntry::inputs(study),
            files: Vec::new(),
            backend: if conditions.gpu.is_some() { "gpu" } else { "cpu" },
            adapter: conditions.gpu.map(|GpuChoice { device, solver, .. }| Adapter {
                name: device.facts.name.clone(),
                kind: device.facts.kind.to_string(),
                driver: device.facts.driver.clone(),
                solver: solver.name().into(),
            }),
            precision: conditions.gpu.map_or("f64", |gpu| gpu.precision.name()),
            fallback: None,
            worst_residual: None,
            threads: conditions.threads,
            started_utc: utc(conditions.started),
            starts: 1,
            wall_seconds: 0.0,
            processor_seconds: None,
            peak_memory_bytes: None,
            counts: Counts {
                designs_asked: study.design_count(),
                rows_asked: study.step_count(),
                ..Counts::default()
            },
            remarks: Vec::new(),
            answers: None,
            stage_seconds: serde_json::Map::new(),
            host: Host::current(),
            started: conditions.started,
            before: Spent::default(),
        }
    }

    /// Says that the run went to its end.
    pub fn complete(&mut self) {
        (self.state, self.begun_anew) = (State::Complete, false);
    }

    /// Of one part of the study.
    pub fn of_part(mut self, shard: Shard, header_bytes: Vec<u64>) -> Manifest {
        let rows = self.counts.rows_asked / self.counts.designs_asked.max(1);
        self.counts.designs_asked = shard.designs.end - shard.designs.start;
        self.counts.rows_asked = self.counts.designs_asked * rows;
        (self.part, self.header_bytes) = (Some(shard), header_bytes);
        self
    }

    /// Takes over what an unfinished run has done; or what keeps this program, as it is started now, from going on with it.
    pub fn go_on(&mut self, origin: &Origin) -> Result<(), String> {
        let by = |program: &str, computed: &str| format!("{program} on {computed}");
        let (then, now) =
            (by(&origin.program(), &origin.computed_by), by(&self.program.in_words(), &self.computed_by()));
        if then != now {
            return Err(format!("an unfinished result by {then}, this is {now}"));
        }
        let part = |part: Option<&Shard>| match part {
            Some(Shard { shard, of, designs, .. }) => {
                format!("shard {shard} of {of} (designs {} to {})", designs.start, designs.end)
            }
            None => "the whole sweep".into(),
        };
        let (then, now) = (part(origin.part.as_ref().map(|(part, _)| part)), part(self.part.as_ref()));
        if then != now {
            return Err(format!("an unfinished result of {then}, not of {now}"));
        }
        self.counts = origin.counts.clone();
        self.starts = origin.starts + 1;
        self.started_utc.clone_from(&origin.started_utc);
        self.before = origin.spent;
        self.stage_seconds.clone_from(&origin.stage_seconds);
        Ok(())
    }

    /// Says what a file of the run is.
    pub fn set_file(&mut self, name: &str, print: &Fingerprint) {
        self.files.retain(|file| file.path != name);
        self.files.push(FileEntry::new(name, print));
    }

    /// The names of the files that the run has made.
    pub fn file_names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| file.path.as_str())
    }

    /// What a person calls that which computed.
    pub fn computed_by(&self) -> String {
        computed_by(self.adapter.as_ref(), self.precision)
    }

    /// Takes over what only the sweep knows.
    pub fn add_statistics(&mut self, statistics: &Statistics) {
        self.counts.distinct_bodies += statistics.distinct_bodies;
        if self.adapter.is_some() {
            *self.counts.designs_on_cpu.get_or_insert(0) += statistics.designs_on_cpu;
        }
        self.fallback.clone_from(&statistics.fallback);
        self.worst_residual = statistics.worst_residual;
        for (stage, time) in &statistics.stages {
            let before = self.stage_seconds.get(*stage).and_then(serde_json::Value::as_f64).unwrap_or(0.0);
            self.stage_seconds.insert(stage.to_string(), (before + time.as_secs_f64()).into());
        }
    }

    /// Writes the manifest beside `path`, from where `publish` puts it in place: a reader, or a crash, never
    /// meets half a manifest.
    pub fn stage(&mut self, path: &Path) -> Result<(), Error> {
        let wall = seconds_since(self.started);
        self.wall_seconds = self.before.wall_seconds + wall;
        self.processor_seconds =
            processor_seconds().map(|own| own + self.before.processor_seconds.unwrap_or(0.0));
        self.peak_memory_bytes = peak_memory();
        stage_bytes(path, &text(self))
    }

    pub fn save(&mut self, path: &Path) -> Result<(), Error> {
        self.stage(path)?;
        publish(path)
    }
}

/// Writes any manifest, so that nobody meets half of it.
pub fn write(manifest: &impl Serialize, path: &Path) -> Result<(), Error> {
    write_whole(path, &text(manifest))
}

/// The text of a manifest.
pub fn text(manifest: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(manifest).expect("a manifest has only JSON's own types");
    text.push(b'\n');
    text
}
