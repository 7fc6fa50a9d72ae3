//! What a mesh level is worth, measured: where that is enough, one mesh does, and no second one must tell how good it is.
//!
//! `examples/mesh_errors.rs` solved 650 to 1,500 bodies of each shape on every level, of stiff ones 400 half discs and 200
//! to 260 blocks of each support, and compared the work of the contact pressure with `series`, or with the finest mesh, under
//! loads of eight decades, the partner being rigid. The numbers are above what 99 of 100 had, most by a quarter. The error
//! of a joint's force is that of its bodies, each by its share of the work.

use crate::mechanics::body::{Body, Shape, annulus, block, cored_disc, half_disc};
use crate::mechanics::compliance::near_field::NEARLY_INCOMPRESSIBLE;
use crate::mechanics::grading::STIFF;
use crate::mechanics::material::Idealization;

/// Levels that are known of any shape, coarsest first.
pub const KNOWN_LEVELS: usize = 5;

/// Contact half angles at which the next column begins, deg.
const COLUMNS: [f64; 3] = [10.0, 45.0, 75.0];

/// A row a level, coarsest first.
type Table = [[f64; COLUMNS.len() + 1]; KNOWN_LEVELS];

const CONCENTRIC: Table = [
    [9.8e-4, 2.3e-3, 2.7e-3, 3.0e-3],
    [5.2e-4, 9.2e-4, 1.1e-3, 1.2e-3],
    [1.9e-4, 3.1e-4, 3.6e-4, 3.8e-4],
    [6.2e-5, 9.7e-5, 1.2e-4, 1.1e-4],
    [2.9e-5, 2.5e-5, 2.9e-5, 2.7e-5],
];

const HALF_DISC: Table = [
    [1.2e-3, 1.6e-3, 1.5e-3, 3.4e-3],
    [4.0e-4, 5.5e-4, 5.0e-4, 9.9e-4],
    [1.9e-4, 3.0e-4, 2.7e-4, 5.1e-4],
    [8.6e-5, 1.5e-4, 2.9e-4, 1.7e-4],
    [2.9e-5, 5.2e-5, 9.6e-5, 7.4e-5],
];

const STIFF_HALF_DISC: Table = [
    [1.3e-3, 1.4e-3, 3.0e-4, 4.5e-3],
    [6.2e-4, 8.0e-4, 9.2e-4, 1.4e-3],
    [3.3e-4, 5.2e-4, 5.9e-4, 6.6e-4],
    [1.5e-4, 2.9e-4, 5.8e-4, 2.8e-4],
    [5.5e-5, 1.1e-4, 2.3e-4, 1.6e-4],
];

const VERY_STIFF_HALF_DISC: Table = [
    [1.3e-3, 1.4e-3, 2.3e-3, 1.8e-2],
    [7.4e-4, 9.3e-4, 1.1e-3, 4.7e-3],
    [4.4e-4, 7.3e-4, 1.4e-3, 1.8e-3],
    [2.4e-4, 4.8e-4, 1.2e-3, 4.5e-4],
    [9.0e-5, 1.8e-4, 5.3e-4, 2.5e-4],
];

const NEARLY_INCOMPRESSIBLE_HALF_DISC: Table = [
    [1.2e-3, 1.5e-3, 7.9e-3, 3.5e-2],
    [1.1e-3, 9.3e-4, 1.1e-3, 9.9e-3],
    [4.5e-4, 7.3e-4, 1.6e-3, 4.4e-3],
    [3.2e-4, 6.2e-4, 2.3e-3, 4.2e-4],
    [1.2e-4, 2.4e-4, 8.8e-4, 3.5e-4],
];

const BLOCK_HELD_AROUND: Table = [
    [2.6e-3, 3.2e-3, 4.2e-3, 3.2e-3],
    [1.1e-3, 1.6e-3, 1.6e-3, 1.5e-3],
    [4.5e-4, 6.8e-4, 8.2e-4, 8.7e-4],
    [9.4e-5, 2.4e-4, 6.1e-4, 6.8e-4],
    [2.3e-5, 6.5e-5, 1.4e-4, 1.5e-4],
];

const BLOCK_ON_BASE: Table = [
    [7.2e-3, 9.9e-3, 7.9e-3, 6.0e-3],
    [2.7e-3, 2.8e-3, 3.4e-3, 3.1e-3],
    [9.3e-4, 8.2e-4, 9.3e-4, 9.0e-4],
    [2.7e-4, 4.2e-4, 4.5e-4, 4.3e-4],
    [6.0e-5, 1.0e-4, 1.2e-4, 1.0e-4],
];

const STIFF_BLOCK_HELD_AROUND: Table = [
    [1.0e-2, 3.3e-3, 6.3e-3, 7.6e-3],
    [3.4e-3, 2.3e-3, 2.7e-3, 1.6e-3],
    [6.0e-4, 1.0e-3, 1.4e-3, 1.3e-3],
    [2.0e-4, 4.4e-4, 1.2e-3, 4.6e-4],
    [4.3e-5, 9.8e-5, 3.8e-4, 2.0e-4],
];

const STIFF_BLOCK_ON_BASE: Table = [
    [1.3e-2, 1.2e-2, 1.2e-2, 1.2e-2],
    [6.1e-3, 8.0e-3, 8.0e-3, 8.0e-3],
    [1.7e-3, 1.0e-3, 1.0e-3, 1.0e-3],
    [4.8e-4, 4.5e-4, 4.9e-4, 4.9e-4],
    [1.2e-4, 2.1e-4, 2.2e-4, 2.2e-4],
];

