//! What a device has counted of the rows of some designs, and where it lies among the words that come back.

use super::{AskedHistogram, AskedQuantity, Question};

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

/// Words of all rows together, before all others; as `shaders/answers.wgsl` has them.
const OF_ALL: usize = 8;

/// Rows of a batch at most, so that no word overflows.
pub const MOST_ROWS: usize = 1 << 20;

/// Where counts begin, in words.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Of each quantity its sketch and its sums; zero where there are none.
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
        let of_quantity = |quantity: &AskedQuantity| {
            let sketch = if quantity.has_sketch { place(SKETCH_WORDS) } else { 0 };
            [sketch, if quantity.has_sums { place(SUM_WORDS) } else { 0 }]
        };
        let quantities = quantities.iter().map(of_quantity).collect();
        Layout { quantities, histograms, verdicts: end }
    }

    /// Words of a batch.
    pub fn words(&self, designs: usize) -> usize {
        self.verdicts + designs
    }
}

impl Question {
    /// From the words of a batch: what is counted, and a verdict for each design.
    pub fn read(&self, words: &[u32]) -> (Counted, Vec<Verdict>) {
        let (counts, verdicts) = words.split_at(self.layout.verdicts);
        let number = |bits: u32| f64::from(f32::from_bits(bits));
        let rows = u64::from(counts[1]);
        let least_force = number(f32::INFINITY.to_bits() - counts[7]);
        let quantities = self.layout.quantities.iter().map(|[sketch, sums]| CountedQuantity {
            sketch: if *sketch > 0 { read_sketch(&counts[*sketch..][..SKETCH_WORDS]) } else { Vec::new() },
            sums: if *sums > 0 { read_sums(&counts[*sums..][..SUM_WORDS]) } else { Vec::new() },
        });
        let histograms = self.layout.histograms.iter().zip(&self.histograms);
        let histogram = |(at, own): (&usize, &AskedHistogram)| {
            counts[*at..][..own.edges.len() + 1].iter().map(|count| u64::from(*count)).collect()
        };
        let counted = Counted {
            designs: u64::from(counts[0]),
            rows,
            kept_rows: u64::from(counts[2]),
            large_rows: u64::from(counts[3]),
            greatest_force_error: number(counts[4]),
            greatest_linearity_error: number(counts[5]),
            forces: (rows > 0).then(|| [least_force, number(counts[6])]),
            quantities: quantities.collect(),
            histograms: histograms.map(histogram).collect(),
        };
        let verdict = |word: &u32| match word {
            1 => Verdict::Counted,
            2 => Verdict::Candidate,
            _ => Verdict::Open,
        };
        (counted, verdicts.iter().map(verdict).collect())
    }
}

/// The sign and the exponent of a place, positive numbers before negative ones.
fn sign_and_exponent(place: usize) -> (bool, i32) {
    (place >= EXPONENTS, FIRST_EXPONENT + (place % EXPONENTS) as i32)
}

fn read_sketch(words: &[u32]) -> Vec<(f64, u64)> {
    let met = words.iter().enumerate().filter(|(_, count)| **count > 0);
    let value = |(place, count): (usize, &u32)| {
        let (is_negative, exponent) = sign_and_exponent(place / LEADING);
        let size = (1.0 + (place % LEADING) as f64 / LEADING as f64) * 2.0_f64.powi(exponent);
        (if is_negative { -size } else { size }, u64::from(*count))
    };
    met.map(value).collect()
}

fn read_sums(words: &[u32]) -> Vec<CountedSum> {
    let met = words.chunks_exact(PARTS).enumerate().filter(|(_, parts)| parts[0] > 0);
    let sum = |(place, parts): (usize, &[u32])| {
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
    };
    met.map(sum).collect()
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
