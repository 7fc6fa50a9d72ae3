//! How many different things were met, in little memory however many they are.

use std::hash::{BuildHasher, Hash};

use foldhash::HashSet;
use foldhash::fast::FixedState;

/// Exact up to this many; beyond, an estimate to some 0.3 %. What is kept stays in the processor's cache.
const KEPT: usize = 1 << 18;

/// Keeps hashes; when they become too many, only those that end with so many zeros, which are as many times fewer (Flajolet, "On
/// adaptive sampling", Computing 43, 1990).
#[derive(Default)]
pub struct Distinct {
    hashes: HashSet<u64>,
    zeros: u32,
    /// All, each as often as it came.
    met: u64,
}

impl Distinct {
    pub fn meet(&mut self, thing: &impl Hash) {
        let hash = FixedState::with_seed(0).hash_one(thing);
        self.met += 1;
        if hash.trailing_zeros() < self.zeros {
            return;
        }
        self.hashes.insert(hash);
        self.shrink();
    }

    /// With what somebody else has met.
    pub fn merge(&mut self, other: Distinct) {
        self.zeros = self.zeros.max(other.zeros);
        self.hashes.extend(other.hashes);
        self.met += other.met;
        self.keep();
        self.shrink();
    }

    fn shrink(&mut self) {
        while self.hashes.len() > KEPT {
            self.zeros += 1;
            self.keep();
        }
    }

    fn keep(&mut self) {
        let zeros = self.zeros;
        self.hashes.retain(|hash| hash.trailing_zeros() >= zeros);
    }

    /// Never more than were met.
    pub fn count(&self) -> u64 {
        ((self.hashes.len() as u64) << self.zeros).min(self.met)
    }
}

/// About how many distinct things there are among `all`, of which `seen` were looked at and so many different ones found.
pub fn distinct_among(all: f64, seen: f64, found: f64) -> f64 {
    // Of D, equally frequent, D (1 - exp(-seen/D)) are met.
    let (mut low, mut high) = (found, all.max(found));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle * (1.0 - (-seen / middle).exp()) < found { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_are_counted_and_more_are_estimated() {
        let mut distinct = Distinct::default();
        for number in 0..KEPT as u64 {
            distinct.meet(&number);
            distinct.meet(&(number / 2));
        }
        assert_eq!((distinct.count(), distinct.zeros), (KEPT as u64, 0));
        for number in 0..5_000_000_u64 {
            distinct.meet(&number);
        }
        assert!(distinct.hashes.len() <= KEPT);
        let error = distinct.count() as f64 / 5e6 - 1.0;
        // Four times the standard deviation.
        assert!(error.abs() < 0.011, "{error}");
        // Met once each, an estimate that is too great is known to be.
        let (mut too_great, mut each_once) = (0, Distinct::default());
        for number in 0..2_000_000_u64 {
            each_once.meet(&number);
            let estimate = (each_once.hashes.len() as u64) << each_once.zeros;
            too_great += u64::from(estimate > number + 1);
            assert!(each_once.count() <= number + 1);
        }
        assert!(too_great > 0);
    }

    /// In whatever parts things are met, the same is kept of them.
    #[test]
    fn parts_come_to_the_whole() {
        let numbers = 0..1_200_000_u64;
        let mut parts = [Distinct::default(), Distinct::default(), Distinct::default()];
        let mut whole = Distinct::default();
        for number in numbers {
            // Most of them in the last part, which keeps fewer.
            let part = if number % 100 == 0 { (number / 100 % 2) as usize } else { 2 };
            parts[part].meet(&(number / 3 * 2));
            whole.meet(&(number / 3 * 2));
        }
        let [mut first, second, third] = parts;
        assert!(first.zeros == 0 && whole.zeros > 0);
        first.merge(second);
        first.merge(third);
        assert_eq!((first.count(), first.zeros), (whole.count(), whole.zeros));
        assert_eq!(first.hashes, whole.hashes);
    }

    /// Of a thousand different things, drawn at random; where each is another one there may be as many as there are.
    #[test]
    fn few_that_are_looked_at_tell_how_many_there_are() {
        let mut seed = 1_u64;
        let mut draw = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % 1000
        };
        let found: HashSet<u64> = (0..2000).map(|_| draw()).collect();
        let told = distinct_among(1e6, 2000.0, found.len() as f64);
        assert!((told - 1000.0).abs() < 60.0, "{told}");
        assert_eq!(distinct_among(1e6, 100.0, 100.0).round(), 1e6);
        assert_eq!(distinct_among(1e6, 100.0, 1.0).round(), 1.0);
    }
}
