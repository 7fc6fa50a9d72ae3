//! Failed rows of a finished table: which they are, and the table with others in their places.

use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use csv::{Reader, ReaderBuilder, StringRecord};
use serde_json::{Value, json};

use crate::engine::outcome::DesignOutcome;
use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::counts::Counts;
use crate::output::folder::{MANIFEST, TABLE};
use crate::output::host::Program;
use crate::output::manifest;
use crate::output::manifest_parts::{FileEntry, State};
use crate::output::results::Results;
use crate::output::schema::result_columns;
use crate::output::sink::{Sink, SinkFile};
use crate::output::table::{Table, settle};
use crate::output::whole_file;
use crate::study::columns::{DESIGN, Quantity};
use crate::study::config::Study;
use crate::study::fingerprint::read_pieces;
use crate::study::output_options::{Format, OutputOptions};

/// A row without an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedRow {
    pub design: u64,
    /// Of the design's rows, from 0.
    pub step: usize,
    /// Where it stands in the file.
    bytes: Range<u64>,
    status: String,
}

/// Why the rows of a study cannot be found again in its result, if so.
pub fn refusal(study: &Study) -> Option<&'static str> {
    let OutputOptions { format, .. } = study.output;
    match () {
        () if study.select.is_some() => Some("[select] has left rows out"),
        () if study.reduce.is_some() => Some("the answers to [reduce] cannot be taken apart"),
        () if format != Format::Csv => Some("only rows of table.csv can be replaced"),
        () => None,
    }
}

/// The failed rows of a table, which has all rows of each of its designs.
pub fn failed_rows(table: &Path) -> Result<Vec<FailedRow>, Error> {
    let unreadable = |source| Error::Io { action: "read", path: table.into(), source };
    let broken =
        |problem: String| Error::Input { file: table.into(), line: None, key: String::new(), problem };
    let file = File::open(table).map_err(unreadable)?;
    let end = file.metadata().map_err(unreadable)?.len();
    let mut reader: Reader<File> = ReaderBuilder::new().buffer_capacity(1 << 20).from_reader(file);
    let header = reader.headers().map_err(|error| broken(error.to_string()))?;
    let place = |name: &str| {
        let found = header.iter().position(|column| column == name);
        found.ok_or_else(|| broken(format!("there is no column `{name}`, which tells what has failed")))
    };
    let (design, status) = (place(DESIGN)?, place(Quantity::Status.name())?);
    let (mut failed, mut record, mut last) = (Vec::new(), StringRecord::new(), None);
    loop {
        let start = reader.position().byte();
        if !reader.read_record(&mut record).map_err(|error| broken(error.to_string()))? {
            return Ok(failed);
        }
        let cell = |place: usize| record.get(place).unwrap_or_default();
        let number = cell(design);
        let number: u64 =
            number.parse().map_err(|_| broken(format!("`{number}` is no number of a design")))?;
        let step = last.filter(|(design, _)| *design == number).map_or(0, |(_, step)| step + 1);
        last = Some((number, step));
        if cell(status).starts_with("failed: ") {
            let bytes = start..reader.position().byte().min(end);
            failed.push(FailedRow { design: number, step, bytes, status: cell(status).into() });
        }
    }
}

/// What may be put in the place of a failed row.
pub struct NewRow {
    design: u64,
    step: usize,
    text: Vec<u8>,
    counts: Counts,
}

/// The rows of designs that were solved again.
pub fn new_rows(table: &Table, mut outcomes: Vec<DesignOutcome>) -> Vec<NewRow> {
    settle(&result_columns(), &mut outcomes);
    let of_step = |outcome: &DesignOutcome, step: usize| {
        let mut one = outcome.clone();
        (one.steps, one.case.steps) = (vec![outcome.steps[step].clone()], [outcome.case.steps[step]].into());
        let mut counts = Counts::default();
        counts.add(&one);
        let text = table.rows(&[one]);
        NewRow { design: outcome.case.index, step, text, counts }
    };
    let rows =
        outcomes.iter().flat_map(|outcome| (0..outcome.steps.len()).map(move |step| of_step(outcome, step)));
    rows.collect()
}

/// Rewrites a finished result with new rows in the places of failed ones.
pub struct Rewriter<'a> {
    claim: &'a Claim,
    results: &'a Results,
    failed: std::iter::Peekable<std::vec::IntoIter<FailedRow>>,
    old: OldTable,
    table: SinkFile,
    counts: Counts,
    /// The last design that has a failed row again.
    last_failed: Option<u64>,
}

