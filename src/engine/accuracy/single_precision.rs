//! Which bodies the processor condenses in single precision, and what that leaves of a force, there and on a device, whose contact is in it,
//! too.

use crate::engine::accuracy::known_errors::known_errors;
use crate::mechanics::body::Body;
use crate::mechanics::grading::GradingClass;

/// From this accuracy on, relative, of the force.
const COARSE: f64 = 1e-2;

/// On these mesh levels, the coarsest: their own errors are mostly far greater.
const LEVELS: usize = 2;

/// What single precision leaves of a body, relative, of the force, at most: on the processor (`tests/engine/single_precision.rs`), and
/// on a device with its contact (`tests/gpu_parity/sweeps.rs`).
pub const OF_SINGLES: f64 = 1e-4;

/// What it leaves of a force, relative, at most, where a device solves the contact of interpolated bodies in it
/// (`tests/gpu_parity/joints.rs`).
pub const OF_CONTACT_IN_SINGLES: f64 = 1e-5;

/// Whether an accuracy of the force bears it.
pub fn accuracy_bears_singles(accuracy: f64) -> bool {
    accuracy >= COARSE
}

/// Whether a body on a mesh of a class does: where its meshes were measured, it is bare, pressed at the load line, and its far boundary
/// round. Blocks lose more, and so may what is too deep, too thin or too little compressible to have been measured.
pub fn body_bears_singles(body: &Body, class: &GradingClass) -> bool {
    let may_be =
        class.level < LEVELS && !class.is_lined() && !class.all_around && body.shape.sides.is_empty();
    may_be && known_errors(body, class.level).is_some()
}
