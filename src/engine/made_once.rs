//! What several ladders need and one of them makes, while the others wait for it or make something else.

use std::collections::hash_map::Entry;
use std::hash::Hash;
use std::sync::{Arc, Condvar, Mutex, MutexGuard};

use foldhash::HashMap;

pub struct MadeOnce<K, V> {
    slots: Mutex<HashMap<K, Slot<V>>>,
    changed: Condvar,
}

enum Slot<V> {
    /// By somebody who has begun.
    Making,
    Made(Arc<V>),
}

impl<K, V> Default for MadeOnce<K, V> {
    fn default() -> MadeOnce<K, V> {
        MadeOnce { slots: Mutex::default(), changed: Condvar::new() }
    }
}

impl<K: Clone + Eq + Hash, V> MadeOnce<K, V> {
    /// What is made of each of some different keys. `make` is given those that nobody has begun, and makes all of them; for others it waits only
    /// then, so that two who need the same do not wait for each other.
    pub fn of(&self, keys: &[K], mut make: impl FnMut(Vec<K>) -> Vec<(K, V)>) -> Vec<Arc<V>> {
        let mut found: Vec<Option<Arc<V>>> = vec![None; keys.len()];
        loop {
            let mut slots = self.slots();
            let (mut open, mut is_waiting) = (Vec::new(), false);
            for (found, key) in found.iter_mut().zip(keys).filter(|(found, _)| found.is_none()) {
                match slots.entry(key.clone()) {
                    Entry::Occupied(slot) => match slot.get() {
                        Slot::Made(value) => *found = Some(Arc::clone(value)),
                        Slot::Making => is_waiting = true,
                    },
                    Entry::Vacant(slot) => {
                        slot.insert(Slot::Making);
                        open.push(key.clone());
                    }
                }
            }
            if !open.is_empty() {
                drop(slots);
                let claim = Claim { of: self, keys: open.clone() };
                let made = make(open);
                self.slots().extend(made.into_iter().map(|(key, value)| (key, Slot::Made(Arc::new(value)))));
                drop(claim);
            } else if is_waiting {
                drop(self.changed.wait(slots).unwrap_or_else(|poisoned| poisoned.into_inner()));
            } else {
                return found.into_iter().flatten().collect();
            }
        }
    }

    /// Forgets what is made; who has it keeps it.
    pub fn forget(&self) {
        self.slots().retain(|_, slot| matches!(slot, Slot::Making));
    }

    fn slots(&self) -> MutexGuard<'_, HashMap<K, Slot<V>>> {
        // A thread that panicked has left the map whole.
        self.slots.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Keys that one is at; what is not made of them when it ends, as where it panics, is anybody's again.
struct Claim<'a, K: Clone + Eq + Hash, V> {
    of: &'a MadeOnce<K, V>,
    keys: Vec<K>,
}

impl<K: Clone + Eq + Hash, V> Drop for Claim<'_, K, V> {
    fn drop(&mut self) {
        let mut slots = self.of.slots();
        for key in &self.keys {
            if matches!(slots.get(key), Some(Slot::Making)) {
                slots.remove(key);
            }
        }
        self.of.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn squares(keys: Vec<u64>) -> Vec<(u64, u64)> {
        keys.into_iter().map(|key| (key, key * key)).collect()
    }

    /// Whoever asks, in whatever order, has what each key is made to, and each is made once.
    #[test]
    fn each_is_made_once() {
        let (made, count, begun) = (MadeOnce::default(), AtomicUsize::new(0), Barrier::new(8));
        std::thread::scope(|scope| {
            for thread in 0..8 {
                let (made, count, begun) = (&made, &count, &begun);
                scope.spawn(move || {
                    begun.wait();
                    for round in 0..20 {
                        let mut keys: Vec<u64> = (10 * round..10 * round + 30).collect();
                        keys.rotate_left(thread * 4);
                        let found = made.of(&keys, |open| {
                            count.fetch_add(open.len(), Ordering::Relaxed);
                            std::thread::yield_now();
                            squares(open)
                        });
                        assert!(found.iter().map(|value| **value).eq(keys.iter().map(|key| key * key)));
                    }
                });
            }
        });
        assert_eq!(count.into_inner(), 220);
        made.forget();
        let mut again = 0;
        made.of(&[3, 5], |open| {
            again += open.len();
            squares(open)
        });
        assert_eq!(again, 2);
    }

    /// What one has begun and not made another one makes, who was waiting for it.
    #[test]
    fn a_maker_that_panics_leaves_it_to_others() {
        let (made, begun) = (MadeOnce::default(), Barrier::new(2));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let failed = catch_unwind(AssertUnwindSafe(|| {
                    made.of(&[1, 2], |_| {
                        begun.wait();
                        std::thread::sleep(std::time::Duration::from_millis(20));
                        panic!("for the test")
                    })
                }));
                assert!(failed.is_err());
            });
            begun.wait();
            let found = made.of(&[2, 3], squares);
            assert_eq!(found.iter().map(|value| **value).collect::<Vec<_>>(), [4, 9]);
        });
    }
}
