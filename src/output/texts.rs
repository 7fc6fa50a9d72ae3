//! What commands beside `run` leave in a folder: a few texts, and a manifest that begins alike in all of them.

use serde::Serialize;

use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::folder::MANIFEST;
use crate::output::host::Program;
use crate::output::manifest;
use crate::output::manifest_parts::{Config, FileEntry, State};
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

/// How such a manifest begins.
#[derive(Clone, Debug, Serialize)]
pub struct Beginning {
    #[serde(flatten)]
    program: Program,
    pub state: State,
    command: &'static str,
    pub title: String,
    config: Config,
    inputs: Vec<FileEntry>,
}

impl Beginning {
    pub fn of(study: &Study, command: &'static str) -> Beginning {
        Beginning {
            program: Program::CURRENT,
            state: State::Complete,
            command,
            title: study.title().to_string(),
            config: Config::of(study),
            inputs: FileEntry::inputs(study),
        }
    }
}

/// Writes files by their names, and says what the manifest says of them.
pub fn write<const COUNT: usize>(
    claim: &Claim,
    texts: [(&str, String); COUNT],
) -> Result<Vec<FileEntry>, Error> {
    let write = |(name, text): (&str, String)| {
        let path = claim.partial(name);
        let entry = FileEntry::new(name, &Fingerprint::of(text.as_bytes()));
        match std::fs::write(&path, text) {
            Ok(()) => Ok(entry),
            Err(source) => Err(Error::Io { action: "write", path, source }),
        }
    };
    texts.into_iter().map(write).collect()
}

/// Writes the manifest, the last of all files, and gives them their own names.
pub fn publish(claim: &Claim, manifest: &impl Serialize) -> Result<(), Error> {
    manifest::write(manifest, &claim.partial(MANIFEST))?;
    claim.publish()
}
