//! What many bodies share whatever computes them: pressure spaces with their moments, and the near fields of classes.
//! Each is made once and kept.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::engine::request::{BodyRequest, ELEMENT, Fidelity, SpaceKey, concentric};
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::ring_loads::RingLoads;
use crate::mechanics::compliance::{NODE_COUNT, PressureCompliance};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::real::LANES;

/// Bodies with one of these share a near field.
pub type NearFieldKey = (NearFieldClass, SpaceKey);

/// A pressure space with the moments that `series` needs of it.
pub struct Space {
    pub space: PressureSpace,
    pub moments: Vec<[f64; NODE_COUNT]>,
    pub highest: usize,
    pub rings: RingLoads,
}

/// Near fields beyond these many bytes are dropped before the next ones are made.
const KEPT_BYTES: usize = 64 << 20;

#[derive(Default)]
pub struct NearFieldLibrary {
    spaces: HashMap<SpaceKey, Space>,
    near_fields: HashMap<NearFieldKey, NearField>,
}

impl NearFieldLibrary {
    /// A space that was prepared.
    pub fn space(&self, key: SpaceKey) -> &Space {
        &self.spaces[&key]
    }

    /// Adds the near field of a body, which was prepared, to its condensed compliance.
    pub fn correct(&self, request: &BodyRequest, compliance: &mut PressureCompliance) {
        let (around, between) = near_field_keys(request);
        let around = around.each_ref().map(|key| self.near_field(key));
        NearField::correct(around, between, request.body.poissons_ratio, compliance);
    }

    /// A near field that was prepared.
    pub fn near_field(&self, key: &NearFieldKey) -> &NearField {
        &self.near_fields[key]
    }

    /// What the near fields take.
    pub fn bytes(&self) -> usize {
        self.near_fields.keys().map(near_field_bytes).sum()
    }

    /// Whether a near field is at hand.
    pub fn has(&self, key: &NearFieldKey) -> bool {
        self.near_fields.contains_key(key)
    }

    /// Makes all that `requests` need and that is not there yet. What others needed may be gone then.
    pub fn prepare(&mut self, requests: &[BodyRequest]) {
        if self.bytes() > KEPT_BYTES {
            self.near_fields.clear();
        }
        let mut near_fields: HashSet<NearFieldKey> = HashSet::new();
        let mut needs: HashMap<SpaceKey, usize> = HashMap::new();
        for request in requests {
            let highest = match request.fidelity {
                Fidelity::Series => concentric(&request.body).modes_needed(),
                Fidelity::Mesh { .. } => {
                    let new = near_field_keys(request).0.into_iter();
                    let new = new.filter(|key| !self.has(key));
                    let highest = |key: NearFieldKey| {
                        near_fields.insert(key);
                        key.0.highest_mode()
                    };
                    match new.map(highest).max() {
                        Some(highest) => highest,
                        None => continue,
                    }
                }
            };
            let most = needs.entry(request.space).or_default();
            *most = highest.max(*most);
        }
        self.prepare_spaces(needs);
        let made: Vec<(NearFieldKey, NearField)> = near_fields
            .into_par_iter()
            .map(|key| {
                let Space { space, moments, highest, rings } = &self.spaces[&key.1];
                (key, NearField::new(&key.0, space, moments, *highest, rings))
            })
            .collect();
        self.near_fields.extend(made);
    }

    /// Spaces with their moments up to a mode.
    fn prepare_spaces(&mut self, mut needs: HashMap<SpaceKey, usize>) {
        let known = |key: &SpaceKey| self.spaces.get(key).map(|space| space.highest);
        needs.retain(|key, highest| known(key).is_none_or(|known| known < *highest));
        let stale: Vec<(SpaceKey, usize, Option<Space>)> =
            needs.into_iter().map(|(key, highest)| (key, highest, self.spaces.remove(&key))).collect();
        let made: Vec<(SpaceKey, Space)> = stale
            .into_par_iter()
            .map(|(key, highest, old)| {
                let (space, rings) = match old {
                    Some(old) => (old.space, old.rings),
                    None => (PressureSpace::new(key.terms, key.limit()), RingLoads::default()),
                };
                let moments = space.moments(highest);
                (key, Space { space, moments, highest, rings })
            })
            .collect();
        self.spaces.extend(made);
    }
}

/// What a near field takes.
pub fn near_field_bytes((_, space): &NearFieldKey) -> usize {
    LANES * NODE_COUNT * packed_count(space.terms) * size_of::<f64>()
}

/// The two near fields between which that of a body on a mesh lies, and how far from the first to the second.
pub fn near_field_keys(request: &BodyRequest) -> ([NearFieldKey; 2], f64) {
    let level = match request.fidelity {
        Fidelity::Mesh { level } => level,
        Fidelity::Series => unreachable!("an exact body has no near field"),
    };
    let grading = GradingClass::of(&request.body, ELEMENT, level);
    let (around, between) = NearFieldClass::around(&request.body, grading);
    (around.map(|class| (class, request.space)), between)
}
