//! Saves rows as they come, so that a run that ends early leaves whole rows and a manifest that says where it stood: the next run
//! goes on from there.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::engine::outcome::DesignOutcome;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::folder::{Claim, MANIFEST, table_name};
use crate::output::laws_table::LawsTable;
use crate::output::manifest::{self, Conditions, Counts, Manifest, Origin, State};
use crate::output::sink::{Sink, SinkFile};
use crate::output::table_sink::{portion, table_sink};
use crate::study::config::Study;

/// What the outcomes of a run go to.
pub struct Sinks {
    all: Vec<Box<dyn Sink>>,
    portion: u64,
}

/// What some designs add to a run: bytes for each of its files, and counts.
pub struct Rows {
    bytes: Vec<Vec<u8>>,
    counts: Counts,
}

impl Rows {
    /// How many designs they are of.
    pub fn designs(&self) -> u64 {
        self.counts.designs
    }
}

impl Sinks {
    pub fn of(study: &Study) -> Sinks {
        let mut all: Vec<Box<dyn Sink>> = vec![table_sink(study)];
        if study.fits_laws() {
            all.push(Box::new(LawsTable));
        }
        Sinks { all, portion: portion(study) }
    }

    /// Designs whose rows are made together.
    pub fn portion(&self) -> u64 {
        self.portion
    }

    /// Rows of designs that follow each other, made by any thread.
    pub fn rows(&self, mut outcomes: Vec<DesignOutcome>) -> Rows {
        let bytes = self.all.iter().map(|sink| sink.rows(&mut outcomes)).collect();
        let mut counts = Counts::default();
        outcomes.iter().for_each(|outcome| counts.add(outcome));
        Rows { bytes, counts }
    }
}

/// Time between two manifests of a run that goes on: what it loses at most when it is killed.
const MARK: Duration = Duration::from_millis(250);

/// Writes the files and the manifest of one run, under their partial names until it is complete. Before the first rows it
/// only proves that it can: a run that ends before leaves nothing behind.
pub struct Recorder {
    claim: Claim,
    /// The name of the table's file.
    table: &'static str,
    manifest: Manifest,
    sinks: Arc<Sinks>,
    files: Vec<SinkFile>,
    /// Whether the files are this run's.
    begun: bool,
    finished: bool,
    marked: Instant,
}

impl Recorder {
    pub fn new(claim: Claim, study: &Study, conditions: &Conditions) -> Result<Recorder, Error> {
        let sinks = Sinks::of(study);
        let file = |sink: &Box<dyn Sink>| SinkFile::new(sink.file_name(), claim.partial(sink.file_name()));
        let files = sinks.all.iter().map(file).collect();
        let manifest = Manifest::new(study, conditions);
        let (sinks, marked) = (Arc::new(sinks), Instant::now());
        let table = table_name(study.output.format);
        let mut recorder =
            Recorder { claim, table, manifest, sinks, files, begun: false, finished: false, marked };
        recorder.manifest.stage(&recorder.manifest_path())?;
        Ok(recorder)
    }

    /// Goes on with what an unfinished run of the same study has left, from design number `designs` on. Where its files are not what
    /// its manifest says, the run begins anew, and this says why.
    pub fn go_on(&mut self, unfinished: &Origin) -> Result<Option<String>, Error> {
        let mut manifest = self.manifest.clone();
        manifest.go_on(unfinished).map_err(|problem| {
            let dir = self.claim.folder().dir().to_path_buf();
            Error::CannotGoOn { dir, problem }
        })?;
        for file in &mut self.files {
            let known = unfinished.files.iter().find(|(name, _)| name == file.name());
            file.open()?;
            if !known.map_or(Ok(false), |(_, print)| file.is_still(print))? {
                return Ok(Some(format!("{} is not what it was when the run before ended", file.name())));
            }
        }
        self.files.iter_mut().try_for_each(SinkFile::go_on)?;
        self.manifest = manifest;
        self.begun = true;
        self.mark()?;
        Ok(None)
    }

    /// Designs whose rows are there.
    pub fn designs(&self) -> u64 {
        self.manifest.counts.designs
    }

    /// What rows are made with.
    pub fn sinks(&self) -> Arc<Sinks> {
        Arc::clone(&self.sinks)
    }

    /// Where the manifest is until the run is complete.
    fn manifest_path(&self) -> PathBuf {
        self.claim.partial(MANIFEST)
    }

    /// Where the rows are until the run is complete.
    pub fn partial_table(&self) -> PathBuf {
        self.claim.partial(self.table)
    }

    /// Adds the rows of the next designs.
    pub fn write(&mut self, rows: &Rows) -> Result<(), Error> {
        self.begin()?;
        for (file, bytes) in self.files.iter_mut().zip(&rows.bytes) {
            file.append(bytes)?;
        }
        self.manifest.counts.merge(&rows.counts);
        if self.marked.elapsed() > MARK { self.mark() } else { Ok(()) }
    }

    /// Ends a run that went through all designs: table and manifest take the place of what was there before.
    pub fn finish(mut self, statistics: &Statistics) -> Result<Manifest, Error> {
        self.manifest.add_statistics(statistics);
        match self.close().and_then(|()| self.claim.publish()) {
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

    /// All that a complete run leaves is on disk afterwards.
    fn close(&mut self) -> Result<(), Error> {
        self.begin()?;
        for (file, sink) in self.files.iter_mut().zip(&self.sinks.all) {
            file.end(&**sink)?;
        }
        self.manifest.state = State::Complete;
        self.mark()
    }

    /// Ends a run that was interrupted: the rows so far stay, and what was there before stays as well.
    pub fn interrupt(mut self, statistics: Option<&Statistics>) -> Result<Manifest, Error> {
        if let Some(statistics) = statistics {
            self.manifest.add_statistics(statistics);
        }
        self.manifest.state = State::Interrupted;
        if self.begun {
            self.mark()?;
            self.finished = true;
        }
        Ok(self.manifest.clone())
    }

    /// Ends a run that an error stopped: rows written so far are kept, and the manifest tells the error.
    pub fn fail(mut self, error: &Error) {
        self.manifest.error = Some(error.to_string());
    }

    /// Opens the files, once. The rows of a run before that did not end are gone only when the new manifest is in place: no
    /// crash may leave new rows under an old manifest.
    fn begin(&mut self) -> Result<(), Error> {
        if self.begun {
            return Ok(());
        }
        self.files.iter_mut().try_for_each(SinkFile::open)?;
        manifest::publish(&self.manifest_path())?;
        self.begun = true;
        self.claim.remove_others(self.files.iter().map(SinkFile::name))?;
        for (file, sink) in self.files.iter_mut().zip(&self.sinks.all) {
            file.begin(&sink.header())?;
        }
        Ok(())
    }

    /// Saves where the run stands.
    fn mark(&mut self) -> Result<(), Error> {
        for file in &self.files {
            self.manifest.set_file(file.name(), &file.fingerprint());
        }
        self.manifest.save(&self.manifest_path())?;
        self.marked = Instant::now();
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
        if !self.begun {
            let _ = std::fs::remove_file(manifest::staged(&self.manifest_path()));
            return;
        }
        if std::thread::panicking() && self.manifest.error.is_none() {
            self.manifest.error = Some("the program panicked, which is a fault in it".into());
        }
        self.manifest.state = State::Failed;
        let _ = self.mark();
    }
}
