//! What many bodies share whatever computes them: pressure spaces with their moments, and the near fields of classes.
//! Each is made once and kept.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::engine::request::{BodyRequest, ELEMENT, Fidelity, SpaceKey, concentric};
use crate::mechanics::body::Body;
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

    /// Adds the near field of a body to its condensed compliance; `keys` are its own, and were prepared.
    pub fn correct(&self, body: &Body, keys: &NearFieldKeys, compliance: &mut PressureCompliance) {
        let around = keys.around.each_ref().map(|key| self.near_field(key));
        NearField::correct(around, keys.between, body.poissons_ratio, compliance);
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

    /// Makes the spaces of exact bodies, with the moments they need, as far as they are not there yet.
    pub fn prepare_series(&mut self, requests: &[BodyRequest]) {
        let needs = requests.iter().map(|request| (request.space, concentric(&request.body).modes_needed()));
        self.prepare_spaces(needs);
    }

    /// Makes near fields, with their spaces, as far as they are not there yet. Others may be gone then.
    pub fn prepare(&mut self, keys: impl Iterator<Item = NearFieldKey>) {
        if self.bytes() > KEPT_BYTES {
            self.near_fields.clear();
        }
        let near_fields: HashSet<NearFieldKey> = keys.filter(|key| !self.has(key)).collect();
        self.prepare_spaces(near_fields.iter().map(|(class, space)| (*space, class.highest_mode())));
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
    fn prepare_spaces(&mut self, modes: impl Iterator<Item = (SpaceKey, usize)>) {
        let mut needs: HashMap<SpaceKey, usize> = HashMap::new();
        for (space, highest) in modes {
            let most = needs.entry(space).or_default();
            *most = highest.max(*most);
        }
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

/// The two near fields between which that of a body on a mesh lies.
pub struct NearFieldKeys {
    pub around: [NearFieldKey; 2],
    /// How far from the first to the second, 0 to 1.
    pub between: f64,
}

impl NearFieldKeys {
    /// Of a body whose mesh is of a class.
    pub fn new(body: &Body, class: GradingClass, space: SpaceKey) -> NearFieldKeys {
        let (around, between) = NearFieldClass::around(body, class);
        NearFieldKeys { around: around.map(|class| (class, space)), between }
    }

    pub fn of(request: &BodyRequest) -> NearFieldKeys {
        let level = match request.fidelity {
            Fidelity::Mesh { level } => level,
            Fidelity::Series => unreachable!("an exact body has no near field"),
        };
        let class = GradingClass::of(&request.body, ELEMENT, level);
        NearFieldKeys::new(&request.body, class, request.space)
    }
}
