//! What a device has counted of the rows of some designs, and where it lies among the words that come back.

use std::ops::Range;

use super::{AskedHistogram, AskedQuantity, Question};
use crate::engine::accuracy::Want;

/// Numbers that are counted have binary exponents from this on, and so many of them, of either sign.
pub const FIRST_EXPONENT: i32 = -32;
pub const EXPONENTS: usize = 64;

/// Of a sketch: what the ten digits behind the leading one may be.
pub const LEADING: usize = 1 << 10;
const SKETCH_WORDS: usize = 2 * EXPONENTS * LEADING;

/// Of sums, each exponent: how many numbers, and sums of 12 digits at a time of their mantissas and of the products that squares of
/// mantissas are made of.
pub const PARTS: usize = 9;
pub const SUM_WORDS: usize = 2 * EXPONENTS * PARTS;

/// Words of all rows together, before all others, in their order: up to large rows they are sums, the others the greatest.
#[derive(Clone, Copy)]
pub enum Total {
    CountedDesigns,
    CountedRows,
    KeptRows,
    LargeRows,
    GreatestError,
    GreatestLinearity,
    GreatestForce,
    /// Of the bits of the smallest force, from those of infinity.
    LeastForce,
    /// How many these are.
    Count,
}

const OF_ALL: usize = Total::Count as usize;

/// Rows of a batch at most, so that no word overflows.
pub const MOST_ROWS: usize = 1 << 20;

/// Where counts begin, in words.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Of each quantity its sketch and its sums; zero where there are none. Whoever has a sketch has sums.
    pub quantities: Vec<[usize; 2]>,
    pub histograms: Vec<usize>,
    /// The verdicts, one a design, behind all counts.
    pub verdicts: usize,
}

/// What is to be done with a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All of it: nothing is counted.
    Open,
    /// Nothing more.
    Counted,
    /// It is counted, but may have a row among the extreme ones.
    Candidate,
    /// As open ones, but it is known what it wants (`Want`).
    MoreNodes,
    MoreTerms,
    FinerMesh,
}

impl Verdict {
    const ALL: [Verdict; 6] = [
        Verdict::Open,
        Verdict::Counted,
        Verdict::Candidate,
        Verdict::MoreNodes,
        Verdict::MoreTerms,
        Verdict::FinerMesh,
    ];

    /// As a device tells it.
    fn of(word: u32) -> Verdict {
        Verdict::ALL.into_iter().find(|own| *own as u32 == word).unwrap_or(Verdict::Open)
    }

    /// What the first attempt at the design has left to be wanted, as far as is known.
    pub fn want(self) -> Want {
        match self {
            Verdict::Open | Verdict::Counted | Verdict::Candidate => Want::Nothing,
            Verdict::MoreNodes => Want::MoreNodes,
            Verdict::MoreTerms => Want::MoreTerms,
            Verdict::FinerMesh => Want::FinerMesh,
        }
    }
}

/// Of the rows of some designs, by a device. Equal for the same designs, whatever batches they came in.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted {
    pub designs: u64,
    pub rows: u64,
    pub kept_rows: u64,
    /// Those that are remarked on for large displacement; all others are plainly good.
    pub large_rows: u64,
    pub greatest_force_error: f64,
    pub greatest_linearity_error: f64,
    /// The least and the greatest, N; `None` of no rows.
    pub forces: Option<[f64; 2]>,
    /// Of each quantity, empty where nothing was asked; of each histogram, below the first edge, in the bins, above the last.
    pub quantities: Vec<CountedQuantity>,
    pub histograms: Vec<Vec<u64>>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct CountedQuantity {
    pub sums: Vec<CountedSum>,
    /// A number, and how many agree with it in sign, exponent and ten digits.
    pub sketch: Vec<(f64, u64)>,
}

/// Of numbers of one sign and one exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountedSum {
    pub is_negative: bool,
    pub count: u64,
    /// In units of 2^exponent, and their squares in units of the square of that.
    pub sum: u64,
    pub squares: u128,
    pub exponent: i32,
}

