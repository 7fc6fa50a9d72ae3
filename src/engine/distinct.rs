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
}

impl Distinct {
    pub fn meet(&mut self, thing: &impl Hash) {
        let hash = FixedState::with_seed(0).hash_one(thing);
        if hash.trailing_zeros() < self.zeros {
            return;
        }
        self.hashes.insert(hash);
        while self.hashes.len() > KEPT {
            self.zeros += 1;
            let zeros = self.zeros;
            self.hashes.retain(|hash| hash.trailing_zeros() >= zeros);
        }
    }

    pub fn count(&self) -> u64 {
        (self.hashes.len() as u64) << self.zeros
    }
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
    }
}
