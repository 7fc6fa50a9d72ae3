//! What a sweep will cost, told without solving any of it.

use std::hash::BuildHasher;
use std::ops::{AddAssign, Mul, Range};

use foldhash::fast::RandomState;
use foldhash::{HashMap, HashSet};

use crate::engine::accuracy::Estimate as HowKnown;
use crate::engine::accuracy::mesh_change::Trust;
use crate::engine::accuracy::single_precision::{accuracy_bears_singles, body_bears_singles};
use crate::engine::body_request::{
    BodyRequest, Fidelity, MeshSize, TopologyKey, concentric, mesh_class, mesh_size,
};
use crate::engine::distinct::distinct_among;
use crate::engine::expected_contact::ExpectedContact;
use crate::engine::interpolation::fit_plan::{InterpolationPlan, picks};
use crate::engine::joint_contact::joint_key;
use crate::engine::law_fit::{law_case, range_of};
use crate::engine::plan::JointPlan;
use crate::engine::spaces::SpaceKey;
use crate::engine::unit_costs::{
    Time, Unit, batch, body_seconds, design, few_bodies, interpolated_design, joint_seconds,
    near_field_works, reference_seconds, row, series, space, space_modes, space_ring_modes, topology,
};
use crate::error::Error;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::compliance::near_field::{InCommon, NearFieldClass, ReferenceMesh};
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::laws::calibrated::samples::RANGE;
use crate::mechanics::real::LANES;
use crate::mechanics::singles::SINGLES;
use crate::study::config::{MethodChoice, Study};
use crate::study::design::{DesignCase, Load};

/// What a sweep will take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate {
    pub designs: u64,
    /// So many of them tell all that is not of their number alone.
    pub looked_at: u64,
    pub rows: u64,
    pub distinct_bodies: u64,
    /// Designs whose bodies are interpolated.
    pub interpolated: u64,
    /// Designs that are beyond what can be solved.
    pub refused: u64,
    /// Unknowns of all meshes that the first attempt at each of the others needs.
    pub unknowns: u64,
    /// Core time; the threads share it.
    pub time: Time,
}

/// Share of the designs that go on to the next finer mesh, by what is foreseen of the error on the one they have: as `configs/random.toml`,
/// `configs/hypercube-block.toml` and `configs/thin-walls.toml` have it from 1 % to 0.01 %.
fn climbers(case: &DesignCase, plan: &JointPlan, accuracy: f64) -> f64 {
    match plan.estimate {
        HowKnown::Exact | HowKnown::Change(Trust::SqueezedFilm) => 0.0,
        HowKnown::Known if accuracy >= LITTLE_ASKED => 0.0,
        HowKnown::Known => match plan.worst_foreseen_error(&ExpectedContact::of(case)) {
            Some(error) if error > accuracy => 0.8,
            Some(error) if error > 0.8 * accuracy => 0.3,
            _ => 0.0,
        },
        HowKnown::Change(Trust::Concentric | Trust::Full | Trust::Lined) => 0.1,
        HowKnown::Change(Trust::Wary) if Trust::Wary.error(plan.level, 0.0) > 0.5 * accuracy => 0.9,
        HowKnown::Change(Trust::Wary) => 0.2,
    }
}

/// From this accuracy on hardly any mesh that is known has to be followed by a finer one.
const LITTLE_ASKED: f64 = 1e-2;

/// Of more designs than this so many tell an estimate.
pub const MOST_LOOKED_AT: u64 = 1 << 16;

/// Rungs of the ladder that fewer designs come to are left out.
const FEW: f64 = 0.05;

/// Bodies that fill the lanes of common batches.
#[derive(Default)]
struct Group {
    size: MeshSize,
    modes: usize,
    bodies: f64,
    side: usize,
    /// That a batch takes.
    lanes: usize,
    /// Whether they have layers.
    is_lined: bool,
}

impl Group {
    fn time(&self) -> Time {
        let in_lanes = batches(self.bodies.max(1.0), self.lanes, self.size);
        Time { in_lanes, others: topology(self.size, self.modes).seconds() } * likely(self.bodies)
    }
}

