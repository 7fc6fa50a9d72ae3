//! `jointsweep run`: from a config to a folder with a result.

use std::io::Write;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::available_parallelism;
use std::time::SystemTime;

use jointsweep::Error;
use jointsweep::engine::backend::gpu::solver::GpuChoice;
use jointsweep::engine::cost;
use jointsweep::engine::sweep::{self, SweepOptions};
use jointsweep::output::folder::ResultFolder;
use jointsweep::output::manifest::{Conditions, State};
use jointsweep::output::recorder::Recorder;
use jointsweep::study::config::Study;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::progress::Progress;
use super::{Ending, INTERRUPTED, RunArgs, backend, report, say};

pub fn run(args: &RunArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let study = Study::load(&args.config)?;
    let folder = ResultFolder::check(args.out.as_deref(), &study, args.force)?;
    if args.dry_run {
        let text = report::estimate(&cost::estimate(&study)?, &folder.table());
        let _ = std::io::stdout().write_all(text.as_bytes());
        return Ok(Ending::Complete);
    }

    let chosen = backend::choose(&args.backend, &study)?;
    let stop = stop_on_signals();
    let threads = args.threads.or(available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let gpu = chosen.as_ref().map(|(device, precision)| GpuChoice { device, precision: *precision });
    let conditions = Conditions { gpu, threads, started };
    let mut recorder = Recorder::new(folder.clone(), &study, &conditions)?;
    let mut progress = Progress::new(study.design_count(), args.quiet);
    let options = SweepOptions { threads, gpu, notify: Some(&say) };
    let outcome = sweep::run(&study, &options, &mut |outcome| {
        recorder.write(outcome)?;
        progress.advance();
        Ok(if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    });
    progress.finish();
    let statistics = match outcome {
        Ok(statistics) => statistics,
        Err(error) => {
            recorder.fail(&error);
            return Err(error);
        }
    };
    let manifest = recorder.finish(&statistics)?;
    if !args.quiet {
        say(report::summary(&manifest, &folder.table()).trim_end());
    }
    Ok(match manifest.state {
        State::Interrupted => Ending::Interrupted,
        _ if manifest.counts.failed_designs > 0 => Ending::SomeDesignsFailed,
        _ => Ending::Complete,
    })
}

/// A flag that the first Ctrl-C (or SIGTERM, as batch systems send it) raises, to end the sweep after the design
/// at hand; the second ends the process. SIGHUP is left alone for the sake of `nohup`. Should a handler not be
/// had, the signal ends the process: the rows on disk are whole even then.
fn stop_on_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal must find the flag still down.
        let _ = flag::register_conditional_shutdown(signal, i32::from(INTERRUPTED), Arc::clone(&stop));
        let _ = flag::register(signal, Arc::clone(&stop));
    }
    stop
}
