//! What a sweep will cost, told without solving any of it.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, RandomState};

use crate::engine::accuracy::Estimate as HowKnown;
use crate::engine::accuracy::mesh_change::Trust;
use crate::engine::interpolation::plan::InterpolationPlan;
use crate::engine::plan::JointPlan;
use crate::engine::request::{BodyRequest, Fidelity, MeshSize, TopologyKey, concentric, mesh_size};
use crate::engine::spaces::SpaceKey;
use crate::engine::unit_costs::{
    DESIGN_SECONDS, INTERPOLATED_DESIGN_SECONDS, INTERPOLATED_ROW_SECONDS, ROW_SECONDS, START_SECONDS,
    TOPOLOGY_SECONDS, batch_seconds, request_seconds, series_seconds, space_seconds, spread_seconds,
};
use crate::error::Error;
use crate::mechanics::compliance::near_field::NearFieldClass;
use crate::mechanics::compliance::ring_modes::RingModes;
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
    /// Designs that are beyond what can be solved.
    pub refused: u64,
    /// Unknowns of all meshes that the first attempt at each of the others needs.
    pub unknowns: u64,
    /// Core time, s; the threads share it.
    pub seconds: f64,
}

/// Share of the designs that go on to the next finer mesh, from each to the next; more of those whose meshes are trusted little,
/// above all where much is asked: as lists of blocks and `configs/thin-walls.toml` have it.
fn climbers(plan: &JointPlan, accuracy: f64) -> f64 {
    match plan.estimate {
        HowKnown::Exact | HowKnown::Change(Trust::SqueezedFilm) => 0.0,
        HowKnown::Known | HowKnown::Change(Trust::Concentric | Trust::Full) => 0.1,
        HowKnown::Change(Trust::Wary) if accuracy >= MUCH_ASKED => 0.2,
        HowKnown::Change(Trust::Wary) => 0.3,
    }
}

/// Below this accuracy meshes that are trusted little are often not enough.
const MUCH_ASKED: f64 = 5e-3;

/// Rungs of the ladder that fewer designs come to are left out.
const FEW: f64 = 0.05;

/// Bodies that fill the lanes of common batches.
#[derive(Default)]
struct Group {
    size: MeshSize,
    modes: usize,
    bodies: f64,
}

impl Group {
    fn seconds(&self) -> f64 {
        let batches = (self.bodies / LANES as f64).ceil();
        likely(self.bodies) * (TOPOLOGY_SECONDS + batches * batch_seconds(self.size, self.modes))
    }
}

/// How likely a thing is needed that so many bodies need on average.
fn likely(bodies: f64) -> f64 {
    bodies.min(1.0)
}

/// What the bodies of a sweep need, each thing once.
#[derive(Default)]
struct Needs {
    hasher: RandomState,
    // Hashes, not keys: 8 bytes a body keep a million designs small.
    bodies: HashSet<u64>,
    solved: HashSet<u64>,
    groups: HashMap<u64, Group>,
    /// With the size of the reference's mesh, and how many bodies need it.
    near_fields: HashMap<NearFieldClass, (MeshSize, f64)>,
    /// Highest mode by space.
    spaces: HashMap<SpaceKey, usize>,
    unknowns: u64,
    seconds: f64,
}

impl Needs {
    /// Adds a body as it is solved `times` a design, less than once where only some designs come to it.
    fn add(&mut self, request: &BodyRequest, times: f64) {
        self.bodies.insert(self.hasher.hash_one(request.body.key()));
        if !self.solved.insert(self.hasher.hash_one(request.key())) {
            return;
        }
        let Fidelity::Mesh { level } = request.fidelity else {
            self.seconds += times * request_seconds(request);
            return;
        };
        let size = mesh_size(&request.body, level);
        let topology = TopologyKey::of(request);
        let group = self.groups.entry(self.hasher.hash_one(&topology)).or_default();
        (group.size, group.modes) = (size, RingModes::of(&topology.class).count);
        group.bodies += times;
        if times == 1.0 {
            self.unknowns += size.unknowns;
        }
        for class in NearFieldClass::around(&request.body, topology.class).0 {
            // The reference has some of the body's layers; around half a ring it is that of the whole.
            let rings = if class.half_ring { 2 } else { 1 };
            let layers = class.layer_count() as u64;
            let unknowns = rings * size.unknowns * layers / size.layers;
            let (mesh, bodies) = self.near_fields.entry(class).or_default();
            *mesh = MeshSize { unknowns, layers };
            *bodies += times;
        }
    }