/// Of so many bodies of one topology in lanes, s. Few are condensed one after the other.
fn batches(bodies: f64, lanes: usize, size: MeshSize) -> f64 {
    let lanes = lanes as f64;
    let count = (bodies / lanes).floor() + (bodies % lanes / few_bodies(size)).min(1.0);
    count * batch(size).seconds()
}

/// A mesh on which references of near fields lie.
#[derive(Default)]
struct OfReferences {
    /// The largest of its classes, whose sizes are told by their bodies.
    size: MeshSize,
    modes: usize,
    references: f64,
    /// That need it.
    bodies: f64,
}

impl OfReferences {
    fn time(&self) -> Time {
        let in_lanes = batches(self.references.max(1.0), LANES, self.size);
        Time { in_lanes, others: topology(self.size, self.modes).seconds() } * likely(self.bodies)
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
    /// Whether bodies that bear it are condensed in single precision.
    in_singles: bool,
    in_common: InCommon,
    /// Hashes of pins, and of plates.
    bodies: [HashSet<u64>; 2],
    solved: HashSet<u64>,
    groups: HashMap<u64, Group>,
    /// With the size of the reference's mesh, and how many bodies need it.
    near_fields: HashMap<NearFieldClass, (MeshSize, f64)>,
    /// Highest mode of exact bodies by space.
    spaces: HashMap<SpaceKey, usize>,
    /// Ring modes of bodies on meshes in each space, and how many joints need them.
    ring_modes: HashMap<(SpaceKey, RingModes), f64>,
    /// Joints that have a curve of their own; of these the first ones of designs, and how often designs asked for one.
    joints: HashSet<u64>,
    first_joints: usize,
    asked: usize,
    /// Of the meshes of pins, and of plates; so are the seconds of bodies.
    unknowns: [u64; 2],
    of_bodies: [f64; 2],
    of_joints: f64,
    /// Of these the contact of joints that a device may solve.
    for_devices: Part,
}

impl Needs {
    fn of_study(study: &Study) -> Needs {
        let in_singles = accuracy_bears_singles(study.solve.accuracy);
        Needs { in_singles, in_common: study.in_common(), ..Needs::default() }
    }

    /// Adds a body that a design has.
    fn meet(&mut self, body: &Body) {
        self.bodies[body.shape.side as usize].insert(self.hasher.hash_one(body));
    }

    /// Adds a body as it is solved `times` a design, less than once where only some designs come to it.
    fn add(&mut self, request: &BodyRequest, times: f64) {
        self.meet(&request.body);
        let side = request.body.shape.side as usize;
        if !self.solved.insert(self.hasher.hash_one(request)) {
            return;
        }
        let Fidelity::Mesh { level } = request.fidelity else {
            self.of_bodies[side] += times * body_seconds(request);
            return;
        };
        let size = mesh_size(&request.body, level);
        // The processor condenses bodies of either idealization abreast.
        let topology = TopologyKey::of(request).of_either_idealization();
        let group = self.groups.entry(self.hasher.hash_one(&topology)).or_default();
        (group.size, group.modes) = (size, RingModes::of(&topology.class).count);
        let in_singles = self.in_singles && body_bears_singles(&request.body, &topology.class);
        group.lanes = if in_singles { SINGLES } else { LANES };
        group.side = side;
        group.bodies += times;
        if times == 1.0 {
            self.unknowns[side] += size.unknowns;
        }
        group.is_lined = topology.class.is_lined();
        if group.is_lined {
            // A lined body has a reference of its own, condensed like it, with exact modes.
            group.bodies += times;
            self.of_bodies[side] += times * reference_seconds(&request.body);
            return;
        }
        for class in NearFieldClass::around(&request.body, topology.class, &self.in_common).0 {
            // The reference has some of the body's layers; around half a ring it is that of the whole.
            let rings = if class.half_ring { 2 } else { 1 };
            let layers = class.layer_count() as u64;
            let unknowns = rings * size.unknowns * layers / size.layers;
            let (mesh, bodies) = self.near_fields.entry(class).or_default();
            *mesh = MeshSize { unknowns, layers };
            *bodies += times;
        }
    }

