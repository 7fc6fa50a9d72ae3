//! From the accuracy asked to what is computed: for each body exact modes or a mesh, and how fine.

use crate::engine::accuracy::known_errors::{
    COLUMNS, Group, KNOWN_LEVELS, NO_MESH, Table, columns, first_place, known_of_levels, place_from,
};
use crate::engine::accuracy::mesh_change::Trust;
use crate::engine::accuracy::{Estimate, Want};
use crate::engine::body_request::{BodyHandle, BodyRequest, Fidelity, JointBodies};
use crate::engine::expected_contact::ExpectedContact;
use crate::engine::outcome::Method;
use crate::engine::refusal::{Refusal, is_bounded};
use crate::engine::spaces::SpaceKey;
use crate::mechanics::body::Body;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::study::config::MethodChoice;
use crate::study::design::{DesignCase, JointDesign};

/// What a design is solved with, at one rung of the ladder of resolutions.
#[derive(Clone, Debug)]
pub struct JointPlan {
    pub pin: BodyRequest,
    pub plate: BodyRequest,
    pub space: SpaceKey,
    /// Of the bodies on meshes.
    pub level: usize,
    pub estimate: Estimate,
    /// Of pin and plate the place among `known_errors::all` of what is known of their coarsest meshes; `None` where nothing is, or there is no mesh.
    pub first_known: [Option<u32>; 2],
}

/// What a body without a mesh is off by on any level.
const WITHOUT_MESH: Table = [[0.0; COLUMNS.len() + 1]; KNOWN_LEVELS];

/// Nodes from which on the curve of bodies on meshes gets no better.
const NODES_OF_NOISE: usize = 48;

/// The mesh level to begin with for an accuracy (relative, of the force): the coarsest whose typical error, measured
/// in `tests/engine/oracle.rs`, is below it. Where a design's own estimate says otherwise, it moves up the ladder.
pub fn first_level(accuracy: f64) -> usize {
    const REACHED: [f64; LEVEL_COUNT - 1] = [3e-3, 6e-4, 2e-4, 8e-5, 0.0];
    1 + REACHED.iter().position(|reached| accuracy > *reached).unwrap_or(LEVEL_COUNT - 2)
}

impl JointPlan {
    /// The cheapest that will meet an accuracy (relative, of the force) as far as is foreseen.
    pub fn cheapest(case: &DesignCase, method: MethodChoice, accuracy: f64) -> Result<JointPlan, Refusal> {
        let expected = ExpectedContact::of(case);
        let first = first_level(accuracy);
        let mut plan = JointPlan::without_estimate(case, &expected, method, accuracy, first)?;
        if plan.meshed().next().is_none() {
            return Ok(plan);
        }
        let known = plan.errors_of_levels(&expected, plan.chosen_for(&expected));
        let is_enough = |errors: &[f64; KNOWN_LEVELS]| {
            (0..KNOWN_LEVELS).find(|level| errors[*level] <= accuracy && plan.is_bounded_on(*level))
        };
        if let Some(level) = known.as_ref().and_then(is_enough) {
            return Ok(JointPlan { estimate: Estimate::Known, ..plan.moved_to(level) });
        }
        plan = plan.told_by_coarser();
        // The first level whose own estimate can be good enough.
        let can_do = |plan: &JointPlan| match plan.estimate {
            Estimate::Change(trust) => trust.error(plan.level, 0.0) <= accuracy,
            _ => true,
        };
        plan = std::iter::successors(Some(plan.clone()), JointPlan::finer).find(can_do).unwrap_or(plan);
        while !plan.is_bounded_on(plan.level) && plan.level > 1 {
            let coarser = plan.level - 1;
            plan = plan.on_level(coarser);
        }
        Ok(plan)
    }

    /// The same for another joint of the same shapes.
    pub fn of_other(&self, joint: &JointDesign) -> JointPlan {
        let [pin, plate] = [(&self.pin, &joint.pin), (&self.plate, &joint.plate)]
            .map(|(request, part)| BodyRequest { body: joint.body(part), ..*request });
        let first_known = [&pin, &plate].map(first_known);
        JointPlan { pin, plate, first_known, ..*self }
    }

    pub fn method(&self) -> Method {
        if self.estimate == Estimate::Exact { Method::Series } else { Method::Fe }
    }

    /// Whether no mesh of a level takes too much memory or time.
    fn is_bounded_on(&self, level: usize) -> bool {
        self.meshed().all(|request| is_bounded(&request.body, level))
    }

    /// What is known of the meshes, each body by its share of the work; `None` where nothing is known.
    pub fn foreseen_error(&self, expected: &ExpectedContact) -> Option<f64> {
        self.errors_of_levels(expected, self.chosen_for(expected))?.get(self.level).copied()
    }

