//! Ladders side by side. What one thread of a ladder does alone (finding topologies, keeping what is solved, giving a device its work) is
//! little of its work, but on many threads most of its time. So a few threads each are a crew with a ladder of its own. Batches go to the
//! crews in turn, and come back in that order:
//!
//! ```text
//!   drawn    0 1 2 3 4 5 6 7
//!   crew 0   0     3     6       the first batch with all threads, before the others begin: it makes spaces, fits and kernels,
//!   crew 1     1     4     7     and tells what rows are among the extreme ones
//!   crew 2       2     5
//! ```

use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::Duration;

use rayon::ThreadPool;
use rayon::prelude::*;

use super::digestion::{Solved, stretches};
use super::{CountedDesigns, Digest, SolvedDesigns, Statistics, SweepOptions};
use crate::engine::backend::precision::Precision;
use crate::engine::drawing::{Batch, Chosen, Drawn, FIRST_BATCH};
use crate::engine::interpolation::drawn_on_device::Drawing;
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::ladder::Ladder;
use crate::engine::ladder::counting::{Counting, drawn_here};
use crate::engine::law_fit::add_laws;
use crate::engine::outcome::{Answer, DesignOutcome};
use crate::engine::question::counted::Verdict;
use crate::engine::threads::{joined, pool, spawned};
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// Threads of a crew: on sixteen, crews of four take longer at 1 %, and crews of one at 0.1 % (docs/performance.md).
const CREW: usize = 2;

/// Batches of a crew at least, so that none is done long before the others, unless they would be smaller than this.
const ROUNDS: u64 = 4;
const FEWEST: u64 = 512;

/// The threads of each crew; of one crew those of the sweep.
pub(super) struct Crews {
    pools: Vec<ThreadPool>,
}

impl Crews {
    /// So many threads in crews.
    pub(super) fn new(threads: usize) -> Result<Crews, Error> {
        let count = threads / CREW;
        if count < 2 {
            return Ok(Crews { pools: Vec::new() });
        }
        let threads_before = |crew: usize| crew * threads / count;
        let pools = (0..count).map(|crew| pool(threads_before(crew + 1) - threads_before(crew)));
        Ok(Crews { pools: pools.collect::<Result<_, _>>()? })
    }

    pub(super) fn count(&self) -> usize {
        self.pools.len().max(1)
    }

    /// Designs of a batch, of so many in all: at most this many.
    pub(super) fn batch_size(&self, most: usize, designs: u64) -> usize {
        let in_rounds = designs.div_ceil(ROUNDS * self.count() as u64).max(FEWEST);
        if self.pools.is_empty() { most } else { most.min(in_rounds.next_multiple_of(FEWEST) as usize) }
    }

    /// Solves what is drawn for each crew; tells what they did, and how long they digested.
    pub(super) fn solve_all<T: Send>(
        &self,
        study: &Study,
        options: &SweepOptions,
        (plan, drawing): (Option<InterpolationPlan>, Option<&Drawing>),
        digest: &Digest<T>,
        all: &ThreadPool,
        of_crews: Vec<(Receiver<Drawn>, SyncSender<Solved<T>>)>,
    ) -> Result<(Statistics, Duration), Error> {
        let fallback = OnceLock::new();
        let mut of_crews = of_crews.into_iter();
        let Some((drawn, solved)) = of_crews.next() else { return Ok(Default::default()) };
        // Without fits there is little to learn for the others, and kernels take their time to be made.
        let is_apart = usize::from(plan.is_some() || options.gpu.is_none());
        let lead = Crew::new(study, (options, self.count()), (plan, drawing), digest, &fallback);
        let lead = lead.solve_some(drawn.iter().take(is_apart), all, &solved);
        let twins: Vec<Crew<T>> = (0..of_crews.len()).map(|_| lead.twin()).collect();
        let mut pools = self.pools.iter();
        let own = pools.next().unwrap_or(all);
        let crews = std::thread::scope(|scope| -> Result<Vec<Crew<T>>, Error> {
            let mut others = Vec::with_capacity(twins.len());
            for ((twin, (drawn, solved)), pool) in twins.into_iter().zip(of_crews).zip(pools) {
                others.push(spawned(scope, move || twin.solve_rest(drawn, pool, solved))?);
            }
            let lead = lead.solve_rest(drawn, own, solved);
            Ok(std::iter::once(lead).chain(others.into_iter().map(joined)).collect())
        })?;
        let mut statistics = Statistics::default();
        crews.iter().for_each(|crew| crew.add_to(&mut statistics));
        statistics.fallback = fallback.get().cloned();
        Ok((statistics, crews.iter().map(|crew| crew.digestion).sum()))
    }
}

/// What has become of a batch.
enum Begun {
    Counting(Counting),
    /// The processor has to solve them.
    Cases(Vec<DesignCase>),
}

