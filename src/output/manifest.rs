//! `manifest.json`: what was asked, by which program and on what machine, what came of it and how long it took.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::engine::backend::gpu::solver::GpuChoice;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::counts::Counts;
use crate::output::host::{Host, Program, in_words, peak_memory, processor_seconds, seconds_since, utc};
use crate::output::schema::constants_as_json;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

/// Where a run stands. A run that goes on, or was killed, is `Incomplete`: the lock of its folder tells which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    Incomplete,
    Complete,
    Interrupted,
    Failed,
}

/// How a study is run, as far as the study itself does not say.
#[derive(Clone, Copy)]
pub struct Conditions<'a> {
    /// The GPU that computes; without one the processor does.
    pub gpu: Option<GpuChoice<'a>>,
    pub threads: usize,
    pub started: SystemTime,
}

#[derive(Clone, Debug, Serialize)]
pub struct Manifest {
    #[serde(flatten)]
    program: Program,
    pub state: State,
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

/// Time spent, s.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    wall_seconds: f64,
    processor_seconds: Option<f64>,
}

/// Which part of a sweep a shard is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1.
    pub shard: u64,
    pub of: u64,
    /// The numbers of its designs.
    pub designs: Range<u64>,
    /// Of the whole sweep.
    pub sweep_designs: u64,
}

/// What computed beside the processor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Adapter {
    pub name: String,
    kind: String,
    driver: String,
}

/// The config, as the user named it and word for word.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Config {
    path: String,
    text: String,
}

impl Config {
    pub fn of(study: &Study) -> Config {
        Config { path: study.path().display().to_string(), text: study.source_text().to_string() }
    }
}

/// A file with what tells whether it is still the same.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FileEntry {
    path: String,
    bytes: u64,
    /// As `xxh128sum` prints it.
    xxh128: String,
}

impl FileEntry {
    pub fn new(path: &str, print: &Fingerprint) -> FileEntry {
        FileEntry { path: path.into(), bytes: print.bytes, xxh128: print.hash() }
    }

    /// The config and the list of designs it names.
    pub fn inputs(study: &Study) -> Vec<FileEntry> {
        let entry = |(path, print): (&Path, Fingerprint)| FileEntry::new(&path.display().to_string(), &print);
        study.inputs().into_iter().map(entry).collect()
    }

    fn fingerprint(&self) -> Option<Fingerprint> {
        Fingerprint::parse(self.bytes, &self.xxh128)
    }
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
            error: None,
            title: study.title().to_string(),
            part: None,
            header_bytes: Vec::new(),
            config: Config::of(study),
            designs_file: study.designs_file().map(|path| path.display().to_string()),
            constants: constants_as_json(study),
            inputs: FileEntry::inputs(study),
            files: Vec::new(),
            backend: if conditions.gpu.is_some() { "gpu" } else { "cpu" },
            adapter: conditions.gpu.map(|GpuChoice { device, .. }| Adapter {
                name: device.facts.name.clone(),
                kind: device.facts.kind.to_string(),
                driver: device.facts.driver.clone(),
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
        stage(self, path)
    }

    pub fn save(&mut self, path: &Path) -> Result<(), Error> {
        self.stage(path)?;
        publish(path)
    }
}

fn computed_by(adapter: Option<&Adapter>, precision: &str) -> String {
    adapter.map_or("cpu".into(), |adapter| format!("{}, {precision}", adapter.name))
}

/// Writes any manifest beside `path`.
pub fn stage(manifest: &impl Serialize, path: &Path) -> Result<(), Error> {
    stage_bytes(path, &text(manifest))
}

/// The text of a manifest.
pub fn text(manifest: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(manifest).expect("a manifest has only JSON's own types");
    text.push(b'\n');
    text
}

/// Writes bytes where a file waits before it is published.
pub fn stage_bytes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let staged = staged(path);
    std::fs::write(&staged, bytes).map_err(|source| Error::Io { action: "write", path: staged, source })
}

/// A folder with those it is in, where they are not there.
pub fn create_dir(dir: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(dir).map_err(|source| Error::Io { action: "create", path: dir.into(), source })
}

/// A path whose file name ends with something more.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(suffix);
    path.with_file_name(name)
}

/// Where a file waits before it is published.
pub fn staged(path: &Path) -> PathBuf {
    with_suffix(path, ".tmp")
}

/// Writes a file so that nobody meets half of it.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    stage_bytes(path, bytes)?;
    publish(path)
}