    /// The same from the narrowest contact on, whatever the bodies.
    pub fn worst_foreseen_error(&self, expected: &ExpectedContact) -> Option<f64> {
        let half_angles = [expected.narrowest, expected.half_angle];
        self.errors_of_levels(expected, half_angles)?.get(self.level).copied()
    }

    /// The half angles, rad, for which its meshes are chosen. Of blocks the narrowest contact counts like the widest; of other bodies what is known of
    /// narrow ones is so far above what most have that to begin on a finer mesh costs what it saves.
    pub fn chosen_for(&self, expected: &ExpectedContact) -> [f64; 2] {
        let is_block = |request: &BodyRequest| Group::of(&request.body).is_some_and(Group::is_block);
        let narrowest = if self.meshed().any(is_block) { expected.narrowest } else { expected.half_angle };
        [narrowest, expected.half_angle]
    }

    /// What is known of the meshes of each level at half angles, rad, from the one to the other.
    fn errors_of_levels(
        &self,
        expected: &ExpectedContact,
        half_angles: [f64; 2],
    ) -> Option<[f64; KNOWN_LEVELS]> {
        let known = |(request, first): (&BodyRequest, Option<u32>)| match request.fidelity {
            Fidelity::Series => Some(&WITHOUT_MESH),
            Fidelity::Mesh { .. } => known_of_levels(first? as usize),
        };
        let [pin, plate] = self.with_first_known();
        let known = [known(pin)?, known(plate)?];
        let columns = columns(half_angles);
        let mut errors = [0.0; KNOWN_LEVELS];
        for (level, error) in errors.iter_mut().enumerate() {
            for column in columns.clone() {
                let [of_pin, of_plate] =
                    [0, 1].map(|body| expected.shares[body] * known[body][level][column]);
                *error = f64::max(*error, of_pin + of_plate);
            }
        }
        Some(errors)
    }

    /// What a design is solved with next, `None` where it wants nothing or there is no more.
    pub fn next(&self, want: Want) -> Option<JointPlan> {
        let in_space = |space: Option<SpaceKey>| Some(JointPlan { space: space?, ..self.clone() });
        match want {
            Want::Nothing => None,
            Want::MoreTerms => in_space(self.space.with_more_terms()).or_else(|| self.finer()),
            // Between the nodes of a mesh's curve there is its noise, which further nodes lessen little.
            Want::MoreNodes if self.estimate != Estimate::Exact && self.space.nodes >= NODES_OF_NOISE => {
                self.finer().or(in_space(self.space.with_more_nodes()))
            }
            // Functions of few trial pressures may be rougher than those of more.
            Want::MoreNodes => in_space(self.space.with_more_nodes())
                .or_else(|| self.finer())
                .or_else(|| in_space(self.space.with_more_terms())),
            // No mesh there is makes up for what is held back of it.
            Want::FinerMesh if self.estimate == Estimate::Change(Trust::SqueezedFilm) => None,
            Want::FinerMesh => self.finer(),
        }
    }

    /// The next rung of the ladder of meshes, `None` at its end. Where nothing is known of it, it is told by the one before.
    pub fn finer(&self) -> Option<JointPlan> {
        let level = self.level + 1;
        if level == LEVEL_COUNT {
            return None;
        }
        let finer = match self.estimate {
            Estimate::Exact => return None,
            Estimate::Known => {
                let finer = self.clone().moved_to(level);
                if finer.known_places().is_some() { finer } else { finer.told_by_coarser() }
            }
            _ => self.clone().on_level(level),
        };
        finer.is_bounded_on(level).then_some(finer)
    }

    /// On meshes of a level that are told by the next coarser ones.
    fn on_level(self, level: usize) -> JointPlan {
        self.moved_to(level).told_by_coarser()
    }

    /// On meshes of a level that are told as these are.
    fn moved_to(mut self, level: usize) -> JointPlan {
        for request in [&mut self.pin, &mut self.plate] {
            if let Fidelity::Mesh { level: own } = &mut request.fidelity {
                *own = level;
            }
        }
        JointPlan { level, ..self }
    }

    /// For a design at a mesh level, the error told by the next coarser one (so from 1 on).
    pub fn new(
        case: &DesignCase,
        method: MethodChoice,
        accuracy: f64,
        level: usize,
    ) -> Result<JointPlan, Refusal> {
        let plan = JointPlan::without_estimate(case, &ExpectedContact::of(case), method, accuracy, level)?;
        Ok(plan.told_by_coarser())
    }

