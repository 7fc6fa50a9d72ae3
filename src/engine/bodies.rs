//! The distinct bodies of a sweep: each is solved once, in batches of one topology, and kept while it is in use.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use foldhash::{HashMap, HashSet};
use rayon::prelude::*;

use crate::engine::backend::Device;
use crate::engine::backend::adapter::GpuError;
use crate::engine::body_request::{BodyRequest, Fidelity, Group, RequestKey, TopologyKey, concentric};
use crate::engine::near_fields::NearFieldLibrary;
use crate::engine::outcome::BackendKind;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::NearFieldClass;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::{BodyCompliance, Boundary};
use crate::mechanics::real::LANES;

/// Solves bodies and remembers them, with everything that many bodies share.
#[derive(Default)]
pub struct BodyLibrary<'a> {
    near_fields: NearFieldLibrary,
    plans: HashMap<TopologyKey, CondensationPlan>,
    solved: HashMap<RequestKey, SolvedBody>,
    device: Option<Box<dyn Device + 'a>>,
    /// Why the device was given up: it is only asked what it has done.
    lost: Option<GpuError>,
    /// Time spent in each stage, summed over threads.
    pub times: BodyTimes,
}

/// A body with what has condensed it.
#[derive(Clone)]
pub struct SolvedBody {
    pub compliance: Arc<BodyCompliance>,
    pub backend: BackendKind,
}

/// Where a library's time went, summed over threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyTimes {
    pub shared: Duration,
    pub condense: Duration,
    pub series: Duration,
}

/// Solved bodies beyond these many bytes are dropped before the next ones are solved, but for those asked for.
const KEPT_BODIES: usize = 4 << 20;

/// And plans: a list of a million different blocks takes no more memory than one of a thousand.
const KEPT_PLANS: usize = 64 << 20;

/// No more bodies are solved at a time than need so many near fields.
const PORTION: usize = 1000;

