//! Loads of modes on rings: plans of bodies whose rings are divided alike share them.

use std::borrow::Cow;

use foldhash::{HashMap, HashSet};
use rayon::prelude::*;

use crate::mechanics::compliance::near_field::LoadedRing;

/// Those made so far: few, since rings fall into few classes.
#[derive(Default)]
pub struct RingLoads {
    known: HashMap<LoadedRing, Vec<Vec<f64>>>,
}

impl RingLoads {
    /// Makes them, as far as they are not there yet.
    pub fn prepare(&mut self, rings: impl Iterator<Item = LoadedRing>) {
        let new: HashSet<LoadedRing> = rings.filter(|ring| !self.known.contains_key(ring)).collect();
        let made: Vec<_> = new.into_par_iter().map(|ring| (ring, ring.loads())).collect();
        self.known.extend(made);
    }

    /// Made now where they were not prepared.
    pub fn of(&self, ring: &LoadedRing) -> Cow<'_, [Vec<f64>]> {
        self.known.get(ring).map_or_else(|| ring.loads().into(), |known| known.into())
    }
}
