//! How fast the processor of this machine is just now, beside the one whose times `unit_costs` are.

use std::sync::RwLock;
use std::time::{Duration, Instant};

use foldhash::HashMap;

use crate::engine::body_request::{BodyHandle, BodyRequest, Fidelity, Group, Meshed, TopologyKey, mesh_size};
use crate::engine::threads::{joined, spawned};
use crate::engine::unit_costs::{Pace, Time, body_seconds, topology};
use crate::mechanics::body::{Body, MAX_PARAMETERS, SHAPES};
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::material::Idealization;
use crate::mechanics::real::LANES;

/// Bodies that are measured, with their ratios: on the mesh that most sweeps at 1 % take, a small one and a large one.
pub const MEASURED: [(&str, [f64; MAX_PARAMETERS]); 2] =
    [("annulus", [3.0, 0.0, 0.0]), ("block", [4.0, 5.0, 4.5])];
/// Of their meshes.
pub const LEVEL: usize = 1;

/// No two bodies are alike, and all have one topology: their ratios are larger than these by so much at most, relative.
const SPREAD: f64 = 0.01;

/// How long each thread of the processor is measured.
const AT_WORK: Duration = Duration::from_millis(20);

/// A topology of the processor, with bodies that fill its lanes.
struct MeasuredTopology {
    key: TopologyKey,
    bodies: Vec<Body>,
    plan: CondensationPlan,
    /// What `unit_costs` says of them.
    foreseen: Time,
}

impl MeasuredTopology {
    fn new(name_and_ratios: (&str, [f64; MAX_PARAMETERS])) -> MeasuredTopology {
        let requests = requests(name_and_ratios, LANES);
        let group = groups(&requests).pop();
        let (key, group) =
            group.unwrap_or_else(|| unreachable!("there are some bodies, all of one topology"));
        let bodies: Vec<Body> = group.into_iter().map(|meshed| meshed.body).collect();
        let modes = RingModes::of(&key.class);
        let (size, in_lanes) = (mesh_size(&bodies[0], LEVEL), LANES as f64 * body_seconds(&requests[0]));
        let foreseen = Time { in_lanes, others: topology(size, modes.count).seconds() };
        MeasuredTopology { plan: Self::planned(&key, &bodies[0]), key, bodies, foreseen }
    }

    fn planned(key: &TopologyKey, body: &Body) -> CondensationPlan {
        CondensationPlan::new(body, key.grading(body), RingModes::of(&key.class))
    }

    /// The shortest of many times over what was foreseen: others may use the processor, too.
    fn pace(&self) -> Pace {
        let shortest = |work: &dyn Fn()| {
            let (begun, mut shortest) = (Instant::now(), f64::INFINITY);
            while begun.elapsed() < AT_WORK {
                let started = Instant::now();
                work();
                shortest = shortest.min(started.elapsed().as_secs_f64());
            }
            shortest
        };
        let in_lanes = shortest(&|| _ = std::hint::black_box(self.plan.condense(&self.bodies)));
        let others = shortest(&|| _ = std::hint::black_box(Self::planned(&self.key, &self.bodies[0])));
        Pace { in_lanes: in_lanes / self.foreseen.in_lanes, others: others / self.foreseen.others }
    }
}

/// The mean over all threads, each while all are at work: those of a core share it, and clocks are lower.
pub fn measured_pace() -> Pace {
    let measured = MEASURED.map(MeasuredTopology::new);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let gate = RwLock::new(());
    let paces = || {
        drop(gate.read());
        measured.each_ref().map(MeasuredTopology::pace)
    };
    let all: Vec<Pace> = std::thread::scope(|scope| {
        let shut = gate.write();
        // As many as the system gives.
        let others: Vec<_> = (1..threads).map_while(|_| spawned(scope, paces).ok()).collect();
        drop(shut);
        std::iter::once(paces()).chain(others.into_iter().map(joined)).flatten().collect()
    });
    let mean = |of: fn(&Pace) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    Pace { in_lanes: mean(|pace| pace.in_lanes), others: mean(|pace| pace.others) }
}

/// Like one another, as many as are asked for.
pub fn requests((name, ratios): (&str, [f64; MAX_PARAMETERS]), count: usize) -> Vec<BodyRequest> {
    let shape = SHAPES.into_iter().find(|shape| shape.name == name);
    let shape = shape.unwrap_or_else(|| unreachable!("no shape is called {name}"));
    let request = |i: usize| {
        let larger = 1.0 + SPREAD * i as f64 / count as f64;
        let mut body = Body::concentric(2.0, 0.3, Idealization::PlaneStress);
        (body.shape, body.parameters) = (shape, ratios.map(|ratio| ratio * larger));
        // Of those that can be held in several ways the last, which asks least of a precision.
        body.support = shape.supports.len().saturating_sub(1);
        BodyRequest { body, fidelity: Fidelity::Mesh { level: LEVEL } }
    };
    (0..count).map(request).collect()
}

/// By topology, each body by its place among the requests.
pub fn groups(requests: &[BodyRequest]) -> Vec<Group> {
    let mut groups: HashMap<TopologyKey, Vec<Meshed>> = HashMap::default();
    for (place, request) in requests.iter().enumerate() {
        let meshed = Meshed { handle: BodyHandle::of(place), body: request.body.clone(), around: None };
        groups.entry(TopologyKey::of(request)).or_default().push(meshed);
    }
    groups.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each part is measured by work of its own.
    #[test]
    fn a_machine_has_a_pace() {
        let Pace { in_lanes, others } = measured_pace();
        assert!([in_lanes, others].iter().all(|pace| (0.05..50.0).contains(pace)), "{in_lanes} {others}");
        assert!(in_lanes != others);
    }
}
