//! From the accuracy asked to what is computed: for each body exact modes or a mesh, and how fine.

use std::f64::consts::PI;

use crate::engine::request::{BodyRequest, Fidelity, SpaceKey};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::study::config::MethodChoice;
use crate::study::design::JointDesign;

/// What a design is solved with, at one rung of the ladder of resolutions.
#[derive(Clone, Copy, Debug)]
pub struct JointPlan {
    pub pin: BodyRequest,
    pub plate: BodyRequest,
    /// Of the bodies on meshes.
    pub level: usize,
}

/// The mesh level to begin with for an accuracy (relative, of the force): the coarsest whose typical error, measured
/// in `tests/oracle.rs`, is below it. Where a design's own estimate says otherwise, it moves up the ladder.
pub fn first_level(accuracy: f64) -> usize {
    const REACHED: [f64; LEVEL_COUNT - 1] = [5e-3, 1.5e-3, 5e-4, 1.5e-4, 0.0];
    1 + REACHED.iter().position(|reached| accuracy > *reached).unwrap_or(LEVEL_COUNT - 2)
}

/// Estimated error of the force on a mesh level from its relative change since the next coarser level, summed over the
/// bodies: a multiple of the change, and a floor for changes that are small by chance. Measured against `series` and
/// against the finest level (tests/oracle.rs), so that at least 95 % of the errors are below the estimate.
pub fn mesh_error(level: usize, change: f64) -> f64 {
    const ERROR_PER_CHANGE: [f64; LEVEL_COUNT] = [f64::INFINITY, 3.5, 1.5, 1.5, 1.5, 2.0];
    const FLOOR: [f64; LEVEL_COUNT] = [f64::INFINITY, 7e-4, 8e-5, 2e-5, 1e-5, 5e-6];
    ERROR_PER_CHANGE[level] * change + FLOOR[level]
}

/// How far the change between meshes can be trusted as a measure of the error, ever less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trust {
    Full,
    /// A body is nearly incompressible in plane strain: both meshes may be about to lock, the finer one a little less.
    NearlyIncompressible,
    /// And its wall is thin: no mesh here is fine enough for what is squeezed along it.
    SqueezedFilm,
}

/// Walls thinner than this (|ln r|) squeeze what is nearly incompressible.
const FILM: f64 = 0.15;

impl Trust {
    fn of(request: &BodyRequest) -> Trust {
        let Body { shape, parameters, poissons_ratio, idealization, .. } = &request.body;
        let range = PoissonRange::of(*poissons_ratio, *idealization);
        match request.fidelity {
            Fidelity::Mesh { .. } if range == PoissonRange::Incompressible => {
                let is_film = (shape.depth_range)(parameters).0 < FILM;
                if is_film { Trust::SqueezedFilm } else { Trust::NearlyIncompressible }
            }
            _ => Trust::Full,
        }
    }

    /// `mesh_error` with what is held back; measured in `tests/extremes.rs`.
    pub fn error(self, level: usize, change: f64) -> f64 {
        let error = mesh_error(level, change);
        match self {
            Trust::Full => error,
            Trust::NearlyIncompressible => 1.5 * error + 14.0 * mesh_error(level, 0.0),
            Trust::SqueezedFilm => 0.1 + error,
        }
    }
}

/// Trial pressures for a body this deep (|ln r|): the layer between contact and far boundary must be resolved too.
fn terms(least_depth: f64) -> usize {
    match least_depth {
        depth if depth > 0.35 => 10,
        depth if depth > 0.15 => 16,
        _ => 24,
    }
}

impl JointPlan {
    /// For a design at a mesh level (from 1 on); `None` where `series` is asked for bodies it has no modes of.
    pub fn new(joint: &JointDesign, method: MethodChoice, level: usize) -> Option<JointPlan> {
        let (pin, plate) = (joint.body(&joint.pin), joint.body(&joint.plate));
        if method == MethodChoice::Series && !(pin.shape.concentric && plate.shape.concentric) {
            return None;
        }
        let depth = |body: &Body| (body.shape.depth_range)(&body.parameters).0;
        let space =
            SpaceKey { half_ring: pin.shape.end_angle < PI, terms: terms(depth(&pin).min(depth(&plate))) };
        let request = |body: Body| {
            let exact = method != MethodChoice::Fe && body.shape.concentric;
            let fidelity = if exact { Fidelity::Series } else { Fidelity::Mesh { level } };
            BodyRequest { body, fidelity, space }
        };
        Some(JointPlan { pin: request(pin), plate: request(plate), level })
    }

    /// The lesser trust of the two bodies.
    pub fn trust(&self) -> Trust {
        Trust::of(&self.pin).max(Trust::of(&self.plate))
    }

    /// The bodies to solve: each mesh comes with the next coarser one, whose difference says how good it is.
    pub fn requests(&self) -> impl Iterator<Item = BodyRequest> {
        [self.pin, self.plate].into_iter().flat_map(|request| [Some(request), coarser(&request)]).flatten()
    }
}

/// The same body on the next coarser mesh.
pub fn coarser(request: &BodyRequest) -> Option<BodyRequest> {
    match request.fidelity {
        Fidelity::Series => None,
        Fidelity::Mesh { level } => {
            Some(BodyRequest { fidelity: Fidelity::Mesh { level: level - 1 }, ..*request })
        }
    }
}