/// Puts a staged file in place.
pub fn publish(path: &Path) -> Result<(), Error> {
    let into_error = |source| Error::Io { action: "write", path: path.into(), source };
    std::fs::rename(staged(path), path).map_err(into_error)
}

/// What a result is of: a config and the list of designs that it may name, word for word.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Of the config, with its text.
    pub path: String,
    pub text: String,
    files: Vec<Fingerprint>,
}

impl Inputs {
    pub fn of(study: &Study) -> Inputs {
        let Config { path, text } = Config::of(study);
        Inputs { path, text, files: study.inputs().into_iter().map(|(_, print)| print).collect() }
    }
}

/// Wherever the config is.
impl PartialEq for Inputs {
    fn eq(&self, other: &Inputs) -> bool {
        self.text == other.text && self.files == other.files
    }
}

/// What a manifest on disk says of a result.
#[derive(Clone, Debug)]
pub struct Origin {
    pub inputs: Inputs,
    /// What was done with it; a run does not say.
    pub command: Option<String>,
    /// Only runs say.
    pub state: Option<State>,
    pub version: String,
    pub commit: Option<String>,
    /// What was made, by name.
    pub files: Vec<(String, Fingerprint)>,
    pub counts: Counts,
    /// Answers so far.
    pub answers: Option<Box<RawValue>>,
    pub remarks: Vec<String>,
    /// Of a part of a sweep: which, and the bytes of each file's header.
    pub part: Option<(Shard, Vec<u64>)>,
    /// Inputs that are the same in all rows and that the table does not have, with their cells.
    pub constants: Vec<(String, String)>,
    /// As `Manifest::computed_by` says it.
    pub computed_by: String,
    started_utc: String,
    starts: u64,
    spent: Spent,
    stage_seconds: serde_json::Map<String, serde_json::Value>,
}

/// The part of a manifest that is read again.
#[derive(Deserialize)]
struct Saved {
    config: Config,
    version: String,
    commit: Option<String>,
    command: Option<String>,
    state: Option<State>,
    part: Option<Shard>,
    #[serde(default)]
    header_bytes: Vec<u64>,
    adapter: Option<Adapter>,
    #[serde(default)]
    precision: String,
    #[serde(default)]
    inputs: Vec<FileEntry>,
    #[serde(default)]
    files: Vec<FileEntry>,
    #[serde(default)]
    constants: serde_json::Map<String, serde_json::Value>,
    #[serde(default)]
    counts: serde_json::Value,
    #[serde(default)]
    started_utc: String,
    #[serde(default)]
    starts: u64,
    answers: Option<Box<RawValue>>,
    #[serde(default)]
    remarks: Vec<String>,
    #[serde(default)]
    wall_seconds: f64,
    processor_seconds: Option<f64>,
    #[serde(default)]
    stage_seconds: serde_json::Map<String, serde_json::Value>,
}

impl Origin {
    /// Reads a manifest; `None` where it is none of this program's.
    pub fn of(manifest: &str) -> Option<Origin> {
        let saved: Saved = serde_json::from_str(manifest).ok()?;
        let named = |file: FileEntry| Some((file.path.clone(), file.fingerprint()?));
        let cell = |value: serde_json::Value| match value {
            serde_json::Value::String(word) => word,
            serde_json::Value::Null => String::new(),
            other => other.to_string(),
        };
        Some(Origin {
            constants: saved.constants.into_iter().map(|(name, value)| (name, cell(value))).collect(),
            computed_by: computed_by(saved.adapter.as_ref(), &saved.precision),
            part: saved.part.map(|part| (part, saved.header_bytes)),
            inputs: Inputs {
                path: saved.config.path,
                text: saved.config.text,
                files: saved.inputs.iter().filter_map(FileEntry::fingerprint).collect(),
            },
            command: saved.command,
            state: saved.state,
            version: saved.version,
            commit: saved.commit,
            files: saved.files.into_iter().filter_map(named).collect(),
            // Other commands count other things.
            counts: serde_json::from_value(saved.counts).unwrap_or_default(),
            answers: saved.answers,
            remarks: saved.remarks,
            started_utc: saved.started_utc,
            starts: saved.starts,
            spent: Spent { wall_seconds: saved.wall_seconds, processor_seconds: saved.processor_seconds },
            stage_seconds: saved.stage_seconds,
        })
    }

    /// What has made it, as `Program::in_words` says it.
    pub fn program(&self) -> String {
        in_words(Program::CURRENT.program, &self.version, self.commit.as_deref())
    }
}
