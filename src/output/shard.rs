//! A shard: the rows of some designs of a sweep, in one file that says what it is.
//!
//! The bytes of its tables, one behind the other, each with its header; then its manifest, as JSON; then 32 bytes: how long the
//! manifest is (8 bytes, little end first), the XXH128 of the manifest (16 bytes) and `JSWSHRD1`. It has its name only when it is whole.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::engine::relay::Ended;
use crate::error::Error;
use crate::output::folder::{RUN, ResultFolder};
use crate::output::manifest_parts::Shard;
use crate::output::origin::Origin;
use crate::study::fingerprint::{Fingerprint, read_pieces};

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

/// The numbers in a name with this ending: which shard, and of how many.
pub fn numbers(name: &str, ending: &str) -> Option<(u64, u64)> {
    let own = name.strip_suffix(ending)?;
    let (shard, of) = own.strip_prefix("shard-")?.split_once("-of-")?;
    let (shard, of) = (shard.parse().ok()?, of.parse().ok()?);
    ((1..=of).contains(&shard) && stem(shard, of) == own).then_some((shard, of))
}

/// More files than a folder of a cluster's file system should have.
pub const MOST_SHARDS: u64 = 100_000;

/// What a whole shard says of itself.
#[derive(Debug)]
pub struct ShardFile {
    pub path: PathBuf,
    pub shard: Shard,
    pub origin: Origin,
    /// The manifest's text.
    pub manifest: String,
    /// In the order of the files of `origin`.
    pub tables: Vec<ShardTable>,
}

/// Where a table stands in a shard's file, and what it is.
#[derive(Debug)]
pub struct ShardTable {
    /// Bytes before it.
    start: u64,
    /// Bytes of its header.
    header: u64,
    print: Fingerprint,
}

impl ShardFile {
    /// Reads what a shard says of itself, and whether it is as long as it says.
    pub fn open(path: &Path) -> Result<ShardFile, Error> {
        let damaged = |problem: &str| Error::DamagedShard { path: path.into(), problem: problem.to_string() };
        let (manifest, bytes_before) = read_manifest(path)?;
        let origin = Origin::of(&manifest).ok_or_else(|| damaged("its manifest is of another program"))?;
        let Some((shard, headers)) = origin.part.clone() else {
            return Err(damaged("its manifest is of no shard"));
        };
        if path.file_name().is_none_or(|name| *name != *file_name(shard.shard, shard.of)) {
            return Err(damaged(&format!("it is shard {} of {}", shard.shard, shard.of)));
        }
        let (mut tables, mut start) = (Vec::new(), 0_u64);
        for ((_, print), header) in origin.files.iter().zip(&headers) {
            tables.push(ShardTable { start, header: *header, print: *print });
            start = start.saturating_add(print.bytes);
        }
        if start != bytes_before || headers.len() != origin.files.len() {
            return Err(damaged("it is not as long as it says"));
        }
        Ok(ShardFile { path: path.into(), shard, origin, manifest, tables })
    }
}

/// The text of a shard's manifest, and how many bytes stand before it.
fn read_manifest(path: &Path) -> Result<(String, u64), Error> {
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
    let bytes_before = length - TAIL - manifest_length;
    file.seek(SeekFrom::Start(bytes_before)).map_err(unreadable)?;
    let mut manifest = vec![0; manifest_length as usize];
    file.read_exact(&mut manifest).map_err(unreadable)?;
    if Fingerprint::of(&manifest).bytes_of_hash() != tail[8..24] {
        return Err(damaged("its manifest is not what it was"));
    }
    let manifest = String::from_utf8(manifest).map_err(|_| damaged("its manifest is no text"))?;
    Ok((manifest, bytes_before))
}

impl ShardTable {
    /// Hands over the table's bytes, the header only when asked, and checks them all. `path` is the shard's, `name` the table's.
    pub fn read(
        &self,
        path: &Path,
        name: &str,
        with_header: bool,
        give: &mut dyn FnMut(Vec<u8>) -> Result<(), Ended>,
    ) -> Result<(), Ended> {
        let unreadable = |source| Ended::Failed(Error::Io { action: "read", path: path.into(), source });
        let mut file = File::open(path).map_err(unreadable)?;
        file.seek(SeekFrom::Start(self.start)).map_err(unreadable)?;
        let mut skipped = if with_header { 0 } else { self.header };
        let printer = read_pieces(file, self.print.bytes, unreadable, |piece| {
            let skip = skipped.min(piece.len() as u64);
            skipped -= skip;
            give(piece[skip as usize..].to_vec())
        })?;
        if printer.fingerprint() != self.print {
            let problem = format!("its {name} is not what it was");
            return Err(Ended::Failed(Error::DamagedShard { path: path.into(), problem }));
        }
        Ok(())
    }
}

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
        for name in [
            "shard-7-of-100.shard",
            "shard-007-of-100",
            "shard--1-of-2.shard",
            "shard-1-of-2.shard.tmp",
            "shard-0-of-2.shard",
            "shard-3-of-2.shard",
        ] {
            assert_eq!(numbers(name, ".shard"), None, "{name}");
        }
    }
}
