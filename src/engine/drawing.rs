//! The designs of a sweep, drawn in batches ahead of those who solve them.

use std::ops::Range;
use std::thread::ScopedJoinHandle;

use crate::engine::distinct::Distinct;
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// The designs to solve, by their numbers.
#[derive(Clone, Debug, Default)]
pub enum Chosen {
    #[default]
    All,
    Range(Range<u64>),
    /// In their order, none twice.
    Listed(Vec<u64>),
}

/// A batch of designs, or why it cannot be read.
pub type Drawn = Result<Vec<DesignCase>, Error>;

type Cases<'a> = Box<dyn Iterator<Item = Result<DesignCase, Error>> + Send + 'a>;

impl Chosen {
    pub fn count(&self, study: &Study) -> u64 {
        match self {
            Chosen::All => study.design_count(),
            Chosen::Range(range) => range.end.min(study.design_count()).saturating_sub(range.start),
            Chosen::Listed(numbers) => numbers.len() as u64,
        }
    }

    /// Some of them, counted from the first that is chosen.
    fn cases<'a>(&'a self, study: &'a Study, Range { start, end }: Range<u64>) -> Result<Cases<'a>, Error> {
        let own = |first: u64| -> Result<Cases<'a>, Error> {
            Ok(Box::new(study.cases()?.skip((first + start) as usize).take((end - start) as usize)))
        };
        match self {
            Chosen::All => own(0),
            Chosen::Range(range) => own(range.start),
            Chosen::Listed(numbers) => {
                let numbers = &numbers[start as usize..end as usize];
                Ok(Box::new(study.cases_at(numbers.iter().copied())?))
            }
        }
    }
}

/// Designs of the first batch, so that a slow sweep shows its first rows soon.
pub const FIRST_BATCH: usize = 64;

/// Threads that solve to one that draws: interpolated designs, the quickest, take four times as long to solve as to draw.
const SOLVING: usize = 4;

/// Designs that a thread draws at a time, at least.
const FEWEST: usize = 1024;

/// Draws designs, and finds out how many of their bodies are different.
pub struct Drawer<'a> {
    study: &'a Study,
    chosen: &'a Chosen,
    left: Range<u64>,
    /// Those that are left, where they come one after another: a list of designs.
    listed: Option<Cases<'a>>,
    /// Of each thread.
    bodies: Vec<Distinct>,
}

impl<'a> Drawer<'a> {
    /// For so many threads that solve.
    pub fn new(study: &'a Study, chosen: &'a Chosen, threads: usize) -> Result<Drawer<'a>, Error> {
        let left = 0..chosen.count(study);
        let is_listed = study.designs_file().is_some();
        let listed = is_listed.then(|| chosen.cases(study, left.clone())).transpose()?;
        let hands = if is_listed { 1 } else { (threads / SOLVING).max(1) };
        let bodies = (0..hands).map(|_| Distinct::default()).collect();
        Ok(Drawer { study, chosen, left, listed, bodies })
    }

    /// Draws all in batches, up to the first that cannot be read or that nobody takes; tells how many different bodies there were. The first batch is a small one,
    /// unless a whole one `is_soon` solved.
    pub fn draw_all(
        &mut self,
        batch_size: usize,
        is_soon: impl Fn(&[DesignCase]) -> bool,
        mut hand_over: impl FnMut(Drawn) -> bool,
    ) -> u64 {
        let mut first = self.draw(FIRST_BATCH.min(batch_size));
        if let Ok(designs) = &mut first
            && is_soon(designs)
        {
            match self.draw(batch_size.saturating_sub(FIRST_BATCH)) {
                Ok(more) => designs.extend(more),
                Err(error) => first = Err(error),
            }
        }
        let mut batch = first;
        loop {
            let is_last = batch.as_ref().is_ok_and(Vec::is_empty);
            let is_broken = batch.is_err();
            if is_last || !hand_over(batch) || is_broken {
                break;
            }
            // Up to a multiple of its size: what is made of numbered portions finds whole ones in it.
            let size = batch_size as u64;
            batch = self.draw((size - (self.first_number() + self.left.start) % size) as usize);
        }
        let mut bodies = std::mem::take(&mut self.bodies).into_iter();
        let mut all = bodies.next().unwrap_or_default();
        bodies.for_each(|own| all.merge(own));
        all.count()
    }

    /// Of the first design that is chosen.
    fn first_number(&self) -> u64 {
        match self.chosen {
            Chosen::Range(range) => range.start,
            Chosen::All | Chosen::Listed(_) => 0,
        }
    }

    /// As many as are asked for, if there are.
    fn draw(&mut self, count: usize) -> Drawn {
        let Range { start, end } = self.left;
        let next = end.min(start + count as u64);
        self.left.start = next;
        let (study, chosen, bodies) = (self.study, self.chosen, &mut self.bodies);
        if let Some(cases) = &mut self.listed {
            return met(cases.take(count), &mut bodies[0]);
        }
        let each = (next - start).div_ceil(bodies.len() as u64).max(FEWEST as u64);
        let piece = |place: u64| (start + place * each).min(next)..(start + (place + 1) * each).min(next);
        if piece(0).end == next {
            return met(chosen.cases(study, piece(0))?, &mut bodies[0]);
        }
        let pieces: Vec<Drawn> = std::thread::scope(|scope| {
            let mut hands = Vec::with_capacity(bodies.len());
            for (place, own) in (0..).zip(bodies) {
                hands.push(scope.spawn(move || met(chosen.cases(study, piece(place))?, own)));
            }
            hands.into_iter().map(joined).collect()
        });
        let mut all = Vec::with_capacity((next - start) as usize);
        for piece in pieces {
            all.extend(piece?);
        }
        Ok(all)
    }
}

