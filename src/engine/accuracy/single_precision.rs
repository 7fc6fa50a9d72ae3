//! Which bodies are condensed in single precision, and what that leaves of a force.

use crate::mechanics::body::Body;
use crate::mechanics::grading::GradingClass;

/// From this accuracy on, relative, of the force.
const COARSE: f64 = 1e-2;

/// On these mesh levels, the coarsest: their own errors are mostly far greater.
const LEVELS: usize = 2;

/// Relative, of the force, at most (`tests/engine/single_precision.rs`).
pub const OF_SINGLES: f64 = 3e-5;

/// Whether an accuracy of the force bears it.
pub fn accuracy_bears_singles(accuracy: f64) -> bool {
    accuracy >= COARSE
}

/// Whether a body on a mesh of a class does: where it is bare, pressed at the load line, and its far boundary round: blocks lose
/// more.
pub fn body_bears_singles(body: &Body, class: &GradingClass) -> bool {
    class.level < LEVELS && !class.is_lined() && !class.all_around && body.shape.sides.is_empty()
}
