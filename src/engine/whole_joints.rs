//! Joints that are a device's from the numbers of their bodies to their states: what it condenses stays there, and the processor only adds
//! what it knows of bodies beside their meshes, as weights of tables. A portion of designs goes there at once, and is waited for once.
//! Designs whose joints a device has no kernel for, or finds no state of that is good enough, are left.

use std::collections::VecDeque;
use std::ops::Range;
use std::time::Duration;

use hashbrown::HashTable;
use rayon::prelude::*;

use crate::engine::accuracy::Want;
use crate::engine::accuracy::body_errors::OwnError;
use crate::engine::accuracy::fit_bound::FitBound;
use crate::engine::backend::joints::{AskedOfJoints, CondensedBody};
use crate::engine::backend::{Device, IN_FLIGHT};
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_portions::{MANY, Portion};
use crate::engine::body_request::{Around, BodyHandle, BodyRequest, Fidelity, Group, Meshed};
use crate::engine::contact_on_device::{BodyOnDevice, GivenBody, given, is_for_devices, judged_designs};
use crate::engine::device_joints::{JOINTS_TOGETHER, Underway, gathered};
use crate::engine::hashed::Hashed;
use crate::engine::joint_contact::{Alike, joint_key};
use crate::engine::outcome::{Answer, Method};
use crate::engine::plan::JointPlan;
use crate::engine::question::Asker;
use crate::engine::question::tables::{BoundPlaces, Standing};
use crate::engine::spaces::{Needs, Spaces};
use crate::engine::stopwatch::Stopwatch;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass};
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::study::design::DesignCase;

/// Designs tried together go to a device in so many portions, none smaller than `FEWEST` but the last: each keeps a large device busy.
const PORTIONS: usize = 4;
const FEWEST: usize = 1024;

/// Of all that go there.
pub fn portions<T>(all: &[T]) -> std::slice::Chunks<'_, T> {
    all.chunks(all.len().div_ceil(PORTIONS).max(FEWEST))
}

/// A ladder's bodies and spaces, on the way through some designs.
pub struct WholeJoints<'a, 'd> {
    pub library: &'a mut BodyLibrary<'d>,
    pub spaces: &'a mut Spaces,
    /// Asked: relative, of the force.
    pub accuracy: f64,
    /// Time of what is made of the states, summed over threads.
    pub contact: Duration,
}

/// A design of a portion.
#[derive(Clone, Copy)]
struct Open<'a> {
    /// Its place among those tried together.
    place: usize,
    /// Among the cases.
    design: usize,
    plan: &'a JointPlan,
}

/// Designs that the device has.
struct Begun<'a> {
    open: &'a [Open<'a>],
    alike: Alike,
    underway: Underway<f64>,
}

/// The different bodies of some requests.
struct Distinct<'a> {
    table: HashTable<u32>,
    requests: Vec<Hashed<&'a BodyRequest>>,
}

impl<'a> Distinct<'a> {
    fn with_room_for(requests: usize) -> Distinct<'a> {
        Distinct { table: HashTable::with_capacity(requests), requests: Vec::with_capacity(requests) }
    }

    fn place(&mut self, request: Hashed<&'a BodyRequest>) -> u32 {
        let Distinct { table, requests } = self;
        let is_same = |place: &u32| requests[*place as usize] == request;
        let hash_of = |place: &u32| requests[*place as usize].own_hash();
        let new = requests.len() as u32;
        let place = *table.entry(request.own_hash(), is_same, hash_of).or_insert(new).get();
        if place == new {
            requests.push(request);
        }
        place
    }
}

/// Where a body of a portion is.
#[derive(Clone, Copy)]
enum Met {
    Solved(BodyHandle),
    OnDevice { place: CondensedBody, modes: RingModes, between: f64 },
}

impl WholeJoints<'_, '_> {
    /// The answers to designs that a device has found, in their order; `None` for the others.
    pub fn solve(
        &mut self,
        cases: &[DesignCase],
        open: &[(usize, JointPlan)],
    ) -> Vec<Option<(Answer, Want)>> {
        let mut answers = vec![None; open.len()];
        let all = (0..).zip(open).map(|(place, (design, plan))| Open { place, design: *design, plan });
        let whole: Vec<Open> = all.filter(|open| is_for_devices(open.plan)).collect();
        let mut begun: VecDeque<Begun> = VecDeque::new();
        for portion in portions(&whole) {
            if begun.len() == IN_FLIGHT {
                begun.pop_front().into_iter().for_each(|first| self.finish(cases, first, &mut answers));
            }
            begun.extend(self.begin(cases, portion));
        }
        begun.into_iter().for_each(|first| self.finish(cases, first, &mut answers));
        answers
    }

