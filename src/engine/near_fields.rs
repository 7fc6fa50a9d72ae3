//! What many bodies share whatever computes them: pressure spaces with their moments, and the near fields of classes.
//! Each is made once and kept.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::engine::request::{BodyRequest, ELEMENT, Fidelity, SpaceKey, concentric};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::NODE_COUNT;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass, PoissonRange};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::grading::GradingClass;

/// Bodies with one of these share a near field.
pub type NearFieldKey = (NearFieldClass, SpaceKey);

/// A pressure space with the moments that `series` needs of it.
pub struct Space {
    pub space: PressureSpace,
    pub moments: Vec<[f64; NODE_COUNT]>,
    pub highest: usize,
}

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

    /// A near field that was prepared.
    pub fn near_field(&self, key: &NearFieldKey) -> &NearField {
        &self.near_fields[key]
    }

    /// Makes all that `requests` need and that is not there yet.
    pub fn prepare(&mut self, requests: &[BodyRequest]) {
        let mut near_fields: HashSet<NearFieldKey> = HashSet::new();
        let mut needs: HashMap<SpaceKey, usize> = HashMap::new();
        for request in requests {
            let highest = match request.fidelity {
                Fidelity::Series => concentric(&request.body).highest_mode(),
                Fidelity::Mesh { .. } => {
                    let key = near_field_key(request);
                    if self.near_fields.contains_key(&key) {
                        continue;
                    }
                    let highest = key.0.highest_mode();
                    near_fields.insert(key);
                    highest
                }
            };
            let most = needs.entry(request.space).or_default();
            *most = highest.max(*most);
        }
        self.prepare_spaces(needs);
        let made: Vec<(NearFieldKey, NearField)> = near_fields
            .into_par_iter()
            .map(|key| {
                let Space { space, moments, highest } = &self.spaces[&key.1];
                (key, NearField::new(&key.0, space, moments, *highest))
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
                let space = match old {
                    Some(old) => old.space,
                    None => PressureSpace::new(key.terms, key.limit()),
                };
                let moments = space.moments(highest);
                (key, Space { space, moments, highest })
            })
            .collect();
        self.spaces.extend(made);
    }
}

/// The near field of a body on a mesh.
pub fn near_field_key(request: &BodyRequest) -> NearFieldKey {
    let Body { shape, idealization, poissons_ratio, .. } = request.body;
    let level = match request.fidelity {
        Fidelity::Mesh { level } => level,
        Fidelity::Series => unreachable!("an exact body has no near field"),
    };
    let grading = GradingClass::of(&request.body, ELEMENT, level);
    let half_ring = shape.end_angle < std::f64::consts::PI;
    let range = PoissonRange::of(poissons_ratio, idealization);
    (NearFieldClass { side: shape.side, half_ring, grading, idealization, range }, request.space)
}
