//! Shards put together: the result that one run of the whole sweep would have left, to the byte.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::engine::relay::{Ended, relay};
use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::counts::Counts;
use crate::output::folder::{MANIFEST, Permissions, RUN, ResultFolder, TABLE_PARQUET, Verdict};
use crate::output::manifest;
use crate::output::manifest_parts::{FileEntry, Shard, State};
use crate::output::origin::{Inputs, Origin};
use crate::output::parquet_table::ParquetTable;
use crate::output::reduce::Reductions;
use crate::output::shard::{ShardFile, ShardTable, file_name};
use crate::output::sink::SinkFile;
use crate::output::survey::{Survey, ranges, survey};
use crate::output::whole_file::write_whole;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

/// What became of a merge.
#[derive(Debug)]
pub enum Merged {
    /// The manifest of the result.
    Now(Box<Origin>),
    /// It was there before.
    Before(Box<Origin>),
}

/// Puts the shards of a folder together, in the same folder. Nothing is written unless all are there, of one sweep and by one
/// program; what is written takes its name only when every byte was what its shard says.
pub fn merge(dir: &Path, permissions: Permissions) -> Result<Merged, Error> {
    let refuse = |problem: String| Error::NoShards { dir: dir.into(), problem };
    let mut parts: Option<Parts> = None;
    let mut first_problem = Ok(());
    let survey = survey(dir, &mut |shard| {
        if first_problem.is_ok() {
            first_problem = match &mut parts {
                None => Parts::new(shard).map(|new| parts = Some(new)),
                Some(parts) => follows(&parts.last, &shard).map_err(refuse).and_then(|()| parts.add(shard)),
            };
        }
    })?;
    if let Some(problem) = what_is_missing(&survey) {
        return Err(refuse(problem));
    }
    first_problem?;
    let Some(parts) = parts.filter(Parts::is_whole) else {
        return Err(refuse("the shards are not of the whole sweep".into()));
    };
    let folder = ResultFolder::new(&RUN, dir.into());
    if let Verdict::Done(origin) = folder.check_for(&parts.inputs, permissions)? {
        return Ok(Merged::Before(origin));
    }
    let claim = folder.claim("of a merge")?;
    if let Verdict::Done(origin) = folder.check_for(&parts.inputs, permissions)? {
        return Ok(Merged::Before(origin));
    }
    let text = write(&claim, &parts)?;
    let unreadable = || refuse("the manifest of its first shard cannot be read".into());
    Ok(Merged::Now(Box::new(Origin::of(&text).ok_or_else(unreadable)?)))
}

/// What keeps the shards from being whole, in words, and what to do about it.
fn what_is_missing(survey: &Survey) -> Option<String> {
    if let Some((shard, problem)) = survey.damaged.first() {
        let name = file_name(*shard, survey.of);
        return Some(format!("{name} is damaged ({problem}): run this shard again"));
    }
    let of = survey.of;
    match survey.missing[..] {
        [] => None,
        [one] => Some(format!("shard {one} of {of} is missing: run it with --shard {one}/{of}")),
        _ => {
            let missing = ranges(&survey.missing);
            Some(format!("shards {missing} of {of} are missing: run each of them with --shard I/{of}"))
        }
    }
}

/// Whether one shard follows another of the same sweep; else what differs, in words, and what to do about it.
fn follows(one: &ShardFile, next: &ShardFile) -> Result<(), String> {
    let [name, next_name] = [one, next].map(|shard| file_name(shard.shard.shard, shard.shard.of));
    let differ = |what: &str, its: String, next_its: String| {
        let again = "run one of them again, as the other was";
        Err(format!("{name} and {next_name} are of different {what}: {its} and {next_its}; {again}"))
    };
    let (own, other) = (&one.origin, &next.origin);
    if own.inputs.text != other.inputs.text {
        return differ("configs", own.inputs.path.clone(), other.inputs.path.clone());
    }
    if own.inputs != other.inputs {
        return Err(format!(
            "{name} and {next_name} are of different lists of designs: run one of them again"
        ));
    }
    if own.program() != other.program() {
        return differ("programs", own.program(), other.program());
    }
    if own.computed_by != other.computed_by {
        return differ("devices", own.computed_by.clone(), other.computed_by.clone());
    }
    let tables =
        |origin: &Origin| origin.files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().join(", ");
    if tables(own) != tables(other) {
        return differ("tables", tables(own), tables(other));
    }
    let (designs, next_designs) = (&one.shard.designs, &next.shard.designs);
    if designs.end != next_designs.start {
        let [said, next_said] = [designs, next_designs].map(|of| format!("{} to {}", of.start, of.end));
        return Err(format!(
            "{name} has the designs {said}, {next_name} has {next_said}: run one of them again"
        ));
    }
    Ok(())
}

