//! Shards put together: the result that one run of the whole sweep would have left, to the byte.

use std::path::Path;

use serde_json::Value;

use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::counts::Counts;
use crate::output::folder::{MANIFEST, Permissions, RUN, ResultFolder, TABLE_PARQUET, Verdict};
use crate::output::manifest;
use crate::output::manifest_parts::{FileEntry, Shard, State};
use crate::output::origin::{Inputs, Origin};
use crate::output::parquet_table::ParquetTable;
use crate::output::reduce::Reductions;
use crate::output::shard::{ShardFile, Survey, file_name, ranges, survey};
use crate::output::sink::SinkFile;
use crate::output::whole_file;
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
    let survey = survey(dir)?;
    let refuse = |problem: String| Error::NoShards { dir: dir.into(), problem };
    if let Some(problem) = what_is_missing(&survey) {
        return Err(refuse(problem));
    }
    let shards: Result<Vec<ShardFile>, Error> =
        (1..=survey.of).map(|shard| ShardFile::open(&dir.join(file_name(shard, survey.of)))).collect();
    let shards = shards?;
    shards.windows(2).try_for_each(|pair| fit(&pair[0], &pair[1])).map_err(refuse)?;
    let (first, last) = (&shards[0], &shards[shards.len() - 1]);
    if first.shard.designs.start != 0 || last.shard.designs.end != last.shard.sweep_designs {
        return Err(refuse("the shards are not of the whole sweep".into()));
    }
    let folder = ResultFolder::new(&RUN, dir.into());
    if let Verdict::Done(origin) = folder.check_for(&first.origin.inputs, permissions)? {
        return Ok(Merged::Before(origin));
    }
    let claim = folder.claim("of a merge")?;
    if let Verdict::Done(origin) = folder.check_for(&first.origin.inputs, permissions)? {
        return Ok(Merged::Before(origin));
    }
    let text = write(&claim, &shards)?;
    let unreadable = || refuse("the manifest of its first shard cannot be read".into());
    Ok(Merged::Now(Box::new(Origin::of(&text).ok_or_else(unreadable)?)))
}

/// In words, where something is.
fn what_is_missing(survey: &Survey) -> Option<String> {
    if let Some((shard, problem)) = survey.damaged.first() {
        let name = file_name(*shard, survey.of);
        return Some(format!("{name} is damaged ({problem}): run this shard again"));
    }
    let of = survey.of;
    match survey.missing[..] {
        [] => None,
        [one] => Some(format!("shard {one} of {of} is missing")),
        _ => Some(format!("shards {} of {of} are missing", ranges(&survey.missing))),
    }
}

/// Whether one shard follows another; else what differs.
fn fit(one: &ShardFile, next: &ShardFile) -> Result<(), String> {
    let names = [one, next].map(|shard| file_name(shard.shard.shard, shard.shard.of));
    let differ = |what: &str, of: [String; 2]| {
        Err(format!("{} and {} are of different {what}: {} and {}", names[0], names[1], of[0], of[1]))
    };
    let both = [one, next].map(|shard| &shard.origin);
    if both[0].inputs.text != both[1].inputs.text {
        return differ("configs", both.map(|origin| origin.inputs.path.clone()));
    }
    if both[0].inputs != both[1].inputs {
        return Err(format!("{} and {} are of different lists of designs", names[0], names[1]));
    }
    if both[0].program() != both[1].program() {
        return differ("programs", both.map(Origin::program));
    }
    if both[0].computed_by != both[1].computed_by {
        return differ("devices", both.map(|origin| origin.computed_by.clone()));
    }
    let tables =
        |origin: &Origin| origin.files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().join(", ");
    if tables(both[0]) != tables(both[1]) {
        return differ("tables", both.map(tables));
    }
    let [Shard { designs, .. }, Shard { designs: next_designs, .. }] = [&one.shard, &next.shard];
    if designs.end != next_designs.start {
        let said = [designs, next_designs].map(|designs| format!("{} to {}", designs.start, designs.end));
        return Err(format!("{} has the designs {}, {} has {}", names[0], said[0], names[1], said[1]));
    }
    Ok(())
}

