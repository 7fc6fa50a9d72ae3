//! Saves rows as they come, so that a run that ends early leaves whole rows and a manifest that says where it stood: the next run
//! goes on from there.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::value::to_raw_value;

use crate::engine::sweep::Statistics;
use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::folder::{MANIFEST, SAFE, table_name};
use crate::output::manifest::{self, Conditions, Manifest};
use crate::output::manifest_parts::{Shard, State};
use crate::output::origin::Origin;
use crate::output::reduce::Reductions;
use crate::output::shard;
use crate::output::sink::SinkFile;
use crate::output::sinks::{Rows, Sinks};
use crate::output::whole_file;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;

/// Time between two manifests of a run that goes on: what it loses at most when it is killed ...
const MARK: Duration = Duration::from_millis(250);
/// ... unless they are so large, for the answers in them, that they would take more than a hundredth of the time; ...
const SHARE: u32 = 100;
/// ... and what it loses when the machine goes down, which may keep what is written in memory.
const SAFE_MARK: Duration = Duration::from_secs(60);

/// Writes the files and the manifest of one run, under their partial names until it is complete. Before the first rows it
/// only proves that it can: a run that ends before leaves nothing behind.
pub struct Recorder {
    claim: Claim,
    /// The name of the table's file.
    table: &'static str,
    manifest: Manifest,
    /// Of a shard: which, and the file that it becomes.
    shard: Option<(Shard, PathBuf)>,
    sinks: Arc<Sinks>,
    files: Vec<SinkFile>,
    answers: Option<Reductions>,
    /// Whether the files are this run's.
    begun: bool,
    finished: bool,
    /// When its manifest last told where it stands.
    marked: Option<Instant>,
    /// Time from one manifest to the next.
    pause: Duration,
    saved: Instant,
}

impl Recorder {
    pub fn new(claim: Claim, study: &Study, conditions: &Conditions) -> Result<Recorder, Error> {
        Recorder::start(claim, study, conditions, None)
    }

    /// Of a shard, which becomes this file when it is whole. `claim` is of the folder where its rows are until then.
    pub fn of_shard(
        claim: Claim,
        study: &Study,
        conditions: &Conditions,
        shard: Shard,
        file: PathBuf,
    ) -> Result<Recorder, Error> {
        Recorder::start(claim, study, conditions, Some((shard, file)))
    }

    fn start(
        claim: Claim,
        study: &Study,
        conditions: &Conditions,
        shard: Option<(Shard, PathBuf)>,
    ) -> Result<Recorder, Error> {
        let sinks = Sinks::of(study);
        let names = sinks.all.iter().map(|sink| sink.file_name());
        let files = names.map(|name| SinkFile::new(name, claim.partial(name))).collect();
        let mut manifest = Manifest::new(study, conditions);
        if let Some((shard, _)) = &shard {
            let headers = sinks.all.iter().map(|sink| sink.header().len() as u64).collect();
            manifest = manifest.of_part(shard.clone(), headers);
        }
        let (answers, sinks) = (sinks.answers(), Arc::new(sinks));
        let mut recorder = Recorder {
            claim,
            table: table_name(study.output.format),
            manifest,
            shard,
            sinks,
            files,
            answers,
            begun: false,
            finished: false,
            marked: None,
            pause: MARK,
            saved: Instant::now(),
        };
        recorder.manifest.stage(&recorder.manifest_path())?;
        Ok(recorder)
    }

    /// Goes on with what an unfinished run of the same study has left. Where its files are not what its manifest says, they are what
    /// an earlier one says, or the run begins anew; then this says what is wrong.
    pub fn go_on(&mut self, unfinished: &Origin) -> Result<Option<String>, Error> {
        self.files.iter_mut().try_for_each(SinkFile::open)?;
        let earlier =
            std::fs::read_to_string(self.claim.partial(SAFE)).ok().and_then(|text| Origin::of(&text));
        let earlier = earlier.filter(|earlier| earlier.inputs == unfinished.inputs);
        let mut problem = None;
        for origin in [unfinished].into_iter().chain(&earlier) {
            let mut manifest = self.manifest.clone();
            manifest.go_on(origin).map_err(|problem| {
                let dir = self.claim.folder().dir().to_path_buf();
                Error::CannotGoOn { dir, problem }
            })?;
            if origin.files.is_empty() && origin.answers.is_none() {
                // It was killed before it had marked anything, and nothing is lost.
                continue;
            }
            let told = match (self.first_changed(origin)?, self.answers_of(origin)) {
                (None, Ok(answers)) => {
                    self.files.iter_mut().try_for_each(SinkFile::go_on)?;
                    (self.manifest, self.answers) = (manifest, answers);
                    self.begun = true;
                    self.mark()?;
                    return Ok(problem);
                }
                (Some(changed), _) => format!("{changed} is not what it was when the run before ended"),
                (None, Err(())) => "the answers so far of the run before cannot be read".into(),
            };
            problem.get_or_insert(told);
        }
        Ok(problem)
    }

    /// What an unfinished run has found out.
    fn answers_of(&self, origin: &Origin) -> Result<Option<Reductions>, ()> {
        let Some(mut answers) = self.sinks.answers() else { return Ok(None) };
        let found =
            origin.answers.as_ref().and_then(|text| serde_json::from_str(text.get()).ok()).ok_or(())?;
        answers.merge(&found).map_err(|_| ())?;
        Ok(Some(answers))
    }

