//! A shard: the rows of some designs of a sweep, in one file that says what it is.
//!
//! The bytes of its tables, one behind the other, each with its header; then its manifest, as JSON; then 32 bytes: how long the
//! manifest is (8 bytes, little end first), the XXH128 of the manifest (16 bytes) and `JSWSHRD1`. It has its name only when it is whole.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::folder::{RUN, ResultFolder};
use crate::output::manifest_parts::Shard;
use crate::output::origin::Origin;
use crate::study::fingerprint::{Fingerprint, Fingerprinter};

const MAGIC: &[u8; 8] = b"JSWSHRD1";
const TAIL: u64 = 32;

/// The longest manifest that is read, bytes: those with a long front of Pareto are a few megabytes.
const LONGEST_MANIFEST: u64 = 1 << 30;

impl Shard {
    pub fn file(&self, dir: &Path) -> PathBuf {
        dir.join(file_name(self.shard, self.of))
    }

    /// Where its rows are while it is made.
    pub fn folder(&self, dir: &Path) -> ResultFolder {
        ResultFolder::new(&RUN, dir.join(folder_name(self.shard, self.of)))
    }
}

/// "shard-007-of-100.shard".
pub fn file_name(shard: u64, of: u64) -> String {
    format!("{}.shard", stem(shard, of))
}

fn folder_name(shard: u64, of: u64) -> String {
    format!("{}.partial", stem(shard, of))
}

fn stem(shard: u64, of: u64) -> String {
    format!("shard-{shard:0width$}-of-{of}", width = of.to_string().len())
}

/// The numbers in a name with this ending.
fn numbers(name: &str, ending: &str) -> Option<(u64, u64)> {
    let (shard, of) = name.strip_suffix(ending)?.strip_prefix("shard-")?.split_once("-of-")?;
    let numbers = (shard.parse().ok()?, of.parse().ok()?);
    (stem(numbers.0, numbers.1) == name.strip_suffix(ending)?).then_some(numbers)
}

/// What is in a folder of shards, as the names and the ends of the files say.
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

/// Looks at a folder of shards; it says nothing of processes.
pub fn survey(dir: &Path) -> Result<Survey, Error> {
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
        [one, other, ..] => return refuse(format!("there are shards of {one} and shards of {other}")),
    };
    let mut survey = Survey { of, ..Survey::default() };
    for (shard, _) in &files {
        match ShardFile::open(&dir.join(file_name(*shard, of))) {
            Ok(_) => survey.complete.push(*shard),
            Err(Error::DamagedShard { problem, .. }) => survey.damaged.push((*shard, problem)),
            Err(error) => return Err(error),
        }
    }
    survey.missing = (1..=of).filter(|shard| survey.complete.binary_search(shard).is_err()).collect();
    let is_missing = |shard: &u64| survey.missing.binary_search(shard).is_ok();
    survey.started = folders.into_iter().map(|(shard, _)| shard).filter(is_missing).collect();
    Ok(survey)
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

/// More files than a folder of a cluster's file system should have.
pub const MOST_SHARDS: u64 = 100_000;

/// A whole shard, to be read.
#[derive(Debug)]
pub struct ShardFile {
    pub path: PathBuf,
    pub shard: Shard,
    /// With its tables, in their order.
    pub origin: Origin,
    /// The manifest's text.
    pub manifest: String,
    /// The bytes of each table's header.
    headers: Vec<u64>,
}

