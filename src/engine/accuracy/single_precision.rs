//! What single precision leaves of a force, and which meshes are condensed in it.

use crate::engine::accuracy::known_errors::Group;
use crate::mechanics::body::Body;
use crate::mechanics::grading::GradingClass;

/// Mesh levels that are condensed in single precision: the coarsest, whose own errors are mostly far greater.
const LEVELS: usize = 2;

/// Relative, of the force, at most (`tests/engine/single_precision.rs`).
const OF_SINGLES: f64 = 3e-5;

/// Whether a body on a mesh of a class is condensed in single precision: where it is bare, pressed at the load line, and its far boundary round.
/// Blocks lose up to 1e-4 of the force.
pub fn bears_singles(body: &Body, class: &GradingClass) -> bool {
    class.level < LEVELS && !class.is_lined() && !class.all_around && body.shape.sides.is_empty()
}

/// What it leaves of a force, of meshes of a level.
pub fn error_of_singles(group: Group, level: usize) -> f64 {
    match group {
        Group::Concentric | Group::HalfDisc if level < LEVELS => OF_SINGLES,
        _ => 0.0,
    }
}