impl Layout {
    pub fn new(quantities: &[AskedQuantity], histograms: &[AskedHistogram]) -> Layout {
        let mut end = OF_ALL;
        let mut place = |words: usize| {
            end += words;
            end - words
        };
        let histograms = histograms.iter().map(|histogram| place(histogram.edges.len() + 1)).collect();
        let mut places = |is_asked: fn(&AskedQuantity) -> bool, words: usize| {
            let own = quantities.iter().map(|quantity| if is_asked(quantity) { place(words) } else { 0 });
            own.collect::<Vec<_>>()
        };
        let sums = places(|quantity| quantity.has_sums, SUM_WORDS);
        let sketches = places(|quantity| quantity.has_sketch, SKETCH_WORDS);
        let quantities = sketches.into_iter().zip(sums).map(|(sketch, sums)| [sketch, sums]).collect();
        Layout { quantities, histograms, verdicts: end }
    }

    /// Words of a batch.
    pub fn words(&self, designs: usize) -> usize {
        self.verdicts + designs
    }

    /// The words of a batch that are worth reading where values of each quantity lie in a range, or anywhere: most of a sketch is empty.
    pub fn worth_reading(&self, ranges: &[Option<[f64; 2]>], designs: usize) -> Vec<Range<usize>> {
        let sketches = || self.quantities.iter().map(|[sketch, _]| *sketch);
        let first = sketches().filter(|sketch| *sketch > 0).min().unwrap_or(self.verdicts);
        let mut parts: Vec<Range<usize>> = std::iter::once(0..first).collect();
        for (sketch, range) in sketches().zip(ranges).filter(|(sketch, _)| *sketch > 0) {
            let places = range.map_or([0..EXPONENTS, 0..EXPONENTS], exponents_of);
            for (first, own) in [sketch, sketch + EXPONENTS * LEADING].into_iter().zip(places) {
                if !own.is_empty() {
                    parts.push(first + own.start * LEADING..first + own.end * LEADING);
                }
            }
        }
        parts.push(self.verdicts..self.words(designs));
        parts
    }

    /// Whether all is there that was counted.
    pub fn is_whole(&self, told: &Told) -> bool {
        let is_there = |[sketch, sums]: &[usize; 2]| {
            *sketch == 0
                || told.words(*sums..sums + SUM_WORDS).is_some_and(|sums| {
                    met(sums).all(|(place, _)| told.words(block(*sketch, place)).is_some())
                })
        };
        self.quantities.iter().all(is_there)
    }
}

/// The exponents of positive and of negative numbers in a range, and one more at either end.
fn exponents_of([least, greatest]: [f64; 2]) -> [Range<usize>; 2] {
    let place = |size: f64, more: i32| {
        (size.log2().floor() as i32 - FIRST_EXPONENT + more).clamp(0, EXPONENTS as i32) as usize
    };
    let of = |least: f64, greatest: f64| match greatest > 0.0 {
        true => (if least > 0.0 { place(least, -1) } else { 0 })..place(greatest, 2),
        false => 0..0,
    };
    [of(least, greatest), of(-greatest, -least)]
}

/// Words that have come back, in parts.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// How many designs they are of.
    pub designs: usize,
    /// Where each part lies in the whole, ascending.
    pub parts: Vec<Range<usize>>,
    /// One part after another.
    pub all: Vec<u32>,
}

impl Told {
    /// Some of the whole; `None` where they have not come.
    pub fn words(&self, wanted: Range<usize>) -> Option<&[u32]> {
        let mut at = 0;
        for part in &self.parts {
            if part.start <= wanted.start && wanted.end <= part.end {
                return self.all.get(at + wanted.start - part.start..at + wanted.end - part.start);
            }
            at += part.len();
        }
        None
    }
}