/// A panic of one thread is one of all.
pub fn joined<T>(thread: ScopedJoinHandle<T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// All of them, with their bodies met.
fn met(cases: impl Iterator<Item = Result<DesignCase, Error>>, bodies: &mut Distinct) -> Drawn {
    let meet = |case: &Result<DesignCase, Error>| {
        if let Ok(DesignCase { joint, .. }) = case {
            [&joint.pin, &joint.plate].into_iter().for_each(|part| bodies.meet(&joint.body(part)));
        }
    };
    cases.inspect(meet).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::mpsc::sync_channel;

    use super::*;

    fn study() -> Study {
        let config = r#"
            [joint]
            idealization     = "plane-stress"
            hole_radius      = "10 mm"
            radial_clearance = { from = "0.01 mm", to = "1 mm", count = 2500 }
            thickness        = "8 mm"
            pin   = { model = "rigid-core", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }
            plate = { model = "annulus", outer_radius_ratio = 3, youngs_modulus = "210 GPa", poissons_ratio = 0.3 }
            [load]
            force = "5 kN"
        "#;
        Study::from_text(Path::new("config"), config.to_string()).unwrap()
    }

    /// Sizes of the batches in which designs are drawn, where a whole batch is soon solved or not.
    #[test]
    fn a_sweep_begins_with_a_whole_batch_where_that_is_soon_solved() {
        let study = study();
        let sizes = |is_soon: bool| -> Vec<usize> {
            let (sender, drawn) = sync_channel(10);
            let mut drawer = Drawer::new(&study, &Chosen::All, 1).unwrap();
            drawer.draw_all(
                1024,
                |first| is_soon && first.len() == FIRST_BATCH,
                |batch| sender.send(batch).is_ok(),
            );
            drop(sender);
            let batches: Vec<Vec<DesignCase>> = drawn.iter().map(Result::unwrap).collect();
            assert!(batches.iter().flatten().map(|case| case.index).eq(0..2500));
            batches.iter().map(Vec::len).collect()
        };
        assert_eq!(sizes(false), [64, 960, 1024, 452]);
        assert_eq!(sizes(true), [1024, 1024, 452]);
    }

    /// However many threads draw, the same designs come in the same order, and as many bodies are counted.
    #[test]
    fn many_threads_draw_the_same() {
        let study = study();
        for chosen in [Chosen::All, Chosen::Range(100..2400), Chosen::Listed((0..2500).step_by(2).collect())]
        {
            let drawn = |threads: usize| {
                let (sender, drawn) = sync_channel(10);
                let bodies = Drawer::new(&study, &chosen, threads).unwrap().draw_all(
                    2100,
                    |_| false,
                    |batch| sender.send(batch).is_ok(),
                );
                drop(sender);
                let batches: Vec<Vec<DesignCase>> = drawn.iter().map(Result::unwrap).collect();
                let numbers: Vec<u64> = batches.iter().flatten().map(|case| case.index).collect();
                assert_eq!(numbers.len() as u64, chosen.count(&study));
                (bodies, numbers)
            };
            assert_eq!(drawn(1), drawn(64));
        }
    }
}
