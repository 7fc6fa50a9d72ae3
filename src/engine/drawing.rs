//! The designs of a sweep, drawn in batches ahead of those who solve them.

use std::ops::Range;

use crate::engine::distinct::{Distinct, distinct_among};
use crate::engine::threads::{joined, spawned};
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;
use crate::study::sampling::mix;

/// The designs to solve, by their numbers.
#[derive(Clone, Debug, Default)]
pub enum Chosen {
    #[default]
    All,
    Range(Range<u64>),
    /// In their order, none twice.
    Listed(Vec<u64>),
}

/// Designs that follow each other.
pub enum Batch {
    Cases(Vec<DesignCase>),
    /// By their numbers: a device draws them.
    Numbers(Range<u64>),
}

/// A batch, or why it cannot be read.
pub type Drawn = Result<Batch, Error>;

pub type DrawnCases = Result<Vec<DesignCase>, Error>;

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

/// Designs that tell how many different bodies there are, where a device draws.
const LOOKED_AT: u64 = 1 << 16;

/// Draws designs, and finds out how many of their bodies are different.
pub struct Drawer<'a> {
    study: &'a Study,
    chosen: &'a Chosen,
    left: Range<u64>,
    /// Those that are left, where they come one after another: a list of designs.
    listed: Option<Cases<'a>>,
    /// Of each thread.
    bodies: Vec<Distinct>,
    /// Whether a device draws.
    on_device: bool,
    /// Batches at the beginning that are small ones.
    small: usize,
}

impl<'a> Drawer<'a> {
    /// For so many threads that solve.
    pub fn new(study: &'a Study, chosen: &'a Chosen, threads: usize) -> Result<Drawer<'a>, Error> {
        let left = 0..chosen.count(study);
        let is_listed = study.designs_file().is_some();
        let listed = is_listed.then(|| chosen.cases(study, left.clone())).transpose()?;
        let hands = if is_listed { 1 } else { (threads / SOLVING).max(1) };
        let bodies = (0..hands).map(|_| Distinct::default()).collect();
        Ok(Drawer { study, chosen, left, listed, bodies, on_device: false, small: 1 })
    }

    /// That hands over numbers, from which a device draws the designs.
    pub fn on_device(self, on_device: bool) -> Drawer<'a> {
        Drawer { on_device, ..self }
    }

    /// That begins with so many small batches.
    pub fn with_small(self, small: usize) -> Drawer<'a> {
        Drawer { small, ..self }
    }

    /// Draws all in batches, up to the first that cannot be read or that nobody takes; tells how many different bodies there were. The first ones are
    /// small, unless a whole one `is_soon` solved.
    pub fn draw_all(
        &mut self,
        batch_size: usize,
        is_soon: impl Fn(&[DesignCase]) -> bool,
        mut hand_over: impl FnMut(Drawn) -> bool,
    ) -> u64 {
        if self.on_device {
            return self.number_all(batch_size, hand_over);
        }
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
        let mut small = self.small.saturating_sub(1);
        loop {
            let is_last = batch.as_ref().is_ok_and(Vec::is_empty);
            let is_broken = batch.is_err();
            if is_last || !hand_over(batch.map(Batch::Cases)) || is_broken {
                break;
            }
            let most = if small > 0 { FIRST_BATCH } else { batch_size };
            small = small.saturating_sub(1);
            batch = self.draw(self.to_a_multiple(batch_size).min(most));
        }
        let mut bodies = std::mem::take(&mut self.bodies).into_iter();
        let mut all = bodies.next().unwrap_or_default();
        bodies.for_each(|own| all.merge(own));
        all.count()
    }

    /// Hands over all numbers in batches, up to the first that nobody takes; tells about how many different bodies there were.
    fn number_all(&mut self, batch_size: usize, mut hand_over: impl FnMut(Drawn) -> bool) -> u64 {
        let (first, study, all) = (self.first_number(), self.study, self.left.clone());
        std::thread::scope(|scope| {
            let of_all = spawned(scope, move || about_distinct(study, first + all.start..first + all.end));
            let of_all = match of_all {
                Ok(of_all) => of_all,
                Err(error) => {
                    hand_over(Err(error));
                    return 0;
                }
            };
            let start = self.left.start;
            let mut count = FIRST_BATCH.min(batch_size);
            while !self.left.is_empty() {
                let Range { start, end } = self.left;
                let next = end.min(start + count as u64);
                if !hand_over(Ok(Batch::Numbers(first + start..first + next))) {
                    break;
                }
                self.left.start = next;
                count = self.to_a_multiple(batch_size);
            }
            let of_all = joined(of_all);
            if self.left.is_empty() {
                of_all
            } else {
                about_distinct(study, first + start..first + self.left.start)
            }
        })
    }

    /// Designs up to a multiple of the size of a batch: what is made of numbered portions finds whole ones in it.
    fn to_a_multiple(&self, batch_size: usize) -> usize {
        let size = batch_size as u64;
        (size - (self.first_number() + self.left.start) % size) as usize
    }

    /// Of the first design that is chosen.
    fn first_number(&self) -> u64 {
        match self.chosen {
            Chosen::Range(range) => range.start,
            Chosen::All | Chosen::Listed(_) => 0,
        }
    }

    /// As many as are asked for, if there are.
    pub fn draw(&mut self, count: usize) -> DrawnCases {
        let Range { start, end } = self.left;
        let next = end.min(start + count as u64);
        self.left.start = next;
        let (study, chosen, bodies) = (self.study, self.chosen, &mut self.bodies);
        if let Some(cases) = &mut self.listed {
            return met(cases.take(count), next - start, &mut bodies[0]);
        }
        let each = (next - start).div_ceil(bodies.len() as u64).max(FEWEST as u64);
        let piece = |place: u64| (start + place * each).min(next)..(start + (place + 1) * each).min(next);
        let of_piece = |place: u64, bodies: &mut Distinct| {
            let piece = piece(place);
            let count = piece.end - piece.start;
            met(chosen.cases(study, piece)?, count, bodies)
        };
        if piece(0).end == next {
            return of_piece(0, &mut bodies[0]);
        }
        let pieces: Vec<DrawnCases> = std::thread::scope(|scope| {
            let hands = (0..).zip(bodies).map(|(place, own)| spawned(scope, move || of_piece(place, own)));
            let hands: Vec<_> = hands.collect::<Result<_, Error>>()?;
            Ok(hands.into_iter().map(joined).collect())
        })?;
        let mut all = Vec::with_capacity((next - start) as usize);
        for piece in pieces {
            all.extend(piece?);
        }
        Ok(all)
    }
}