    /// The same with an estimate that is for exact bodies alone.
    fn without_estimate(
        case: &DesignCase,
        expected: &ExpectedContact,
        method: MethodChoice,
        accuracy: f64,
        level: usize,
    ) -> Result<JointPlan, Refusal> {
        let joint = &case.joint;
        if let Some(refusal) = Refusal::of_joint(case, method) {
            return Err(refusal);
        }
        let (pin, plate) = (joint.body(&joint.pin), joint.body(&joint.plate));
        if method == MethodChoice::Series && !(pin.shape.concentric && plate.shape.concentric) {
            return Err(Refusal::NotConcentric);
        }
        // Who asks for `series` wants it exact.
        let wanted = if method == MethodChoice::Series { 0.0 } else { accuracy };
        let space = if joint.is_press_fit() {
            SpaceKey::of_press_fits(wanted)
        } else {
            SpaceKey::coarsest(&pin, &plate, wanted, expected.half_angle)
        };
        let request = |body: Body| {
            let exact = method != MethodChoice::Fe && body.shape.concentric;
            let fidelity = if exact { Fidelity::Series } else { Fidelity::Mesh { level } };
            BodyRequest { body, fidelity }
        };
        let (pin, plate) = (request(pin), request(plate));
        let first_known = [&pin, &plate].map(first_known);
        let plan = JointPlan { pin, plate, space, level, estimate: Estimate::Exact, first_known };
        let refusal = plan.meshed().find_map(|request| Refusal::of_mesh(&request.body));
        refusal.map_or(Ok(plan), Err)
    }

    /// With the lesser trust of the bodies on meshes.
    fn told_by_coarser(mut self) -> JointPlan {
        if let Some(trust) = self.meshed().map(Trust::of).max() {
            self.estimate = Estimate::Change(trust);
        }
        self
    }

    /// The bodies, each with its own.
    fn with_first_known(&self) -> [(&BodyRequest, Option<u32>); 2] {
        let [pin, plate] = self.first_known;
        [(&self.pin, pin), (&self.plate, plate)]
    }

    /// Of pin and plate the place among `known_errors::all` of what is known of their meshes; `None` where nothing is known of one.
    pub fn known_places(&self) -> Option<[usize; 2]> {
        let place = |(request, first): (&BodyRequest, Option<u32>)| match request.fidelity {
            Fidelity::Series => Some(NO_MESH),
            Fidelity::Mesh { level } => place_from(first? as usize, level),
        };
        let [pin, plate] = self.with_first_known();
        Some([place(pin)?, place(plate)?])
    }

    /// The bodies on meshes.
    pub fn meshed(&self) -> impl Iterator<Item = &BodyRequest> {
        [&self.pin, &self.plate].into_iter().filter(|request| request.fidelity != Fidelity::Series)
    }

    /// The bodies to solve: each on its own mesh and then, where that is what tells the error, on the next coarser one; the pin first.
    pub fn requests(&self) -> impl Iterator<Item = BodyRequest> {
        let with_coarser = |request: &BodyRequest| [Some(request.clone()), self.coarser(request)];
        [&self.pin, &self.plate].into_iter().flat_map(with_coarser).flatten()
    }

    /// Those of its requests, in their order.
    pub fn bodies(&self, requested: &mut impl Iterator<Item = BodyHandle>) -> Option<JointBodies> {
        let mut of = |request: &BodyRequest| {
            let own = requested.next()?;
            let coarser = if self.has_coarser(request) { Some(requested.next()?) } else { None };
            Some((own, coarser))
        };
        let [(pin, coarser_pin), (plate, coarser_plate)] = [of(&self.pin)?, of(&self.plate)?];
        Some(JointBodies { own: [pin, plate], coarser: [coarser_pin, coarser_plate] })
    }

    fn has_coarser(&self, request: &BodyRequest) -> bool {
        request.fidelity != Fidelity::Series && matches!(self.estimate, Estimate::Change(_))
    }

    /// The body on the next coarser mesh, where the change since then is what tells the error.
    pub fn coarser(&self, request: &BodyRequest) -> Option<BodyRequest> {
        match request.fidelity {
            Fidelity::Mesh { level } if self.has_coarser(request) => {
                Some(BodyRequest { fidelity: Fidelity::Mesh { level: level - 1 }, ..request.clone() })
            }
            _ => None,
        }
    }
}

/// `JointPlan::first_known` of a body.
fn first_known(request: &BodyRequest) -> Option<u32> {
    match request.fidelity {
        Fidelity::Series => None,
        Fidelity::Mesh { .. } => first_place(&request.body).map(|place| place as u32),
    }
}