impl<'a> Rewriter<'a> {
    pub fn new(
        claim: &'a Claim,
        results: &'a Results,
        failed: Vec<FailedRow>,
    ) -> Result<Rewriter<'a>, Error> {
        // First of all, so that no crash leaves a table that nobody vouches for.
        save(claim, results, State::Incomplete, &results.origin.counts, &[])?;
        let mut table = SinkFile::new(TABLE, claim.partial(TABLE));
        table.open()?;
        table.begin(&[])?;
        let counts = Counts { failed_designs: 0, ..results.origin.counts.clone() };
        let (failed, old) = (failed.into_iter().peekable(), OldTable::open(results.table())?);
        Ok(Rewriter { claim, results, failed, old, table, counts, last_failed: None })
    }

    /// Takes the rows of the next designs; those that had not failed stay as they are.
    pub fn add(&mut self, rows: &[NewRow]) -> Result<(), Error> {
        for new in rows {
            let is_next = |row: &FailedRow| (row.design, row.step) == (new.design, new.step);
            let Some(row) = self.failed.next_if(is_next) else { continue };
            self.old.copy_to(row.bytes.start, &mut self.table)?;
            self.old.skip_to(row.bytes.end)?;
            self.table.append(&new.text)?;
            self.counts.replace_failure(&row.status, &new.counts);
            if new.counts.failed_rows > 0 && self.last_failed != Some(new.design) {
                self.counts.failed_designs += 1;
                self.last_failed = Some(new.design);
            }
        }
        Ok(())
    }

    /// Puts the new result in the place of the old one, and returns its manifest's text.
    pub fn finish(mut self) -> Result<String, Error> {
        self.old.copy_to(u64::MAX, &mut self.table)?;
        let mut files = vec![FileEntry::new(TABLE, &self.table.fingerprint())];
        for (name, print) in self.results.origin.files.iter().filter(|(name, _)| name != TABLE) {
            let (from, to) = (self.results.dir().join(name), self.claim.partial(name));
            std::fs::copy(&from, &to).map_err(|source| Error::Io { action: "write", path: to, source })?;
            files.push(FileEntry::new(name, print));
        }
        let text = save(self.claim, self.results, State::Complete, &self.counts, &files)?;
        self.claim.publish()?;
        Ok(text)
    }
}

/// Writes the manifest of the result as it will be.
fn save(
    claim: &Claim,
    results: &Results,
    state: State,
    counts: &Counts,
    files: &[FileEntry],
) -> Result<String, Error> {
    let mut manifest: Value = serde_json::from_str(&results.manifest).unwrap_or_default();
    if let Some(manifest) = manifest.as_object_mut() {
        manifest.insert("state".into(), json!(state));
        manifest.insert("files".into(), json!(files));
        manifest.insert("counts".into(), json!(counts));
        manifest.insert("failed_rows_done_again_by".into(), Program::CURRENT.in_words().into());
    }
    let text = manifest::text(&manifest);
    whole_file::write_whole(&claim.partial(MANIFEST), &text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// A table that is read from its beginning to its end.
struct OldTable {
    path: PathBuf,
    file: File,
    /// Where the file stands, bytes.
    at: u64,
}

impl OldTable {
    fn open(path: PathBuf) -> Result<OldTable, Error> {
        match File::open(&path) {
            Ok(file) => Ok(OldTable { path, file, at: 0 }),
            Err(source) => Err(Error::Io { action: "read", path, source }),
        }
    }

    /// Copies what stands before a place, or all that is left.
    fn copy_to(&mut self, end: u64, to: &mut SinkFile) -> Result<(), Error> {
        let OldTable { path, file, at } = self;
        let unreadable = |source| Error::Io { action: "read", path: path.clone(), source };
        let copied = read_pieces(file, end.saturating_sub(*at), unreadable, |bytes| to.append(bytes))?;
        *at += copied.fingerprint().bytes;
        Ok(())
    }

    fn skip_to(&mut self, place: u64) -> Result<(), Error> {
        let sought = self.file.seek(SeekFrom::Start(place));
        self.at = sought.map_err(|source| Error::Io { action: "read", path: self.path.clone(), source })?;
        Ok(())
    }
}
