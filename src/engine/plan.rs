//! From the accuracy asked to what is computed: for each body exact modes or a mesh, and how fine.

use std::f64::consts::PI;

use crate::engine::foresight::Foresight;
use crate::engine::known_errors::{KNOWN_LEVELS, known_error};
use crate::engine::refusal::{Refusal, is_bounded};
use crate::engine::request::{BodyRequest, Fidelity, SpaceKey};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::arc::TERM_CHOICES;
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::compliance::thin_wall::THIN;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::study::config::MethodChoice;
use crate::study::design::DesignCase;

/// What a design is solved with, at one rung of the ladder of resolutions.
#[derive(Clone, Copy, Debug)]
pub struct JointPlan {
    pub pin: BodyRequest,
    pub plate: BodyRequest,
    /// Of the bodies on meshes.
    pub level: usize,
    pub estimate: Estimate,
}

/// How the error of the force is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimate {
    /// Both bodies are exact.
    Exact,
    /// What the mesh level is known to be worth (`known_errors`).
    Known,
    /// From the change since the next coarser mesh.
    Change(Trust),
}

/// What the answer to a design still wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Want {
    Nothing,
    /// The meshes are good enough, but the pressure is not.
    MoreTerms,
    FinerMesh,
}

/// The mesh level to begin with for an accuracy (relative, of the force): the coarsest whose typical error, measured
/// in `tests/oracle.rs`, is below it. Where a design's own estimate says otherwise, it moves up the ladder.
pub fn first_level(accuracy: f64) -> usize {
    const REACHED: [f64; LEVEL_COUNT - 1] = [3e-3, 6e-4, 2e-4, 8e-5, 0.0];
    1 + REACHED.iter().position(|reached| accuracy > *reached).unwrap_or(LEVEL_COUNT - 2)
}

/// Estimated error of the force on a mesh level from its relative change since the next coarser level, summed over the
/// bodies: a multiple of the change, and a floor for changes that are small by chance. Measured against `series` and
/// against the finest level (tests/oracle.rs), so that at least 95 % of the errors are below the estimate.
pub fn mesh_error(level: usize, change: f64) -> f64 {
    const ERROR_PER_CHANGE: [f64; LEVEL_COUNT] = [f64::INFINITY, 3.5, 2.0, 2.0, 1.2, 1.2];
    const FLOOR: [f64; LEVEL_COUNT] = [f64::INFINITY, 5e-4, 8e-5, 5e-5, 2e-5, 1e-5];
    ERROR_PER_CHANGE[level] * change + FLOOR[level]
}

/// How far the change between meshes can be trusted as a measure of the error, ever less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trust {
    /// Near and far field are those of the class's reference, but for its ratio: the finer mesh is far better.
    Concentric,
    Full,
    /// Both meshes may be wrong alike: a body is nearly incompressible in plane strain, so that they lock, or is a block more
    /// lopsided than any that was measured.
    Wary,
    /// It is nearly incompressible and its wall is thin: no mesh here is fine enough for what is squeezed along it.
    SqueezedFilm,
}

/// Walls thinner than this (|ln r|) squeeze what is nearly incompressible.
const FILM: f64 = 0.15;

impl Trust {
    fn of(request: &BodyRequest) -> Trust {
        let Body { shape, poissons_ratio, idealization, .. } = &request.body;
        let range = PoissonRange::of(*poissons_ratio, *idealization);
        match request.fidelity {
            Fidelity::Mesh { .. } if range == PoissonRange::Incompressible => {
                let is_film = request.body.depth_range().0 < FILM;
                if is_film { Trust::SqueezedFilm } else { Trust::Wary }
            }
            Fidelity::Mesh { .. }
                if !shape.sides.is_empty() && known_error(&request.body, 0, 0.0).is_none() =>
            {
                Trust::Wary
            }
            _ if shape.concentric => Trust::Concentric,
            _ => Trust::Full,
        }
    }

    /// `mesh_error` with what is held back; measured in `tests/extremes.rs`.
    pub fn error(self, level: usize, change: f64) -> f64 {
        let error = mesh_error(level, change);
        match self {
            Trust::Concentric => 0.4 * error + 0.6 * mesh_error(level, 0.0),
            Trust::Full => error,
            Trust::Wary => 3.0 * error + 20.0 * mesh_error(level, 0.0),
            Trust::SqueezedFilm => 0.1 + error,
        }
    }
}

/// From this contact half angle on, rad, few trial pressures leave something of the half angle and the peak pressure.
const WIDE: f64 = 1.4;

