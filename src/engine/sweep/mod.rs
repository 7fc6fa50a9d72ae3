//! Designs x plan x backend -> outcomes in design order.

mod digestion;
mod crews;

use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

use crews::Crews;
use digestion::{Digested, digest_all};

use crate::engine::backend::Counts;
use crate::engine::backend::choice::GpuChoice;
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::cost::DesignCost;
use crate::engine::drawing::{Chosen, Drawer, FIRST_BATCH};
use crate::engine::interpolation::drawn_on_device::Drawing;
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::outcome::DesignOutcome;
use crate::engine::question::Asker;
use crate::engine::question::counted::Counted;
use crate::engine::stopwatch::Stopwatch;
use crate::engine::threads::{joined, pool, spawned, take_and_free};
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
    /// What elimination and joints have asked of the GPU.
    pub asked: Counts,
    /// The greatest true residual that an outcome of the GPU rests on.
    pub worst_residual: Option<f64>,
    /// Why the GPU was given up, if it was.
    pub fallback: Option<String>,
    /// True when the receiver ended the sweep before its last design.
    pub interrupted: bool,
}

/// Takes what comes of a sweep, in design order whatever the threads, until it breaks.
pub type Receive<'a, T = DesignOutcome> = &'a mut dyn FnMut(T) -> Result<ControlFlow<()>, Error>;

/// What has become of designs that follow each other.
pub struct SolvedDesigns {
    /// Each with its answer; without those that a device has counted.
    pub outcomes: Vec<DesignOutcome>,
    pub on_device: Option<CountedDesigns>,
}

impl From<Vec<DesignOutcome>> for SolvedDesigns {
    fn from(outcomes: Vec<DesignOutcome>) -> SolvedDesigns {
        SolvedDesigns { outcomes, on_device: None }
    }
}

/// Designs whose rows a device has counted for who asks.
pub struct CountedDesigns {
    pub counted: Counted,
    /// Some of them, solved: they may have rows among the extreme ones.
    pub candidates: Vec<DesignOutcome>,
}

/// What the threads that solve also make of outcomes, so that whoever receives it has little left to do.
pub struct Digest<'a, T> {
    /// A portion ends before the designs whose numbers are multiples of this, and nowhere else but at the end.
    pub designs: u64,
    pub make: &'a (dyn Fn(SolvedDesigns) -> T + Sync),
}

/// How a sweep is run.
#[derive(Clone, Default)]
pub struct SweepOptions<'a> {
    /// Threads that solve; 0 for one a processor.
    pub threads: usize,
    /// The GPU that solves; without one the processor does.
    pub gpu: Option<GpuChoice<'a>>,
    /// Told at once, in one line, that the GPU was given up and why.
    pub notify: Option<&'a (dyn Fn(&str) + Sync)>,
    /// Who asks for nothing but what all rows come to: a GPU may count them.
    pub asker: Option<&'a dyn Asker>,
    /// Whether the processor condenses all bodies in double precision, those on coarse meshes, too: as it does beside a GPU that does.
    pub in_double: bool,
    pub designs: Chosen,
}

/// Designs of a batch on the processor: enough to fill the lanes of many topologies, few enough to stay small.
const BATCH: usize = 2048;

/// The same where bodies are interpolated: of the few that are not there are enough to fill lanes and threads.
const INTERPOLATED_BATCH: usize = 16_384;

/// The most rows of a batch: designs of many loads come in smaller ones.
const MOST_ROWS: u64 = 10 * INTERPOLATED_BATCH as u64;

/// A sweep whose whole batches take no longer than this by the forecast, s, begins with one: lanes are filled better.
const SOON: f64 = 0.25;

/// Bytes. Almost the greatest that the C library learns from: what lies free at the end of its memory goes back to the system where it is more than
/// twice as much, and batches of a sweep on a device free some 20 MB at a time.
const KEPT_BLOCK: usize = 31 << 20;

/// Lets the C library keep what is dropped for what is made next. It takes each block of more than 128 KiB from the system, with pages
/// that all must be cleared, and gives it back, until a greater one has been dropped (`M_MMAP_THRESHOLD`, mallopt(3)).
pub fn keep_blocks() {
    take_and_free(KEPT_BLOCK);
}