impl ShardFile {
    /// Reads what a shard says of itself, and whether it is as long as it says.
    pub fn open(path: &Path) -> Result<ShardFile, Error> {
        let unreadable = |source| Error::Io { action: "read", path: path.into(), source };
        let damaged = |problem: &str| Error::DamagedShard { path: path.into(), problem: problem.to_string() };
        let mut file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut tail = [0; TAIL as usize];
        if length < TAIL {
            return Err(damaged("it is cut"));
        }
        file.seek(SeekFrom::Start(length - TAIL)).map_err(unreadable)?;
        file.read_exact(&mut tail).map_err(unreadable)?;
        if &tail[24..] != MAGIC {
            return Err(damaged("its end is missing"));
        }
        let manifest_length = u64::from_le_bytes(tail[..8].try_into().expect("eight bytes"));
        if manifest_length > LONGEST_MANIFEST.min(length - TAIL) {
            return Err(damaged("its end is not what it was"));
        }
        file.seek(SeekFrom::Start(length - TAIL - manifest_length)).map_err(unreadable)?;
        let mut manifest = vec![0; manifest_length as usize];
        file.read_exact(&mut manifest).map_err(unreadable)?;
        if Fingerprint::of(&manifest).bytes_of_hash() != tail[8..24] {
            return Err(damaged("its manifest is not what it was"));
        }
        let manifest = String::from_utf8(manifest).map_err(|_| damaged("its manifest is no text"))?;
        let origin = Origin::of(&manifest).ok_or_else(|| damaged("its manifest is of another program"))?;
        let Some((shard, headers)) = origin.part.clone() else {
            return Err(damaged("its manifest is of no shard"));
        };
        if path.file_name().is_none_or(|name| *name != *file_name(shard.shard, shard.of)) {
            return Err(damaged(&format!("it is shard {} of {}", shard.shard, shard.of)));
        }
        let tables: u64 = origin.files.iter().map(|(_, print)| print.bytes).sum();
        if tables + manifest_length + TAIL != length || headers.len() != origin.files.len() {
            return Err(damaged("it is not as long as it says"));
        }
        Ok(ShardFile { path: path.into(), shard, origin, manifest, headers })
    }

    /// Hands over the bytes of its table number `place`, the header only when asked, and checks them all.
    pub fn read_table(
        &self,
        place: usize,
        with_header: bool,
        take: &mut dyn FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let unreadable = |source| Error::Io { action: "read", path: self.path.clone(), source };
        let (name, print) = &self.origin.files[place];
        let start: u64 = self.origin.files[..place].iter().map(|(_, print)| print.bytes).sum();
        let mut file = File::open(&self.path).map_err(unreadable)?;
        file.seek(SeekFrom::Start(start)).map_err(unreadable)?;
        let mut printer = Fingerprinter::default();
        let mut skipped = if with_header { 0 } else { self.headers[place] };
        let (mut piece, mut left) = (vec![0; PIECE], print.bytes);
        while left > 0 {
            let wanted = left.min(PIECE as u64) as usize;
            let count = match file.read(&mut piece[..wanted]) {
                Ok(0) => break,
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => return Err(unreadable(source)),
            };
            left -= count as u64;
            printer.update(&piece[..count]);
            let skip = skipped.min(count as u64);
            skipped -= skip;
            take(&piece[skip as usize..count])?;
        }
        if printer.fingerprint() != *print {
            let problem = format!("its {name} is not what it was");
            return Err(Error::DamagedShard { path: self.path.clone(), problem });
        }
        Ok(())
    }
}

/// Bytes read at a time.
const PIECE: usize = 1 << 20;

/// Makes a shard of its tables, which are files of their own until then: the first of them becomes the shard, made where it is not
/// there.
pub fn pack(tables: &[PathBuf], manifest: &[u8], to: &Path) -> Result<(), Error> {
    let (first, others) = tables.split_first().expect("a shard has a table");
    let unwritable = |source| Error::Io { action: "write", path: first.clone(), source };
    let mut file = OpenOptions::new().append(true).create(true).open(first).map_err(unwritable)?;
    for table in others {
        let unreadable = |source| Error::Io { action: "read", path: table.clone(), source };
        let mut table = File::open(table).map_err(unreadable)?;
        std::io::copy(&mut table, &mut file).map_err(unwritable)?;
    }
    let mut end = manifest.to_vec();
    end.extend_from_slice(&(manifest.len() as u64).to_le_bytes());
    end.extend_from_slice(&Fingerprint::of(manifest).bytes_of_hash());
    end.extend_from_slice(MAGIC);
    file.write_all(&end).and_then(|()| file.sync_data()).map_err(unwritable)?;
    std::fs::rename(first, to).map_err(|source| Error::Io { action: "write", path: to.into(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_the_order_of_the_shards() {
        assert_eq!(file_name(7, 100), "shard-007-of-100.shard");
        assert_eq!(numbers("shard-007-of-100.shard", ".shard"), Some((7, 100)));
        for name in
            ["shard-7-of-100.shard", "shard-007-of-100", "shard--1-of-2.shard", "shard-1-of-2.shard.tmp"]
        {
            assert_eq!(numbers(name, ".shard"), None, "{name}");
        }
    }
}
