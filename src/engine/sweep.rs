//! Designs x plan x backend -> outcomes in design order.

use std::collections::{BTreeMap, HashSet};
use std::hash::{BuildHasher, RandomState};
use std::ops::ControlFlow;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

use crate::engine::backend::cpu::CpuBackend;
use crate::engine::outcome::DesignOutcome;
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// What a sweep did, for the summary and the manifest.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    pub designs: u64,
    pub steps: u64,
    pub distinct_bodies: u64,
    /// Steps by status.
    pub statuses: BTreeMap<String, u64>,
    /// Wall time of each stage, in the order they run, summed over threads.
    pub stages: Vec<(&'static str, Duration)>,
    /// True when the receiver ended the sweep before its last design.
    pub interrupted: bool,
}

/// Hands every outcome to `receive`, in design order whatever the threads, until it breaks.
pub type Receive<'a> = &'a mut dyn FnMut(DesignOutcome) -> Result<ControlFlow<()>, Error>;

/// How a sweep is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepOptions {
    /// Threads that solve; 0 for one a processor.
    pub threads: usize,
}

/// Designs solved at a time: enough to fill the lanes of many topologies, few enough to stay small.
const BATCH: usize = 1024;

/// Designs of the first batch, so that a slow sweep shows its first rows soon.
const FIRST_BATCH: usize = 64;

/// Runs every design of `study` and hands the outcomes over one by one. One batch is solved while the one before is
/// received.
pub fn run(study: &Study, options: &SweepOptions, receive: Receive) -> Result<Statistics, Error> {
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Error::Threads { threads, problem: error.to_string() })?;
    let mut cases = study.cases()?;
    let total = study.design_count();
    let mut statistics = Statistics::default();
    let (solved_sender, solved) = sync_channel::<Result<Vec<DesignOutcome>, Error>>(1);
    std::thread::scope(|scope| {
        let solver = scope.spawn(move || {
            let mut backend = CpuBackend::new(study.solve);
            let mut distinct = Distinct::default();
            let mut size = FIRST_BATCH;
            loop {
                let batch: Result<Vec<DesignCase>, Error> = cases.by_ref().take(size).collect();
                size = BATCH;
                let solved = match batch {
                    Ok(batch) if batch.is_empty() => break,
                    Ok(batch) => {
                        batch.iter().for_each(|case| distinct.meet(case));
                        Ok(pool.install(|| backend.solve(batch)))
                    }
                    Err(error) => Err(error),
                };
                let failed = solved.is_err();
                // The receiver is gone when it has broken off.
                if solved_sender.send(solved).is_err() || failed {
                    break;
                }
            }
            (backend, distinct)
        });
        let mut received = Duration::ZERO;
        let result = receive_all(&solved, receive, &mut statistics, &mut received);
        drop(solved);
        statistics.interrupted &= statistics.designs < total;
        match solver.join() {
            Ok((backend, distinct)) => {
                let times = backend.library.times;
                statistics.distinct_bodies = distinct.hashes.len() as u64;
                statistics.stages = vec![
                    ("preparation", times.shared),
                    ("series", times.series),
                    ("condensation", times.condense),
                    ("contact", backend.contact_time),
                    ("table", received),
                ];
            }
            Err(panic) => std::panic::resume_unwind(panic),
        }
        result
    })?;
    Ok(statistics)
}

fn receive_all(
    solved: &std::sync::mpsc::Receiver<Result<Vec<DesignOutcome>, Error>>,
    receive: Receive,
    statistics: &mut Statistics,
    time: &mut Duration,
) -> Result<(), Error> {
    for batch in solved {
        let started = Instant::now();
        for outcome in batch? {
            statistics.designs += 1;
            statistics.steps += outcome.steps.len() as u64;
            for step in &outcome.steps {
                match statistics.statuses.get_mut(&step.status) {
                    Some(count) => *count += 1,
                    None => {
                        statistics.statuses.insert(step.status.clone(), 1);
                    }
                }
            }
            if receive(outcome)?.is_break() {
                statistics.interrupted = true;
                return Ok(());
            }
        }
        *time += started.elapsed();
    }
    Ok(())
}

/// Counts distinct bodies by hash: 8 bytes each.
#[derive(Default)]
struct Distinct {
    hasher: RandomState,
    hashes: HashSet<u64>,
}

impl Distinct {
    fn meet(&mut self, case: &DesignCase) {
        for part in [&case.joint.pin, &case.joint.plate] {
            self.hashes.insert(self.hasher.hash_one(case.joint.body(part).key()));
        }
    }
}
