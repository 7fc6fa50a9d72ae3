//! Saves outcomes as they come, so that a run that ends early leaves a valid table and a manifest that says so.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::engine::outcome::DesignOutcome;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::folder::{ResultFolder, remove_empty};
use crate::output::manifest::{self, Conditions, Manifest, State};
use crate::output::table::Table;
use crate::study::config::Study;

/// Rows are handed to the file in portions of about this many bytes ...
const PORTION: usize = 1 << 16;
/// ... and at least this often, for those who watch the file of a slow run.
const PATIENCE: Duration = Duration::from_secs(1);

/// Writes the table and the manifest of one run. Until the first outcome it only proves that it can: an earlier
/// result stays as it is, and a run that ends before leaves nothing behind.
pub struct Recorder {
    folder: ResultFolder,
    /// Folders made for this run, outermost first.
    created: Vec<PathBuf>,
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
    /// Bytes of whole rows in the file.
    length: u64,
    written: Instant,
}

impl Recorder {
    pub fn new(folder: ResultFolder, study: &Study, conditions: &Conditions) -> Result<Recorder, Error> {
        let created = folder.create()?;
        let mut recorder = Recorder {
            folder,
            created,
            manifest: Manifest::new(study, conditions),
            table: Table::default(),
            waiting: Vec::new(),
            file: None,
            finished: false,
        };
        recorder.manifest.stage(&recorder.folder.manifest())?;
        Ok(recorder)
    }

    /// Adds the rows of a design.
    pub fn write(&mut self, mut outcome: DesignOutcome) -> Result<(), Error> {
        self.begin()?;
        self.table.push_rows(&mut self.waiting, &mut outcome);
        self.manifest.counts.add(&outcome);
        let overdue = self.file.as_ref().is_some_and(|table| table.written.elapsed() > PATIENCE);
        if self.waiting.len() >= PORTION || overdue { self.flush() } else { Ok(()) }
    }

    /// Ends the run: all rows and the final manifest are on disk afterwards.
    pub fn finish(mut self, statistics: &Statistics) -> Result<Manifest, Error> {
        self.manifest.add_statistics(statistics);
        let state = if statistics.interrupted { State::Interrupted } else { State::Complete };
        match self.close(state) {
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

    fn close(&mut self, state: State) -> Result<(), Error> {
        self.begin()?;
        self.flush()?;
        self.manifest.state = state;
        self.manifest.save(&self.folder.manifest())
    }

    /// Ends a run that an error stopped: rows written so far are kept, and the manifest tells the error.
    pub fn fail(mut self, error: &Error) {
        self.manifest.error = Some(error.to_string());
    }

    /// Replaces what was in the folder, once. The old table is emptied only when the new manifest is in place:
    /// no crash may leave the new table under the old manifest.
    fn begin(&mut self) -> Result<(), Error> {
        if self.file.is_some() {
            return Ok(());
        }
        let path = self.folder.table();
        let into_error = |source| Error::Io { action: "write", path: path.clone(), source };
        let opened = OpenOptions::new().write(true).create(true).truncate(false).open(&path);
        let file = opened.map_err(into_error)?;
        manifest::publish(&self.folder.manifest())?;
        self.table.push_header(&mut self.waiting);
        let emptied = file.set_len(0).map_err(into_error);
        self.file = Some(TableFile { file, path, length: 0, written: Instant::now() });
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
            let _ = self.file.set_len(self.length);
            return Err(Error::Io { action: "write", path: self.path.clone(), source });
        }
        self.length += rows.len() as u64;
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
        if self.file.is_some() {
            let _ = self.flush();
            self.manifest.state = State::Failed;
            let _ = self.manifest.save(&self.folder.manifest());
        } else {
            let _ = std::fs::remove_file(manifest::staged(&self.folder.manifest()));
            remove_empty(&self.created);
        }
    }
}