/// Writes the tables and the manifest of the whole sweep, and returns the manifest's text.
fn write(claim: &Claim, shards: &[ShardFile]) -> Result<String, Error> {
    let path = claim.partial(MANIFEST);
    let mut merged = Merger::new(shards);
    // First of all, so that no crash leaves a table that nobody vouches for.
    whole_file::write_whole(&path, &merged.text(State::Incomplete))?;
    let tables = &shards[0].origin.files;
    claim.remove_others(tables.iter().map(|(name, _)| name.as_str()))?;
    for (place, (name, _)) in tables.iter().enumerate() {
        let mut file = SinkFile::new(name, claim.partial(name));
        file.open()?;
        file.begin(&[])?;
        for (number, shard) in shards.iter().enumerate() {
            shard.read_table(place, number == 0, &mut |bytes| file.append(bytes))?;
        }
        if name == TABLE_PARQUET {
            file.end(&ParquetTable::of(&study(&shards[0])?))?;
        }
        merged.files.push(FileEntry::new(name, &file.fingerprint()));
    }
    if let Some(answers) = answers(shards)? {
        for (name, bytes) in answers.files() {
            whole_file::write_whole(&claim.partial(name), &bytes)?;
            merged.files.push(FileEntry::new(name, &Fingerprint::of(&bytes)));
        }
        merged.remarks = answers.remarks();
    }
    let text = merged.text(State::Complete);
    whole_file::write_whole(&path, &text)?;
    claim.publish()?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// What the shards are of; the list of designs that it may name must still be there.
fn study(shard: &ShardFile) -> Result<Study, Error> {
    let Inputs { path, text, .. } = &shard.origin.inputs;
    Study::from_text(Path::new(path), text.clone())
}

/// The answers of all shards together.
fn answers(shards: &[ShardFile]) -> Result<Option<Reductions>, Error> {
    let mut joined: Option<Reductions> = None;
    for shard in shards {
        let Some(text) = &shard.origin.answers else { return Ok(None) };
        let more: Reductions = serde_json::from_str(text.get()).map_err(|_| Error::DamagedShard {
            path: shard.path.clone(),
            problem: "its answers cannot be read".into(),
        })?;
        match &mut joined {
            None => joined = Some(more),
            Some(joined) => joined.merge(&more)?,
        }
    }
    Ok(joined)
}

/// The manifest of a merged result: that of the first shard, with what all came to.
struct Merger {
    first: Value,
    counts: Counts,
    spent: [f64; 2],
    shards: usize,
    files: Vec<FileEntry>,
    remarks: Vec<String>,
}

impl Merger {
    fn new(shards: &[ShardFile]) -> Merger {
        let mut counts = Counts::default();
        let mut spent = [0.0; 2];
        for shard in shards {
            counts.merge(&shard.origin.counts);
            counts.designs_asked += shard.origin.counts.designs_asked;
            counts.rows_asked += shard.origin.counts.rows_asked;
            let own: Value = serde_json::from_str(&shard.manifest).unwrap_or_default();
            for (sum, key) in spent.iter_mut().zip(SPENT) {
                *sum += own.get(key).and_then(Value::as_f64).unwrap_or(0.0);
            }
        }
        let first = serde_json::from_str(&shards[0].manifest).unwrap_or_default();
        Merger { first, counts, spent, shards: shards.len(), files: Vec::new(), remarks: Vec::new() }
    }

    fn text(&self, state: State) -> Vec<u8> {
        let mut manifest = self.first.clone();
        if let Some(manifest) = manifest.as_object_mut() {
            for key in ["part", "header_bytes", "stage_seconds", "starts", "answers"] {
                manifest.shift_remove(key);
            }
            manifest.insert("state".into(), serde_json::json!(&state));
            manifest.insert("shards".into(), self.shards.into());
            manifest.insert("files".into(), serde_json::json!(&self.files));
            if !self.remarks.is_empty() {
                manifest.insert("remarks".into(), serde_json::json!(&self.remarks));
            }
            manifest.insert("counts".into(), serde_json::json!(&self.counts));
            for (key, spent) in SPENT.into_iter().zip(self.spent) {
                manifest.insert(key.into(), spent.into());
            }
        }
        manifest::text(&manifest)
    }
}

/// Times of a manifest that add up.
const SPENT: [&str; 2] = ["wall_seconds", "processor_seconds"];