impl Question {
    /// From the words of a batch: what is counted, and a verdict for each design.
    pub fn read(&self, told: &Told) -> (Counted, Vec<Verdict>) {
        let words = |from: usize, count: usize| told.words(from..from + count).unwrap_or(&[]);
        let totals: [u32; OF_ALL] = words(0, OF_ALL).try_into().unwrap_or([0; OF_ALL]);
        let total = |own: Total| totals[own as usize];
        let number = |bits: u32| f64::from(f32::from_bits(bits));
        let least_force = number(f32::INFINITY.to_bits() - total(Total::LeastForce));
        let quantity = |[sketch, sums]: &[usize; 2]| {
            let own = if *sums > 0 { words(*sums, SUM_WORDS) } else { &[] };
            let blocks = met(own).map(|(place, _)| (place, told.words(block(*sketch, place)).unwrap_or(&[])));
            CountedQuantity {
                sketch: if *sketch > 0 { blocks.flat_map(read_block).collect() } else { Vec::new() },
                sums: met(own).map(read_sum).collect(),
            }
        };
        let histograms = self.layout.histograms.iter().zip(&self.histograms);
        let histogram = |(at, own): (&usize, &AskedHistogram)| {
            words(*at, own.edges.len() + 1).iter().map(|count| u64::from(*count)).collect()
        };
        let counted = Counted {
            designs: u64::from(total(Total::CountedDesigns)),
            rows: u64::from(total(Total::CountedRows)),
            kept_rows: u64::from(total(Total::KeptRows)),
            large_rows: u64::from(total(Total::LargeRows)),
            greatest_force_error: number(total(Total::GreatestError)),
            greatest_linearity_error: number(total(Total::GreatestLinearity)),
            forces: (total(Total::CountedRows) > 0)
                .then(|| [least_force, number(total(Total::GreatestForce))]),
            quantities: self.layout.quantities.iter().map(quantity).collect(),
            histograms: histograms.map(histogram).collect(),
        };
        // Of designs that no device had a look at there are none: they are open.
        let verdicts = words(self.layout.verdicts, told.designs).iter().map(|word| Verdict::of(*word));
        let open = std::iter::repeat(Verdict::Open);
        (counted, verdicts.chain(open).take(told.designs).collect())
    }
}

/// The sign and the exponent of a place, positive numbers before negative ones.
fn sign_and_exponent(place: usize) -> (bool, i32) {
    (place >= EXPONENTS, FIRST_EXPONENT + (place % EXPONENTS) as i32)
}

/// The exponents of sums that there are numbers of, with what is summed of them.
fn met(sums: &[u32]) -> impl Iterator<Item = (usize, &[u32])> {
    sums.chunks_exact(PARTS).enumerate().filter(|(_, parts)| parts[0] > 0)
}

/// Where the numbers of an exponent are in a sketch.
fn block(sketch: usize, place: usize) -> Range<usize> {
    sketch + place * LEADING..sketch + (place + 1) * LEADING
}

fn read_block((place, words): (usize, &[u32])) -> impl Iterator<Item = (f64, u64)> {
    let (is_negative, exponent) = sign_and_exponent(place);
    let unit = if is_negative { -(2.0_f64.powi(exponent)) } else { 2.0_f64.powi(exponent) };
    let met = words.iter().enumerate().filter(|(_, count)| **count > 0);
    met.map(move |(leading, count)| ((1.0 + leading as f64 / LEADING as f64) * unit, u64::from(*count)))
}

fn read_sum((place, parts): (usize, &[u32])) -> CountedSum {
    let (is_negative, exponent) = sign_and_exponent(place);
    let halves = |at: usize| u128::from(parts[at]) + (u128::from(parts[at + 1]) << 12);
    CountedSum {
        is_negative,
        count: u64::from(parts[0]),
        sum: halves(1) as u64,
        // (2^12 high + low)^2.
        squares: (halves(3) << 24) + (halves(5) << 13) + halves(7),
        // Mantissas are whole numbers of 24 digits.
        exponent: exponent - 23,
    }
}

impl Counted {
    /// Of no rows.
    pub fn none(question: &Question) -> Counted {
        Counted {
            designs: 0,
            rows: 0,
            kept_rows: 0,
            large_rows: 0,
            greatest_force_error: 0.0,
            greatest_linearity_error: 0.0,
            forces: None,
            quantities: vec![CountedQuantity::default(); question.quantities.len()],
            histograms: question.histograms.iter().map(|own| vec![0; own.edges.len() + 1]).collect(),
        }
    }

    /// With what was counted of other designs of the same question.
    pub fn merge(&mut self, other: &Counted) {
        self.designs += other.designs;
        self.rows += other.rows;
        self.kept_rows += other.kept_rows;
        self.large_rows += other.large_rows;
        self.greatest_force_error = self.greatest_force_error.max(other.greatest_force_error);
        self.greatest_linearity_error = self.greatest_linearity_error.max(other.greatest_linearity_error);
        self.forces = match (self.forces, other.forces) {
            (Some(own), Some(theirs)) => Some([own[0].min(theirs[0]), own[1].max(theirs[1])]),
            (own, theirs) => own.or(theirs),
        };
        for (own, theirs) in self.quantities.iter_mut().zip(&other.quantities) {
            own.sums.extend(&theirs.sums);
            own.sketch.extend(&theirs.sketch);
        }
        for (own, theirs) in self.histograms.iter_mut().zip(&other.histograms) {
            own.iter_mut().zip(theirs).for_each(|(own, theirs)| *own += theirs);
        }
    }
}