impl<'a> BodyLibrary<'a> {
    /// Which condenses on a device as long as that lasts.
    pub fn on(device: Box<dyn Device + 'a>) -> BodyLibrary<'a> {
        BodyLibrary { device: Some(device), ..BodyLibrary::default() }
    }

    pub fn device(&self) -> Option<&(dyn Device + 'a)> {
        self.device.as_deref()
    }

    /// Why the device was given up, if it was.
    pub fn lost(&self) -> Option<&GpuError> {
        self.lost.as_ref()
    }

    /// Forgets solved bodies, but not what they share.
    pub fn forget(&mut self) {
        self.solved.clear();
    }

    /// A solved body. Every request since the last `solve` has an answer.
    pub fn solved(&self, request: &BodyRequest) -> &SolvedBody {
        &self.solved[&request.key()]
    }

    /// Solves the requests that have no answer yet.
    pub fn solve(&mut self, requests: &[BodyRequest]) {
        let mut missing: Vec<BodyRequest> = Vec::new();
        let mut asked = HashSet::default();
        for request in requests {
            if asked.insert(request.key()) && !self.solved.contains_key(&request.key()) {
                missing.push(request.clone());
            }
        }
        if missing.is_empty() {
            return;
        }
        if self.solved.values().map(|body| body.compliance.bytes()).sum::<usize>() > KEPT_BODIES {
            self.solved.retain(|key, _| asked.contains(key));
        }
        let (series, meshed): (Vec<BodyRequest>, Vec<BodyRequest>) =
            missing.into_iter().partition(|request| request.fidelity == Fidelity::Series);
        let exact: Vec<(BodyRequest, BodyCompliance, Duration)> = series
            .into_par_iter()
            .map(|request| {
                let started = Instant::now();
                let compliance = concentric(&request.body).compliance();
                (request, compliance, started.elapsed())
            })
            .collect();
        for (request, compliance, time) in exact {
            self.times.series += time;
            self.keep(&request, compliance, BackendKind::Cpu);
        }
        let started = Instant::now();
        let portions = portions(&meshed);
        self.times.shared += started.elapsed();
        portions.into_iter().for_each(|portion| self.solve_meshed(portion));
    }

    fn keep(&mut self, request: &BodyRequest, compliance: BodyCompliance, backend: BackendKind) {
        self.solved.insert(request.key(), SolvedBody { compliance: Arc::new(compliance), backend });
    }

    fn solve_meshed(&mut self, mut groups: Vec<Group>) {
        let started = Instant::now();
        let around = |(key, group): &Group| {
            let class = key.class;
            group
                .iter()
                .map(|request| request.body.clone())
                .collect::<Vec<Body>>()
                .into_iter()
                .flat_map(move |body| NearFieldClass::around(&body, class).0)
        };
        self.near_fields.prepare(groups.iter().flat_map(around));
        self.times.shared += started.elapsed();
        if let Some(device) = self.device.as_mut().filter(|_| self.lost.is_none()) {
            match device.condense(&groups) {
                Ok(works) => groups = self.take(groups, works),
                Err(error) => self.lost = Some(error),
            }
        }
        let bytes: usize = self.plans.values().map(CondensationPlan::bytes).sum();
        if bytes > KEPT_PLANS / 2 {
            self.plans.clear();
        }
        let room = AtomicUsize::new(KEPT_PLANS / 2);
        let solved: Vec<SolvedGroup> =
            groups.into_par_iter().map(|group| self.solve_group(group, &room)).collect();
        for SolvedGroup { key, plan, plan_time, batches } in solved {
            self.times.shared += plan_time;
            self.plans.extend(plan.map(|plan| (key, plan)));
            for (solved, time) in batches {
                self.times.condense += time;
                for (request, compliance) in solved {
                    self.keep(&request, compliance, BackendKind::Cpu);
                }
            }
        }
    }

    /// Takes what a device has condensed; gives back what it has left.
    fn take(&mut self, groups: Vec<Group>, works: Vec<Vec<Option<Vec<f64>>>>) -> Vec<Group> {
        let mut left = Vec::new();
        for ((key, group), works) in groups.into_iter().zip(works) {
            let mut of_group = Vec::new();
            for (request, works) in group.into_iter().zip(works) {
                match works {
                    Some(works) => {
                        let compliance = self.corrected(&key, &request.body, works);
                        self.keep(&request, compliance, BackendKind::Gpu);
                    }
                    None => of_group.push(request),
                }
            }
            if !of_group.is_empty() {
                left.push((key, of_group));
            }
        }
        left
    }

    /// From condensed works to the compliance of a body.
    fn corrected(&self, key: &TopologyKey, body: &Body, mut works: Vec<f64>) -> BodyCompliance {
        self.near_fields.correct(body, key.class, &mut works);
        BodyCompliance::new(body, Boundary::RingModes(RingModes::of(&key.class), works))
    }

    /// Bodies of one topology; a plan that is new is kept while there is `room` for it, in bytes.
    fn solve_group(&self, (key, group): Group, room: &AtomicUsize) -> SolvedGroup {
        let started = Instant::now();
        let mut new = None;
        let plan = match self.plans.get(&key) {
            Some(known) => known,
            None => {
                let body = &group[0].body;
                new.insert(CondensationPlan::new(body, key.grading(body), RingModes::of(&key.class)))
            }
        };
        let plan_time = started.elapsed();
        let condense = |batch: &[BodyRequest]| {
            let started = Instant::now();
            let bodies: Vec<Body> = batch.iter().map(|request| request.body.clone()).collect();
            let works = plan.condense(&bodies).into_iter();
            let solved = batch
                .iter()
                .zip(works)
                .map(|(request, works)| (request.clone(), self.corrected(&key, &request.body, works)));
            (solved.collect(), started.elapsed())
        };
        let batches = group.par_chunks(LANES).map(condense).collect();
        let fits = |plan: &CondensationPlan| {
            let take = |left: usize| left.checked_sub(plan.bytes());
            room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_ok()
        };
        SolvedGroup { plan: new.filter(fits), key, plan_time, batches }
    }
}

struct SolvedGroup {
    key: TopologyKey,
    /// To be kept.
    plan: Option<CondensationPlan>,
    plan_time: Duration,
    batches: Vec<(Vec<(BodyRequest, BodyCompliance)>, Duration)>,
}

/// The requests by topology, in portions each of which ends where it needs more than `PORTION` near fields.
fn portions(requests: &[BodyRequest]) -> Vec<Vec<Group>> {
    let mut groups: HashMap<TopologyKey, Vec<BodyRequest>> = HashMap::default();
    for request in requests {
        groups.entry(TopologyKey::of(request)).or_default().push(request.clone());
    }
    let mut portions: Vec<Vec<Group>> = Vec::new();
    let mut portion = Vec::new();
    let mut near_fields: HashSet<NearFieldClass> = HashSet::default();
    for (key, group) in groups {
        for request in &group {
            near_fields.extend(NearFieldClass::around(&request.body, key.class).0);
        }
        portion.push((key, group));
        if near_fields.len() > PORTION {
            portions.push(std::mem::take(&mut portion));
            near_fields.clear();
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
        let request = |index: usize| BodyRequest {
            body: Body {
                shape: &annulus::SHAPE,
                parameters: [(0.05 + 0.05 * index as f64).exp(), 0.0, 0.0],
                support: 0,
                poissons_ratio: if index.is_multiple_of(2) { 0.3 } else { -0.3 },
                idealization: Idealization::PlaneStress,
                lining: Default::default(),
            },
            fidelity: Fidelity::Mesh { level: index % 4 },
        };
        let requests: Vec<BodyRequest> = (0..240).map(request).collect();
        let mut library = BodyLibrary::default();
        for batch in requests.chunks(24) {
            library.solve(batch);
            for request in batch {
                assert!(library.solved(request).compliance.is_finite());
            }
            let plans: usize = library.plans.values().map(CondensationPlan::bytes).sum();
            assert!(plans <= KEPT_PLANS && library.near_fields.bytes() <= 64 << 20);
        }
    }
}
