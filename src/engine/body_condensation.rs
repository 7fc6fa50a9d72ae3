//! The processor's condensation of a portion's bodies: by topology, abreast, in the precision that each of them bears.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::single_precision::{OF_SINGLES, body_bears_singles};
use crate::engine::body_request::{Around, BodyHandle, Group, Meshed, TopologyKey};
use crate::engine::ring_loads::RingLoads;
use crate::engine::stopwatch::Stopwatch;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::lined_reference::LinedReference;
use crate::mechanics::compliance::near_field::{LoadedRing, NearField, ReferenceMesh};
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::{BodyCompliance, Boundary};
use crate::mechanics::real::LANES;
use crate::mechanics::singles::SINGLES;

/// From condensed works to the compliance of a body, by the near fields of its portion.
pub fn corrected(
    near_fields: &[&NearField],
    around: Option<Around>,
    key: &TopologyKey,
    body: &Body,
    mut works: Vec<f64>,
) -> BodyCompliance {
    if let Some(Around { classes, between }) = around {
        let around = classes.map(|place| near_fields[place as usize]);
        NearField::correct(around, between, body, &mut works);
    }
    BodyCompliance::new(body, Boundary::RingModes(RingModes::of(&key.class), works))
}

/// Bodies of one topology; a plan that is new is kept while there is `room` for it, in bytes.
pub fn condense_group(
    plans: &HashMap<TopologyKey, CondensationPlan>,
    ring_loads: &RingLoads,
    (key, mut group): Group,
    may_be_in_singles: bool,
    room: &AtomicUsize,
) -> CondensedGroup {
    let started = Stopwatch::start();
    let mut new = None;
    let plan = match plans.get(&key) {
        Some(known) => known,
        None => {
            let (body, modes) = (&group[0].body, RingModes::of(&key.class));
            let loads = ring_loads.of(&LoadedRing::of(body.shape, &key.class));
            new.insert(CondensationPlan::with_loads(body, key.grading(body), modes, &loads))
        }
    };
    let plan_time = started.elapsed();
    let condense =
        |batch: &[Meshed], condense: fn(&CondensationPlan, &[Body]) -> Vec<Vec<f64>>, rounding: f64| {
            let started = Stopwatch::start();
            let bodies: Vec<Body> = batch.iter().map(|meshed| meshed.body.clone()).collect();
            let works = batch.iter().cloned().zip(condense(plan, &bodies)).collect();
            CondensedBatch { works, rounding, time: started.elapsed() }
        };
    let in_singles = |meshed: &Meshed| may_be_in_singles && body_bears_singles(&meshed.body, &key.class);
    let (in_singles, in_double) = parted(&mut group, in_singles);
    let in_singles = in_singles
        .par_chunks(SINGLES)
        .map(|batch| condense(batch, CondensationPlan::condense_in_singles, OF_SINGLES));
    let in_double = in_double.par_chunks(LANES).map(|batch| condense(batch, CondensationPlan::condense, 0.0));
    let batches = in_singles.chain(in_double).collect();
    let fits = |plan: &CondensationPlan| {
        let take = |left: usize| left.checked_sub(plan.bytes());
        room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_ok()
    };
    CondensedGroup { plan: new.filter(fits), key, plan_time, batches }
}

/// Those that are, and the others.
fn parted<T>(all: &mut [T], is: impl Fn(&T) -> bool) -> (&[T], &[T]) {
    let mut count = 0;
    for place in 0..all.len() {
        if is(&all[place]) {
            all.swap(count, place);
            count += 1;
        }
    }
    all.split_at(count)
}

/// A body with its works, without its near field.
pub type Condensed = (Meshed, Vec<f64>);

pub struct CondensedGroup {
    pub key: TopologyKey,
    /// To be kept.
    pub plan: Option<CondensationPlan>,
    pub plan_time: Duration,
    pub batches: Vec<CondensedBatch>,
}

/// Bodies that were condensed abreast.
pub struct CondensedBatch {
    pub works: Vec<Condensed>,
    /// What that leaves of a force, relative.
    pub rounding: f64,
    pub time: Duration,
}

/// Of each lined body its reference, with the works of that.
pub fn condensed_references(
    ring_loads: &RingLoads,
    groups: &[Group],
) -> HashMap<BodyHandle, (LinedReference, Vec<f64>)> {
    let mut on_meshes: HashMap<ReferenceMesh, Vec<(BodyHandle, LinedReference)>> = HashMap::default();
    for (key, group) in groups.iter().filter(|(key, _)| key.class.is_lined()) {
        for meshed in group {
            let reference = LinedReference::of(&meshed.body, key.class);
            on_meshes.entry(reference.mesh).or_default().push((meshed.handle, reference));
        }
    }
    let condense = |(mesh, references): (ReferenceMesh, Vec<(BodyHandle, LinedReference)>)| {
        let plan = mesh.plan(&references[0].1.body, &ring_loads.of(&mesh.ring()));
        let bodies: Vec<Body> = references.iter().map(|(_, reference)| reference.body.clone()).collect();
        let works: Vec<Vec<f64>> =
            bodies.par_chunks(LANES).flat_map_iter(|bodies| plan.condense(bodies)).collect();
        let with_works = |((handle, reference), works)| (handle, (reference, works));
        references.into_iter().zip(works).map(with_works).collect::<Vec<_>>()
    };
    on_meshes.into_par_iter().flat_map_iter(condense).collect()
}

/// The groups in lanes, each of which has its own elasticity: fewer, and fuller.
pub fn of_either_idealization(groups: Vec<Group>) -> Vec<Group> {
    let mut joined: HashMap<TopologyKey, Vec<Meshed>> = HashMap::default();
    for (key, group) in groups {
        joined.entry(key.of_either_idealization()).or_default().extend(group);
    }
    joined.into_iter().collect()
}
