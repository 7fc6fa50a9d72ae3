//! Bodies condensed on a device: what comes back is the works of each and nothing else.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use foldhash::HashMap;
use rayon::prelude::*;

use super::batch::{BodyCounts, KernelFacts, adapted, batches, most_bytes};
use super::context::{GpuDevice, GpuError};
use super::elimination::{Elimination, KeptWorks};
use super::front_topology::{FrontTopology, Job};
use super::joint_kernel::JointKernel;
use super::kernels::{Kernels, Making, Precision};
use super::layout::MeshLayout;
use super::layouts::Layout;
use super::stages::SystemBatch;
use super::works::{BodyWorks, ModeLoads};
use crate::engine::accuracy::single_precision::OF_SINGLES;
use crate::engine::backend::device_solver::DeviceSolver;
use crate::engine::backend::drawn::DrawnDesigns;
use crate::engine::backend::joints::{JointBatch, MISSING, SolvedJoints};
use crate::engine::backend::{Counts, Device, Works};
use crate::engine::body_request::{Group, TopologyKey};
use crate::engine::question::counted::Told;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::ring_modes::{Push, RingModes};
use crate::mechanics::mesh::RingTopology;
use crate::mechanics::solve::refine::RefineSettings;

/// Condenses bodies on a device; keeps what those of a topology share.
pub struct GpuCondenser<'a> {
    kernels: Kernels<'a>,
    solver: DeviceSolver,
    topologies: HashMap<TopologyKey, OnDevice>,
    elimination: Elimination,
    begun: VecDeque<Begun>,
    /// Which joints it solves, by this.
    solves_joints: SolvedJoints,
    joints: JointKernel,
    pub report: GpuReport,
}

/// Groups whose works were not asked for yet.
struct Begun {
    /// Those that are there: all but of the groups that are eliminated, whose places follow.
    works: Works,
    eliminated: Vec<usize>,
}

/// What a device has done so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct GpuReport {
    /// Bodies condensed, and the columns of their rings that were solved for.
    pub bodies: u64,
    pub solves: u64,
    /// The greatest |b - K x|/|b| of a column that works rest on.
    pub worst_residual: f64,
    /// Wall times: layouts and what bodies share; from numbers to works, without what the device does alone.
    pub preparation: Duration,
    pub condensation: Duration,
    /// Of joints, from their numbers to their states.
    pub contact: Duration,
}

/// What the bodies of a topology share on the device, as its solver takes them.
enum OnDevice {
    Eliminated(Arc<Layout>, Box<FrontTopology>),
    Iterated(Box<Topology>),
    /// Too fine a mesh for elimination.
    Left,
}

/// What conjugate gradients on the bodies of a topology share.
pub(crate) struct Topology {
    pub(crate) layout: MeshLayout,
    pub(crate) counts: BodyCounts,
    pub(crate) loads: ModeLoads,
    pub(crate) facts: KernelFacts,
}

/// Invocations of a workgroup: the twin's count of partial sums, two subgroups of the common size.
pub const INVOCATIONS: u32 = 64;

/// Time of an iteration of one body before any was measured, s: short for a processor and long for a large GPU.
pub(crate) const FIRST_GUESS: f64 = 1e-5;

/// What the bodies of topologies share, here and on the device, is dropped beyond these many bytes before more is made.
const KEPT_BYTES: u64 = 256 << 20;

/// Steps of conjugate gradients on Q8 meshes over the root of the unknowns, to a residual of 1e-6.
const STEPS_PER_ROOT: f64 = 8.0;

/// And the most they are given: nu = 0.499 in plane strain asks for eight times as many as others. Dispatches beyond what
/// is needed find nothing to do, but must be looked at.
const MOST_STEPS_PER_ROOT: f64 = 100.0;

impl<'a> GpuCondenser<'a> {
    pub fn new(
        device: &'a GpuDevice,
        precision: Precision,
        solver: DeviceSolver,
        making: Making,
    ) -> Result<GpuCondenser<'a>, GpuError> {
        Ok(GpuCondenser::with(Kernels::new(device, precision, INVOCATIONS, making)?, solver))
    }

    /// By kernels that are there.
    pub fn with(kernels: Kernels<'a>, solver: DeviceSolver) -> GpuCondenser<'a> {
        GpuCondenser {
            solves_joints: SolvedJoints::None,
            joints: JointKernel::new(kernels.making),
            kernels,
            solver,
            topologies: HashMap::default(),
            elimination: Elimination::default(),
            begun: VecDeque::new(),
            report: GpuReport::default(),
        }
    }

    /// One of so many that share the device and its memory.
    pub fn sharing(self, sharing: usize) -> GpuCondenser<'a> {
        GpuCondenser { elimination: Elimination::with_bytes(most_bytes(sharing)), ..self }
    }

    /// Which solves these joints, too, and leaves others to the processor.
    pub fn solving_joints(self, solves_joints: SolvedJoints) -> GpuCondenser<'a> {
        GpuCondenser { solves_joints, ..self }
    }
}

