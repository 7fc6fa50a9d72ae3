//! The distinct bodies of a batch of joints, in the order of their slots: exact ones first, then those on meshes, group after
//! group, so that a batch of bodies fills a run of slots.

use std::collections::HashMap;
use std::ops::Range;

use rayon::prelude::*;

use super::contact::{NO_SLOT, NOTHING};
use crate::engine::plan::{Compared, JointPlan};
use crate::engine::request::{BodyRequest, Fidelity, RequestKey, TopologyKey};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::study::design::DesignCase;

/// Bodies with one of these go in common batches: one topology, one near field.
pub(super) type GroupKey = (TopologyKey, PoissonRange);

/// The bodies of one group, as a run of slots.
pub(super) struct BodyGroup {
    pub(super) key: GroupKey,
    pub(super) slots: Range<usize>,
}

/// Bodies by their slots.
pub(super) struct DistinctBodies {
    pub(super) requests: Vec<BodyRequest>,
    pub(super) groups: Vec<BodyGroup>,
}

impl DistinctBodies {
    /// `requests` put in the order of their groups, which come as they are first met.
    pub(super) fn new(requests: Vec<BodyRequest>) -> DistinctBodies {
        Self::ordered(requests).0
    }

    /// And the slot of each request.
    fn ordered(requests: Vec<BodyRequest>) -> (DistinctBodies, Vec<u32>) {
        let keys: Vec<Option<GroupKey>> = requests.par_iter().with_min_len(64).map(group_key).collect();
        let mut exact: Vec<usize> = Vec::new();
        let mut members: Vec<(GroupKey, Vec<usize>)> = Vec::new();
        let mut known: HashMap<GroupKey, usize> = HashMap::new();
        for (index, key) in keys.into_iter().enumerate() {
            let Some(key) = key else {
                exact.push(index);
                continue;
            };
            let group = *known.entry(key).or_insert_with_key(|key| {
                members.push((key.clone(), Vec::new()));
                members.len() - 1
            });
            members[group].1.push(index);
        }
        let mut order = exact;
        let groups = members
            .into_iter()
            .map(|(key, own)| {
                let first = order.len();
                order.extend(own);
                BodyGroup { key, slots: first..order.len() }
            })
            .collect();
        let mut slots = vec![0; requests.len()];
        for (slot, index) in (0..).zip(&order) {
            slots[*index] = slot;
        }
        let requests = order.iter().map(|index| requests[*index]).collect();
        (DistinctBodies { requests, groups }, slots)
    }

    /// The bodies of a group.
    pub(super) fn of(&self, group: &BodyGroup) -> Vec<Body> {
        self.requests[group.slots.clone()].iter().map(|request| request.body).collect()
    }
}

/// `None` for an exact body.
fn group_key(request: &BodyRequest) -> Option<GroupKey> {
    let range = PoissonRange::of(request.body.poissons_ratio, request.body.idealization);
    (request.fidelity != Fidelity::Series).then(|| (TopologyKey::of(request), range))
}

/// The distinct bodies of joints, and the slots of each joint: pin, plate, and what either is compared with.
pub(super) fn distinct(joints: &[(&DesignCase, JointPlan)]) -> (DistinctBodies, Vec<[u32; 4]>) {
    let mut known: HashMap<RequestKey, usize> = HashMap::new();
    let mut requests = Vec::new();
    let mut place = |request: BodyRequest| {
        *known.entry(request.key()).or_insert_with(|| {
            requests.push(request);
            requests.len() - 1
        })
    };
    // Of what a body is compared with where it is a body, else the sentinel.
    let mut other = |compared: Compared| match compared {
        Compared::Not => Err(NO_SLOT),
        Compared::WithNothing => Err(NOTHING),
        Compared::With(request) => Ok(place(request)),
    };
    let places: Vec<[Result<usize, u32>; 4]> = joints
        .iter()
        .map(|(_, plan)| {
            let JointPlan { pin, plate, .. } = plan;
            [Compared::With(*pin), Compared::With(*plate), plan.compared(pin), plan.compared(plate)]
                .map(&mut other)
        })
        .collect();
    let (bodies, slots) = DistinctBodies::ordered(requests);
    let slot = |place: Result<usize, u32>| place.map_or_else(|sentinel| sentinel, |place| slots[place]);
    (bodies, places.into_iter().map(|places| places.map(slot)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::request::SpaceKey;
    use crate::mechanics::body::{annulus, cored_disc};
    use crate::mechanics::material::Idealization;

    /// An annulus of a ratio or, below 1, a disc with a core.
    fn request(ratio: f64, poissons_ratio: f64, fidelity: Fidelity) -> BodyRequest {
        let shape = if ratio > 1.0 { &annulus::SHAPE } else { &cored_disc::SHAPE };
        let parameters = [ratio, 0.0, 0.0];
        let idealization = Idealization::PlaneStress;
        let body = Body { shape, parameters, support: 0, poissons_ratio, idealization };
        BodyRequest { body, fidelity, space: SpaceKey { half_ring: false, terms: 10 } }
    }

    #[test]
    fn bodies_of_a_group_have_slots_side_by_side() {
        let mesh = Fidelity::Mesh { level: 1 };
        let requests = [
            request(3.0, 0.3, mesh),
            request(0.1, 0.3, mesh),
            request(3.01, 0.2, mesh),
            // The same mesh, another near field.
            request(3.0, -0.3, mesh),
            request(3.0, 0.1, Fidelity::Series),
            request(0.1, 0.25, mesh),
        ];
        let (bodies, slots) = DistinctBodies::ordered(requests.to_vec());
        assert_eq!(slots, [1, 3, 2, 5, 0, 4]);
        for (request, slot) in requests.iter().zip(slots) {
            assert_eq!(bodies.requests[slot as usize].key(), request.key());
        }
        let runs: Vec<Range<usize>> = bodies.groups.iter().map(|group| group.slots.clone()).collect();
        assert_eq!(runs, [1..3, 3..5, 5..6]);
        for group in &bodies.groups {
            assert!(
                bodies.requests[group.slots.clone()]
                    .iter()
                    .all(|own| group_key(own).as_ref() == Some(&group.key))
            );
        }
    }
}