/// Of designs by their numbers about how many different bodies they have, from some of them.
fn about_distinct(study: &Study, numbers: Range<u64>) -> u64 {
    let count = numbers.end - numbers.start;
    let looked_at: Vec<u64> = if count <= LOOKED_AT {
        numbers.collect()
    } else {
        let mut some: Vec<u64> = (0..LOOKED_AT).map(|place| numbers.start + mix(place) % count).collect();
        some.sort_unstable();
        some.dedup();
        some
    };
    let mut of_sides = [Distinct::default(), Distinct::default()];
    let cases = study.cases_at(looked_at.iter().copied()).into_iter().flatten().flatten();
    for DesignCase { joint, .. } in cases {
        for (bodies, part) in of_sides.iter_mut().zip([&joint.pin, &joint.plate]) {
            bodies.meet(&joint.body(part));
        }
    }
    let about = |bodies: &Distinct| match bodies.count() {
        found if count <= LOOKED_AT => found,
        found => distinct_among(count as f64, looked_at.len() as f64, found as f64).round() as u64,
    };
    of_sides.iter().map(about).sum()
}

/// All of them, about as many as `count`, with their bodies met.
fn met(
    cases: impl Iterator<Item = Result<DesignCase, Error>>,
    count: u64,
    bodies: &mut Distinct,
) -> DrawnCases {
    let mut all = Vec::with_capacity(count as usize);
    for case in cases {
        let case = case?;
        let joint = &case.joint;
        [&joint.pin, &joint.plate].into_iter().for_each(|part| bodies.meet(&joint.body(part)));
        all.push(case);
    }
    Ok(all)
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

    fn cases_of(drawn: Drawn) -> Vec<DesignCase> {
        match drawn.unwrap() {
            Batch::Cases(cases) => cases,
            Batch::Numbers(numbers) => panic!("{numbers:?}"),
        }
    }

    /// Sizes of the batches in which designs are drawn, where a whole batch is soon solved or not.
    #[test]
    fn a_sweep_begins_with_a_whole_batch_where_that_is_soon_solved() {
        let study = study();
        let sizes = |small: usize, is_soon: bool| -> Vec<usize> {
            let (sender, drawn) = sync_channel(10);
            let mut drawer = Drawer::new(&study, &Chosen::All, 1).unwrap().with_small(small);
            drawer.draw_all(
                1024,
                |first| is_soon && first.len() == FIRST_BATCH,
                |batch| sender.send(batch).is_ok(),
            );
            drop(sender);
            let batches: Vec<Vec<DesignCase>> = drawn.iter().map(cases_of).collect();
            assert!(batches.iter().flatten().map(|case| case.index).eq(0..2500));
            batches.iter().map(Vec::len).collect()
        };
        assert_eq!(sizes(1, false), [64, 960, 1024, 452]);
        assert_eq!(sizes(3, false), [64, 64, 64, 832, 1024, 452]);
        assert_eq!(sizes(1, true), [1024, 1024, 452]);
    }

    /// Where a device draws, numbers are handed over in batches that end like those of designs, up to the first that nobody takes, and as many
    /// bodies are told.
    #[test]
    fn numbers_are_handed_over_like_designs() {
        let batches = |study: &Study, chosen: Chosen, most: usize| {
            let mut batches: Vec<Range<u64>> = Vec::new();
            let mut drawer = Drawer::new(study, &chosen, 4).unwrap().on_device(true);
            let bodies = drawer.draw_all(
                1024,
                |_| panic!("nothing is drawn"),
                |batch| {
                    let Ok(Batch::Numbers(numbers)) = batch else { panic!("designs") };
                    batches.push(numbers);
                    batches.len() < most
                },
            );
            (batches, bodies)
        };
        let study = study();
        let (found, bodies) = batches(&study, Chosen::Range(100..2400), 10);
        assert_eq!((found, bodies), (vec![100..164, 164..1024, 1024..2048, 2048..2400], 2));
        // Of the last one nobody knows whether it was taken.
        assert_eq!(batches(&study, Chosen::All, 2), (vec![0..64, 64..1024], 2));
        let text = study
            .source_text()
            .replace("2500", "4000")
            .replace("outer_radius_ratio = 3", "outer_radius_ratio = { from = 2, to = 4, count = 50 }");
        let study = Study::from_text(Path::new("config"), text).unwrap();
        assert!(study.design_count() > 2 * LOOKED_AT);
        let (_, bodies) = batches(&study, Chosen::All, usize::MAX);
        assert_eq!(bodies, 1 + 50);
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
                let batches: Vec<Vec<DesignCase>> = drawn.iter().map(cases_of).collect();
                let numbers: Vec<u64> = batches.iter().flatten().map(|case| case.index).collect();
                assert_eq!(numbers.len() as u64, chosen.count(&study));
                (bodies, numbers)
            };
            assert_eq!(drawn(1), drawn(64));
        }
    }
}
