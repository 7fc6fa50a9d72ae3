//! Shards of a sweep: what their files are called, and which of them are in a folder.

use std::path::Path;

use crate::error::Error;

/// The most shards that a folder may have.
pub const MOST_SHARDS: u64 = 1_000_000;

/// `shard-007-of-100.shard`: the number counts from 1.
pub fn file_name(shard: u64, of: u64) -> String {
    let width = of.to_string().len();
    format!("shard-{shard:0width$}-of-{of}.shard")
}

/// Which shards of a sweep are in a folder; all lists ascend.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    pub of: u64,
    pub complete: Vec<u64>,
    /// Begun and not complete: in work, or left by a process that was killed.
    pub started: Vec<u64>,
    /// All that are not complete, the started and the damaged ones too.
    pub missing: Vec<u64>,
    /// Files that are not what they should be, and why.
    pub damaged: Vec<(u64, String)>,
}

/// Looks which shards are in a folder; their files alone tell.
pub fn survey(dir: &Path) -> Result<Survey, Error> {
    let refuse = |problem: String| Error::NoResult { dir: dir.into(), problem };
    let into_error = |source| Error::Io { action: "read", path: dir.into(), source };
    let mut survey = Survey::default();
    for entry in std::fs::read_dir(dir).map_err(into_error)? {
        let name = entry.map_err(into_error)?.file_name();
        let Some((shard, of, kind)) = name.to_str().and_then(parse) else { continue };
        if survey.of != 0 && survey.of != of {
            let problem = format!("holds shards of a sweep in {of} and of one in {}", survey.of);
            return Err(refuse(problem));
        }
        survey.of = of;
        match kind {
            Kind::Complete => survey.complete.push(shard),
            Kind::Started => survey.started.push(shard),
        }
    }
    if survey.of == 0 {
        return Err(refuse("holds no shards".into()));
    }
    survey.complete.sort_unstable();
    survey.started.retain(|shard| survey.complete.binary_search(shard).is_err());
    survey.started.sort_unstable();
    survey.missing = (1..=survey.of).filter(|shard| survey.complete.binary_search(shard).is_err()).collect();
    Ok(survey)
}

enum Kind {
    Complete,
    Started,
}

/// The shard that a name is of.
fn parse(name: &str) -> Option<(u64, u64, Kind)> {
    let (stem, kind) = match name.strip_suffix(".partial") {
        Some(stem) => (stem, Kind::Started),
        None => (name.strip_suffix(".shard")?, Kind::Complete),
    };
    let (shard, of) = stem.strip_prefix("shard-")?.split_once("-of-")?;
    let (shard, of): (u64, u64) = (shard.parse().ok()?, of.parse().ok()?);
    let is_possible = (1..=of).contains(&shard) && of <= MOST_SHARDS;
    (is_possible && file_name(shard, of).strip_suffix(".shard")? == stem).then_some((shard, of, kind))
}
