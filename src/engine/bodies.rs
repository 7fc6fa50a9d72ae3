//! The distinct bodies of a sweep: each is solved once, in batches of one topology, and kept while it is in use.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::mechanics::body::{Body, BodyKey};
use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass, PoissonRange};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::series::ConcentricBody;
use crate::mechanics::element::ElementKind;
use crate::mechanics::grading::GradingClass;
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::held_columns;
use crate::mechanics::real::LANES;

/// Which `PressureSpace` a body is solved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SpaceKey {
    /// Whether the pin's ring ends at pi/2.
    pub half_ring: bool,
    pub terms: usize,
}

impl SpaceKey {
    /// The largest contact half angle, rad: just short of a half ring's end, where its face is held, and beyond any
    /// free contact of a whole ring.
    pub fn limit(self) -> f64 {
        if self.half_ring { 1.54 } else { 2.4 }
    }
}

/// How a body's compliance is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fidelity {
    /// Exact, mode by mode; concentric bodies only.
    Series,
    /// On a mesh of this level.
    Mesh { level: usize },
}

/// A body to solve.
#[derive(Clone, Copy, Debug)]
pub struct BodyRequest {
    pub body: Body,
    pub fidelity: Fidelity,
    pub space: SpaceKey,
}

/// Equal for requests with the same answer.
pub type RequestKey = (BodyKey, Fidelity, SpaceKey);

impl BodyRequest {
    pub fn key(&self) -> RequestKey {
        (self.body.key(), self.fidelity, self.space)
    }
}

/// The elements of every mesh: the error of a compliance is of fourth order with Q8, of second with Q4 (tests/lame.rs).
const ELEMENT: ElementKind = ElementKind::Quad8;

/// How large a body's mesh is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshSize {
    pub unknowns: u64,
    pub layers: u64,
}

/// The size of a body's mesh at a level.
pub fn mesh_size(body: &Body, level: usize) -> MeshSize {
    let class = GradingClass::of(body, ELEMENT, level);
    let columns = class.grading(body.shape.end_angle).angles.len() as u64 - 1;
    let layers = class.layer_count as u64;
    // Two unknowns a node: corner rows of 2 columns + 1 nodes, mid-side rows of columns + 1; supports are few.
    MeshSize { unknowns: 2 * layers * (3 * columns + 2), layers }
}

/// What is alike for bodies whose meshes of a level can be condensed side by side.
pub fn topology(request: &BodyRequest, level: usize) -> impl std::hash::Hash + use<> {
    plan_key(request, GradingClass::of(&request.body, ELEMENT, level))
}

/// Bodies of one plan share their topology and can fill the lanes of one batch.
#[derive(Clone, PartialEq, Eq, Hash)]
struct PlanKey {
    shape: &'static str,
    idealization: Idealization,
    held: Vec<bool>,
    class: GradingClass,
    space: SpaceKey,
}

type NearFieldKey = (NearFieldClass, SpaceKey);

/// A pressure space with the moments that `series` needs of it.
struct Space {
    space: PressureSpace,
    moments: Vec<f64>,
    highest: usize,
}

/// Solves bodies and remembers them, with everything that many bodies share.
#[derive(Default)]
pub struct BodyLibrary {
    spaces: HashMap<SpaceKey, Space>,
    plans: HashMap<PlanKey, CondensationPlan>,
    near_fields: HashMap<NearFieldKey, NearField>,
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
        &self.spaces[&key].space
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
        self.prepare_spaces(missing.iter().map(|request| match request.fidelity {
            Fidelity::Series => (request.space, concentric(&request.body).highest_mode()),
            Fidelity::Mesh { .. } => (request.space, 0),
        }));
        let (series, meshed): (Vec<_>, Vec<_>) =
            missing.iter().partition::<Vec<BodyRequest>, _>(|request| request.fidelity == Fidelity::Series);
        let batches = self.prepare_meshes(&meshed);
        self.times.shared += started.elapsed();

