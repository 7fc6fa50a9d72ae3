//! `table.csv.zst`: the text of `table.csv`, compressed portion by portion; each portion is one Zstandard frame, and the header another
//! one. Frames one behind the other are one file to every reader.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::engine::outcome::DesignOutcome;
use crate::output::folder::TABLE_ZST;
use crate::output::sink::Sink;
use crate::output::table::Table;
use crate::study::config::Study;

/// Writes outcomes as compressed rows.
pub struct ZstTable {
    text: Table,
}

/// Faster than the levels above it and no larger than the next five: `zstd -b1 -e6 table.csv`, of the sweep of `benches/formats`.
const LEVEL: i32 = 1;

impl ZstTable {
    /// As the study asks for it.
    pub fn of(study: &Study) -> ZstTable {
        ZstTable { text: Table::of(study) }
    }
}

impl Sink for ZstTable {
    fn file_name(&self) -> &'static str {
        TABLE_ZST
    }

    fn header(&self) -> Vec<u8> {
        frame(&self.text.header())
    }

    fn rows(&self, outcomes: &[DesignOutcome]) -> Vec<u8> {
        if outcomes.iter().all(|outcome| outcome.steps.is_empty()) {
            return Vec::new();
        }
        frame(&self.text.rows(outcomes))
    }
}

/// With a checksum of its content.
fn frame(text: &[u8]) -> Vec<u8> {
    let compress = || {
        let mut compressor = zstd::bulk::Compressor::new(LEVEL)?;
        compressor.set_parameter(zstd::zstd_safe::CParameter::ChecksumFlag(true))?;
        compressor.compress(text)
    };
    compress().expect("only a lack of memory keeps text from being compressed")
}

/// The text of such a file.
pub fn open_text(path: &Path) -> std::io::Result<Box<dyn Read + Send>> {
    Ok(Box::new(zstd::Decoder::new(File::open(path)?)?))
}
