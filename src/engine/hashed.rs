//! Keys that bring their hash: made by many threads, looked up by one.

use std::hash::{BuildHasher, Hash, Hasher};

use foldhash::fast::FixedState;

/// A key with its hash: maps hash that alone, and compare whole keys only where the hashes are equal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hashed<K> {
    hash: u64,
    pub key: K,
}

impl<K: Hash> Hashed<K> {
    pub fn new(key: K) -> Hashed<K> {
        Hashed { hash: FixedState::with_seed(0).hash_one(&key), key }
    }
}

impl<K> Hashed<K> {
    pub fn own_hash(&self) -> u64 {
        self.hash
    }
}

impl<K> Hash for Hashed<K> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.hash);
    }
}
