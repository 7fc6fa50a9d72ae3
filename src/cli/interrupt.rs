//! Ctrl-C, and SIGTERM as batch systems send it: the run ends within a second, whatever a design is doing, and its rows stay.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};

use jointsweep::internals::output::recorder::Recorder;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::{INTERRUPTED, report, say};

/// Whether the user wants the run to end.
pub struct Interrupt {
    asked: Arc<AtomicBool>,
}

/// The run has so long to end by itself, after the design at hand. Then it is ended.
const GRACE: Duration = Duration::from_millis(500);

/// Between two looks for a second signal.
const PAUSE: Duration = Duration::from_millis(10);

impl Interrupt {
    /// From now on. SIGHUP is left alone for the sake of `nohup`. Should a handler not be had, a signal ends the process:
    /// the rows on disk are whole even then.
    pub fn watch(recorder: &Arc<Mutex<Option<Recorder>>>, quiet: bool) -> Interrupt {
        let asked = Arc::new(AtomicBool::new(false));
        // Weak: when the run panics its recorder must go with it.
        let (flag, recorder) = (Arc::clone(&asked), Arc::downgrade(recorder));
        #[cfg(unix)]
        {
            // A file that may not grow is then an error of the write, not the end of the process.
            let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
            if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
                let watching = move || {
                    if signals.forever().next().is_some() {
                        flag.store(true, Ordering::Relaxed);
                        let ended = Instant::now() + GRACE;
                        while Instant::now() < ended && signals.pending().next().is_none() {
                            std::thread::sleep(PAUSE);
                        }
                        end_now(&recorder, quiet);
                    }
                };
                // Without anybody who watches they end the process, too.
                if std::thread::Builder::new().spawn(watching).is_err() {
                    let always = Arc::new(AtomicBool::new(true));
                    for signal in [SIGINT, SIGTERM] {
                        let _ = signal_hook::flag::register_conditional_default(signal, Arc::clone(&always));
                    }
                }
            }
        }
        #[cfg(not(unix))]
        {
            let _ = (recorder, quiet, GRACE, PAUSE);
            for signal in [SIGINT, SIGTERM] {
                let exit = i32::from(INTERRUPTED);
                let _ = signal_hook::flag::register_conditional_shutdown(signal, exit, Arc::clone(&flag));
                let _ = signal_hook::flag::register(signal, Arc::clone(&flag));
            }
        }
        Interrupt { asked }
    }

    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }
}

/// Ends the process with all rows so far, unless the run is about to end by itself.
fn end_now(recorder: &Weak<Mutex<Option<Recorder>>>, quiet: bool) {
    let Some(recorder) = recorder.upgrade() else { return };
    let Some(recorder) = recorder.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
    let rows = recorder.partial_table();
    match recorder.interrupt(None) {
        Ok(manifest) if !quiet => say(&report::interrupted(&manifest, rows.as_deref())),
        Ok(_) => {}
        Err(error) => say(&format!("error: {error}")),
    }
    signal_hook::low_level::exit(i32::from(INTERRUPTED));
}