/// Runs designs of `study` and hands the outcomes over one by one.
pub fn run(study: &Study, options: &SweepOptions, receive: Receive) -> Result<Statistics, Error> {
    let (mut received, mut steps, mut is_broken) = (0, 0, false);
    let mut receive_all = |outcomes: Vec<DesignOutcome>| {
        for outcome in outcomes {
            received += 1;
            steps += outcome.steps.len() as u64;
            if receive(outcome)?.is_break() {
                is_broken = true;
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    };
    let digest = Digest { designs: FIRST_BATCH as u64, make: &|solved| solved.outcomes };
    let mut statistics = run_digested(study, options, &digest, &mut receive_all)?;
    (statistics.designs, statistics.steps) = (received, steps);
    statistics.interrupted = is_broken && received < options.designs.count(study);
    Ok(statistics)
}

/// Runs designs of `study`, digests the outcomes and hands the portions over one by one. While one batch is solved the next one is
/// drawn, the one before is digested and the one before that received.
pub fn run_digested<T: Send>(
    study: &Study,
    options: &SweepOptions,
    digest: &Digest<T>,
    receive: Receive<T>,
) -> Result<Statistics, Error> {
    keep_blocks();
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    let pool = pool(threads)?;
    let crews = Crews::new(threads)?;
    let count = options.designs.count(study);
    let mut statistics = Statistics::default();
    let (drawn_senders, drawn): (Vec<_>, Vec<_>) = (0..crews.count()).map(|_| sync_channel(1)).unzip();
    // Nothing waits for its digestion, so that few batches are there at a time.
    let (solved_senders, solved): (Vec<_>, Vec<_>) = (0..crews.count()).map(|_| sync_channel(0)).unzip();
    let (digested_sender, digested) = sync_channel(1);
    let plan = InterpolationPlan::of_study(study);
    let drawing = plan.as_ref().and_then(|_| drawing(study, options));
    // Each crew that has rows counted needs some to compare others with. Of fits the first batch is the lead's alone.
    let solves_all = options.gpu.is_some_and(|gpu| gpu.joints == SolvedJoints::All);
    let counts_on_meshes = solves_all && options.asker.is_some() && plan.is_none();
    let small = if counts_on_meshes { crews.count() } else { 1 };
    let drawer = Drawer::new(study, &options.designs, threads)?;
    let mut drawer = drawer.on_device(drawing.is_some()).with_small(small);
    let on_processor = if plan.is_some() { INTERPOLATED_BATCH } else { BATCH };
    let most = options.gpu.map_or(on_processor, |gpu| match &drawing {
        Some(_) => gpu.drawn_batch_size(),
        None => gpu.batch_size(plan.is_some()),
    });
    let batch_size = crews.batch_size(most, count).min(designs_of_rows(study.steps_per_design()));
    std::thread::scope(|scope| {
        let cost = DesignCost::without_interpolation(study);
        let is_soon = move |first: &[DesignCase]| {
            let looked_at = first.iter().step_by(FIRST_BATCH / 4);
            let seconds: f64 = looked_at.map(|case| cost.seconds(case)).sum();
            options.gpu.is_none() && seconds / 4.0 * batch_size as f64 <= SOON * threads as f64
        };
        let mut places = (0..crews.count()).cycle();
        let hand_over =
            move |batch| places.next().is_some_and(|crew| drawn_senders[crew].send(batch).is_ok());
        let drawer = spawned(scope, move || drawer.draw_all(batch_size, is_soon, hand_over))?;
        let (pool, crews) = (&pool, &crews);
        let of_crews = drawn.into_iter().zip(solved_senders).collect();
        let plan = (plan, drawing.as_ref());
        let solver = spawned(scope, move || crews.solve_all(study, options, plan, digest, pool, of_crews))?;
        let digester = spawned(scope, move || digest_all(digest, pool, &solved, &digested_sender))?;
        let mut received = Duration::ZERO;
        let result = receive_all(&digested, receive, &mut statistics, &mut received);
        // Those who still send to nobody end.
        drop(digested);
        let digestion = joined(digester);
        let solved = joined(solver);
        let distinct_bodies = joined(drawer);
        statistics.interrupted &= statistics.designs < count;
        if options.gpu.is_none() {
            statistics.designs_on_cpu = 0;
        }
        result?;
        let (Statistics { solves, asked, worst_residual, fallback, mut stages, .. }, of_crews) = solved?;
        stages.extend([("table", digestion + of_crews), ("writing", received)]);
        Ok(Statistics { distinct_bodies, solves, asked, worst_residual, fallback, stages, ..statistics })
    })
}

/// By which a device draws designs whose rows it is asked to count; `None` where none does.
fn drawing(study: &Study, options: &SweepOptions) -> Option<Drawing> {
    let (gpu, asker) = (options.gpu?, options.asker?);
    let follow_each_other = !matches!(options.designs, Chosen::Listed(_));
    (gpu.draws() && follow_each_other).then(|| Drawing::of(study, asker.question()))?
}

/// The most designs of a batch whose designs have so many rows each.
fn designs_of_rows(rows: u64) -> usize {
    (MOST_ROWS / rows.max(1)).max(1) as usize
}

fn receive_all<T>(
    digested: &Receiver<Digested<T>>,
    receive: Receive<T>,
    statistics: &mut Statistics,
    time: &mut Duration,
) -> Result<(), Error> {
    for portions in digested {
        let started = Stopwatch::start();
        for portion in portions? {
            statistics.designs += portion.designs;
            statistics.steps += portion.steps;
            statistics.designs_on_cpu += portion.on_cpu;
            if receive(portion.content)?.is_break() {
                statistics.interrupted = true;
                return Ok(());
            }
        }
        *time += started.elapsed();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten loads leave batches as they are; a hundred thousand do not make one of a thousand designs.
    #[test]
    fn designs_of_many_loads_come_in_small_batches() {
        assert_eq!([0, 1, 10].map(designs_of_rows).into_iter().min(), Some(INTERPOLATED_BATCH));
        assert_eq!([1_000, 100_000, u64::MAX].map(designs_of_rows), [163, 1, 1]);
    }
}
