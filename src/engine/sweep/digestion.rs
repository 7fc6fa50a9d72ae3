//! What becomes of outcomes: they are digested in portions of designs that follow each other. A crew digests the portions that begin and
//! end in its batch, whose outcomes its own processors have at hand; the ends of batches are joined to portions behind all crews.

use std::sync::mpsc::{Receiver, SyncSender};
use std::time::Duration;

use rayon::ThreadPool;
use rayon::prelude::*;

use super::{CountedDesigns, Digest, SolvedDesigns};
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::stopwatch::Stopwatch;
use crate::error::Error;

/// A batch that is solved, or why it could not be drawn.
pub(super) type Solved<T> = Result<Vec<Stretch<T>>, Error>;
pub(super) type Digested<T> = Result<Vec<Portion<T>>, Error>;

/// Designs of a batch that follow each other.
pub(super) enum Stretch<T> {
    Digested(Portion<T>),
    /// To be joined to what is before or behind them.
    Open(Vec<DesignOutcome>),
}

/// Designs that follow each other, digested.
pub(super) struct Portion<T> {
    pub(super) designs: u64,
    pub(super) steps: u64,
    pub(super) on_cpu: u64,
    pub(super) content: T,
}

impl<T: Send> Portion<T> {
    fn of(solved: SolvedDesigns, digest: &Digest<T>) -> Portion<T> {
        let SolvedDesigns { outcomes, on_device } = &solved;
        let [designs, steps] = on_device
            .as_ref()
            .map_or([0; 2], |CountedDesigns { counted, .. }| [counted.designs, counted.rows]);
        Portion {
            designs: designs + outcomes.len() as u64,
            steps: steps + outcomes.iter().map(|outcome| outcome.steps.len() as u64).sum::<u64>(),
            on_cpu: outcomes.iter().filter(|outcome| outcome.backend == BackendKind::Cpu).count() as u64,
            content: (digest.make)(solved),
        }
    }

    /// With what that has taken.
    fn timed(solved: SolvedDesigns, digest: &Digest<T>) -> (Portion<T>, Duration) {
        let started = Stopwatch::start();
        (Portion::of(solved, digest), started.elapsed())
    }
}

/// The portions of a batch, digested but for those at its ends that may go on in other batches; and what that has taken, summed over threads.
/// Where designs `are_consecutive`, the next batch begins with the next number.
pub(super) fn stretches<T: Send>(
    solved: SolvedDesigns,
    digest: &Digest<T>,
    are_consecutive: bool,
) -> (Vec<Stretch<T>>, Duration) {
    let digested = |(portion, time)| (Stretch::Digested(portion), time);
    if solved.on_device.is_some() {
        // What is counted cannot be cut.
        let (stretch, time) = digested(Portion::timed(solved, digest));
        return (vec![stretch], time);
    }
    let begins = |number: u64| number.is_multiple_of(digest.designs);
    let pieces = cut(solved.outcomes, digest.designs);
    let last = pieces.len().saturating_sub(1);
    let stretch = |(place, piece): (usize, Vec<DesignOutcome>)| {
        let [first, end] = [piece.first(), piece.last()].map(|own| own.map_or(1, |own| own.case.index));
        let is_whole = begins(first) && (place < last || (are_consecutive && begins(end + 1)));
        if is_whole {
            digested(Portion::timed(piece.into(), digest))
        } else {
            (Stretch::Open(piece), Duration::ZERO)
        }
    };
    let (stretches, times): (Vec<_>, Vec<Duration>) = pieces.into_par_iter().enumerate().map(stretch).unzip();
    (stretches, times.into_iter().sum())
}

/// Cuts outcomes before those whose numbers are multiples of `designs`.
fn cut(mut outcomes: Vec<DesignOutcome>, designs: u64) -> Vec<Vec<DesignOutcome>> {
    let is_cut = |place: &usize| outcomes[*place].case.index.is_multiple_of(designs);
    let cuts: Vec<usize> = (1..outcomes.len()).filter(is_cut).collect();
    let mut pieces: Vec<Vec<DesignOutcome>> =
        cuts.into_iter().rev().map(|place| outcomes.split_off(place)).collect();
    if !outcomes.is_empty() {
        pieces.push(outcomes);
    }
    pieces.reverse();
    pieces
}

/// Digests what crews have left, in turn, up to the first failure to draw; gives back how long that took, summed over threads.
pub(super) fn digest_all<T: Send>(
    digest: &Digest<T>,
    pool: &ThreadPool,
    solved: &[Receiver<Solved<T>>],
    digested: &SyncSender<Digested<T>>,
) -> Duration {
    let mut digestion = Digestion::new(digest, pool);
    for stretches in solved.iter().cycle().map_while(|crew| crew.recv().ok()) {
        // The receiver is gone when it has broken off.
        if digested.send(stretches.map(|stretches| digestion.add(stretches))).is_err() {
            return digestion.time;
        }
    }
    let _ = digested.send(Ok(digestion.end()));
    digestion.time
}

/// Joins outcomes to portions and digests these on all threads.
struct Digestion<'a, T> {
    digest: &'a Digest<'a, T>,
    pool: &'a ThreadPool,
    /// Outcomes that wait for the rest of their portions.
    waiting: Vec<DesignOutcome>,
    digested: Stopwatch,
    /// Summed over threads.
    time: Duration,
}

