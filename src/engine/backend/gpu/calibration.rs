//! How fast a device condenses bodies and solves joints, and the processor beside it: measured on both, which takes a second or two.

use std::time::Instant;

use super::context::{GpuDevice, GpuError};
use super::kernels::{Making, Precision};
use super::solver::GpuCondenser;
use crate::engine::backend::Device;
use crate::engine::backend::device_solver::DeviceSolver;
use crate::engine::backend::joints::{
    Amplitudes, BatchedJoint, BodyTables, DeviceBody, DeviceJoint, JointBatch, JointTables, SolvedJoints,
    states,
};
use crate::engine::backend::rates::{JointRates, Rates};
use crate::engine::body_request::{BodyRequest, TopologyKey};
use crate::engine::processor_pace::{MEASURED, groups, measured_pace, requests};
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::engine::unit_costs::{body_seconds, curve, spread_seconds};
use crate::mechanics::body::MAX_PARAMETERS;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::{BodyCompliance, Boundary};
use crate::mechanics::contact::compliance_rows::ModeMembers;
use crate::mechanics::contact::curve_space::CurveSpace;
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::outlines::Outlines;

/// A device gets ever more bodies at a time, until it takes so long, s, or has the most.
const LONG_ENOUGH: f64 = 0.1;
const FEWEST: usize = 64;
const MOST: usize = 16_384;

/// What the device, which solves these joints, and a thread of the processor take.
pub fn measure(
    gpu: &GpuDevice,
    precision: Precision,
    solver: DeviceSolver,
    solves_joints: SolvedJoints,
) -> Result<Rates, GpuError> {
    let started = Instant::now();
    let mut condenser =
        GpuCondenser::new(gpu, precision, solver, Making::Trusted)?.solving_joints(solves_joints);
    for name_and_ratios in MEASURED {
        condense(&mut condenser, &requests(name_and_ratios, 1))?;
    }
    let joint = (solves_joints > SolvedJoints::None).then(MeasuredJoint::new);
    if let Some(joint) = &joint {
        joint.solve(&mut condenser, 1)?;
    }
    let start = started.elapsed().as_secs_f64();
    let joints = joint.map(|joint| joint.rates(&mut condenser)).transpose()?;
    let processor = measured_pace();
    let mut rates = Rates { processor, device: 0.0, host: 0.0, start, joints };
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
    }
    Ok(rates)
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

/// A joint that is solved as often as one likes: of the first of the bodies measured, and a pin.
pub struct MeasuredJoint {
    bodies: [(BodyRequest, BodyCompliance); 2],
    key: SpaceKey,
    spaces: Spaces,
}

/// Its pin, how large the clearance is, and the indentations over that.
const PIN: (&str, [f64; MAX_PARAMETERS]) = ("rigid-core", [0.3, 0.0, 0.0]);
const CLEARANCE: f64 = 1e-3;
pub const INDENTATIONS: [f64; 10] = [0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 4.0, 8.0];

/// Of the space, relative, and its half angle, rad.
const ACCURACY: f64 = 0.01;
const HALF_ANGLE: f64 = 0.5;

impl MeasuredJoint {
    #[expect(clippy::new_without_default, reason = "it takes some milliseconds")]
    pub fn new() -> MeasuredJoint {
        let bodies = [PIN, MEASURED[0]].map(|name_and_ratios| {
            let request = requests(name_and_ratios, 1).remove(0);
            let (key, body) = (TopologyKey::of(&request), &request.body);
            let modes = RingModes::of(&key.class);
            let works = CondensationPlan::new(body, key.grading(body), modes).condense_alone(body);
            let compliance = BodyCompliance::new(body, Boundary::RingModes(modes, works));
            (request, compliance)
        });
        let [(pin, _), (plate, _)] = &bodies;
        let key = SpaceKey::coarsest(&pin.body, &plate.body, ACCURACY, HALF_ANGLE);
        let mut spaces = Spaces::default();
        spaces.prepare(bodies.iter().map(|(_, compliance)| (key, compliance)));
        MeasuredJoint { bodies, key, spaces }
    }

    pub fn joint(&self) -> DeviceJoint<'_> {
        let body = |side: usize| {
            let compliance = &self.bodies[side].1;
            let amplitudes = Amplitudes::Modes(self.members(side), compliance);
            DeviceBody { infinite: [compliance.even, compliance.odd], share: 1.0, amplitudes }
        };
        DeviceJoint { bodies: [body(0), body(1)], outlines: Outlines::new(CLEARANCE) }
    }

    fn members(&self, side: usize) -> ModeMembers {
        let (request, compliance) = &self.bodies[side];
        let members = ModeMembers::of(request.body.shape.side, compliance);
        members.unwrap_or_else(|| unreachable!("a body on a mesh is no bed"))
    }

    /// The space of its curve.
    pub fn space(&self) -> (SpaceKey, &CurveSpace) {
        (self.key, self.spaces.get(self.key))
    }

    /// It so many times, each under these indentations over its clearance.
    pub fn batch(&self, count: usize, indentations: &[f64]) -> JointBatch<'_> {
        let bodies = [0, 1].map(|side| BodyTables::Modes(self.members(side)));
        let tables = JointTables { bodies, space: self.space() };
        let mut batch = JointBatch { tables: vec![tables], ..JointBatch::default() };
        let joint = self.joint();
        let mut numbers = Vec::new();
        for _ in 0..count {
            let numbers_at = numbers.len() as u32;
            let loads = indentations.iter().map(|over| DimensionlessLoad::Indentation(CLEARANCE * over));
            let counts = joint.numbers(loads, &mut numbers);
            let [load_count, amplitude_count] =
                counts.unwrap_or_else(|| unreachable!("there are some loads, and not too many"));
            let condensed = [None; 2];
            batch.joints.push(BatchedJoint { tables: 0, numbers_at, load_count, amplitude_count, condensed });
        }
        batch.numbers.push(numbers);
        batch
    }

    /// So many times: from their numbers to their states, s, and what the processor does of it.
    fn solve(&self, condenser: &mut GpuCondenser, count: usize) -> Result<[f64; 2], GpuError> {
        let started = Instant::now();
        let batch = self.batch(count, &INDENTATIONS);
        let numbered = started.elapsed();
        condenser.begin_joints(&batch)?;
        let begun = started.elapsed();
        let found = condenser.finish_joints()?;
        let solved = started.elapsed();
        let (joint, size) = (self.joint(), batch.joints[0].found());
        let each = found.chunks_exact(size).map(|own| states(own, joint.even(), &joint.outlines));
        let sum: f64 = each.flatten().flat_map(|(_, states)| states).map(|found| found.state.force).sum();
        std::hint::black_box(sum);
        let host = begun + (started.elapsed() - solved);
        Ok([solved - numbered, host].map(|time| time.as_secs_f64()))
    }

    fn rates(&self, condenser: &mut GpuCondenser) -> Result<JointRates, GpuError> {
        let spread: f64 = self.bodies.iter().map(|(request, _)| spread_seconds(request, self.key)).sum();
        let on_processor = spread + curve(self.key).seconds();
        let mut count = FEWEST;
        while self.solve(condenser, count)?[0] < LONG_ENOUGH && count < MOST {
            count *= 4;
        }
        let [device, host] = self.solve(condenser, count)?.map(|time| time / count as f64);
        let on_meshes = condenser.solves_joints() == SolvedJoints::All;
        Ok(JointRates { device: device / on_processor, host, on_meshes })
    }
}