/// Trial pressures for a body this deep (|ln r|): the layer between contact and far boundary must be resolved too. What few of
/// them leave of contacts up to a half angle is measured in `tests/series.rs`.
fn terms(least_depth: f64, accuracy: f64, half_angle: f64) -> usize {
    let [deep, middling, thin] = match accuracy {
        rough if rough >= 1e-2 => [6, 6, 10],
        common if common >= 1e-4 && half_angle < WIDE => [6, 6, 16],
        common if common >= 1e-4 => [10, 10, 16],
        _ => [10, 16, 24],
    };
    match least_depth {
        depth if depth > 0.35 => deep,
        depth if depth > 0.15 => middling,
        _ => thin,
    }
}

/// The pressure space of a joint for an accuracy of the force and contacts up to a half angle, rad.
pub fn space_of(pin: &Body, plate: &Body, accuracy: f64, half_angle: f64) -> SpaceKey {
    let thinnest = pin.depth_range().0.min(plate.depth_range().0);
    let terms = terms(thinnest, accuracy, half_angle);
    SpaceKey { half_ring: pin.shape.end_angle < PI, terms }
}

/// What the compliance of a body is compared with, to tell how good an answer is: how the work of the pressure changes says it.
#[derive(Clone, Copy, Debug)]
pub enum Compared {
    /// It is exact.
    Not,
    /// Its mesh is known to be good to a share of the work that goes into the body: that work is the change.
    WithNothing,
    /// With the same body on the next coarser mesh.
    With(BodyRequest),
}

impl Compared {
    fn coarser(self) -> Option<BodyRequest> {
        if let Compared::With(request) = self { Some(request) } else { None }
    }
}

impl JointPlan {
    /// The cheapest that will meet an accuracy (relative, of the force) as far as is foreseen.
    pub fn cheapest(case: &DesignCase, method: MethodChoice, accuracy: f64) -> Result<JointPlan, Refusal> {
        let mut plan = JointPlan::new(case, method, accuracy, first_level(accuracy))?;
        if plan.estimate == Estimate::Exact {
            return Ok(plan);
        }
        let foresight = Foresight::of(case);
        let is_enough =
            |plan: &JointPlan| plan.foreseen_error(&foresight).is_some_and(|error| error <= accuracy);
        let mut known =
            (0..KNOWN_LEVELS).map(|level| JointPlan { estimate: Estimate::Known, ..plan.on_level(level) });
        if let Some(known) = known.find(|plan| is_enough(plan) && plan.is_bounded()) {
            return Ok(known);
        }
        // The first level whose own estimate can be good enough.
        let can_do = |plan: &JointPlan| match plan.estimate {
            Estimate::Change(trust) => trust.error(plan.level, 0.0) <= accuracy,
            _ => true,
        };
        plan = std::iter::successors(Some(plan), JointPlan::finer).find(can_do).unwrap_or(plan);
        while !plan.is_bounded() && plan.level > 1 {
            plan = plan.on_level(plan.level - 1);
        }
        Ok(plan)
    }

    /// Whether no mesh takes too much memory or time.
    fn is_bounded(&self) -> bool {
        self.meshed().all(|request| is_bounded(&request))
    }

    /// What is known of the meshes, each body by its share of the work; `None` where nothing is known.
    pub fn foreseen_error(&self, foresight: &Foresight) -> Option<f64> {
        let bodies = [self.pin, self.plate].into_iter().zip(foresight.shares);
        let meshed = bodies.filter(|(request, _)| request.fidelity != Fidelity::Series);
        let known = |request: BodyRequest| known_error(&request.body, self.level, foresight.half_angle);
        meshed.map(|(request, share)| Some(share * known(request)?)).sum()
    }

    /// What a design is solved with next, `None` where it wants nothing or there is no more.
    pub fn next(&self, want: Want) -> Option<JointPlan> {
        match want {
            Want::Nothing => None,
            Want::MoreTerms => self.with_more_terms().or_else(|| self.finer()),
            // No mesh there is makes up for what is held back of it.
            Want::FinerMesh if self.estimate == Estimate::Change(Trust::SqueezedFilm) => None,
            Want::FinerMesh => self.finer(),
        }
    }

    fn with_more_terms(&self) -> Option<JointPlan> {
        let terms = TERM_CHOICES.into_iter().find(|terms| *terms > self.pin.space.terms)?;
        let with =
            |request: BodyRequest| BodyRequest { space: SpaceKey { terms, ..request.space }, ..request };
        Some(JointPlan { pin: with(self.pin), plate: with(self.plate), ..*self })
    }