impl Device for GpuCondenser<'_> {
    fn rounding(&self) -> f64 {
        if self.kernels.precision == Precision::F32 { OF_SINGLES } else { 0.0 }
    }

    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        self.meet(groups)?;
        let started = Instant::now();
        let (eliminated, jobs) = self.jobs(groups);
        self.report.bodies += jobs.iter().map(|job| job.count() as u64).sum::<u64>();
        self.elimination.begin(&self.kernels, jobs)?;
        let mut works = Works::with_capacity(groups.len());
        for (key, requests) in groups {
            works.push(match self.topologies.get_mut(key) {
                Some(OnDevice::Iterated(topology)) => {
                    let bodies: Vec<Body> = requests.iter().map(|meshed| meshed.body.clone()).collect();
                    condense(&self.kernels, topology, &bodies, &mut self.report)?
                }
                _ => vec![None; requests.len()],
            });
        }
        self.begun.push_back(Begun { works, eliminated });
        self.report.condensation += started.elapsed();
        Ok(())
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        let started = Instant::now();
        let Some(Begun { mut works, eliminated }) = self.begun.pop_front() else { return Ok(Works::new()) };
        for (place, found) in eliminated.into_iter().zip(self.elimination.finish(&self.kernels)?) {
            works[place] = found;
        }
        self.report.condensation += started.elapsed();
        Ok(works)
    }

    fn solves_joints(&self) -> SolvedJoints {
        self.solves_joints
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        let started = Instant::now();
        let begun = self.joints.begin(self.kernels.gpu, batch);
        self.report.contact += started.elapsed();
        begun
    }

    fn begin_whole(&mut self, groups: &[Group], batch: &JointBatch) -> Result<bool, GpuError> {
        // The kernel of joints takes works in single precision.
        if self.kernels.precision != Precision::F32 || self.solver == DeviceSolver::Pcg {
            return Ok(false);
        }
        self.meet(groups)?;
        let started = Instant::now();
        let (eliminated, jobs) = self.jobs(groups);
        let kept = self.elimination.keep(&self.kernels, &jobs)?;
        self.report.condensation += started.elapsed();
        let Some(KeptWorks { buffer, bytes, places: of_jobs, unsent }) = kept else { return Ok(false) };
        self.report.bodies += of_jobs.len() as u64;
        let (mut places, mut of_jobs) = (Vec::new(), of_jobs.into_iter());
        let mut eliminated = eliminated.into_iter().peekable();
        for (place, (_, group)) in groups.iter().enumerate() {
            let is_there = eliminated.next_if_eq(&place).is_some();
            places.extend((0..group.len()).map(|_| match is_there {
                true => of_jobs.next().unwrap_or(MISSING),
                false => MISSING,
            }));
        }
        let started = Instant::now();
        let mut kept = KeptWorks { buffer, bytes, places, unsent };
        let begun = self.joints.begin_with(self.kernels.gpu, batch, Some(&mut kept));
        let sent = self.elimination.sent(&self.kernels, kept.unsent);
        self.report.contact += started.elapsed();
        begun.and(sent).map(|()| true)
    }

    fn begin_drawn(&mut self, drawn: &DrawnDesigns) -> Result<bool, GpuError> {
        let started = Instant::now();
        let begun = self.joints.begin_drawn(self.kernels.gpu, drawn);
        self.report.contact += started.elapsed();
        begun
    }

    fn finish_joints(&mut self) -> Result<Vec<f32>, GpuError> {
        let started = Instant::now();
        let found = self.joints.finish(self.kernels.gpu);
        self.report.contact += started.elapsed();
        found
    }

    fn finish_answers(&mut self) -> Result<Vec<Told>, GpuError> {
        let started = Instant::now();
        let told = self.joints.finish_answers(self.kernels.gpu);
        self.report.contact += started.elapsed();
        told
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        let GpuReport { preparation, condensation, contact, .. } = self.report;
        let mut stages =
            vec![("preparation on the GPU", preparation), ("condensation on the GPU", condensation)];
        if self.solves_joints > SolvedJoints::None {
            stages.push(("contact on the GPU", contact));
        }
        stages
    }

    fn counts(&self) -> Counts {
        self.elimination.counts.and(self.joints.counts)
    }

    fn worst_residual(&self) -> f64 {
        self.report.worst_residual
    }

    fn solves(&self) -> u64 {
        self.report.solves
    }
}

