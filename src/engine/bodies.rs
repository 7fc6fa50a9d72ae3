//! The distinct bodies of a sweep: each is solved once, in batches of one topology, and kept while it is in use.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::near_fields::{NearFieldLibrary, Space};
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

/// Solved bodies kept at most, beyond those of the batch at hand.
const KEPT: usize = 4096;

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
        if self.solved.len() + missing.len() > KEPT + asked.len() {
            self.solved.retain(|key, _| asked.contains(key));
        }
        let started = Instant::now();
        self.shared.prepare(&missing);
        let (series, meshed): (Vec<_>, Vec<_>) =
            missing.iter().partition::<Vec<BodyRequest>, _>(|request| request.fidelity == Fidelity::Series);
        let batches = self.prepare_meshes(&meshed);
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
        let condensed: Vec<(Vec<(RequestKey, PressureCompliance)>, Duration)> = batches
            .par_iter()
            .map(|(plan, requests)| {
                let started = Instant::now();
                (self.condense(plan, requests), started.elapsed())
            })
            .collect();
        for (key, compliance, time) in exact {
            self.times.series += time;
            self.solved.insert(key, Arc::new(compliance));
        }
        for (solved, time) in condensed {
            self.times.condense += time;
            self.solved.extend(solved.into_iter().map(|(key, compliance)| (key, Arc::new(compliance))));
        }
    }

    fn condense(
        &self,
        plan: &TopologyKey,
        requests: &[BodyRequest],
    ) -> Vec<(RequestKey, PressureCompliance)> {
        let bodies: Vec<Body> = requests.iter().map(|request| request.body).collect();
        let mut compliances = self.plans[plan].condense(&bodies);
        for (request, compliance) in requests.iter().zip(&mut compliances) {
            self.shared.correct(request, compliance);
        }
        requests.iter().map(BodyRequest::key).zip(compliances).collect()
    }

    /// The plans of the requests; returns the requests in batches that fill the lanes of one plan.
    fn prepare_meshes(&mut self, requests: &[BodyRequest]) -> Vec<(TopologyKey, Vec<BodyRequest>)> {
        let mut groups: HashMap<TopologyKey, Vec<BodyRequest>> = HashMap::new();
        for request in requests {
            groups.entry(TopologyKey::of(request)).or_default().push(*request);
        }
        let new_plans: Vec<(TopologyKey, CondensationPlan)> = groups
            .par_iter()
            .filter(|(key, _)| !self.plans.contains_key(*key))
            .map(|(key, group)| {
                let Space { space, rings, .. } = self.shared.space(key.space);
                let grading = key.grading(&group[0].body);
                (key.clone(), CondensationPlan::new(&group[0].body, grading, space, rings))
            })
            .collect();
        self.plans.extend(new_plans);
        let batches = groups.into_iter().flat_map(|(key, group)| {
            let pieces: Vec<_> = group.chunks(LANES).map(|piece| (key.clone(), piece.to_vec())).collect();
            pieces
        });
        batches.collect()
    }
}
