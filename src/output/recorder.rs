//! Saves outcomes as they come, so that a run that ends early leaves whole rows and a manifest that says so.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::engine::outcome::DesignOutcome;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::folder::{Claim, MANIFEST, TABLE};
use crate::output::manifest::{self, Conditions, Manifest, State};
use crate::output::table::Table;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprinter;

/// Rows are handed to the file in portions of about this many bytes ...
const PORTION: usize = 1 << 16;
/// ... and at least this often, for those who watch the file of a slow run.
const PATIENCE: Duration = Duration::from_secs(1);

/// Writes the table and the manifest of one run, under their partial names until it is complete. Before the first outcome it
/// only proves that it can: a run that ends before leaves nothing behind.
pub struct Recorder {
    claim: Claim,
    manifest: Manifest,
    table: Table,
    /// Whole rows that wait for the file.
    waiting: Vec<u8>,
    /// From the first outcome on.
    file: Option<TableFile>,
    finished: bool,
}

struct TableFile {
    file: File,
    path: PathBuf,
    /// Of the whole rows in the file.
    printer: Fingerprinter,
    written: Instant,
}

impl Recorder {
    pub fn new(claim: Claim, study: &Study, conditions: &Conditions) -> Result<Recorder, Error> {
        let mut recorder = Recorder {
            claim,
            manifest: Manifest::new(study, conditions),
            table: Table::default(),
            waiting: Vec::new(),
            file: None,
            finished: false,
        };
        recorder.manifest.stage(&recorder.manifest_path())?;
        Ok(recorder)
    }

    /// Where the manifest is until the run is complete.
    fn manifest_path(&self) -> PathBuf {
        self.claim.partial(MANIFEST)
    }

    /// Where the rows are until the run is complete.
    pub fn partial_table(&self) -> PathBuf {
        self.claim.partial(TABLE)
    }

    /// Adds the rows of a design.
    pub fn write(&mut self, mut outcome: DesignOutcome) -> Result<(), Error> {
        self.begin()?;
        self.table.push_rows(&mut self.waiting, &mut outcome);
        self.manifest.counts.add(&outcome);
        let overdue = self.file.as_ref().is_some_and(|table| table.written.elapsed() > PATIENCE);
        if self.waiting.len() >= PORTION || overdue { self.flush() } else { Ok(()) }
    }

    /// Ends a run that went through all designs: table and manifest take the place of what was there before.
    pub fn finish(mut self, statistics: &Statistics) -> Result<Manifest, Error> {
        self.manifest.add_statistics(statistics);
        match self.close(State::Complete).and_then(|()| self.claim.publish()) {
            Ok(()) => {
                self.finished = true;
                Ok(self.manifest.clone())
            }
            Err(error) => {
                self.fail(&error);
                Err(error)
            }
        }
    }

    /// Ends a run that was interrupted: the rows so far stay, and what was there before stays as well.
    pub fn interrupt(mut self, statistics: Option<&Statistics>) -> Result<Manifest, Error> {
        if let Some(statistics) = statistics {
            self.manifest.add_statistics(statistics);
        }
        if self.file.is_some() {
            self.close(State::Interrupted)?;
            self.finished = true;
        }
        self.manifest.state = State::Interrupted;
        Ok(self.manifest.clone())
    }

    /// All rows and a manifest in this state are on disk afterwards.
    fn close(&mut self, state: State) -> Result<(), Error> {
        self.begin()?;
        self.flush()?;
        self.manifest.state = state;
        if let Some(table) = &self.file {
            self.manifest.set_file(TABLE, &table.printer.fingerprint());
        }
        self.manifest.save(&self.manifest_path())
    }

    /// Ends a run that an error stopped: rows written so far are kept, and the manifest tells the error.
    pub fn fail(mut self, error: &Error) {
        self.manifest.error = Some(error.to_string());
    }

    /// Opens the table, once. The rows of a run before that did not end are gone only when the new manifest is in place: no
    /// crash may leave new rows under an old manifest.
    fn begin(&mut self) -> Result<(), Error> {
        if self.file.is_some() {
            return Ok(());
        }
        let path = self.partial_table();
        let into_error = |source| Error::Io { action: "write", path: path.clone(), source };
        let opened = OpenOptions::new().write(true).create(true).truncate(false).open(&path);
        let file = opened.map_err(into_error)?;
        manifest::publish(&self.manifest_path())?;
        self.table.push_header(&mut self.waiting);
        let emptied = file.set_len(0).map_err(into_error);
        let printer = Fingerprinter::default();
        self.file = Some(TableFile { file, path, printer, written: Instant::now() });
        emptied
    }

    fn flush(&mut self) -> Result<(), Error> {
        match &mut self.file {
            Some(table) => table.append(&mut self.waiting),
            None => Ok(()),
        }
    }
}

impl TableFile {
    /// Appends all of `rows` or, when that fails, none of them: the file ends with a whole row.
    fn append(&mut self, rows: &mut Vec<u8>) -> Result<(), Error> {
        if let Err(source) = self.file.write_all(rows) {
            // Should this fail too, the first error is still the one to tell.
            let _ = self.file.set_len(self.printer.fingerprint().bytes);
            return Err(Error::Io { action: "write", path: self.path.clone(), source });
        }
        self.printer.update(rows);
        self.written = Instant::now();
        rows.clear();
        Ok(())
    }
}

/// A recorder that goes without having finished belongs to a run that failed, maybe in a panic. There is nobody
/// left to tell of further errors.
impl Drop for Recorder {
    fn drop(&mut self) {
        if self.finished {
            return;
        }
        if self.file.is_none() {
            let _ = std::fs::remove_file(manifest::staged(&self.manifest_path()));
            return;
        }
        if std::thread::panicking() && self.manifest.error.is_none() {
            self.manifest.error = Some("the program panicked, which is a fault in it".into());
        }
        let _ = self.flush();
        self.manifest.state = State::Failed;
        let _ = self.manifest.save(&self.manifest_path());
    }
}
