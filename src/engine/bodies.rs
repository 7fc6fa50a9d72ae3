//! The distinct bodies of a sweep: each is solved once, in batches of one topology, and kept while it is in use.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::near_fields::{NearFieldKey, NearFieldKeys, NearFieldLibrary, Space, near_field_bytes};
use crate::engine::request::{BodyRequest, Fidelity, RequestKey, SpaceKey, TopologyKey, concentric};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::real::LANES;

/// Solves bodies and remembers them, with everything that many bodies share.
#[derive(Default)]
pub struct BodyLibrary {
    pub shared: NearFieldLibrary,
    plans: HashMap<TopologyKey, CondensationPlan>,
    solved: HashMap<RequestKey, Arc<PressureCompliance>>,
    /// Time spent in each stage, summed over threads.
    pub times: BodyTimes,
}

/// Where a library's time went, summed over threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyTimes {
    pub shared: Duration,
    pub condense: Duration,
    pub series: Duration,
}

/// Solved bodies beyond these many bytes are dropped before the next ones are solved, but for those asked for: some four
/// thousand with six trial pressures.
const KEPT_BODIES: usize = 24 << 20;

/// And plans: a list of a million different blocks takes no more memory than one of a thousand.
const KEPT_PLANS: usize = 64 << 20;

/// No more bodies are solved at a time than have near fields of so many bytes.
const PORTION_BYTES: usize = 64 << 20;

impl BodyLibrary {
    pub fn space(&self, key: SpaceKey) -> &PressureSpace {
        &self.shared.space(key).space
    }

    /// A solved body. Every request since the last `solve` has an answer.
    pub fn compliance(&self, key: &RequestKey) -> &Arc<PressureCompliance> {
        &self.solved[key]
    }

    /// Solves the requests that have no answer yet.
    pub fn solve(&mut self, requests: &[BodyRequest]) {
        let mut missing: Vec<BodyRequest> = Vec::new();
        let mut asked = HashSet::new();
        for request in requests {
            if asked.insert(request.key()) && !self.solved.contains_key(&request.key()) {
                missing.push(*request);
            }
        }
        if missing.is_empty() {
            return;
        }
        let bytes: usize = self.solved.values().map(|body| size_of_val(&body.values[..])).sum();
        if bytes > KEPT_BODIES {
            self.solved.retain(|key, _| asked.contains(key));
        }
        let (series, meshed): (Vec<_>, Vec<_>) =
            missing.iter().partition::<Vec<BodyRequest>, _>(|request| request.fidelity == Fidelity::Series);
        self.solve_series(&series);
        let started = Instant::now();
        let portions = portions(&meshed);
        self.times.shared += started.elapsed();
        portions.into_iter().for_each(|portion| self.solve_meshed(portion));
    }

    fn solve_series(&mut self, series: &[BodyRequest]) {
        let started = Instant::now();
        self.shared.prepare_series(series);
        self.times.shared += started.elapsed();
        let exact: Vec<(RequestKey, PressureCompliance, Duration)> = series
            .par_iter()
            .map(|request| {
                let started = Instant::now();
                let Space { space, moments, highest, .. } = self.shared.space(request.space);
                let compliance = concentric(&request.body).compliance(space, moments, *highest);
                (request.key(), compliance, started.elapsed())
            })
            .collect();
        for (key, compliance, time) in exact {
            self.times.series += time;
            self.solved.insert(key, Arc::new(compliance));
        }
    }

    fn solve_meshed(&mut self, groups: Vec<Group>) {
        let started = Instant::now();
        self.shared.prepare(groups.iter().flat_map(|(_, group)| group).flat_map(|(_, keys)| keys.around));
        self.times.shared += started.elapsed();
        let bytes: usize = self.plans.values().map(CondensationPlan::bytes).sum();
        if bytes > KEPT_PLANS / 2 {
            self.plans.clear();
        }
        let room = AtomicUsize::new(KEPT_PLANS / 2);
        let solved: Vec<SolvedGroup> =
            groups.into_par_iter().map(|(key, group)| self.solve_group(key, &group, &room)).collect();
        for SolvedGroup { key, plan, plan_time, batches } in solved {
            self.times.shared += plan_time;
            self.plans.extend(plan.map(|plan| (key, plan)));
            for (solved, time) in batches {
                self.times.condense += time;
                self.solved.extend(solved.into_iter().map(|(key, compliance)| (key, Arc::new(compliance))));
            }
        }
    }

