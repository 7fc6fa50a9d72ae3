//! The distinct bodies of a sweep: each is solved once, in batches of one topology, and kept while it is in use.

use std::collections::VecDeque;
use std::sync::atomic::AtomicUsize;
use std::time::Duration;

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::backend::adapter::GpuError;
use crate::engine::backend::drawn::DrawnDesigns;
use crate::engine::backend::joints::{JointBatch, SolvedJoints};
use crate::engine::backend::{Device, Works};
use crate::engine::body_condensation::{
    Condensed, CondensedBatch, CondensedGroup, condense_group, condensed_references, corrected,
    of_either_idealization,
};
use crate::engine::body_portions::{MANY, Portion, portions};
use crate::engine::body_request::{
    BodyHandle, BodyRequest, Fidelity, Group, Meshed, TopologyKey, concentric,
};
use crate::engine::hashed::Hashed;
use crate::engine::known_bodies::{KnownBodies, RequestKey, SolvedBody};
use crate::engine::near_fields::NearFieldLibrary;
use crate::engine::outcome::BackendKind;
use crate::engine::question::counted::Told;
use crate::engine::ring_loads::RingLoads;
use crate::engine::stopwatch::Stopwatch;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{InCommon, LoadedRing, NearField, NearFieldClass};

/// Solves bodies and remembers them, with everything that many bodies share.
#[derive(Default)]
pub struct BodyLibrary<'a> {
    ring_loads: RingLoads,
    near_fields: NearFieldLibrary,
    plans: HashMap<TopologyKey, CondensationPlan>,
    known: KnownBodies,
    /// What was asked and had no answer, in order.
    begun: VecDeque<Vec<Portion>>,
    device: Option<Box<dyn Device + 'a>>,
    /// Why the device was given up: it is only asked what it has done.
    lost: Option<GpuError>,
    /// Whether those bodies that bear it are condensed in single precision.
    pub in_singles: bool,
    /// Time spent in each stage, summed over threads.
    pub times: BodyTimes,
}

/// To be kept: made by all threads, so that one has little left to do.
struct Handled {
    handle: BodyHandle,
    body: SolvedBody,
    bytes: usize,
}

impl Handled {
    fn new(handle: BodyHandle, compliance: BodyCompliance, backend: BackendKind, rounding: f64) -> Handled {
        let bytes = compliance.bytes();
        Handled { handle, body: SolvedBody { compliance, backend, rounding }, bytes }
    }
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
pub const KEPT_PLANS: usize = 64 << 20;

impl<'a> BodyLibrary<'a> {
    /// Which condenses on a device as long as that lasts.
    pub fn on(self, device: Box<dyn Device + 'a>) -> BodyLibrary<'a> {
        BodyLibrary { device: Some(device), ..self }
    }

    /// Another one without bodies or a device, so that the near fields which either makes the other has.
    pub fn twin(&self) -> BodyLibrary<'a> {
        let near_fields = self.near_fields.twin();
        BodyLibrary { near_fields, in_singles: self.in_singles, ..BodyLibrary::default() }
    }

    pub fn device(&self) -> Option<&(dyn Device + 'a)> {
        self.device.as_deref()
    }

    /// Why the device was given up, if it was.
    pub fn lost(&self) -> Option<&GpuError> {
        self.lost.as_ref()
    }

    /// Which joints the device solves.
    pub fn solves_joints(&self) -> SolvedJoints {
        let device = self.device().filter(|_| self.lost.is_none());
        device.map_or(SolvedJoints::None, Device::solves_joints)
    }

    /// The device, as long as it lasts; to be given back.
    pub fn take_device(&mut self) -> Option<Box<dyn Device + 'a>> {
        self.device.take_if(|_| self.lost.is_none())
    }

    /// With what has become of what it was asked: false where it is lost.
    pub fn give_back(&mut self, device: Box<dyn Device + 'a>, asked: Result<bool, GpuError>) -> bool {
        self.device = Some(device);
        asked.map_err(|error| self.lost = Some(error)).unwrap_or(false)
    }

