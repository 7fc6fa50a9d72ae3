//! What a mesh level is worth, measured: where that is enough, one mesh does, and no second one must tell how good it is.
//!
//! `examples/mesh_errors.rs` solved some hundred bodies of each shape on every level and compared the work of the contact
//! pressure with `series`, or with the finest mesh, under loads of eight decades, the partner being rigid. The numbers
//! are above what 99 of 100 had, most by a quarter, and above what any had where that decides whether 0.1 % is met. The
//! error of a joint's force is that of its bodies, each by its share of the work, so the worse of the two bounds it.

use crate::mechanics::body::{Body, Shape, annulus, block, cored_disc, half_disc};
use crate::mechanics::material::Idealization;

/// Levels that are known of any shape, coarsest first.
pub const KNOWN_LEVELS: usize = 4;

/// Contact half angles at which the next column begins, deg.
const COLUMNS: [f64; 3] = [10.0, 45.0, 75.0];

/// A row a level, coarsest first.
type Row = [f64; COLUMNS.len() + 1];

const CONCENTRIC: [Row; KNOWN_LEVELS] = [
    [9.6e-4, 2.3e-3, 2.7e-3, 3.0e-3],
    [5.2e-4, 9.2e-4, 1.1e-3, 1.2e-3],
    [1.0e-4, 1.7e-4, 1.9e-4, 1.9e-4],
    [5.5e-5, 8.4e-5, 9.5e-5, 9.7e-5],
];

const HALF_DISC: [Row; KNOWN_LEVELS] = [
    [1.9e-3, 2.7e-3, 4.4e-3, 8.7e-3],
    [1.8e-3, 2.4e-3, 3.5e-3, 6.2e-3],
    [5.8e-4, 1.2e-3, 2.2e-3, 3.0e-3],
    [2.7e-4, 5.3e-4, 9.9e-4, 1.3e-3],
];

const STIFF_HALF_DISC: [Row; KNOWN_LEVELS] = [
    [3.0e-3, 4.7e-3, 1.1e-2, 8.7e-3],
    [3.0e-3, 4.2e-3, 8.2e-3, 6.2e-3],
    [1.3e-3, 2.4e-3, 5.8e-3, 3.4e-3],
    [6.0e-4, 1.2e-3, 2.9e-3, 1.6e-3],
];

const BLOCK_HELD_AROUND: [Row; KNOWN_LEVELS] = [
    [2.8e-3, 3.8e-3, 3.9e-3, 3.0e-3],
    [1.1e-3, 1.7e-3, 1.7e-3, 1.5e-3],
    [2.4e-4, 4.2e-4, 7.5e-4, 7.2e-4],
    [9.8e-5, 1.7e-4, 2.9e-4, 3.9e-4],
];

const STOUT_BLOCK_ON_BASE: [Row; KNOWN_LEVELS] = [
    [7.2e-3, 9.9e-3, 9.9e-3, 8.7e-3],
    [2.8e-3, 2.1e-3, 2.7e-3, 2.7e-3],
    [9.2e-4, 8.1e-4, 9.8e-4, 9.7e-4],
    [2.4e-4, 3.3e-4, 5.0e-4, 4.2e-4],
];

// From the third level on they differ so much that a coarser mesh tells more of each than the worst of all.

const BLOCK_ON_BASE: [Row; 2] = [[9.8e-3, 1.4e-2, 1.4e-2, 1.3e-2], [4.7e-3, 7.7e-3, 8.4e-3, 8.0e-3]];

/// Corners between held and free sides are the worse the closer Poisson's ratio is to 1/2 in plane strain: from here on bodies
/// are stiff.
const STIFF: f64 = 0.42;

/// The depth of a block below the hole over its half width from which on it is no stout one: the ends of its base bear more.
const SLENDER: f64 = 1.5;

/// |ln r| of the shallowest and the deepest place that were drawn.
const DEPTHS: [f64; 2] = [0.0198, 5.71];
const DEPTHS_OF_BLOCKS: [f64; 2] = [0.182, 2.65];

/// The error of the force, relative, at a contact half angle (rad) on a mesh level at most; `None` for bodies and levels
/// that were not measured, or behave otherwise: nearly incompressible, nearly conformal.
pub fn known_error(body: &Body, level: usize, half_angle: f64) -> Option<f64> {
    let column = COLUMNS.iter().take_while(|begin| half_angle.to_degrees() >= **begin).count();
    Some(row(body, level)?[column])
}

/// The worst of all half angles.
pub fn worst_known_error(body: &Body, level: usize) -> Option<f64> {
    Some(row(body, level)?.iter().fold(0.0, |worst: f64, error| worst.max(*error)))
}

fn row(body: &Body, level: usize) -> Option<&'static Row> {
    let (is_ordinary, is_stiff) = match body.idealization {
        Idealization::PlaneStress => (body.poissons_ratio > -0.75, false),
        Idealization::PlaneStrain => (body.poissons_ratio < 0.47, body.poissons_ratio > STIFF),
    };
    let is = |shape: &Shape| shape.name == body.shape.name;
    let [half_width, below, _] = body.parameters;
    let (table, [shallowest, deepest]): (&'static [Row], _) = match body.support {
        _ if !is_ordinary => return None,
        _ if is(&annulus::SHAPE) || is(&cored_disc::SHAPE) => (&CONCENTRIC, DEPTHS),
        _ if is(&half_disc::SHAPE) && is_stiff => (&STIFF_HALF_DISC, DEPTHS),
        _ if is(&half_disc::SHAPE) => (&HALF_DISC, DEPTHS),
        0 if is(&block::SHAPE) && (is_stiff || below > SLENDER * half_width) => {
            (&BLOCK_ON_BASE, DEPTHS_OF_BLOCKS)
        }
        0 if is(&block::SHAPE) => (&STOUT_BLOCK_ON_BASE, DEPTHS_OF_BLOCKS),
        1 if is(&block::SHAPE) => (&BLOCK_HELD_AROUND, DEPTHS_OF_BLOCKS),
        _ => return None,
    };
    let (least, greatest) = (body.shape.depth_range)(&body.parameters);
    if least < shallowest || greatest > deepest { None } else { table.get(level) }
}
