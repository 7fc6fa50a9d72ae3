//! How fast a device condenses bodies, and the processor beside it: measured on both, which takes a second or two.

use std::time::Instant;

use foldhash::HashMap;

use super::context::{GpuDevice, GpuError};
use super::kernels::Precision;
use super::solver::GpuCondenser;
use crate::engine::backend::Device;
use crate::engine::backend::device_solver::DeviceSolver;
use crate::engine::backend::rates::Rates;
use crate::engine::body_request::{BodyRequest, Fidelity, Group, TopologyKey};
use crate::engine::unit_costs::body_seconds;
use crate::mechanics::body::{Body, MAX_PARAMETERS, SHAPES};
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::material::Idealization;
use crate::mechanics::real::LANES;

/// Bodies that are measured, with their ratios: on the mesh that most sweeps at 1 % take, a small one and a large one.
const MEASURED: [(&str, [f64; MAX_PARAMETERS]); 2] =
    [("annulus", [3.0, 0.0, 0.0]), ("block", [4.0, 5.0, 4.5])];
const LEVEL: usize = 1;

/// No two bodies are alike, and all have one topology: their ratios are larger than these by so much at most, relative.
const SPREAD: f64 = 0.01;

/// A device gets ever more bodies at a time, until it takes so long, s, or has the most.
const LONG_ENOUGH: f64 = 0.1;
const FEWEST: usize = 64;
const MOST: usize = 16_384;

/// Batches of the processor.
const BATCHES: usize = 16;

/// What the device and one thread of the processor take.
pub fn measure(gpu: &GpuDevice, precision: Precision, solver: DeviceSolver) -> Result<Rates, GpuError> {
    let started = Instant::now();
    let mut condenser = GpuCondenser::new(gpu, precision, solver)?;
    for name_and_ratios in MEASURED {
        condense(&mut condenser, &requests(name_and_ratios, 1))?;
    }
    let start = started.elapsed().as_secs_f64();
    let mut rates = Rates { processor: 0.0, device: 0.0, host: 0.0, start };
    for name_and_ratios in MEASURED {
        let mut count = FEWEST;
        loop {
            let requests = requests(name_and_ratios, count);
            if condense(&mut condenser, &requests)?.all < LONG_ENOUGH && count < MOST {
                count *= 4;
                continue;
            }
            // The first time it makes room for so many.
            let Taken { bodies, all, host } = condense(&mut condenser, &requests)?;
            if bodies == 0 {
                let problem = format!("it has condensed no {}", name_and_ratios.0);
                let adapter = gpu.facts.name.clone();
                return Err(GpuError::Failed { adapter, what: "measuring its speed", problem });
            }
            // Of the two the one that the device is worse at: it is not to be chosen where it might be slower.
            let body = all / bodies as f64;
            rates.device = rates.device.max(body / body_seconds(&requests[0]));
            rates.host = rates.host.max(host / bodies as f64);
            break;
        }
        rates.processor += on_processor(name_and_ratios) / MEASURED.len() as f64;
    }
    Ok(rates)
}

/// Like one another, as many as are asked for.
fn requests((name, ratios): (&str, [f64; MAX_PARAMETERS]), count: usize) -> Vec<BodyRequest> {
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

fn groups(requests: &[BodyRequest]) -> Vec<Group> {
    let mut groups: HashMap<TopologyKey, Vec<BodyRequest>> = HashMap::default();
    for request in requests {
        groups.entry(TopologyKey::of(request)).or_default().push(request.clone());
    }
    groups.into_iter().collect()
}

/// What some bodies have taken, s.
struct Taken {
    /// Those that the device has condensed.
    bodies: usize,
    all: f64,
    /// Until the device had them, with what it lets wait.
    host: f64,
}

fn condense(condenser: &mut GpuCondenser, requests: &[BodyRequest]) -> Result<Taken, GpuError> {
    let groups = groups(requests);
    let started = Instant::now();
    condenser.begin(&groups)?;
    let host = started.elapsed().as_secs_f64();
    let works = condenser.finish()?;
    let all = started.elapsed().as_secs_f64();
    Ok(Taken { bodies: works.iter().flatten().flatten().count(), all, host })
}

/// Of one thread, over what `unit_costs` says; the fastest of some batches, since others may use the processor, too.
fn on_processor(name_and_ratios: (&str, [f64; MAX_PARAMETERS])) -> f64 {
    let requests = requests(name_and_ratios, LANES * BATCHES);
    let mut fastest = f64::INFINITY;
    for (key, group) in groups(&requests) {
        let bodies: Vec<Body> = group.into_iter().map(|request| request.body).collect();
        let plan = CondensationPlan::new(&bodies[0], key.grading(&bodies[0]), RingModes::of(&key.class));
        for batch in bodies.chunks_exact(LANES) {
            let started = Instant::now();
            std::hint::black_box(plan.condense(batch));
            fastest = fastest.min(started.elapsed().as_secs_f64() / LANES as f64);
        }
    }
    fastest / body_seconds(&requests[0])
}