/// Whole portions wait for as many others as there are threads, but not longer than this.
const PATIENCE: Duration = Duration::from_secs(1);

/// Batches that take longer than this are slow.
const SLOW: Duration = Duration::from_millis(250);

impl<'a, T: Send> Digestion<'a, T> {
    fn new(digest: &'a Digest<'a, T>, pool: &'a ThreadPool) -> Digestion<'a, T> {
        Digestion { digest, pool, waiting: Vec::new(), digested: Stopwatch::start(), time: Duration::ZERO }
    }

    /// Of whole portions, with those that waited.
    fn add(&mut self, stretches: Vec<Stretch<T>>) -> Vec<Portion<T>> {
        let mut portions = Vec::with_capacity(stretches.len());
        for stretch in stretches {
            match stretch {
                Stretch::Open(outcomes) if self.waiting.is_empty() => self.waiting = outcomes,
                Stretch::Open(mut outcomes) => self.waiting.append(&mut outcomes),
                Stretch::Digested(portion) => {
                    portions.append(&mut self.end());
                    portions.push(portion);
                }
            }
        }
        let (Some(first), Some(last)) = (self.waiting.first(), self.waiting.last()) else {
            return portions;
        };
        let whole = |number: u64| number / self.digest.designs;
        let count = whole(last.case.index + 1) - whole(first.case.index);
        let enough = self.pool.current_num_threads() as u64;
        if count == 0 || (count < enough && self.digested.elapsed() < PATIENCE) {
            return portions;
        }
        let end = whole(last.case.index + 1) * self.digest.designs;
        let rest = self.waiting.partition_point(|outcome| outcome.case.index < end);
        let rest = self.waiting.split_off(rest);
        let ready = std::mem::replace(&mut self.waiting, rest);
        portions.append(&mut self.digest(ready));
        portions
    }

    /// Of what still waits.
    fn end(&mut self) -> Vec<Portion<T>> {
        let rest = std::mem::take(&mut self.waiting);
        self.digest(rest)
    }

    fn digest(&mut self, outcomes: Vec<DesignOutcome>) -> Vec<Portion<T>> {
        let pieces = cut(outcomes, self.digest.designs);
        let digest = |outcomes: Vec<DesignOutcome>| Portion::timed(outcomes.into(), self.digest);
        // Where batches take long, all threads are at the next one for long: what is there is not to wait for it.
        let digested: Vec<_> = if pieces.len() < 2 || self.digested.elapsed() > SLOW {
            pieces.into_iter().map(digest).collect()
        } else {
            self.pool.install(|| pieces.into_par_iter().map(digest).collect())
        };
        self.digested = Stopwatch::start();
        let (portions, times): (Vec<_>, Vec<Duration>) = digested.into_iter().unzip();
        self.time += times.into_iter().sum::<Duration>();
        portions
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::engine::outcome::Answer;
    use crate::engine::threads::pool;
    use crate::study::config::Study;

    /// However designs are cut into batches, portions end before multiples and nowhere else but at the end; those that a batch has whole are
    /// digested with it.
    #[test]
    fn portions_end_before_multiples() {
        let config = include_str!("../../../configs/random.toml");
        let study = Study::from_text(Path::new("random.toml"), config.to_string()).unwrap();
        let pool = pool(2).unwrap();
        let make = |solved: SolvedDesigns| -> Vec<u64> {
            solved.outcomes.iter().map(|outcome| outcome.case.index).collect()
        };
        let digest = Digest { designs: 100, make: &make };
        for (step, are_consecutive) in [(1, true), (2, false)] {
            for ends in [vec![730], vec![30, 100, 400, 730], vec![64, 65, 310, 311, 420, 730]] {
                let mut cases = study.cases().unwrap().step_by(step).map(Result::unwrap);
                let mut digestion = Digestion::new(&digest, &pool);
                let (mut portions, mut in_batches, mut begin) = (Vec::new(), 0, 0);
                for end in ends {
                    let own = cases.by_ref().take((end - begin) / step);
                    let none = || Answer { backend: BackendKind::Cpu, steps: Vec::new() };
                    let outcomes: Vec<_> = own.map(|case| DesignOutcome::new(case, none())).collect();
                    let (stretches, _) = stretches(outcomes.into(), &digest, are_consecutive);
                    let is_digested = |stretch: &&Stretch<_>| matches!(stretch, Stretch::Digested(_));
                    in_batches += stretches.iter().filter(is_digested).count();
                    portions.extend(digestion.add(stretches));
                    begin = end - (end - begin) % step;
                }
                portions.extend(digestion.end());
                let found: Vec<Vec<u64>> = portions.into_iter().map(|portion| portion.content).collect();
                let all: Vec<u64> = (0..begin as u64).step_by(step).collect();
                let expected: Vec<Vec<u64>> =
                    all.chunk_by(|a, b| a / 100 == b / 100).map(<[u64]>::to_vec).collect();
                assert_eq!(found, expected, "{step}");
                assert!(in_batches >= 3, "{in_batches} of {}", found.len());
            }
        }
    }
}
