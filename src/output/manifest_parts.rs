//! Parts of a manifest that are written, and read again.

use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

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
    pub kind: String,
    pub driver: String,
    /// How it condenses bodies; benchmarks do not say.
    #[serde(default)]
    pub solver: String,
}

/// The config, as the user named it and word for word.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Config {
    pub path: String,
    pub text: String,
}

impl Config {
    pub fn of(study: &Study) -> Config {
        Config { path: study.path().display().to_string(), text: study.source_text().to_string() }
    }
}

/// A file with what tells whether it is still the same.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FileEntry {
    pub path: String,
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

    pub fn fingerprint(&self) -> Option<Fingerprint> {
        Fingerprint::parse(self.bytes, &self.xxh128)
    }
}

/// Time spent, s.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    pub wall_seconds: f64,
    pub processor_seconds: Option<f64>,
}

/// What a person calls that which computed.
pub fn computed_by(adapter: Option<&Adapter>, precision: &str) -> String {
    adapter.map_or("cpu".into(), |adapter| format!("{}, {precision}, {}", adapter.name, adapter.solver))
}
