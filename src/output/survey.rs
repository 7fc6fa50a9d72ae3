//! What is in a folder of shards, as the names and the ends of the files say. It says nothing of processes.

use std::path::Path;

use crate::error::Error;
use crate::output::origin::Inputs;
use crate::output::shard::{MOST_SHARDS, ShardFile, file_name, numbers};

/// How far the shards of a sweep are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Survey {
    /// How many shards there are to be.
    pub of: u64,
    pub complete: Vec<u64>,
    /// Begun, and not complete.
    pub started: Vec<u64>,
    /// Not complete: started, damaged or not begun.
    pub missing: Vec<u64>,
    /// With what is wrong.
    pub damaged: Vec<(u64, String)>,
}

/// Looks at a folder of shards, and hands over each complete one, in their order.
pub fn survey(dir: &Path, take: &mut dyn FnMut(ShardFile)) -> Result<Survey, Error> {
    let unreadable = |source| Error::Io { action: "read", path: dir.into(), source };
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for entry in std::fs::read_dir(dir).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name().to_string_lossy().into_owned();
        files.extend(numbers(&name, ".shard"));
        folders.extend(numbers(&name, ".partial"));
    }
    files.sort_unstable();
    folders.sort_unstable();
    let mut counts: Vec<u64> = files.iter().chain(&folders).map(|(_, of)| *of).collect();
    counts.sort_unstable();
    counts.dedup();
    let refuse = |problem: String| Err(Error::NoShards { dir: dir.into(), problem });
    let of = match counts[..] {
        [] => return refuse("there are no shards: `jointsweep run CONFIG --shard 1/N` makes them".into()),
        [of] if of <= MOST_SHARDS => of,
        [of] => return refuse(format!("shards of {of}: at most {MOST_SHARDS} are allowed")),
        [one, other, ..] => {
            return refuse(format!(
                "there are shards of {one} and shards of {other}: move those of one count away"
            ));
        }
    };
    let mut survey = Survey { of, ..Survey::default() };
    for (shard, _) in &files {
        match ShardFile::open(&dir.join(file_name(*shard, of))) {
            Ok(file) => {
                survey.complete.push(*shard);
                take(file);
            }
            Err(Error::DamagedShard { problem, .. }) => survey.damaged.push((*shard, problem)),
            Err(error) => return Err(error),
        }
    }
    survey.missing = (1..=of).filter(|shard| survey.complete.binary_search(shard).is_err()).collect();
    let is_missing = |shard: &u64| survey.missing.binary_search(shard).is_ok();
    survey.started = folders.into_iter().map(|(shard, _)| shard).filter(is_missing).collect();
    Ok(survey)
}

/// A complete shard that cannot be put together with one of these inputs and of so many, as far as names and one of the others tell; in words.
pub fn stranger(dir: &Path, inputs: &Inputs, of: u64) -> Option<String> {
    let entries = std::fs::read_dir(dir).ok()?;
    let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let shards: Vec<(String, u64)> =
        names.filter_map(|name| numbers(&name, ".shard").map(|(_, of)| (name, of))).collect();
    if let Some((name, others)) = shards.iter().find(|(_, others)| *others != of) {
        return Some(format!("{name}, a shard of a sweep in {others}, not in {of}"));
    }
    // Who has put the others there has compared them.
    let (name, file) =
        shards.iter().find_map(|(name, _)| Some((name, ShardFile::open(&dir.join(name)).ok()?)))?;
    let is_stranger = file.origin.inputs != *inputs;
    is_stranger.then(|| format!("{name}, a shard of another config ({})", file.origin.inputs.path))
}

/// "3-5,9", of numbers in their order.
pub fn ranges(numbers: &[u64]) -> String {
    let runs = numbers.chunk_by(|one, next| one + 1 == *next);
    let said = runs.map(|run| match run {
        [one] => one.to_string(),
        _ => format!("{}-{}", run[0], run[run.len() - 1]),
    });
    said.collect::<Vec<_>>().join(",")
}