        let exact: Vec<(RequestKey, PressureCompliance, Duration)> = series
            .par_iter()
            .map(|request| {
                let started = Instant::now();
                let Space { space, moments, highest } = &self.spaces[&request.space];
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

    fn condense(&self, plan: &PlanKey, requests: &[BodyRequest]) -> Vec<(RequestKey, PressureCompliance)> {
        let bodies: Vec<Body> = requests.iter().map(|request| request.body).collect();
        let mut compliances = self.plans[plan].condense(&bodies);
        for (request, compliance) in requests.iter().zip(&mut compliances) {
            let near_field = &self.near_fields[&near_field_key(request, plan.class)];
            near_field.correct(self.space(request.space), request.body.poissons_ratio, compliance);
        }
        requests.iter().map(BodyRequest::key).zip(compliances).collect()
    }

    /// Makes the pressure spaces that are asked for, each with its moments up to a mode.
    fn prepare_spaces(&mut self, needs: impl Iterator<Item = (SpaceKey, usize)>) {
        let mut highest: HashMap<SpaceKey, usize> = HashMap::new();
        for (key, needed) in needs {
            let entry = highest.entry(key).or_default();
            *entry = needed.max(*entry);
        }
        let known = |key: &SpaceKey| self.spaces.get(key).map(|space| space.highest);
        highest.retain(|key, highest| known(key).is_none_or(|known| known < *highest));
        let stale: Vec<(SpaceKey, usize, Option<Space>)> =
            highest.into_iter().map(|(key, highest)| (key, highest, self.spaces.remove(&key))).collect();
        let built: Vec<(SpaceKey, Space)> = stale
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
        self.spaces.extend(built);
    }

    /// The plans and near fields of the requests; returns the requests in batches that fill the lanes of one plan.
    fn prepare_meshes(&mut self, requests: &[BodyRequest]) -> Vec<(PlanKey, Vec<BodyRequest>)> {
        let mut groups: HashMap<PlanKey, Vec<BodyRequest>> = HashMap::new();
        let mut near_fields: HashSet<NearFieldKey> = HashSet::new();
        for request in requests {
            let Fidelity::Mesh { level } = request.fidelity else { continue };
            let class = GradingClass::of(&request.body, ELEMENT, level);
            let near_field = near_field_key(request, class);
            if !self.near_fields.contains_key(&near_field) {
                near_fields.insert(near_field);
            }
            groups.entry(plan_key(request, class)).or_default().push(*request);
        }
        self.prepare_spaces(near_fields.iter().map(|(class, space)| (*space, class.highest_mode())));
        let new_plans: Vec<(PlanKey, CondensationPlan)> = groups
            .par_iter()
            .filter(|(key, _)| !self.plans.contains_key(*key))
            .map(|(key, group)| {
                let body = &group[0].body;
                let grading = key.class.grading(body.shape.end_angle);
                (key.clone(), CondensationPlan::new(body, grading, self.space(key.space)))
            })
            .collect();
        let new_near_fields: Vec<(NearFieldKey, NearField)> = near_fields
            .into_par_iter()
            .map(|key| {
                let Space { space, moments, highest } = &self.spaces[&key.1];
                (key, NearField::new(&key.0, space, moments, *highest))
            })
            .collect();
        self.plans.extend(new_plans);
        self.near_fields.extend(new_near_fields);
        let batches = groups.into_iter().flat_map(|(key, group)| {
            let pieces: Vec<_> = group.chunks(LANES).map(|piece| (key.clone(), piece.to_vec())).collect();
            pieces
        });
        batches.collect()
    }
}

fn plan_key(request: &BodyRequest, class: GradingClass) -> PlanKey {
    let body = &request.body;
    // Only where the far boundary is partly held does the topology depend on the body's own ratios.
    let held = if body.shape.straight_boundary {
        held_columns(body, &class.grading(body.shape.end_angle))
    } else {
        Vec::new()
    };
    PlanKey { shape: body.shape.name, idealization: body.idealization, held, class, space: request.space }
}

fn near_field_key(request: &BodyRequest, class: GradingClass) -> NearFieldKey {
    let Body { shape, idealization, poissons_ratio, .. } = request.body;
    let half_ring = shape.end_angle < std::f64::consts::PI;
    let range = PoissonRange::of(poissons_ratio);
    (NearFieldClass { side: shape.side, half_ring, grading: class, idealization, range }, request.space)
}

fn concentric(body: &Body) -> ConcentricBody {
    ConcentricBody {
        fixed_radius: body.parameters[0],
        poissons_ratio: body.poissons_ratio,
        idealization: body.idealization,
    }
}
