//! Designs x plan x backend -> outcomes in design order.

use std::hash::BuildHasher;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use foldhash::HashSet;
use foldhash::fast::RandomState;

use crate::engine::backend::gpu::solver::{GpuChoice, GpuCondenser};
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::ladder::Ladder;
use crate::engine::law_fit::add_laws;
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// What a sweep did, for the summary and the manifest.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    pub designs: u64,
    pub steps: u64,
    pub distinct_bodies: u64,
    /// Wall time of each stage, in the order they run, summed over threads.
    pub stages: Vec<(&'static str, Duration)>,
    /// Designs that the processor solved, of those given to a GPU.
    pub designs_on_cpu: u64,
    /// Columns of rings that the GPU solved for by conjugate gradients.
    pub solves: u64,
    /// The greatest true residual that an outcome of the GPU rests on.
    pub worst_residual: Option<f64>,
    /// Why the GPU was given up, if it was.
    pub fallback: Option<String>,
    /// True when the receiver ended the sweep before its last design.
    pub interrupted: bool,
}

/// Hands every outcome to `receive`, in design order whatever the threads, until it breaks.
pub type Receive<'a> = &'a mut dyn FnMut(DesignOutcome) -> Result<ControlFlow<()>, Error>;

/// How a sweep is run.
#[derive(Clone, Copy, Default)]
pub struct SweepOptions<'a> {
    /// Threads that solve; 0 for one a processor.
    pub threads: usize,
    /// The GPU that solves; without one the processor does.
    pub gpu: Option<GpuChoice<'a>>,
    /// Told at once, in one line, that the GPU was given up and why.
    pub notify: Option<&'a (dyn Fn(&str) + Sync)>,
}

/// Designs of a batch on the processor: enough to fill the lanes of many topologies, few enough to stay small.
const BATCH: usize = 1024;

/// Designs of the first batch, so that a slow sweep shows its first rows soon.
const FIRST_BATCH: usize = 64;

/// Runs every design of `study` and hands the outcomes over one by one. While one batch is solved the next one is drawn
/// and the one before is received.
pub fn run(study: &Study, options: &SweepOptions, receive: Receive) -> Result<Statistics, Error> {
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Error::Threads { threads, problem: error.to_string() })?;
    let cases = study.cases()?;
    let mut statistics = Statistics::default();
    let (drawn_sender, drawn) = sync_channel(1);
    let (solved_sender, solved) = sync_channel(1);
    let batch_size = options.gpu.map_or(BATCH, |gpu| gpu.batch_size());
    std::thread::scope(|scope| {
        let drawer = scope.spawn(move || draw_all(cases, batch_size, &drawn_sender));
        let solver = scope.spawn(move || solve_all(study, options, &pool, &drawn, &solved_sender));
        let mut received = Duration::ZERO;
        let result = receive_all(&solved, receive, &mut statistics, &mut received);
        // Those who still send to nobody end.
        drop(solved);
        let solution = joined(solver);
        let distinct = joined(drawer);
        statistics.interrupted &= statistics.designs < study.design_count();
        statistics.distinct_bodies = distinct.hashes.len() as u64;
        if options.gpu.is_none() {
            statistics.designs_on_cpu = 0;
        }
        statistics.solves = solution.solves;
        statistics.worst_residual = solution.worst_residual;
        statistics.fallback = solution.fallback;
        statistics.stages = solution.stages;
        statistics.stages.push(("table", received));
        result
    })?;
    Ok(statistics)
}

/// A panic of one thread is one of all.
fn joined<T>(thread: ScopedJoinHandle<T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

type Drawn = Result<Vec<DesignCase>, Error>;
type Solved = Result<Vec<DesignOutcome>, Error>;

/// Draws the designs in batches, up to the first that cannot be read.
fn draw_all(
    mut cases: impl Iterator<Item = Result<DesignCase, Error>>,
    batch_size: usize,
    drawn: &SyncSender<Drawn>,
) -> Distinct {
    let mut distinct = Distinct::default();
    let mut size = FIRST_BATCH;
    loop {
        let batch: Drawn = cases.by_ref().take(size).collect();
        size = batch_size;
        let is_last = match &batch {
            Ok(batch) if batch.is_empty() => break,
            Ok(batch) => {
                batch.iter().for_each(|case| distinct.meet(case));
                false
            }
            Err(_) => true,
        };
        // The solver is gone when the receiver has broken off.
        if drawn.send(batch).is_err() || is_last {
            break;
        }
    }
    distinct
}

/// What is left of the solver at the end.
struct Solution {
    stages: Vec<(&'static str, Duration)>,
    worst_residual: Option<f64>,
    solves: u64,
    fallback: Option<String>,
}

fn solve_all(
    study: &Study,
    options: &SweepOptions,
    pool: &rayon::ThreadPool,
    drawn: &Receiver<Drawn>,
    solved: &SyncSender<Solved>,
) -> Solution {
    let mut fallback = None;
    let ladder = Ladder::new(study.solve).interpolating(InterpolationPlan::of_study(study));
    let mut ladder = match options.gpu.map(GpuCondenser::new) {
        None => ladder,
        Some(Ok(condenser)) => ladder.on(Box::new(condenser)),
        Some(Err(error)) => {
            fallback = given_up(options, &error.to_string());
            ladder
        }
    };
    for batch in drawn {
        let outcomes = batch.map(|batch| {
            let answers = pool.install(|| ladder.answers(&batch));
            let outcomes = batch.into_iter().zip(answers);
            let mut outcomes: Vec<_> =
                outcomes.map(|(case, answer)| DesignOutcome::new(case, answer)).collect();
            if study.fits_laws() {
                pool.install(|| add_laws(&mut ladder, &mut outcomes));
            }
            outcomes
        });
        if let Some(error) = ladder.library.lost().filter(|_| fallback.is_none()) {
            fallback = given_up(options, &error.to_string());
        }
        // The receiver is gone when it has broken off.
        if solved.send(outcomes).is_err() {
            break;
        }
    }
    let device = ladder.library.device();
    Solution {
        stages: ladder.stages(),
        worst_residual: device.map(|device| device.worst_residual()),
        solves: device.map_or(0, |device| device.solves()),
        fallback,
    }
}

/// Says that the processor goes on alone.
fn given_up(options: &SweepOptions, problem: &str) -> Option<String> {
    if let Some(notify) = options.notify {
        notify(&format!("warning: {problem}; the processor goes on alone"));
    }
    Some(problem.to_string())
}

fn receive_all(
    solved: &Receiver<Solved>,
    receive: Receive,
    statistics: &mut Statistics,
    time: &mut Duration,
) -> Result<(), Error> {
    for batch in solved {
        let started = Instant::now();
        for outcome in batch? {
            statistics.designs += 1;
            statistics.steps += outcome.steps.len() as u64;
            statistics.designs_on_cpu += u64::from(outcome.backend == BackendKind::Cpu);
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