/// Writes the tables and the manifest of the whole sweep, and returns the manifest's text.
fn write(claim: &Claim, parts: &Parts) -> Result<String, Error> {
    let path = claim.partial(MANIFEST);
    let (mut files, mut remarks) = (Vec::new(), Vec::new());
    // First of all, so that no crash leaves a table that nobody vouches for.
    write_whole(&path, &parts.text(State::Incomplete, &files, &remarks))?;
    let names: Vec<&str> = parts.last.origin.files.iter().map(|(name, _)| name.as_str()).collect();
    claim.remove_others(names.iter().copied())?;
    for (place, name) in names.into_iter().enumerate() {
        let mut file = SinkFile::new(name, claim.partial(name));
        file.open()?;
        file.begin(&[])?;
        // Shards are read and checked beside what is written.
        let read = |give: &mut dyn FnMut(Vec<u8>) -> Result<(), Ended>| {
            let mut shards = parts.tables.iter().enumerate();
            shards.try_for_each(|(number, (path, tables))| tables[place].read(path, name, number == 0, give))
        };
        relay(read, |bytes| file.append(&bytes))?;
        if name == TABLE_PARQUET {
            file.end(&ParquetTable::of(&parts.study()?))?;
        }
        files.push(FileEntry::new(name, &file.fingerprint()));
    }
    if let Some(answers) = &parts.answers {
        for (name, bytes) in answers.files() {
            write_whole(&claim.partial(name), &bytes)?;
            files.push(FileEntry::new(name, &Fingerprint::of(&bytes)));
        }
        remarks = answers.remarks();
    }
    let text = parts.text(State::Complete, &files, &remarks);
    write_whole(&path, &text)?;
    claim.publish()?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// What the shards come to, added up one by one: of each only its place on the disk is kept, and of the last what the next must fit.
struct Parts {
    inputs: Inputs,
    /// Of the first shard; the result's is made of it.
    manifest: Value,
    first_design: u64,
    last: ShardFile,
    /// Each shard's file, and the tables in it.
    tables: Vec<(PathBuf, Vec<ShardTable>)>,
    counts: Counts,
    wall_seconds: f64,
    processor_seconds: f64,
    answers: Option<Reductions>,
}

impl Parts {
    /// Of the first shard.
    fn new(shard: ShardFile) -> Result<Parts, Error> {
        let mut parts = Parts {
            inputs: shard.origin.inputs.clone(),
            manifest: serde_json::from_str(&shard.manifest).unwrap_or_default(),
            first_design: shard.shard.designs.start,
            answers: answers(&shard)?,
            last: shard,
            tables: Vec::new(),
            counts: Counts::default(),
            wall_seconds: 0.0,
            processor_seconds: 0.0,
        };
        parts.add_last();
        Ok(parts)
    }

    /// Adds the next shard.
    fn add(&mut self, shard: ShardFile) -> Result<(), Error> {
        match (&mut self.answers, answers(&shard)?) {
            (Some(own), Some(more)) => own.merge(&more)?,
            (own, _) => *own = None,
        }
        self.last = shard;
        self.add_last();
        Ok(())
    }

    fn add_last(&mut self) {
        let ShardFile { path, origin, tables, .. } = &mut self.last;
        self.counts.merge(&origin.counts);
        self.counts.designs_asked += origin.counts.designs_asked;
        self.counts.rows_asked += origin.counts.rows_asked;
        self.wall_seconds += origin.spent.wall_seconds;
        self.processor_seconds += origin.spent.processor_seconds.unwrap_or(0.0);
        self.tables.push((path.clone(), std::mem::take(tables)));
    }

    fn is_whole(&self) -> bool {
        let Shard { designs, sweep_designs, .. } = &self.last.shard;
        self.first_design == 0 && designs.end == *sweep_designs
    }

    /// What the shards are of; the list of designs that it may name must still be there.
    fn study(&self) -> Result<Study, Error> {
        Study::from_text(Path::new(&self.inputs.path), self.inputs.text.clone())
    }

    /// The manifest of the whole: that of the first shard, with what all came to.
    fn text(&self, state: State, files: &[FileEntry], remarks: &[String]) -> Vec<u8> {
        let mut manifest = self.manifest.clone();
        if let Some(manifest) = manifest.as_object_mut() {
            for key in ["part", "header_bytes", "stage_seconds", "starts", "answers"] {
                manifest.shift_remove(key);
            }
            manifest.insert("state".into(), json!(state));
            manifest.insert("shards".into(), self.tables.len().into());
            manifest.insert("files".into(), json!(files));
            if !remarks.is_empty() {
                manifest.insert("remarks".into(), json!(remarks));
            }
            manifest.insert("counts".into(), json!(self.counts));
            manifest.insert("wall_seconds".into(), self.wall_seconds.into());
            manifest.insert("processor_seconds".into(), self.processor_seconds.into());
        }
        manifest::text(&manifest)
    }
}

/// The answers of a shard, where its config asks for any.
fn answers(shard: &ShardFile) -> Result<Option<Reductions>, Error> {
    let Some(text) = &shard.origin.answers else { return Ok(None) };
    let damaged =
        || Error::DamagedShard { path: shard.path.clone(), problem: "its answers cannot be read".into() };
    serde_json::from_str(text.get()).map(Some).map_err(|_| damaged())
}
