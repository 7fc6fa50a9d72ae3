//! What a sweep will cost, told without solving any of it.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, RandomState};

use crate::engine::interpolation::plan::InterpolationPlan;
use crate::engine::plan::JointPlan;
use crate::engine::request::{Fidelity, MeshSize, TopologyKey, mesh_size};
use crate::engine::unit_costs::{
    DESIGN_SECONDS, INTERPOLATED_DESIGN_SECONDS, INTERPOLATED_ROW_SECONDS, REFERENCE_TERMS, ROW_SECONDS,
    SERIES_SECONDS, SPACE_SECONDS, TOPOLOGY_SECONDS, batch_seconds,
};
use crate::error::Error;
use crate::mechanics::real::LANES;
use crate::study::config::{MethodChoice, Study};

/// What a sweep will take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    pub designs: u64,
    pub rows: u64,
    pub distinct_bodies: u64,
    /// Designs whose bodies are interpolated.
    pub interpolated: u64,
    /// Unknowns of all meshes that the first attempt at each of the others needs.
    pub unknowns: u64,
    /// Core time, s; the threads share it.
    pub seconds: f64,
}

/// Share of the bodies that are solved again on the next finer mesh.
const CLIMBERS: f64 = 0.1;

/// Bodies that fill the lanes of common batches.
#[derive(Default)]
struct Group {
    size: MeshSize,
    half_ring: bool,
    bodies: f64,
}

impl Group {
    fn seconds(&self) -> f64 {
        // The near field's mesh is that of a whole ring.
        let rings = if self.half_ring { 2 } else { 1 };
        let near_field = MeshSize { unknowns: rings * self.size.unknowns, ..self.size };
        let batches = (self.bodies / LANES as f64).ceil();
        TOPOLOGY_SECONDS + batch_seconds(near_field) + batches * batch_seconds(self.size)
    }
}

/// Goes through the designs of a study without solving any.
pub fn estimate(study: &Study) -> Result<Estimate, Error> {
    let method = study.solve.method;
    let accuracy = study.solve.accuracy;
    let hasher = RandomState::new();
    // Hashes, not keys: 8 bytes a body keep a million designs small.
    let (mut bodies, mut solved) = (HashSet::new(), HashSet::new());
    let mut spaces = HashSet::new();
    let mut groups: HashMap<u64, Group> = HashMap::new();
    let mut estimate =
        Estimate { designs: study.design_count(), rows: study.step_count(), ..Estimate::default() };
    let interpolation = InterpolationPlan::of_study(study);
    for case in study.cases()? {
        let case = case?;
        let joint = &case.joint;
        if interpolation.as_ref().is_some_and(|plan| plan.covers(joint)) {
            estimate.interpolated += 1;
            for part in [&joint.pin, &joint.plate] {
                bodies.insert(hasher.hash_one(joint.body(part).key()));
            }
            continue;
        }
        let first =
            JointPlan::cheapest(&case, method, accuracy).filter(|_| method != MethodChoice::ClosedForm);
        let next = first.and_then(|plan| plan.finer());
        for (plan, is_first) in [(first, true), (next, false)] {
            for request in plan.iter().flat_map(JointPlan::requests) {
                bodies.insert(hasher.hash_one(request.body.key()));
                spaces.insert(request.space);
                if !solved.insert(hasher.hash_one(request.key())) {
                    continue;
                }
                let Fidelity::Mesh { level } = request.fidelity else {
                    estimate.seconds += SERIES_SECONDS;
                    continue;
                };
                let group = groups.entry(hasher.hash_one(TopologyKey::of(&request))).or_default();
                group.half_ring = request.space.half_ring;
                group.size = mesh_size(&request.body, level);
                if is_first {
                    group.bodies += 1.0;
                    estimate.unknowns += group.size.unknowns;
                } else {
                    group.bodies += CLIMBERS;
                }
            }
        }
    }
    estimate.distinct_bodies = bodies.len() as u64;
    let of_space = |terms: usize| SPACE_SECONDS * (terms as f64 / REFERENCE_TERMS).powi(2);
    estimate.seconds += spaces.iter().map(|space| of_space(space.terms)).sum::<f64>()
        + groups.values().map(Group::seconds).sum::<f64>()
        + interpolation.map_or(0.0, |plan| plan.seconds());
    let steps = estimate.rows as f64 / (estimate.designs as f64).max(1.0);
    let interpolated = estimate.interpolated as f64;
    estimate.seconds += (estimate.designs as f64 - interpolated) * (DESIGN_SECONDS + steps * ROW_SECONDS)
        + interpolated * (INTERPOLATED_DESIGN_SECONDS + steps * INTERPOLATED_ROW_SECONDS);
    Ok(estimate)
}