    /// Has the device count the rows of those designs of a study that it can solve, each with its plan, if it has one; tells of each whether it has
    /// it, and in how many batches they come.
    pub fn begin_count(
        &mut self,
        cases: &[DesignCase],
        plans: &[Option<JointPlan>],
        asker: &dyn Asker,
    ) -> (Vec<bool>, usize) {
        let question = asker.question();
        let rounding = self.library.device().map_or(0.0, Device::rounding);
        let standing = Standing::new(question, asker.limits()).on_meshes(rounding);
        let mut tables = standing.tables();
        let no_bound_at = tables.len();
        tables.extend(FitBound::of_none::<f32>());
        let is_counted = |plan: &&JointPlan| plan.method() == Method::Fe && is_for_devices(plan);
        let planned = (0..).zip(plans).filter_map(|(place, plan)| Some((place, plan.as_ref()?)));
        let counted = planned.filter(|(_, plan)| is_counted(plan));
        let whole: Vec<Open> = counted.map(|(place, plan)| Open { place, design: place, plan }).collect();
        let (mut are_there, mut batches) = (vec![false; cases.len()], 0);
        // All at a time, since the device has another batch meanwhile.
        let (mut left, mut together) = (&whole[..], whole.len());
        while let Some((portion, others)) = left.split_at_checked(together.min(left.len()).max(1)) {
            let met = self.meet(portion);
            let Some(mut device) = self.library.take_device() else { break };
            let around = self.library.near_fields(&met.laid.near_fields);
            let give = |place: &usize, numbers: &mut Vec<f32>| {
                let Open { design, plan, .. } = portion[*place];
                let case = &cases[design];
                let own = std::iter::once(case);
                let given =
                    given(self.spaces, plan, met.bodies(*place, self.library, &around), own, numbers)?;
                let bounds =
                    plan.known_places()?.map(|of_mesh| BoundPlaces { of_fit: no_bound_at, kind: 0, of_mesh });
                let is_for_device = standing.push_design(case, given.kept, bounds, numbers);
                // No state comes back that would have to be judged.
                is_for_device.then(|| given.keeping(()))
            };
            let places: Vec<usize> = (0..portion.len()).collect();
            let (mut batch, underway) = gathered(&places, JOINTS_TOGETHER, give);
            batch.near_fields = met.laid.near_fields.iter().copied().zip(around).collect();
            let (tables, ranges) = (tables.clone(), standing.ranges());
            batch.asked = Some(AskedOfJoints { question, tables, ranges });
            let begun = device.begin_whole(&met.laid.groups, &batch);
            if !self.library.give_back(device, begun) {
                if self.library.lost().is_some() || portion.len() <= FEWEST {
                    break;
                }
                // There may be room for fewer.
                together = portion.len() / 2;
                continue;
            }
            left = others;
            batches += 1;
            for (open, is_there) in portion.iter().zip(underway.are_there()) {
                are_there[open.design] = is_there;
            }
        }
        (are_there, batches)
    }

    /// Finds the bodies of a portion, and makes what the device is given of them and their spaces.
    fn meet(&mut self, open: &[Open]) -> MetPortion {
        let started = Stopwatch::start();
        let plans = open.par_iter().with_min_len(MANY).map(|open| open.plan);
        let requests = plans.clone().map(|plan| [&plan.pin, &plan.plate].map(Hashed::new));
        let requests: Vec<[Hashed<&BodyRequest>; 2]> = requests.collect();
        let mut distinct = Distinct::with_room_for(2 * requests.len());
        let places: Vec<[u32; 2]> =
            requests.into_iter().map(|own| own.map(|request| distinct.place(request))).collect();
        let laid = Laid::of(&distinct, self.library);
        self.library.prepare_near_fields(&laid.near_fields);
        let needs = plans.zip(&places).fold(Needs::default, |needs, (plan, places)| {
            let own = [&plan.pin, &plan.plate].into_iter().zip(places);
            own.fold(needs, |needs, (request, place)| match laid.met[*place as usize] {
                Met::Solved(handle) => needs.with((plan.space, &self.library.body(handle).compliance)),
                Met::OnDevice { modes, .. } => {
                    needs.with_modes(plan.space, BodyOnDevice::band_count(&request.body), Some(&modes))
                }
            })
        });
        self.spaces.meet(needs.reduce(Needs::default, Needs::and));
        self.library.times.shared += started.elapsed();
        MetPortion { places, laid }
    }