    /// Adds a space in which a joint of these bodies is solved `times` a design.
    fn add_space(&mut self, space: SpaceKey, plan: &JointPlan, times: f64) {
        let exact = plan.requests().filter(|request| request.fidelity == Fidelity::Series);
        for modes in exact.map(|request| concentric(&request.body).modes_needed()) {
            self.seconds += times * spread_seconds(modes, space);
            let highest = self.spaces.entry(space).or_default();
            *highest = modes.max(*highest);
        }
        self.spaces.entry(space).or_default();
    }

    fn total_seconds(&self) -> f64 {
        let of_near_field = |(class, (size, bodies)): (&NearFieldClass, &(MeshSize, f64))| {
            let modes = RingModes::of(&class.grading).count;
            let exact = LANES as f64 * series_seconds(class.reference().highest_mode());
            likely(*bodies) * (exact + batch_seconds(*size, modes))
        };
        self.seconds
            + self.spaces.iter().map(|(space, highest)| space_seconds(*space, *highest)).sum::<f64>()
            + self.groups.values().map(Group::seconds).sum::<f64>()
            + self.near_fields.iter().map(of_near_field).sum::<f64>()
    }
}

/// Goes through the designs of a study without solving any.
pub fn estimate(study: &Study) -> Result<Estimate, Error> {
    let (method, accuracy) = (study.solve.method, study.solve.accuracy);
    let mut needs = Needs::default();
    let mut estimate =
        Estimate { designs: study.design_count(), rows: study.step_count(), ..Estimate::default() };
    let interpolation = InterpolationPlan::of_study(study);
    for case in study.cases()? {
        let case = case?;
        let joint = &case.joint;
        if interpolation.as_ref().is_some_and(|plan| plan.covers(joint)) {
            estimate.interpolated += 1;
            for part in [&joint.pin, &joint.plate] {
                needs.bodies.insert(needs.hasher.hash_one(joint.body(part).key()));
            }
            continue;
        }
        if method == MethodChoice::ClosedForm {
            continue;
        }
        let Ok(first) = JointPlan::cheapest(&case, method, accuracy) else {
            estimate.refused += 1;
            continue;
        };
        let mut rung = Some((first, 1.0));
        while let Some((plan, share)) = rung.filter(|(_, share)| *share > FEW) {
            plan.requests().for_each(|request| needs.add(&request, share));
            needs.add_space(plan.space, &plan, share);
            rung = plan.finer().map(|finer| (finer, share * climbers(&plan, accuracy)));
        }
    }
    estimate.distinct_bodies = needs.bodies.len() as u64;
    estimate.unknowns = needs.unknowns;
    estimate.seconds =
        START_SECONDS + needs.total_seconds() + interpolation.map_or(0.0, |plan| plan.seconds());
    let steps = estimate.rows as f64 / (estimate.designs as f64).max(1.0);
    let (interpolated, refused) = (estimate.interpolated as f64, estimate.refused as f64);
    estimate.seconds += (estimate.designs as f64 - interpolated - refused)
        * (DESIGN_SECONDS + steps * ROW_SECONDS)
        + interpolated * (INTERPOLATED_DESIGN_SECONDS + steps * INTERPOLATED_ROW_SECONDS);
    Ok(estimate)
}
