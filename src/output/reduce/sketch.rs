//! A fine count of numbers, from which quantiles are told to 0.05 %: numbers that agree in sign, exponent and ten binary digits
//! share a count. Nothing is rounded, so that parts of a sweep add up to the same counts in any order.
//!
//! Where there are too many counts, neighbours are joined, all at once: ten digits become nine. The digits that are left depend on
//! the numbers alone, not on their order: there are never fewer counts with more numbers (as in UDDSketch, Epicoco et al. 2020,
//! after DDSketch, Masson et al. 2019).

use std::collections::BTreeMap;

use foldhash::{HashMap, HashMapExt};
use serde::{Deserialize, Serialize, Serializer};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sketch {
    /// Binary digits behind the leading one that tell numbers apart.
    digits: u32,
    /// By the leading bits, negative for negative numbers; 0 for zeros and for what is smaller than 2.2e-308.
    #[serde(serialize_with = "sorted")]
    counts: HashMap<i64, u64>,
}

fn sorted<S: Serializer>(counts: &HashMap<i64, u64>, serializer: S) -> Result<S::Ok, S::Error> {
    counts.iter().collect::<BTreeMap<_, _>>().serialize(serializer)
}

const MOST_DIGITS: u32 = 10;

/// Counts of one sketch: 19 decades of numbers with ten digits, and all there are with four.
pub const MOST_COUNTS: usize = 1 << 16;

impl Default for Sketch {
    fn default() -> Sketch {
        Sketch { digits: MOST_DIGITS, counts: HashMap::new() }
    }
}

impl Sketch {
    /// `value` must be finite.
    pub fn add(&mut self, value: f64) {
        let leading = match value.abs() {
            tiny if tiny < f64::MIN_POSITIVE => 0,
            size => (size.to_bits() >> (52 - self.digits)) as i64,
        };
        *self.counts.entry(if value < 0.0 { -leading } else { leading }).or_default() += 1;
        self.shrink();
    }

    pub fn merge(&mut self, other: &Sketch) {
        let mut other = other.clone();
        while self.digits > other.digits {
            self.join_neighbours();
        }
        while other.digits > self.digits {
            other.join_neighbours();
        }
        for (leading, count) in other.counts {
            *self.counts.entry(leading).or_default() += count;
        }
        self.shrink();
    }

    fn shrink(&mut self) {
        while self.counts.len() > MOST_COUNTS && self.digits > 0 {
            self.join_neighbours();
        }
    }

    fn join_neighbours(&mut self) {
        self.digits -= 1;
        for (leading, count) in std::mem::take(&mut self.counts) {
            *self.counts.entry(leading.signum() * (leading.abs() >> 1)).or_default() += count;
        }
    }

    /// Whether it can be what a run has left.
    pub fn is_sound(&self) -> bool {
        // Sign, exponent and digits.
        let end = 1_i64 << (11 + self.digits.min(MOST_DIGITS));
        let mut leading = self.counts.keys();
        self.digits <= MOST_DIGITS && leading.all(|leading| (-end..end).contains(leading))
    }

    pub fn count_entries(&self) -> usize {
        self.counts.len()
    }

    /// How far a told number is from the one that is meant, at most, relative.
    pub fn relative_error(&self) -> f64 {
        0.5 / f64::from(1_u32 << self.digits)
    }

    /// The numbers in ascending order, each as the middle of those that share its count, with how often it was met.
    pub fn values(&self) -> impl Iterator<Item = (f64, u64)> {
        let mut counts: Vec<(i64, u64)> =
            self.counts.iter().map(|(&leading, &count)| (leading, count)).collect();
        counts.sort_unstable();
        counts.into_iter().map(|(leading, count)| {
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