    /// The first file that does not begin as a manifest says.
    fn first_changed(&mut self, origin: &Origin) -> Result<Option<String>, Error> {
        for file in &mut self.files {
            let known = origin.files.iter().find(|(name, _)| name == file.name());
            if !known.map_or(Ok(false), |(_, print)| file.is_still(print))? {
                return Ok(Some(file.name().to_string()));
            }
        }
        Ok(None)
    }

    /// The numbers of the designs whose rows are not there yet.
    pub fn designs_left(&self) -> Range<u64> {
        let Range { start, end } = self.designs_asked();
        start + self.manifest.counts.designs..end
    }

    /// The numbers of all designs of the run, which is of a shard or of the whole.
    pub fn designs_asked(&self) -> Range<u64> {
        let first = self.shard.as_ref().map_or(0, |(shard, _)| shard.designs.start);
        first..first + self.manifest.counts.designs_asked
    }

    /// What rows are made with.
    pub fn sinks(&self) -> Arc<Sinks> {
        Arc::clone(&self.sinks)
    }

    /// Where the manifest is until the run is complete.
    fn manifest_path(&self) -> PathBuf {
        self.claim.partial(MANIFEST)
    }

    /// Where the rows are until the run is complete; nothing where none are written.
    pub fn partial_table(&self) -> Option<PathBuf> {
        self.files.iter().any(|file| file.name() == self.table).then(|| self.claim.partial(self.table))
    }

    /// Adds the rows of the next designs.
    pub fn write(&mut self, rows: &Rows) -> Result<(), Error> {
        self.begin()?;
        for (file, bytes) in self.files.iter_mut().zip(&rows.bytes) {
            file.append(bytes)?;
        }
        self.manifest.counts.merge(&rows.counts);
        if let (Some(answers), Some(more)) = (&mut self.answers, &rows.answers) {
            answers.merge(more)?;
        }
        if self.designs_left().is_empty() {
            // The last manifest follows at once.
            return Ok(());
        }
        if self.saved.elapsed() > SAFE_MARK {
            return self.mark_safely();
        }
        if self.marked.is_none_or(|marked| marked.elapsed() > self.pause) { self.mark() } else { Ok(()) }
    }

    /// Ends a run that went through all designs: table and manifest take the place of what was there before.
    pub fn finish(mut self, statistics: &Statistics) -> Result<Manifest, Error> {
        self.manifest.add_statistics(statistics);
        match self.close().and_then(|()| self.publish()) {
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
        if self.shard.is_none() {
            for (file, sink) in self.files.iter_mut().zip(&self.sinks.all) {
                file.end(&**sink)?;
            }
            if let Some(answers) = self.answers.take() {
                for (name, bytes) in answers.files() {
                    whole_file::write_whole(&self.claim.partial(name), &bytes)?;
                    self.manifest.set_file(name, &Fingerprint::of(&bytes));
                }
                self.manifest.remarks = answers.remarks();
            }
            self.manifest.complete();
        }
        // A shard is complete in its own file alone: one that is killed before it has it goes on, with no designs left.
        self.mark()
    }

    /// Gives what is complete its own name.
    fn publish(&mut self) -> Result<(), Error> {
        let Some((_, to)) = &self.shard else { return self.claim.publish() };
        self.manifest.complete();
        let mut tables: Vec<PathBuf> =
            self.files.iter().map(|file| self.claim.partial(file.name())).collect();
        if tables.is_empty() {
            // Answers alone are in the manifest.
            tables.push(self.claim.partial(self.table));
        }
        shard::pack(&tables, &manifest::text(&self.manifest), to)?;
        self.claim.remove()
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
        whole_file::publish(&self.manifest_path())?;
        self.begun = true;
        self.claim.remove_others(self.files.iter().map(SinkFile::name))?;
        for (file, sink) in self.files.iter_mut().zip(&self.sinks.all) {
            file.begin(&sink.header())?;
        }
        Ok(())
    }

    /// Saves where the run stands.
    fn mark(&mut self) -> Result<(), Error> {
        let started = Instant::now();
        for file in &self.files {
            self.manifest.set_file(file.name(), &file.fingerprint());
        }
        let raw = |answers| to_raw_value(answers).expect("answers are numbers and texts");
        self.manifest.answers = self.answers.as_ref().map(raw);
        self.manifest.save(&self.manifest_path())?;
        self.pause = MARK.max(SHARE * started.elapsed());
        self.marked = Some(Instant::now());
        Ok(())
    }

    /// Saves where the run stands, in a place of its own, when all of it is on the disk.
    fn mark_safely(&mut self) -> Result<(), Error> {
        self.files.iter().try_for_each(SinkFile::sync)?;
        self.mark()?;
        self.manifest.save(&self.claim.partial(SAFE))?;
        self.saved = Instant::now();
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
            let _ = std::fs::remove_file(whole_file::staged(&self.manifest_path()));
            return;
        }
        if std::thread::panicking() && self.manifest.error.is_none() {
            self.manifest.error = Some("the program panicked, which is a fault in it".into());
        }
        self.manifest.state = State::Failed;
        let _ = self.mark();
    }
}
