//! Saves outcomes as they come, so that a run that ends early leaves whole rows and a manifest that says so.

use std::path::PathBuf;

use crate::engine::outcome::DesignOutcome;
use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::folder::{Claim, MANIFEST, TABLE};
use crate::output::laws_table::LawsTable;
use crate::output::manifest::{self, Conditions, Manifest, State};
use crate::output::sink::{Sink, SinkFile};
use crate::output::table::Table;
use crate::study::config::Study;

/// Writes the table and the manifest of one run, under their partial names until it is complete. Before the first outcome it
/// only proves that it can: a run that ends before leaves nothing behind.
pub struct Recorder {
    claim: Claim,
    manifest: Manifest,
    sinks: Vec<SinkFile>,
    /// Whether there was an outcome.
    begun: bool,
    finished: bool,
}

impl Recorder {
    pub fn new(claim: Claim, study: &Study, conditions: &Conditions) -> Result<Recorder, Error> {
        let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(Table::default())];
        if study.fits_laws() {
            sinks.push(Box::new(LawsTable));
        }
        let file = |sink: Box<dyn Sink>| {
            let path = claim.partial(sink.file_name());
            SinkFile::new(sink, path)
        };
        let sinks = sinks.into_iter().map(file).collect();
        let manifest = Manifest::new(study, conditions);
        let mut recorder = Recorder { claim, manifest, sinks, begun: false, finished: false };
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
        for sink in &mut self.sinks {
            sink.write(&mut outcome)?;
        }
        self.manifest.counts.add(&outcome);
        Ok(())
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
        if self.begun {
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
        for sink in &self.sinks {
            self.manifest.set_file(sink.name(), &sink.fingerprint());
        }
        self.manifest.save(&self.manifest_path())
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
        self.sinks.iter_mut().try_for_each(SinkFile::open)?;
        manifest::publish(&self.manifest_path())?;
        self.begun = true;
        self.claim.remove_others(self.sinks.iter().map(SinkFile::name))?;
        self.sinks.iter_mut().try_for_each(SinkFile::begin)
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.sinks.iter_mut().try_for_each(SinkFile::flush)
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
        let _ = self.flush();
        self.manifest.state = State::Failed;
        let _ = self.manifest.save(&self.manifest_path());
    }
}
