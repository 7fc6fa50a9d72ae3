//! How often whole numbers were met: a plain list of counts over the range where most of them lie, a map for the others.

use foldhash::HashMap;

/// Two are equal that have the same counts.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// What `near` begins with.
    first: i64,
    near: Vec<u64>,
    far: HashMap<i64, u64>,
    /// Counts above 0.
    entries: usize,
}

/// The list begins and ends at multiples of this, ...
const BLOCK: i64 = 1 << 10;
/// ... and is not longer (128 KiB).
const MOST_NEAR: i64 = 1 << 14;

impl Tally {
    /// Counts `number`, whose size is below 2^62, `times` more.
    pub fn add(&mut self, number: i64, times: u64) {
        let place = number.wrapping_sub(self.first) as usize;
        match self.near.get_mut(place) {
            Some(count) => {
                self.entries += usize::from(*count == 0 && times > 0);
                *count += times;
            }
            None => self.add_beyond(number, times),
        }
    }

    #[cold]
    fn add_beyond(&mut self, number: i64, times: u64) {
        if self.reach(number) {
            return self.add(number, times);
        }
        if times > 0 {
            let count = self.far.entry(number).or_default();
            self.entries += usize::from(*count == 0);
            *count += times;
        }
    }

    /// Makes the list long enough for `number`, unless it would be too long: then it will always be, since the list never gets
    /// shorter, and no number of the map ever belongs into the list.
    fn reach(&mut self, number: i64) -> bool {
        let start = number.div_euclid(BLOCK) * BLOCK;
        let (mut first, mut end) = (start, start + BLOCK);
        let own_end = self.first + self.near.len() as i64;
        if !self.near.is_empty() {
            first = first.min(self.first);
            end = end.max(own_end);
        }
        if end - first > MOST_NEAR {
            return false;
        }
        // Twice as long at least, as long as it may: else it is copied for every block of numbers that come from small to large.
        let more = (2 * self.near.len() as i64).min(MOST_NEAR) - (end - first);
        if more > 0 && first < self.first {
            first -= more
        } else {
            end += more.max(0)
        }
        let mut near = vec![0; (end - first) as usize];
        if !self.near.is_empty() {
            let place = (self.first - first) as usize;
            near[place..place + self.near.len()].copy_from_slice(&self.near);
        }
        (self.first, self.near) = (first, near);
        true
    }

    /// How many numbers were met.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Every number that was met with its count, in any order.
    pub fn for_each(&self, mut receive: impl FnMut(i64, u64)) {
        for (number, count) in (self.first..).zip(&self.near).filter(|(_, count)| **count > 0) {
            receive(number, *count);
        }
        self.far.iter().for_each(|(number, count)| receive(*number, *count));
    }

    /// The same from the smallest number to the largest.
    pub fn sorted(&self) -> Vec<(i64, u64)> {
        let mut all = Vec::with_capacity(self.entries);
        self.for_each(|number, count| all.push((number, count)));
        all.sort_unstable();
        all
    }
}

impl PartialEq for Tally {
    fn eq(&self, other: &Tally) -> bool {
        self.entries == other.entries && self.sorted() == other.sorted()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Near each other, far from each other, and both, in another order each time: against a plain map.
    #[test]
    fn counts_do_not_depend_on_where_they_are_kept() {
        let mut random = 1_u64;
        let mut draw = |below: u64| {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (random >> 33) % below
        };
        let (mut in_list, mut in_map) = (0, 0);
        for spread in [1, 500, 20_000, 3_000_000] {
            let mut numbers: Vec<i64> =
                (0..5000).map(|_| 1_000_000 - draw(spread) as i64 * (1 - 2 * draw(2) as i64)).collect();
            numbers.extend([0, -1, 1, -4_000_000]);
            let mut expected = BTreeMap::new();
            numbers.iter().for_each(|number| *expected.entry(*number).or_insert(0) += 1);
            let mut tally = Tally::default();
            numbers.iter().for_each(|number| tally.add(*number, 1));
            assert_eq!(tally.sorted(), expected.clone().into_iter().collect::<Vec<_>>());
            assert_eq!(tally.entries(), expected.len());
            assert!(tally.near.len() <= MOST_NEAR as usize);
            in_list += tally.near.iter().filter(|count| **count > 0).count();
            in_map += tally.far.len();
            let mut parts = [Tally::default(), Tally::default()];
            for number in numbers.iter().rev() {
                parts[draw(2) as usize].add(*number, 1);
            }
            let [mut one, other] = parts;
            other.for_each(|number, count| one.add(number, count));
            assert!(one == tally);
            one.add(7, 1);
            assert!(one != tally);
        }
        assert!(in_list > 2000 && in_map > 2000, "{in_list} {in_map}");
    }
}