    /// What all bodies to come have in common.
    pub fn share(&mut self, in_common: InCommon) {
        self.near_fields.in_common = in_common;
    }

    /// Requests by topology, with the near fields they need.
    pub fn portions(&self, requests: Vec<(BodyHandle, &BodyRequest)>) -> Vec<Portion> {
        portions(requests, &self.near_fields.in_common)
    }

    /// Makes near fields, as far as they are not there yet. Others may be gone then.
    pub fn prepare_near_fields(&mut self, classes: &[NearFieldClass]) {
        let BodyLibrary { near_fields, ring_loads, .. } = self;
        let new = classes.iter().filter(|class| !near_fields.has(class));
        ring_loads.prepare(new.map(|class| class.mesh().ring()));
        near_fields.prepare(classes.iter().copied(), ring_loads);
    }

    /// What near fields and plans take that are kept for bodies to come.
    pub fn kept_bytes(&self) -> [usize; 2] {
        [self.near_fields.bytes(), self.bytes_of_plans()]
    }

    fn bytes_of_plans(&self) -> usize {
        self.plans.values().map(CondensationPlan::bytes).sum()
    }

    /// Those of classes, which were prepared.
    pub fn near_fields(&self, classes: &[NearFieldClass]) -> Vec<&NearField> {
        self.near_fields.all(classes)
    }

    /// Gives the device joints; where it is lost, they are the processor's.
    pub fn begin_joints(&mut self, batch: &JointBatch) {
        let device = self.device.as_mut().filter(|_| self.lost.is_none());
        self.lost = device.and_then(|device| device.begin_joints(batch).err()).or(self.lost.take());
    }

    /// Has the device draw designs and count their rows; false where it does not, and where it is lost.
    pub fn begin_drawn(&mut self, drawn: &DrawnDesigns) -> bool {
        let Some(device) = self.device.as_mut().filter(|_| self.lost.is_none()) else { return false };
        let begun = device.begin_drawn(drawn);
        begun.unwrap_or_else(|error| {
            self.lost = Some(error);
            false
        })
    }

    /// What the device has found of the joints that were begun before all others; nothing where it is lost.
    pub fn finish_joints(&mut self) -> Option<Vec<f32>> {
        let device = self.device.as_mut().filter(|_| self.lost.is_none())?;
        let found = device.finish_joints();
        found.map_err(|error| self.lost = Some(error)).ok()
    }

    /// What the device tells of joints whose rows it was to count; nothing where it is lost.
    pub fn finish_answers(&mut self) -> Option<Vec<Told>> {
        let device = self.device.as_mut().filter(|_| self.lost.is_none())?;
        let told = device.finish_answers();
        told.map_err(|error| self.lost = Some(error)).ok()
    }

    /// Forgets solved bodies, but not what they share.
    pub fn forget(&mut self) {
        self.drop_all_but(std::iter::empty());
    }

    /// A solved body. Every request has an answer from the end of its `solve` or `finish` up to the next `solve` or `keep_used`.
    pub fn solved(&self, request: &BodyRequest) -> &SolvedBody {
        let handle = self.known.find(&Hashed::new(request.clone()));
        self.body(handle.unwrap_or_else(|| unreachable!("a body is asked for that was not requested")))
    }

    /// The same by its handle.
    pub fn body(&self, handle: BodyHandle) -> &SolvedBody {
        self.known.solved(handle).unwrap_or_else(|| unreachable!("a body is asked for that was not solved"))
    }

    /// Solves the requests that have no answer yet, where no others are begun.
    pub fn solve(&mut self, requests: &[BodyRequest]) {
        let keyed = |request: &BodyRequest| Hashed::new(request.clone());
        let requests: Vec<RequestKey> = requests.par_iter().with_min_len(MANY).map(keyed).collect();
        self.solve_keyed(&requests);
    }