    /// Bodies of one topology; a plan that is new is kept while there is `room` for it, in bytes.
    fn solve_group(&self, key: TopologyKey, group: &[Meshed], room: &AtomicUsize) -> SolvedGroup {
        let started = Instant::now();
        let mut new = None;
        let plan = match self.plans.get(&key) {
            Some(known) => known,
            None => {
                let Space { space, rings, .. } = self.shared.space(key.space);
                let body = &group[0].0.body;
                new.insert(CondensationPlan::new(body, key.grading(body), space, rings))
            }
        };
        let plan_time = started.elapsed();
        let condense = |batch: &[Meshed]| {
            let started = Instant::now();
            (self.condense(plan, batch), started.elapsed())
        };
        let batches = group.par_chunks(LANES).map(condense).collect();
        let fits = |plan: &CondensationPlan| {
            let take = |left: usize| left.checked_sub(plan.bytes());
            room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_ok()
        };
        SolvedGroup { key, plan: new.filter(fits), plan_time, batches }
    }

    fn condense(&self, plan: &CondensationPlan, batch: &[Meshed]) -> Vec<SolvedBody> {
        let bodies: Vec<Body> = batch.iter().map(|(request, _)| request.body).collect();
        let mut compliances = plan.condense(&bodies);
        for ((request, keys), compliance) in batch.iter().zip(&mut compliances) {
            self.shared.correct(&request.body, keys, compliance);
        }
        batch.iter().map(|(request, _)| request.key()).zip(compliances).collect()
    }
}

/// A body on a mesh, and its near fields.
type Meshed = (BodyRequest, NearFieldKeys);

/// Bodies of one topology.
type Group = (TopologyKey, Vec<Meshed>);

type SolvedBody = (RequestKey, PressureCompliance);

struct SolvedGroup {
    key: TopologyKey,
    /// To be kept.
    plan: Option<CondensationPlan>,
    plan_time: Duration,
    batches: Vec<(Vec<SolvedBody>, Duration)>,
}

/// The requests by topology, in portions each of which ends where its near fields take more than `PORTION_BYTES`.
fn portions(requests: &[BodyRequest]) -> Vec<Vec<Group>> {
    let mut groups: HashMap<TopologyKey, Vec<Meshed>> = HashMap::new();
    for request in requests {
        let topology = TopologyKey::of(request);
        let keys = NearFieldKeys::new(&request.body, topology.class, request.space);
        groups.entry(topology).or_default().push((*request, keys));
    }
    let mut portions: Vec<Vec<Group>> = Vec::new();
    let (mut portion, mut bytes) = (Vec::new(), 0);
    let mut near_fields: HashSet<NearFieldKey> = HashSet::new();
    for (key, group) in groups {
        for near_field in group.iter().flat_map(|(_, keys)| keys.around) {
            if near_fields.insert(near_field) {
                bytes += near_field_bytes(&near_field);
            }
        }
        portion.push((key, group));
        if bytes > PORTION_BYTES {
            portions.push(std::mem::take(&mut portion));
            near_fields.clear();
            bytes = 0;
        }
    }
    portions.push(portion);
    portions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::body::annulus;
    use crate::mechanics::material::Idealization;

    /// Bodies of ever new topologies and near fields take no more memory the more there are, and each is answered.
    #[test]
    fn what_is_kept_is_bounded() {
        let space = SpaceKey { half_ring: false, terms: 24 };
        let request = |index: usize| BodyRequest {
            body: Body {
                shape: &annulus::SHAPE,
                parameters: [(0.05 + 0.05 * index as f64).exp(), 0.0, 0.0],
                support: 0,
                poissons_ratio: if index.is_multiple_of(2) { 0.3 } else { -0.3 },
                idealization: Idealization::PlaneStress,
            },
            fidelity: Fidelity::Mesh { level: index % 4 },
            space,
        };
        let requests: Vec<BodyRequest> = (0..240).map(request).collect();
        let mut library = BodyLibrary::default();
        let mut keys: HashSet<NearFieldKey> = HashSet::new();
        for batch in requests.chunks(24) {
            library.solve(batch);
            keys.extend(batch.iter().flat_map(|request| NearFieldKeys::of(request).around));
            for request in batch {
                assert!(library.compliance(&request.key()).values.iter().all(|value| value.is_finite()));
            }
            let plans: usize = library.plans.values().map(CondensationPlan::bytes).sum();
            // What is at hand comes on top.
            assert!(plans <= KEPT_PLANS && library.shared.bytes() <= 2 * PORTION_BYTES);
        }
        let all: usize = keys.iter().map(near_field_bytes).sum();
        assert!(all > 2 * PORTION_BYTES, "{all} bytes show nothing");
    }
}
