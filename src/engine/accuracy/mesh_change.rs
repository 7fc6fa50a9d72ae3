//! What the change from one mesh to the next finer one tells of the error of the finer.

use crate::engine::accuracy::known_errors::known_error;
use crate::engine::request::{BodyRequest, Fidelity};
use crate::engine::spaces::THIN;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::grading::LEVEL_COUNT;

/// Estimated error of the force on a mesh level from its relative change since the next coarser level, summed over the
/// bodies: a multiple of the change, and a floor for changes that are small by chance. Measured against `series` and
/// against the finest level (tests/oracle.rs), so that at least 95 % of the errors are below the estimate.
pub fn mesh_error(level: usize, change: f64) -> f64 {
    const ERROR_PER_CHANGE: [f64; LEVEL_COUNT] = [f64::INFINITY, 3.5, 2.0, 2.0, 1.2, 1.2];
    const FLOOR: [f64; LEVEL_COUNT] = [f64::INFINITY, 5e-4, 8e-5, 5e-5, 2e-5, 1e-5];
    ERROR_PER_CHANGE[level] * change + FLOOR[level]
}

/// How far the change between meshes can be trusted as a measure of the error, ever less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

impl Trust {
    pub fn of(request: &BodyRequest) -> Trust {
        let Body { shape, poissons_ratio, idealization, .. } = &request.body;
        let range = PoissonRange::of(*poissons_ratio, *idealization);
        match request.fidelity {
            Fidelity::Mesh { .. } if range == PoissonRange::Incompressible => {
                let is_film = request.body.depth_range().0 < THIN;
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