    /// The same, with their handles.
    pub fn solve_keyed(&mut self, requests: &[RequestKey]) -> Vec<BodyHandle> {
        self.keep_used(requests.iter());
        let handles = self.begin(requests);
        self.finish();
        handles
    }

    /// Drops solved bodies, where there are many, but for those of these requests.
    pub fn keep_used<'b>(&mut self, requests: impl Iterator<Item = &'b RequestKey>) {
        if self.known.bytes() > KEPT_BODIES {
            self.drop_all_but(requests);
        }
    }

    fn drop_all_but<'b>(&mut self, requests: impl Iterator<Item = &'b RequestKey>) {
        let dropped = self.known.drop_all_but(requests);
        // By any thread, when it has nothing better to do.
        rayon::spawn(move || drop(dropped));
    }

    /// Solves exact bodies, and gives the device the others that have no answer yet. Handles are in the order of the requests.
    pub fn begin(&mut self, requests: &[RequestKey]) -> Vec<BodyHandle> {
        let mut missing: Vec<(BodyHandle, &BodyRequest)> = Vec::new();
        let mut handles = Vec::with_capacity(requests.len());
        for request in requests {
            let (handle, is_new) = self.known.handle(request);
            if is_new {
                missing.push((handle, &request.key));
            }
            handles.push(handle);
        }
        let (series, meshed): (Vec<_>, Vec<_>) =
            missing.into_iter().partition(|(_, request)| request.fidelity == Fidelity::Series);
        let exact: Vec<(Handled, Duration)> = series
            .into_par_iter()
            .map(|(handle, request)| {
                let started = Stopwatch::start();
                let compliance = concentric(&request.body).compliance();
                (Handled::new(handle, compliance, BackendKind::Cpu, 0.0), started.elapsed())
            })
            .collect();
        for (solved, time) in exact {
            self.times.series += time;
            self.keep(solved);
        }
        let started = Stopwatch::start();
        let mut portions = self.portions(meshed);
        self.times.shared += started.elapsed();
        portions.iter_mut().for_each(|portion| self.give_device(portion));
        self.begun.push_back(portions);
        handles
    }

    /// Answers all requests that were begun before all others.
    pub fn finish(&mut self) {
        let begun = self.begun.pop_front();
        begun.into_iter().flatten().for_each(|portion| self.solve_meshed(portion));
    }

    /// The bodies without layers, as long as there is a device.
    fn give_device(&mut self, portion: &mut Portion) {
        let Some(device) = self.device.as_mut().filter(|_| self.lost.is_none()) else { return };
        let (lined, groups) =
            std::mem::take(&mut portion.groups).into_iter().partition(|(key, _)| key.class.is_lined());
        portion.groups = lined;
        if groups.is_empty() {
            return;
        }
        match device.begin(&groups) {
            Ok(()) => portion.on_device = groups,
            Err(error) => {
                self.lost = Some(error);
                portion.groups.extend(groups);
            }
        }
    }

    fn keep(&mut self, Handled { handle, body, bytes }: Handled) {
        self.known.keep(handle, body, bytes);
    }

    fn solve_meshed(&mut self, portion: Portion) {
        let Portion { mut groups, on_device, near_fields: classes } = portion;
        let started = Stopwatch::start();
        let of_near_fields = classes.iter().filter(|class| !self.near_fields.has(class));
        let of_bodies = groups
            .iter()
            .chain(&on_device)
            .map(|(key, group)| LoadedRing::of(group[0].body.shape, &key.class));
        self.ring_loads.prepare(of_near_fields.map(|class| class.mesh().ring()).chain(of_bodies));
        self.times.shared += started.elapsed();
        let started = Stopwatch::start();
        let references = condensed_references(&self.ring_loads, &groups);
        if !references.is_empty() {
            self.times.condense += started.elapsed();
        }
        if !on_device.is_empty() {
            groups.extend(self.take_from_device(on_device, &classes));
        }
        if self.bytes_of_plans() > KEPT_PLANS / 2 {
            self.plans.clear();
        }
        let room = AtomicUsize::new(KEPT_PLANS / 2);
        let groups = of_either_idealization(groups);
        // Where there are few bodies, their near fields are made beside them.
        let BodyLibrary { near_fields, plans, ring_loads, in_singles, .. } = self;
        let prepare = || {
            let started = Stopwatch::start();
            near_fields.prepare(classes.iter().copied(), ring_loads);
            started.elapsed()
        };
        let condense = |group| condense_group(plans, ring_loads, group, *in_singles, &room);
        let (near_field_time, mut condensed): (_, Vec<CondensedGroup>) =
            rayon::join(prepare, || groups.into_par_iter().map(condense).collect());
        self.times.shared += near_field_time;
        let around = near_fields.all(&classes);
        let correct = |key: &TopologyKey, rounding: f64, works: Vec<Condensed>| {
            let started = Stopwatch::start();
            let solve = |(Meshed { handle, body, around: own }, works): Condensed| {
                let compliance = match references.get(&handle) {
                    Some((reference, own)) => reference.compliance(&body, works, own),
                    None => corrected(&around, own, key, &body, works),
                };
                Handled::new(handle, compliance, BackendKind::Cpu, rounding)
            };
            let solved: Vec<Handled> = works.into_iter().map(solve).collect();
            (solved, started.elapsed())
        };
        let corrected: Vec<(Vec<Handled>, Duration)> = condensed
            .par_iter_mut()
            .flat_map(|group| {
                let batches = std::mem::take(&mut group.batches).into_par_iter();
                let key = &group.key;
                batches.map(move |CondensedBatch { works, rounding, time }| {
                    let (solved, more) = correct(key, rounding, works);
                    (solved, time + more)
                })
            })
            .collect();
        for (solved, time) in corrected {
            self.times.condense += time;
            solved.into_iter().for_each(|solved| self.keep(solved));
        }
        for CondensedGroup { key, plan, plan_time, .. } in condensed {
            self.times.shared += plan_time;
            self.plans.extend(plan.map(|plan| (key, plan)));
        }
    }

    /// Waits for a portion that the device was given; gives back what it has left.
    fn take_from_device(&mut self, groups: Vec<Group>, classes: &[NearFieldClass]) -> Vec<Group> {
        let Some(device) = self.device.as_mut().filter(|_| self.lost.is_none()) else { return groups };
        let started = Stopwatch::start();
        self.near_fields.prepare(classes.iter().copied(), &self.ring_loads);
        self.times.shared += started.elapsed();
        match device.finish() {
            Ok(works) => self.take(groups, works, classes),
            Err(error) => {
                self.lost = Some(error);
                groups
            }
        }
    }

    /// Takes what a device has condensed; gives back what it has left.
    fn take(&mut self, groups: Vec<Group>, works: Works, classes: &[NearFieldClass]) -> Vec<Group> {
        let around = self.near_fields.all(classes);
        let rounding = self.device().map_or(0.0, Device::rounding);
        let of_body = |key: &TopologyKey, (meshed, works): (Meshed, Option<Vec<f64>>)| match works {
            Some(works) => {
                let compliance = corrected(&around, meshed.around, key, &meshed.body, works);
                Ok(Handled::new(meshed.handle, compliance, BackendKind::Gpu, rounding))
            }
            None => Err(meshed),
        };
        let of_group = |((key, group), works): (Group, Vec<Option<Vec<f64>>>)| {
            let bodies = group.into_par_iter().with_min_len(MANY).zip(works);
            let taken: Vec<Result<Handled, Meshed>> = bodies.map(|body| of_body(&key, body)).collect();
            (key, taken)
        };
        let taken: Vec<_> = groups.into_par_iter().zip(works).map(of_group).collect();
        let mut left = Vec::new();
        for (key, taken) in taken {
            let mut of_group = Vec::new();
            for body in taken {
                match body {
                    Ok(solved) => self.keep(solved),
                    Err(meshed) => of_group.push(meshed),
                }
            }
            if !of_group.is_empty() {
                left.push((key, of_group));
            }
        }
        left
    }
}
