//! A fine count of numbers, from which quantiles are told to 0.05 %: numbers that agree in sign, exponent and ten binary digits
//! share a count. Nothing is rounded, so that parts of a sweep add up to the same counts in any order.
//!
//! Where there are too many counts, neighbours are joined, all at once: ten digits become nine. The digits that are left depend on
//! the numbers alone, not on their order: there are never fewer counts with more numbers (as in UDDSketch, Epicoco et al. 2020,
//! after DDSketch, Masson et al. 2019).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::tally::Tally;

/// Two are equal that have counted the same, in whatever order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Saved", try_from = "Saved")]
pub struct Sketch {
    /// Binary digits behind the leading one that tell numbers apart.
    digits: u32,
    /// By the leading bits, negative for negative numbers; 0 for zeros and for what is smaller than 2.2e-308.
    counts: Tally,
}

/// A sketch as data.
#[derive(Serialize, Deserialize)]
struct Saved {
    digits: u32,
    counts: BTreeMap<i64, u64>,
}

const MOST_DIGITS: u32 = 10;

/// Counts of one sketch: 19 decades of numbers with ten digits, and all there are with four.
pub const MOST_COUNTS: usize = 1 << 16;

impl Default for Sketch {
    fn default() -> Sketch {
        Sketch { digits: MOST_DIGITS, counts: Tally::default() }
    }
}

impl Sketch {
    /// `value` must be finite.
    pub fn add(&mut self, value: f64) {
        self.add_times(value, 1);
    }

    /// The same of several that are alike.
    pub fn add_times(&mut self, value: f64, times: u64) {
        let leading = match value.abs() {
            tiny if tiny < f64::MIN_POSITIVE => 0,
            size => (size.to_bits() >> (52 - self.digits)) as i64,
        };
        self.counts.add(if value < 0.0 { -leading } else { leading }, times);
        self.shrink();
    }

    pub fn merge(&mut self, other: &Sketch) {
        while self.digits > other.digits {
            self.join_neighbours();
        }
        let more = other.digits - self.digits;
        other.counts.for_each(|leading, count| self.counts.add(joined(leading, more), count));
        self.shrink();
    }

    fn shrink(&mut self) {
        while self.counts.entries() > MOST_COUNTS && self.digits > 0 {
            self.join_neighbours();
        }
    }

    fn join_neighbours(&mut self) {
        self.digits -= 1;
        let before = std::mem::take(&mut self.counts);
        before.for_each(|leading, count| self.counts.add(joined(leading, 1), count));
    }

    pub fn count_entries(&self) -> usize {
        self.counts.entries()
    }

    /// How far a told number is from the one that is meant, at most, relative.
    pub fn relative_error(&self) -> f64 {
        0.5 / f64::from(1_u32 << self.digits)
    }

    /// The numbers in ascending order, each as the middle of those that share its count, with how often it was met.
    pub fn values(&self) -> impl Iterator<Item = (f64, u64)> {
        self.counts.sorted().into_iter().map(|(leading, count)| {
            let edge = |leading: i64| f64::from_bits((leading as u64) << (52 - self.digits)).min(f64::MAX);
            let (low, high) = (edge(leading.abs()), edge(leading.abs() + 1));
            let middle = low + (high - low) / 2.0;
            (if leading == 0 { 0.0 } else { middle.copysign(leading as f64) }, count)
        })
    }

    /// The number of rank `rank`, from 1, in ascending order.
    pub fn at_rank(&self, rank: u64) -> Option<f64> {
        let mut passed = 0;
        self.values().find_map(|(value, count)| {
            passed += count;
            (passed >= rank).then_some(value)
        })
    }
}

/// Leading bits with so many digits less.
fn joined(leading: i64, less: u32) -> i64 {
    leading.signum() * (leading.abs() >> less)
}

impl From<Sketch> for Saved {
    fn from(sketch: Sketch) -> Saved {
        Saved { digits: sketch.digits, counts: sketch.counts.sorted().into_iter().collect() }
    }
}

impl TryFrom<Saved> for Sketch {
    type Error = &'static str;

    fn try_from(Saved { digits, counts }: Saved) -> Result<Sketch, &'static str> {
        // Sign, exponent and digits.
        let end = 1_i64 << (11 + digits.min(MOST_DIGITS));
        if digits > MOST_DIGITS || !counts.keys().all(|leading| (-end..end).contains(leading)) {
            return Err("a count is of no number that there is");
        }
        let mut sketch = Sketch { digits, counts: Tally::default() };
        counts.into_iter().for_each(|(leading, count)| sketch.counts.add(leading, count));
        Ok(sketch)
    }
}