    /// The next rung of the ladder of meshes, `None` at its end. Where nothing is known of it, it is told by the one before.
    pub fn finer(&self) -> Option<JointPlan> {
        let level = self.level + 1;
        if level == LEVEL_COUNT {
            return None;
        }
        let is_known = |request: BodyRequest| known_error(&request.body, level, 0.0).is_some();
        let finer = match self.estimate {
            Estimate::Exact => return None,
            Estimate::Known if self.meshed().all(is_known) => {
                JointPlan { estimate: Estimate::Known, ..self.on_level(level) }
            }
            _ => self.on_level(level),
        };
        finer.is_bounded().then_some(finer)
    }

    fn on_level(&self, level: usize) -> JointPlan {
        let on_level = |request: BodyRequest| match request.fidelity {
            Fidelity::Series => request,
            Fidelity::Mesh { .. } => BodyRequest { fidelity: Fidelity::Mesh { level }, ..request },
        };
        JointPlan::of(on_level(self.pin), on_level(self.plate), level)
    }

    /// For a design at a mesh level, the error told by the next coarser one (so from 1 on).
    pub fn new(
        case: &DesignCase,
        method: MethodChoice,
        accuracy: f64,
        level: usize,
    ) -> Result<JointPlan, Refusal> {
        let joint = &case.joint;
        let (pin, plate) = (joint.body(&joint.pin), joint.body(&joint.plate));
        if method == MethodChoice::Series && !(pin.shape.concentric && plate.shape.concentric) {
            return Err(Refusal::NotConcentric);
        }
        // Who asks for `series` wants it exact.
        let wanted = if method == MethodChoice::Series { 0.0 } else { accuracy };
        let space = space_of(&pin, &plate, wanted, Foresight::of(case).half_angle);
        let request = |body: Body| {
            let exact = method != MethodChoice::Fe && body.shape.concentric;
            let fidelity = if exact { Fidelity::Series } else { Fidelity::Mesh { level } };
            BodyRequest { body, fidelity, space }
        };
        let plan = JointPlan::of(request(pin), request(plate), level);
        match plan.meshed().find_map(|request| Refusal::of_mesh(&request.body)) {
            None => Ok(plan),
            Some(refusal) => Err(refusal),
        }
    }

    fn of(pin: BodyRequest, plate: BodyRequest, level: usize) -> JointPlan {
        let mut plan = JointPlan { pin, plate, level, estimate: Estimate::Exact };
        // The lesser trust of the bodies on meshes.
        if let Some(trust) = plan.meshed().map(|request| Trust::of(&request)).max() {
            plan.estimate = Estimate::Change(trust);
        }
        plan
    }

    /// Whether a body's walls are so thin that they leave an error of their own.
    pub fn has_thin_walls(&self) -> bool {
        [self.pin, self.plate].iter().any(|request| request.body.depth_range().0 < THIN)
    }

    /// The bodies on meshes.
    pub fn meshed(&self) -> impl Iterator<Item = BodyRequest> {
        [self.pin, self.plate].into_iter().filter(|request| request.fidelity != Fidelity::Series)
    }

    /// The bodies to solve.
    pub fn requests(&self) -> impl Iterator<Item = BodyRequest> {
        [self.pin, self.plate]
            .into_iter()
            .flat_map(|request| [Some(request), self.compared(&request).coarser()])
            .flatten()
    }

    /// What the mesh of a body is compared with.
    pub fn compared(&self, request: &BodyRequest) -> Compared {
        match (request.fidelity, self.estimate) {
            (Fidelity::Mesh { level }, Estimate::Change(_)) => {
                Compared::With(BodyRequest { fidelity: Fidelity::Mesh { level: level - 1 }, ..*request })
            }
            (Fidelity::Mesh { .. }, _) => Compared::WithNothing,
            (Fidelity::Series, _) => Compared::Not,
        }
    }

    /// The error of the force, relative, that the meshes leave: `change` is that of the work since what they are
    /// `compared` with.
    pub fn mesh_error(&self, half_angle: f64, change: f64) -> f64 {
        match self.estimate {
            Estimate::Exact => 0.0,
            Estimate::Known => {
                let known = |request: BodyRequest| known_error(&request.body, self.level, half_angle);
                let worst = self.meshed().map(|request| known(request).unwrap_or(f64::INFINITY));
                change * worst.fold(0.0, f64::max)
            }
            Estimate::Change(trust) => trust.error(self.level, change),
        }
    }
}