    /// Adds the contact of a joint as it is solved `times` a design.
    fn add_joint(&mut self, plan: &JointPlan, case: &DesignCase, times: f64) {
        let is_first = times == 1.0;
        self.asked += usize::from(is_first);
        if !self.joints.insert(self.hasher.hash_one(joint_key([&plan.pin, &plan.plate], plan, case))) {
            return;
        }
        self.first_joints += usize::from(is_first);
        let contact = times * joint_seconds(plan);
        self.of_joints += contact;
        if plan.estimate == HowKnown::Known {
            self.for_devices += Part { count: times, seconds: contact };
        }
        let highest = self.spaces.entry(plan.space).or_default();
        for BodyRequest { body, fidelity } in plan.requests() {
            match fidelity {
                Fidelity::Series => *highest = concentric(&body).modes_needed().max(*highest),
                Fidelity::Mesh { level } => {
                    let of_reference =
                        ConcentricBody::with_layers_of(&body).map(|reference| reference.highest_mode());
                    *highest = of_reference.unwrap_or(0).max(*highest);
                    let modes = RingModes::of(&mesh_class(&body, level));
                    *self.ring_modes.entry((plan.space, modes)).or_default() += times;
                }
            }
        }
    }

    /// Adds a design from its first plan on, each finer one by how likely it is.
    fn climb(&mut self, case: &DesignCase, first: JointPlan, accuracy: f64) {
        let mut rung = Some((first, 1.0));
        while let Some((plan, share)) = rung.filter(|(_, share)| *share > FEW) {
            plan.requests().for_each(|request| self.add(&request, share));
            self.add_joint(&plan, case, share);
            rung = plan.finer().map(|finer| (finer, share * climbers(case, &plan, accuracy)));
        }
    }

    /// Where so many designs, which are not all, were looked at: as all of them would have it. What bodies and joints share was met, all of it
    /// that weighs. Tells how many different bodies that is.
    fn stand_for(&mut self, all: f64, seen: f64) -> u64 {
        let times = |looked_at: f64, found: usize| {
            distinct_among(looked_at * all / seen, looked_at, found as f64) / (found as f64).max(1.0)
        };
        let of_sides = [0, 1].map(|side| times(seen, self.bodies[side].len()));
        for side in 0..2 {
            self.of_bodies[side] *= of_sides[side];
            self.unknowns[side] = (self.unknowns[side] as f64 * of_sides[side]) as u64;
        }
        self.groups.values_mut().for_each(|group| group.bodies *= of_sides[group.side]);
        self.of_joints *= times(self.asked as f64, self.first_joints);
        let distinct = |side: usize| of_sides[side] * self.bodies[side].len() as f64;
        (distinct(0) + distinct(1)).round() as u64
    }