/// A ladder on its way through its batches.
struct Crew<'a, T> {
    study: &'a Study,
    /// By which a device draws.
    drawing: Option<&'a Drawing>,
    ladder: Ladder<'a>,
    digest: &'a Digest<'a, T>,
    /// How long that has taken, summed over threads.
    digestion: Duration,
    options: &'a SweepOptions<'a>,
    /// It is one of so many.
    crew_count: usize,
    fits_laws: bool,
    /// Designs whose rows a device counts while the processor makes the numbers of those behind them.
    begun: Option<Counting>,
    /// Whether any row was seen yet that others are compared with.
    knows_limits: bool,
    /// Why the device was given up, of whichever crew was the first to do so.
    fallback: &'a OnceLock<String>,
}

impl<'a, T: Send> Crew<'a, T> {
    fn new(
        study: &'a Study,
        (options, crew_count): (&'a SweepOptions<'a>, usize),
        (plan, drawing): (Option<InterpolationPlan>, Option<&'a Drawing>),
        digest: &'a Digest<'a, T>,
        fallback: &'a OnceLock<String>,
    ) -> Crew<'a, T> {
        let in_double = options.in_double || options.gpu.is_some_and(|gpu| gpu.precision != Precision::F32);
        let mut ladder = Ladder::new(study.solve).sharing(study.in_common());
        if in_double {
            ladder = ladder.in_double();
        }
        Crew {
            study,
            drawing,
            ladder: ladder.interpolating(plan).asked_by(options.asker),
            digest,
            digestion: Duration::ZERO,
            options,
            crew_count,
            fits_laws: study.fits_laws(),
            begun: None,
            knows_limits: false,
            fallback,
        }
    }

    /// Another one, which knows what this one has learnt.
    fn twin(&self) -> Crew<'a, T> {
        let (ladder, digestion) = (self.ladder.twin(), Duration::ZERO);
        Crew { ladder, digestion, begun: None, ..*self }
    }

    /// With the device, if there is one and no crew has lost it.
    fn equipped(self) -> Crew<'a, T> {
        if self.ladder.library.device().is_some() || self.fallback.get().is_some() {
            return self;
        }
        match self.options.gpu.map(|gpu| gpu.condenser()) {
            None => self,
            Some(Ok(condenser)) => {
                let condenser = condenser.sharing(self.crew_count);
                Crew { ladder: self.ladder.on(Box::new(condenser)), ..self }
            }
            Some(Err(error)) => {
                self.give_up(&error.to_string());
                self
            }
        }
    }

    /// Some batches, behind which others come.
    fn solve_some(
        mut self,
        drawn: impl Iterator<Item = Drawn>,
        pool: &ThreadPool,
        solved: &SyncSender<Solved<T>>,
    ) -> Crew<'a, T> {
        for batch in drawn {
            self = self.equipped();
            if !self.hand_over(Some(batch), pool, solved) {
                break;
            }
        }
        self
    }

    /// The last ones.
    fn solve_rest(
        self,
        drawn: Receiver<Drawn>,
        pool: &ThreadPool,
        solved: SyncSender<Solved<T>>,
    ) -> Crew<'a, T> {
        let mut crew = self.solve_some(drawn.iter(), pool, &solved);
        crew.hand_over(None, pool, &solved);
        crew
    }

    /// Solves a batch and what was begun before it; false where nobody takes it any more.
    fn hand_over(&mut self, batch: Option<Drawn>, pool: &ThreadPool, solved: &SyncSender<Solved<T>>) -> bool {
        let ready = pool.install(|| self.digested(batch));
        if let Some(error) = self.ladder.library.lost() {
            self.give_up(&error.to_string());
        }
        // Who digests is gone when the receiver has broken off.
        ready.into_iter().all(|designs| solved.send(designs).is_ok())
    }

    /// What comes of a batch, with the portions digested that it has from beginning to end.
    fn digested(&mut self, batch: Option<Drawn>) -> Vec<Solved<T>> {
        let solved = self.solve(batch);
        let are_consecutive = !matches!(self.options.designs, Chosen::Listed(_));
        let mut digest = |solved| {
            let (stretches, time) = stretches(solved, self.digest, are_consecutive);
            self.digestion += time;
            stretches
        };
        solved.into_iter().map(|solved| solved.map(&mut digest)).collect()
    }

    /// A batch that a device counts comes back when the next one is begun.
    fn solve(&mut self, batch: Option<Drawn>) -> Vec<Result<SolvedDesigns, Error>> {
        let next = batch.map(|batch| batch.and_then(|batch| self.begin(batch)));
        let before = self.begun.take();
        let mut ready: Vec<_> = before.into_iter().filter_map(|before| self.left(before)).collect();
        match next {
            None => {}
            Some(Err(error)) => ready.push(Err(error)),
            Some(Ok(Begun::Counting(counting))) if self.knows_limits => self.begun = Some(counting),
            Some(Ok(Begun::Counting(counting))) => {
                // Without any limit every row might be an extreme one.
                ready.extend(self.left(counting));
                self.knows_limits = true;
            }
            Some(Ok(Begun::Cases(cases))) => {
                let answers = self.ladder.answers(&cases);
                let mut outcomes = outcomes(cases, answers);
                if self.fits_laws {
                    add_laws(&mut self.ladder, &mut outcomes);
                }
                ready.push(Ok(outcomes.into()));
            }
        }
        ready
    }

    /// Has a device count the rows of designs, if it can.
    fn begin(&mut self, batch: Batch) -> Result<Begun, Error> {
        let Crew { study, drawing, ladder, .. } = self;
        let cases = match batch {
            Batch::Cases(cases) => cases,
            Batch::Numbers(numbers) => {
                let counting = drawing.and_then(|drawing| ladder.begin_drawn(drawing, numbers.clone()));
                if let Some(counting) = counting {
                    return Ok(Begun::Counting(counting));
                }
                drawn_here(study, &numbers.collect::<Vec<_>>())?
            }
        };
        Ok(match ladder.begin_count(cases) {
            Ok(counting) => Begun::Counting(counting),
            Err(cases) => Begun::Cases(cases),
        })
    }

    /// Waits for what a device counts, and solves those designs that it has left, or that may have an extreme row.
    fn left(&mut self, counting: Counting) -> Option<Result<SolvedDesigns, Error>> {
        let Crew { study, ladder, options: SweepOptions { asker, .. }, .. } = self;
        let (counted, left) = match ladder.finish_count(study, counting)? {
            Ok(finished) => finished,
            Err(error) => return Some(Err(error)),
        };
        let (cases, verdicts): (Vec<DesignCase>, Vec<Verdict>) = left.into_iter().unzip();
        let answers = ladder.answers_beyond(&cases, |place| verdicts[place].want());
        let mut solved = outcomes(cases, answers);
        (*asker)?.look(&mut solved);
        let (mut outcomes, mut candidates) = (Vec::new(), Vec::new());
        for (outcome, verdict) in solved.into_iter().zip(verdicts) {
            match verdict {
                Verdict::Candidate => candidates.push(outcome),
                _ => outcomes.push(outcome),
            }
        }
        Some(Ok(SolvedDesigns { outcomes, on_device: Some(CountedDesigns { counted, candidates }) }))
    }

    /// Says that the processor goes on alone, once for all crews.
    fn give_up(&self, problem: &str) {
        if self.fallback.set(problem.to_string()).is_ok()
            && let Some(notify) = self.options.notify
        {
            notify(&format!("warning: {problem}; the processor goes on alone"));
        }
    }

    /// What it has done, to that of others.
    fn add_to(&self, Statistics { stages, solves, asked, worst_residual, .. }: &mut Statistics) {
        for (name, time) in self.ladder.stages() {
            match stages.iter_mut().find(|(known, _)| *known == name) {
                Some((_, all)) => *all += time,
                None => stages.push((name, time)),
            }
        }
        if let Some(device) = self.ladder.library.device() {
            *solves += device.solves();
            *asked = asked.and(device.counts());
            // Nothing where all was eliminated.
            let residual = device.worst_residual().max(worst_residual.unwrap_or(0.0));
            *worst_residual = (residual > 0.0).then_some(residual);
        }
    }
}