    /// Gives the device a portion, if it has room for it.
    fn begin<'a>(&mut self, cases: &[DesignCase], open: &'a [Open<'a>]) -> Option<Begun<'a>> {
        let met = self.meet(open);
        let key = |(open, own): (&Open, &[u32; 2])| joint_key(*own, open.plan, &cases[open.design]);
        let alike = Alike::of(open.par_iter().with_min_len(MANY).zip(&met.places).map(key).collect());
        let mut device = self.library.take_device()?;
        let (library, spaces) = (&*self.library, &*self.spaces);
        let around = library.near_fields(&met.laid.near_fields);
        let give = |joint: &Range<u32>, numbers: &mut Vec<f32>| {
            let own = alike.places(joint);
            let first = own[0] as usize;
            let bodies = met.bodies(first, library, &around);
            let own_cases = own.iter().map(|place| &cases[open[*place as usize].design]);
            given(spaces, open[first].plan, bodies, own_cases, numbers)
        };
        let (mut batch, underway) = gathered(&alike.joints, JOINTS_TOGETHER, give);
        batch.near_fields = met.laid.near_fields.iter().copied().zip(around).collect();
        let begun =
            if batch.joints.is_empty() { Ok(false) } else { device.begin_whole(&met.laid.groups, &batch) };
        let is_begun = self.library.give_back(device, begun);
        is_begun.then_some(Begun { open, alike, underway })
    }

    /// Takes what the device has found of a portion.
    fn finish(
        &mut self,
        cases: &[DesignCase],
        Begun { open, alike, underway }: Begun,
        answers: &mut [Option<(Answer, Want)>],
    ) {
        let Some(found) = self.library.finish_joints() else { return };
        let (spaces, accuracy) = (&*self.spaces, self.accuracy);
        let rounding = self.library.device().map_or(0.0, Device::rounding);
        let known = |_, request| known_error(request, rounding);
        let judge = |joint: &Range<u32>, even: f64, found: &[f32]| {
            let own = alike.places(joint);
            let own_cases = own.iter().map(|place| &cases[open[*place as usize].design]);
            let plan = open[own[0] as usize].plan;
            judged_designs(spaces, plan, known, own_cases, accuracy, (even, found))
        };
        let started = Stopwatch::start();
        let judged = underway.judged(&alike.joints, JOINTS_TOGETHER, &found, judge);
        // All threads are at it.
        self.contact += started.elapsed() * rayon::current_num_threads() as u32;
        for (joint, judged) in alike.joints.iter().zip(judged) {
            for (place, answer) in alike.places(joint).iter().zip(judged.into_iter().flatten()) {
                answers[open[*place as usize].place] = Some(answer);
            }
        }
    }
}

/// What is known of a body of a plan that is for devices, as it counts.
fn known_error(request: &BodyRequest, rounding: f64) -> OwnError<'_> {
    match request.fidelity {
        Fidelity::Mesh { level } => OwnError::of_mesh(&request.body, level, rounding),
        Fidelity::Series => OwnError::of_layers(&request.body),
    }
}

/// The bodies of a portion, and of each design those of its pin and plate among them.
struct MetPortion {
    places: Vec<[u32; 2]>,
    laid: Laid,
}

impl MetPortion {
    /// Of a design by its place in the portion.
    fn bodies<'a>(
        &self,
        design: usize,
        library: &'a BodyLibrary,
        around: &[&'a NearField],
    ) -> [GivenBody<'a>; 2] {
        self.places[design].map(|place| self.laid.met[place as usize].given(library, around))
    }
}

/// The different bodies of a portion as the device is given them.
struct Laid {
    groups: Vec<Group>,
    near_fields: Vec<NearFieldClass>,
    /// Of each different body where it is.
    met: Vec<Met>,
}

impl Laid {
    /// Those that need no mesh are solved.
    fn of(distinct: &Distinct, library: &mut BodyLibrary) -> Laid {
        let is_exact = |request: &Hashed<&BodyRequest>| request.key.fidelity == Fidelity::Series;
        let all = || (0..).zip(&distinct.requests);
        let exact = all().filter(|(_, request)| is_exact(request));
        let (places, exact): (Vec<usize>, Vec<_>) =
            exact.map(|(place, request)| (place, Hashed::new(request.key.clone()))).unzip();
        // Those without a mesh are filled in, the others below.
        let mut met = vec![Met::Solved(BodyHandle::of(0)); distinct.requests.len()];
        if !exact.is_empty() {
            let handles = library.solve_keyed(&exact);
            places.into_iter().zip(handles).for_each(|(place, handle)| met[place] = Met::Solved(handle));
        }
        let meshed = all().filter(|(_, request)| !is_exact(request));
        let meshed = meshed.map(|(place, request)| (BodyHandle::of(place), request.key)).collect();
        let mut laid = Laid { groups: Vec::new(), near_fields: Vec::new(), met };
        let mut place = 0;
        for Portion { groups, near_fields, .. } in library.portions(meshed) {
            let before = laid.near_fields.len() as u32;
            for (key, group) in groups {
                let modes = RingModes::of(&key.class);
                for Meshed { handle, around, .. } in &group {
                    // A bare body has one.
                    let Some(Around { classes, between }) = *around else { continue };
                    let near_fields = classes.map(|class| class + before);
                    let own = CondensedBody { place, near_fields };
                    laid.met[handle.place()] = Met::OnDevice { place: own, modes, between };
                    place += 1;
                }
                laid.groups.push((key, group));
            }
            laid.near_fields.extend(near_fields);
        }
        laid
    }
}

impl Met {
    fn given<'a>(self, library: &'a BodyLibrary, near_fields: &[&'a NearField]) -> GivenBody<'a> {
        match self {
            Met::Solved(handle) => GivenBody::Solved(&library.body(handle).compliance),
            Met::OnDevice { place, modes, between } => {
                let around = place.near_fields.map(|own| near_fields[own as usize]);
                GivenBody::OnDevice(BodyOnDevice { modes, around, between, place })
            }
        }
    }
}