    fn total_time(&self) -> Time {
        let of_near_field = |(class, (_, bodies)): (&NearFieldClass, &(MeshSize, f64))| {
            let modes = RingModes::of(&class.grading).count;
            let references: Vec<ConcentricBody> = class.references().collect();
            let highest = references[0].highest_mode();
            let in_lanes = references.len() as f64 * series(highest).seconds();
            let others = near_field_works(highest, modes, references.len()).seconds();
            Time { in_lanes, others } * likely(*bodies)
        };
        let mut meshes: HashMap<ReferenceMesh, OfReferences> = HashMap::default();
        for (class, (size, bodies)) in &self.near_fields {
            let own = meshes.entry(class.mesh()).or_default();
            // The same in whatever order classes come.
            if size.unknowns > own.size.unknowns {
                own.size = *size;
            }
            own.modes = RingModes::of(&class.grading).count;
            own.references += likely(*bodies) * class.references().count() as f64;
            own.bodies += bodies;
        }
        let of_space = |(key, highest): (&SpaceKey, &usize)| {
            space(*key).seconds() + space_modes(*key, *highest).seconds()
        };
        let of_ring_modes = |((key, modes), joints): (&(SpaceKey, RingModes), &f64)| {
            likely(*joints) * space_ring_modes(*key, modes.count).seconds()
        };
        let of_spaces = self.spaces.iter().map(of_space).chain(self.ring_modes.iter().map(of_ring_modes));
        Time::in_lanes(self.of_bodies.iter().sum::<f64>() + self.of_joints)
            + self.groups.values().map(Group::time).sum()
            + self.near_fields.iter().map(of_near_field).sum()
            + meshes.values().map(OfReferences::time).sum()
            + Time::of_others(of_spaces.sum())
    }
}

/// Indentations at work as far as loads tell, mm.
fn working_range_of(case: &DesignCase) -> (f64, f64) {
    let indentations = case.steps.iter().filter_map(|load| match case.joint.from_first_touch(*load) {
        Load::Indentation(value) => Some(value),
        _ => None,
    });
    let clearance = case.joint.radial_clearance;
    range_of(indentations).unwrap_or((RANGE.0 * clearance, RANGE.1 * clearance))
}

/// What a design takes, s.
#[derive(Clone, Copy, Debug, Default)]
pub struct DesignParts {
    /// Bodies that a device may condense, and their condensation on the processor in double precision.
    pub bodies: Part,
    /// What the processor saves of that by single precision.
    pub saved: f64,
    /// Joints of bodies on meshes that a device may solve, and their contact on the processor.
    pub on_meshes: Part,
    /// The same of interpolated bodies.
    pub interpolated: Part,
    pub others: Time,
    /// What of `others` is rows of interpolated designs,
    pub rows_of_interpolated: f64,
    /// and of designs on meshes whose joints a device may solve.
    pub rows_on_meshes: f64,
}

/// Some things, and what they take on the processor, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    pub count: f64,
    pub seconds: f64,
}

impl AddAssign for Part {
    fn add_assign(&mut self, more: Part) {
        self.count += more.count;
        self.seconds += more.seconds;
    }
}

impl Mul<f64> for Part {
    type Output = Part;

    fn mul(self, times: f64) -> Part {
        Part { count: times * self.count, seconds: times * self.seconds }
    }
}

/// What designs of a study take.
pub struct DesignCost<'a> {
    study: &'a Study,
    interpolation: Option<InterpolationPlan>,
}

