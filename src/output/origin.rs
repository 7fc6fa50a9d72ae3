//! What a manifest on disk says of the result beside it.

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::output::counts::Counts;
use crate::output::host::{Program, in_words};
use crate::output::manifest_parts::{Adapter, Config, FileEntry, Shard, Spent, State, computed_by};
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

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
    /// Whether an unfinished run was to begin anew.
    pub begun_anew: bool,
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
    /// Other inputs that it does not have.
    pub left_out: Vec<String>,
    /// As `Manifest::computed_by` says it.
    pub computed_by: String,
    /// The device that was asked, if one was, and the numbers it computed in.
    pub adapter: Option<Adapter>,
    pub precision: String,
    pub started_utc: String,
    pub starts: u64,
    pub spent: Spent,
    pub stage_seconds: serde_json::Map<String, serde_json::Value>,
}

/// The part of a manifest that is read again.
#[derive(Deserialize)]
struct Saved {
    config: Config,
    version: String,
    commit: Option<String>,
    command: Option<String>,
    state: Option<State>,
    #[serde(default)]
    begun_anew: bool,
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
    left_out: Vec<String>,
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
            left_out: saved.left_out,
            computed_by: computed_by(saved.adapter.as_ref(), &saved.precision),
            adapter: saved.adapter,
            precision: saved.precision,
            part: saved.part.map(|part| (part, saved.header_bytes)),
            inputs: Inputs {
                path: saved.config.path,
                text: saved.config.text,
                files: saved.inputs.iter().filter_map(FileEntry::fingerprint).collect(),
            },
            command: saved.command,
            state: saved.state,
            begun_anew: saved.begun_anew,
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

    /// What is wrong with a manifest that cannot be read.
    pub fn complaint(manifest: &str) -> &'static str {
        match serde_json::from_str::<serde_json::Value>(manifest) {
            Ok(_) => "is of another program",
            Err(_) => "is damaged",
        }
    }

    /// What has made it, as `Program::in_words` says it.
    pub fn program(&self) -> String {
        in_words(Program::CURRENT.program, &self.version, self.commit.as_deref())
    }
}