const VERY_STIFF_BLOCK_ON_BASE: Table = [
    [2.0e-2, 1.9e-2, 2.0e-2, 2.0e-2],
    [9.5e-3, 1.3e-2, 1.3e-2, 1.3e-2],
    [3.0e-3, 2.1e-3, 2.1e-3, 2.1e-3],
    [7.5e-4, 1.0e-3, 1.0e-3, 1.0e-3],
    [3.1e-4, 4.6e-4, 4.7e-4, 4.7e-4],
];

const NEARLY_INCOMPRESSIBLE_BLOCK_ON_BASE: Table = [
    [2.6e-2, 2.6e-2, 2.6e-2, 2.6e-2],
    [1.4e-2, 1.7e-2, 1.8e-2, 1.8e-2],
    [3.5e-3, 4.1e-3, 4.2e-3, 4.2e-3],
    [1.4e-3, 1.9e-3, 2.1e-3, 2.1e-3],
    [5.8e-4, 8.5e-4, 8.8e-4, 8.8e-4],
];

/// |ln r| of the shallowest and the deepest place that were drawn.
const DEPTHS: [f64; 2] = [0.0198, 5.71];
const DEPTHS_OF_BLOCKS: [f64; 2] = [0.182, 2.65];

/// Corners between held and free sides are the worse the stiffer a body is in plane strain beside its shear modulus.
#[derive(Clone, Copy)]
enum Stiffness {
    Ordinary,
    Stiff,
    VeryStiff,
    NearlyIncompressible,
}

impl Stiffness {
    /// `None` where it is so little stiff, or so much, that meshes behave otherwise.
    fn of(body: &Body) -> Option<Stiffness> {
        match (body.idealization, body.poissons_ratio) {
            (Idealization::PlaneStress, ratio) => (ratio > -0.75).then_some(Stiffness::Ordinary),
            (Idealization::PlaneStrain, ratio) if ratio <= STIFF => Some(Stiffness::Ordinary),
            (Idealization::PlaneStrain, ratio) if ratio < 0.45 => Some(Stiffness::Stiff),
            (Idealization::PlaneStrain, ratio) if ratio < 0.48 => Some(Stiffness::VeryStiff),
            (Idealization::PlaneStrain, ratio) => (ratio < 0.49).then_some(Stiffness::NearlyIncompressible),
        }
    }
}

/// The error of the force, relative, at a contact half angle (rad) on a mesh level at most; `None` for bodies and levels
/// that were not measured, or behave otherwise: nearly incompressible, nearly conformal.
pub fn known_error(body: &Body, level: usize, half_angle: f64) -> Option<f64> {
    let column = COLUMNS.iter().take_while(|begin| half_angle.to_degrees() >= **begin).count();
    Some(table(body)?.get(level)?[column])
}

/// The worst of all half angles.
pub fn worst_known_error(body: &Body, level: usize) -> Option<f64> {
    Some(table(body)?.get(level)?.iter().fold(0.0, |worst: f64, error| worst.max(*error)))
}

/// The coarsest level that is known to be good enough whatever the load and the other body.
pub fn known_level(body: &Body, accuracy: f64) -> Option<usize> {
    (0..KNOWN_LEVELS).find(|level| worst_known_error(body, *level).is_some_and(|error| error <= accuracy))
}

fn table(body: &Body) -> Option<&'static Table> {
    let is = |shape: &Shape| shape.name == body.shape.name;
    let stiffness = Stiffness::of(body)?;
    let (table, [shallowest, deepest]) = if is(&half_disc::SHAPE) {
        let table = match stiffness {
            Stiffness::Ordinary => &HALF_DISC,
            Stiffness::Stiff => &STIFF_HALF_DISC,
            Stiffness::VeryStiff => &VERY_STIFF_HALF_DISC,
            Stiffness::NearlyIncompressible => &NEARLY_INCOMPRESSIBLE_HALF_DISC,
        };
        (table, DEPTHS)
    } else if is(&block::SHAPE) {
        let table = match (stiffness, body.support) {
            (Stiffness::Ordinary, 0) => &BLOCK_ON_BASE,
            (Stiffness::Ordinary, _) => &BLOCK_HELD_AROUND,
            (Stiffness::Stiff, 0) => &STIFF_BLOCK_ON_BASE,
            (Stiffness::VeryStiff, 0) => &VERY_STIFF_BLOCK_ON_BASE,
            (Stiffness::NearlyIncompressible, 0) => &NEARLY_INCOMPRESSIBLE_BLOCK_ON_BASE,
            (_, _) => &STIFF_BLOCK_HELD_AROUND,
        };
        (table, DEPTHS_OF_BLOCKS)
    } else if is(&annulus::SHAPE) || is(&cored_disc::SHAPE) {
        (&CONCENTRIC, DEPTHS)
    } else {
        return None;
    };
    // Thin walls squeeze what is nearly incompressible along them.
    let may_be_film = body.shape.concentric && body.poissons_ratio > NEARLY_INCOMPRESSIBLE;
    if may_be_film && body.idealization == Idealization::PlaneStrain {
        return None;
    }
    let (least, greatest) = body.depth_range();
    (least >= shallowest && greatest <= deepest).then_some(table)
}