impl DesignCost<'_> {
    pub fn of_study(study: &Study) -> DesignCost<'_> {
        DesignCost { study, interpolation: InterpolationPlan::of_study(study) }
    }

    /// As if nothing were interpolated.
    pub fn without_interpolation(study: &Study) -> DesignCost<'_> {
        DesignCost { study, interpolation: None }
    }

    /// A further design, s, whatever it shares with others.
    pub fn seconds(&self, case: &DesignCase) -> f64 {
        let DesignParts { bodies, saved, on_meshes, interpolated, others, .. } = self.parts(case);
        bodies.seconds - saved + on_meshes.seconds + interpolated.seconds + others.seconds()
    }

    /// The same by what a device may do of it.
    pub fn parts(&self, case: &DesignCase) -> DesignParts {
        let (rows, row) = (case.steps.len() as f64, row(self.study.writes_table()));
        if self.interpolation.as_ref().is_some_and(|plan| plan.covers(&case.joint)) {
            let of_rows = rows * row.seconds();
            return DesignParts {
                interpolated: Part { count: 1.0, seconds: Unit::InterpolatedDesign.seconds() },
                rows_of_interpolated: of_rows,
                others: Time::of_others(of_rows),
                ..DesignParts::default()
            };
        }
        let of_rows = Time::of_others(design(rows, row).seconds());
        let without_meshes = DesignParts { others: of_rows, ..DesignParts::default() };
        let solve = self.study.solve;
        if solve.method == MethodChoice::ClosedForm {
            return without_meshes;
        }
        let Ok(first) = JointPlan::cheapest(case, solve.method, solve.accuracy) else {
            return without_meshes;
        };
        let mut needs = Needs::of_study(self.study);
        needs.climb(case, first, solve.accuracy);
        let mut parts = DesignParts {
            on_meshes: needs.for_devices,
            others: of_rows
                + Time::in_lanes(
                    needs.of_bodies.iter().sum::<f64>() + needs.of_joints - needs.for_devices.seconds,
                ),
            rows_on_meshes: if needs.for_devices.count > 0.0 { rows * row.seconds() } else { 0.0 },
            ..DesignParts::default()
        };
        for group in needs.groups.values() {
            let of_lanes = |lanes: usize| group.bodies * batch(group.size).seconds() / lanes as f64;
            let in_double = of_lanes(LANES);
            if group.is_lined {
                parts.others += Time::in_lanes(in_double);
            } else {
                parts.bodies += Part { count: group.bodies, seconds: in_double };
                parts.saved += in_double - of_lanes(group.lanes);
            }
        }
        parts
    }

    /// Some designs, as if they were run alone: by all of them, or by some that are spread over them, none of which is solved.
    pub fn estimate(&self, designs: Range<u64>) -> Result<Estimate, Error> {
        let DesignCost { study, interpolation } = self;
        let (method, accuracy) = (study.solve.method, study.solve.accuracy);
        let mut needs = Needs::of_study(study);
        let count = designs.end.min(study.design_count()).saturating_sub(designs.start);
        let rows = count.saturating_mul(study.steps_per_design());
        let row = row(study.writes_table());
        let numbers = picks(count, MOST_LOOKED_AT).into_iter().map(|number| designs.start + number);
        let (mut looked_at, mut interpolated, mut refused) = (0_u64, 0_u64, 0_u64);
        let mut of_laws = Time::default();
        for case in study.cases_at(numbers)? {
            let case = case?;
            looked_at += 1;
            let joint = &case.joint;
            if interpolation.as_ref().is_some_and(|plan| plan.covers(joint)) {
                interpolated += 1;
                [&joint.pin, &joint.plate].into_iter().for_each(|part| needs.meet(&joint.body(part)));
                continue;
            }
            if method == MethodChoice::ClosedForm {
                continue;
            }
            let Ok(first) = JointPlan::cheapest(&case, method, accuracy) else {
                refused += 1;
                continue;
            };
            needs.climb(&case, first, accuracy);
            if study.fits_laws() && !joint.is_press_fit() {
                // Their loads go further, where meshes may have to be finer. Unknowns stay those of the table.
                let case = law_case(&case, working_range_of(&case));
                let unknowns = needs.unknowns;
                if let Ok(first) = JointPlan::cheapest(&case, method, accuracy) {
                    let others = design(case.steps.len() as f64, row).seconds() + Unit::Laws.seconds();
                    of_laws += Time { in_lanes: joint_seconds(&first), others };
                    needs.climb(&case, first, accuracy);
                }
                needs.unknowns = unknowns;
            }
        }
        let of_all = count as f64 / (looked_at as f64).max(1.0);
        let all = |of_seen: u64| (of_seen as f64 * of_all).round() as u64;
        let distinct_bodies = if looked_at < count {
            needs.stand_for(count as f64, looked_at as f64)
        } else {
            needs.bodies.iter().map(|bodies| bodies.len() as u64).sum()
        };
        let (interpolated, refused) = (all(interpolated), all(refused));
        let rows_each = rows as f64 / (count as f64).max(1.0);
        let solved = count as f64 - interpolated as f64 - refused as f64;
        let of_designs = solved * design(rows_each, row).seconds()
            + interpolated as f64 * interpolated_design(rows_each, row).seconds();
        let time = needs.total_time()
            + of_laws * of_all
            + interpolation.as_ref().map_or(Time::default(), |plan| plan.time())
            + Time::of_others(Unit::Process.seconds() + of_designs);
        let unknowns = needs.unknowns.iter().sum();
        Ok(Estimate {
            designs: count,
            looked_at,
            rows,
            distinct_bodies,
            interpolated,
            refused,
            unknowns,
            time,
        })
    }
}

/// All designs of a study, none of which is solved.
pub fn estimate(study: &Study) -> Result<Estimate, Error> {
    DesignCost::of_study(study).estimate(0..study.design_count())
}
