//! `jointsweep run`: from a config to a folder with a result.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::drawing::Chosen;
use jointsweep::internals::engine::processor_pace::measured_pace;
use jointsweep::internals::engine::question::Asker;
use jointsweep::internals::engine::sweep::{self, Digest, SweepOptions};
use jointsweep::internals::output::folder::{Permissions, ResultFolder, Verdict};
use jointsweep::internals::output::manifest::{Conditions, Manifest};
use jointsweep::internals::output::origin::Origin;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::study::config::Study;

use super::arguments::{SettingArgs, thread_count, threads};
use super::backend::BackendArgs;
use super::interrupt::Interrupt;
use super::progress::Progress;
use super::{Ending, backend, print, report, retry, say, shard};

#[derive(Args)]
pub struct RunArgs {
    /// The sweep, a TOML file
    pub config: PathBuf,
    #[command(flatten)]
    pub settings: SettingArgs,
    /// Folder of the result [default: out/<config's name>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub backend: BackendArgs,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    pub threads: Option<usize>,
    /// Overwrite the result of another config
    #[arg(long)]
    pub force: bool,
    /// Begin anew where the config was run before; a complete result stays until the new one is. Interrupted, the same command goes on;
    /// with --force, too, it begins anew
    #[arg(long)]
    pub again: bool,
    /// Solve only one of N parts of the sweep, of about the same cost, into one file of the folder; `merge` puts them together
    #[arg(long, value_name = "I/N", value_parser = shard::part)]
    pub shard: Option<shard::Part>,
    /// Do the failed rows of a finished result again, and nothing else
    #[arg(long, conflicts_with_all = ["shard", "again", "force", "dry_run"])]
    pub retry_failed: bool,
    /// Only say what the sweep has to do and what it will cost
    #[arg(long)]
    pub dry_run: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Say the time of each stage, too
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
}

pub fn run(args: &RunArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    backend::check(&args.backend)?;
    let study = args.settings.load_and_warn(&args.config)?;
    let folder = ResultFolder::of_run(args.out.as_deref(), &study);
    if let Some(part) = args.shard {
        return shard::run(args, &study, part, started);
    }
    if args.dry_run {
        print(&report::estimate(&cost::estimate(&study)?, measured_pace(), &folder.table(&study)))?;
        return Ok(Ending::Complete);
    }
    if args.retry_failed {
        return retry::retry(args, &study, &folder);
    }
    let permissions = Permissions { force: args.force, again: args.again };
    let begun = match folder.check(&study, permissions)? {
        Verdict::Done(origin) => return already_done(args, &folder.table(&study), &origin),
        Verdict::Begun(origin) => Some(origin),
        Verdict::ToDo => None,
    };

    let threads = threads(args.threads);
    let chosen = backend::choose_for_sweep(&args.backend, &study, threads, begun.as_deref())?;
    let gpu = backend::gpu(&chosen);
    let claim = folder.claim(&format!("of {}", args.config.display()))?;
    if !claim.is_locked() {
        say(&format!(
            "warning: {} is on a file system without locks: start no second run there",
            folder.dir().display()
        ));
    }
    // While this one waited another run may have ended.
    let begun = match folder.check(&study, permissions)? {
        Verdict::Done(origin) => return already_done(args, &folder.table(&study), &origin),
        Verdict::Begun(origin) => Some(origin),
        Verdict::ToDo => None,
    };
    let conditions = Conditions { gpu, threads, started, anew: args.again };
    let mut recorder = Recorder::new(claim, &study, &conditions)?;
    if let Some(begun) = begun {
        go_on(args, &mut recorder, &begun)?;
    }
    let Some(manifest) = record(args, &study, recorder, &conditions)? else { return Ok(Ending::Interrupted) };
    if !args.quiet {
        print(&report::summary(&manifest, folder.dir(), args.verbose))?;
    }
    Ok(ending(manifest.counts.failed_designs))
}

/// Solves the designs that a recorder has not yet, and ends it; nothing where the user has interrupted it.
pub fn record(
    args: &RunArgs,
    study: &Study,
    recorder: Recorder,
    conditions: &Conditions,
) -> Result<Option<Manifest>, Error> {
    let (designs, sinks) = (recorder.designs_left(), recorder.sinks());
    let mut progress = Progress::of(&recorder.designs_asked(), &designs, args.quiet);
    let recorder = Arc::new(Mutex::new(Some(recorder)));
    let interrupt = Interrupt::watch(&recorder, args.quiet);

    let Conditions { threads, gpu, .. } = *conditions;
    let asking = sinks.asking();
    let asker = asking.as_ref().map(|asking| asking as &dyn Asker);
    let options = SweepOptions {
        threads,
        gpu,
        notify: Some(&say),
        asker,
        designs: Chosen::Range(designs),
        ..SweepOptions::default()
    };
    let digest = Digest { designs: sinks.portion(), make: &|solved| sinks.rows(solved) };
    let outcome = sweep::run_digested(study, &options, &digest, &mut |rows| {
        match recorder.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
            Some(recorder) => recorder.write(&rows)?,
            // The watcher has ended the run.
            None => return Ok(ControlFlow::Break(())),
        }
        progress.advance(rows.designs());
        Ok(if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    });
    progress.finish();
    let Some(recorder) = recorder.lock().unwrap_or_else(PoisonError::into_inner).take() else {
        return Ok(None);
    };
    let statistics = match outcome {
        Ok(statistics) => statistics,
        Err(error) => {
            recorder.fail(&error);
            return Err(error);
        }
    };
    if statistics.interrupted {
        let rows = recorder.partial_table();
        let manifest = recorder.interrupt(Some(&statistics))?;
        if !args.quiet {
            say(&report::interrupted(&manifest, rows.as_deref()));
        }
        return Ok(None);
    }
    recorder.finish(&statistics).map(Some)
}

/// Goes on where a run before has stopped, and says so.
pub fn go_on(args: &RunArgs, recorder: &mut Recorder, begun: &Origin) -> Result<(), Error> {
    let asked = recorder.designs_left();
    let damage = match recorder.go_on(begun) {
        // What cannot go on begins anew, as was asked.
        Err(Error::CannotGoOn { .. }) if args.again => None,
        damage => damage?,
    };
    if !args.quiet {
        let done = recorder.designs_left().start - asked.start;
        say(&report::going_on(done, asked.end - asked.start, damage.as_deref()));
    }
    Ok(())
}

pub fn ending(failed_designs: u64) -> Ending {
    if failed_designs > 0 { Ending::SomeDesignsFailed } else { Ending::Complete }
}

/// Ends as the run that was there before.
pub fn already_done(args: &RunArgs, table: &Path, origin: &Origin) -> Result<Ending, Error> {
    if !args.quiet {
        print(&report::already_done(origin, table))?;
    }
    Ok(ending(origin.counts.failed_designs))
}