/// Of designs with their answers.
fn outcomes(cases: Vec<DesignCase>, answers: Vec<Answer>) -> Vec<DesignOutcome> {
    let cases = cases.into_par_iter().with_min_len(FIRST_BATCH).zip(answers);
    cases.map(|(case, answer)| DesignOutcome::new(case, answer)).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Designs that no device draws are those of their numbers, in order.
    #[test]
    fn what_no_device_draws_is_drawn_by_numbers() {
        let config = include_str!("../../../configs/random.toml");
        let study = Study::from_text(Path::new("random.toml"), config.to_string()).unwrap();
        let numbers: Vec<u64> = (70..333).chain([400, 9999]).collect();
        let cases = drawn_here(&study, &numbers).unwrap();
        assert!(cases.iter().map(|case| case.index).eq(numbers));
    }

    /// All threads are in crews, and all crews have batches.
    #[test]
    fn crews_have_all_threads_and_designs_enough() {
        for (threads, count) in [(1, 1), (2, 1), (3, 1), (4, 2), (9, 4)] {
            let crews = Crews::new(threads).unwrap();
            let in_crews: usize = crews.pools.iter().map(ThreadPool::current_num_threads).sum();
            assert_eq!((crews.count(), if count == 1 { threads } else { in_crews }), (count, threads));
        }
        let [one, four] = [2, 8].map(|threads| Crews::new(threads).unwrap());
        let sizes = |crews: &Crews| [100, 10_000, 1_000_000].map(|designs| crews.batch_size(2048, designs));
        assert_eq!((sizes(&one), sizes(&four)), ([2048; 3], [512, 1024, 2048]));
    }
}
