//! What a sweep will cost, told without solving any of it.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, RandomState};

use crate::engine::plan::{JointPlan, first_level};
use crate::engine::request::{Fidelity, MeshSize, TopologyKey, mesh_size};
use crate::error::Error;
use crate::mechanics::body::Body;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::mechanics::real::LANES;
use crate::study::config::{MethodChoice, Study};

/// What a sweep will take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    pub designs: u64,
    pub rows: u64,
    pub distinct_bodies: u64,
    /// Unknowns of all meshes that the first attempt at each design needs.
    pub unknowns: u64,
    /// Core time, s; the threads share it.
    pub seconds: f64,
}

// Core times in seconds, measured on one core at 134 GFLOP/s (AMD EPYC of family 26, AVX-512): those of a lane batch
// fitted to `cargo bench --bench condense` (within 35 % of it at every level), those of a design and a row from
// `cargo bench --bench contact` and `table`, those of set-ups from the stages of quickstart, liu2007 and random.
// Together they are within a factor of 2 of `jointsweep bench` on these, and on sweeps of blocks.

/// Of the pressures of `REFERENCE_TERMS`; it grows with the square of the terms.
const SPACE_SECONDS: f64 = 4e-3;
const REFERENCE_TERMS: f64 = 10.0;
/// Of what bodies of one topology share, besides the lane batch in which the near field is condensed.
pub const TOPOLOGY_SECONDS: f64 = 0.8e-3;
pub const SERIES_SECONDS: f64 = 20e-6;
const DESIGN_SECONDS: f64 = 15e-6;
const ROW_SECONDS: f64 = 3e-6;

/// Share of the bodies that are solved again on the next finer mesh.
const CLIMBERS: f64 = 0.1;

/// Of one lane batch: a start, the elements and arcs, and the band's factor, as wide as a layer of the mesh.
fn batch_seconds(MeshSize { unknowns, layers }: MeshSize) -> f64 {
    let unknowns = unknowns as f64;
    let width = unknowns / layers as f64;
    10e-6 + unknowns * (0.4e-6 + 1e-10 * width * width)
}

/// Of one body on a mesh among many.
pub fn body_seconds(body: &Body, level: usize) -> f64 {
    batch_seconds(mesh_size(body, level)) / LANES as f64
}

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
    let first = first_level(study.solve.accuracy);
    let hasher = RandomState::new();
    // Hashes, not keys: 8 bytes a body keep a million designs small.
    let (mut bodies, mut solved) = (HashSet::new(), HashSet::new());
    let mut spaces = HashSet::new();
    let mut groups: HashMap<u64, Group> = HashMap::new();
    let mut estimate =
        Estimate { designs: study.design_count(), rows: study.step_count(), ..Estimate::default() };
    for case in study.cases()? {
        let joint = case?.joint;
        for level in first..LEVEL_COUNT.min(first + 2) {
            let plan = JointPlan::new(&joint, method, level).filter(|_| method != MethodChoice::ClosedForm);
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
                if level > first {
                    group.bodies += CLIMBERS;
                } else {
                    group.bodies += 1.0;
                    estimate.unknowns += group.size.unknowns;
                }
            }
        }
    }
    estimate.distinct_bodies = bodies.len() as u64;
    let of_space = |terms: usize| SPACE_SECONDS * (terms as f64 / REFERENCE_TERMS).powi(2);
    estimate.seconds += spaces.iter().map(|space| of_space(space.terms)).sum::<f64>()
        + groups.values().map(Group::seconds).sum::<f64>()
        + estimate.designs as f64 * DESIGN_SECONDS
        + estimate.rows as f64 * ROW_SECONDS;
    Ok(estimate)
}