impl GpuCondenser<'_> {
    /// Prepares topologies that are new.
    fn meet(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        let started = Instant::now();
        if self.topologies.values().map(OnDevice::bytes).sum::<u64>() > KEPT_BYTES {
            self.topologies.clear();
            self.kernels.gpu.layouts.forget();
        }
        let new = groups.iter().filter(|(key, _)| !self.topologies.contains_key(key));
        let new: Vec<(&TopologyKey, &Body)> = new.map(|(key, group)| (key, &group[0].body)).collect();
        if self.solver == DeviceSolver::Pcg {
            for (key, body) in new {
                let topology = Topology::new(&self.kernels, key, body)?;
                self.topologies.insert(key.clone(), OnDevice::Iterated(Box::new(topology)));
            }
        } else {
            let layouts = self.kernels.gpu.layouts.of(&new);
            for ((key, _), layout) in new.into_iter().zip(layouts) {
                self.topologies.insert(key.clone(), OnDevice::new(&self.kernels, layout)?);
            }
        }
        self.report.preparation += started.elapsed();
        Ok(())
    }

    /// The groups that are eliminated: their places, and their bodies.
    fn jobs(&self, groups: &[Group]) -> (Vec<usize>, Vec<Job>) {
        let topologies = &self.topologies;
        let job = |(place, (key, requests)): (usize, &Group)| match topologies.get(key) {
            Some(OnDevice::Eliminated(layout, topology)) => {
                let (mesh, _) = layout.as_ref().as_ref().ok()?;
                let mut numbers = Vec::with_capacity(mesh.body_number_count() * requests.len());
                requests.iter().for_each(|meshed| mesh.add_body_numbers(&meshed.body, &mut numbers));
                Some((place, Job { topology: FrontTopology::clone(topology), numbers }))
            }
            _ => None,
        };
        let jobs: Vec<(usize, Job)> = groups.par_iter().enumerate().filter_map(job).collect();
        jobs.into_iter().unzip()
    }
}

impl OnDevice {
    /// With what elimination takes, if it is not conjugate gradients that are asked for: these do 30 to 80 times the
    /// work, and the processor, which eliminates as well, is the quicker one where a mesh is too fine for the device.
    fn new(kernels: &Kernels, layout: Arc<Layout>) -> Result<OnDevice, GpuError> {
        let topology = match &*layout {
            Ok((mesh, front)) => FrontTopology::new(kernels, mesh, front)?,
            Err(problem) => return Err(no_layout(kernels, problem.clone())),
        };
        Ok(topology.map_or(OnDevice::Left, |topology| OnDevice::Eliminated(layout, Box::new(topology))))
    }

    fn bytes(&self) -> u64 {
        match self {
            OnDevice::Eliminated(layout, topology) => {
                layout.as_ref().as_ref().map_or(0, |(mesh, _)| mesh.bytes()) + topology.bytes()
            }
            OnDevice::Iterated(topology) => topology.bytes(),
            OnDevice::Left => 0,
        }
    }
}

fn no_layout(kernels: &Kernels, problem: String) -> GpuError {
    GpuError::Failed { adapter: kernels.gpu.facts.name.clone(), what: "layout", problem }
}

impl Topology {
    /// Of bodies like `body`.
    pub(crate) fn new(kernels: &Kernels, key: &TopologyKey, body: &Body) -> Result<Topology, GpuError> {
        let grading = key.grading(body);
        let layout =
            MeshLayout::new(body, &grading).map_err(|error| no_layout(kernels, error.to_string()))?;
        let pushes = Push::of(body.shape.side);
        let topology = RingTopology::new(body, &grading);
        let loads = ModeLoads::new(kernels, &RingModes::of(&key.class), pushes, &topology)?;
        Ok(Topology { counts: layout.counts(), layout, loads, facts: kernels.facts(FIRST_GUESS) })
    }

    fn bytes(&self) -> u64 {
        self.layout.bytes() + self.loads.bytes()
    }
}

/// The works on bodies of one topology, batch by batch. A body too large for the device, or whose systems fail, has none.
fn condense(
    kernels: &Kernels,
    topology: &mut Topology,
    bodies: &[Body],
    report: &mut GpuReport,
) -> Result<Vec<Option<Vec<f64>>>, GpuError> {
    let Topology { layout, counts, loads, facts } = topology;
    let precision = kernels.precision;
    let numbers: Vec<Vec<f64>> =
        bodies.par_iter().with_min_len(64).map(|body| layout.body_numbers(body)).collect();
    let root = (counts.unknowns as f64).sqrt();
    let iteration_limit = (MOST_STEPS_PER_ROOT * root) as usize;
    let mut condensed = Vec::with_capacity(bodies.len());
    while condensed.len() < bodies.len() {
        let first = condensed.len();
        // Only the first is used: it tells how the next one is to be cut.
        let left = vec![*counts; bodies.len() - first];
        let Ok(planned) = batches(&left, facts, &kernels.gpu.facts.limits) else { break };
        let Some(batch) = planned.first() else { break };
        let started = Instant::now();
        let own = first..first + batch.bodies.len();
        let systems = SystemBatch::new(kernels, &layout.systems, own.len())?;
        let settings = RefineSettings { iteration_limit, ..precision.settings() };
        systems.assemble_and_condense(layout, &numbers[own.clone()].concat(), &settings, batch.iterations)?;
        for works in systems.works(loads)? {
            condensed.push(works.map(|BodyWorks { works, residual }| {
                report.worst_residual = report.worst_residual.max(residual);
                works
            }));
        }
        // The next batch is cut by the time of this one, and takes its memory.
        let dispatches = (STEPS_PER_ROOT * root / f64::from(batch.iterations)).ceil().max(1.0);
        *facts = adapted(facts, batch, started.elapsed().div_f64(dispatches));
        report.bodies += own.len() as u64;
        report.solves += own.len() as u64 * counts.ring_columns;
    }
    condensed.resize(bodies.len(), None);
    Ok(condensed)
}
