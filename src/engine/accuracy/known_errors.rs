//! What a mesh level is worth, measured: where that is enough, one mesh does, and no second one must tell how good it is.
//!
//! `known_errors.csv` is what `cargo run --release --example mesh_errors` prints: of random bodies of every kind the error of the work of the
//! contact pressure on each level, against `series` or the finest mesh, the partner being rigid. The error of a joint's force
//! is that of its bodies, each by its share of the work.

use std::ops::RangeInclusive;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::engine::csv_rows::rows;
use crate::engine::spaces::THIN;
use crate::mechanics::body::{Body, Shape, annulus, block, cored_disc, half_disc};
use crate::mechanics::material::Compressibility;

/// Levels that are known of any shape, coarsest first.
pub const KNOWN_LEVELS: usize = 5;

/// Contact half angles at which the next column begins, deg.
pub const COLUMNS: [f64; 3] = [10.0, 45.0, 75.0];

/// Least depths, |ln r|, at which the next kind of body begins; and the deepest that was drawn.
pub const DEPTHS: [f64; 7] = [0.0198, 0.1, 0.18, 0.35, 0.7, 1.5, 5.71];

/// How stiff a body is beside its shear modulus. Corners between held and free sides are the worse the stiffer it is in plane strain,
/// and coarse meshes are worse where it is auxetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stiffness {
    /// A negative Poisson's ratio.
    Auxetic,
    Ordinary,
    Stiff,
    #[serde(rename = "very stiff")]
    VeryStiff,
    #[serde(rename = "nearly incompressible")]
    NearlyIncompressible,
}

impl Stiffness {
    pub const ALL: [Stiffness; 5] = [
        Stiffness::Auxetic,
        Stiffness::Ordinary,
        Stiffness::Stiff,
        Stiffness::VeryStiff,
        Stiffness::NearlyIncompressible,
    ];

    /// `None` where it is so little stiff, or so much, that meshes behave otherwise.
    pub fn of(body: &Body) -> Option<Stiffness> {
        match Compressibility::of(body.poissons_ratio, body.idealization) {
            Compressibility::NearlyConformal | Compressibility::Locking => None,
            Compressibility::Auxetic | Compressibility::Negative => Some(Stiffness::Auxetic),
            Compressibility::Stiff => Some(Stiffness::Stiff),
            Compressibility::VeryStiff => Some(Stiffness::VeryStiff),
            Compressibility::NearlyIncompressible => Some(Stiffness::NearlyIncompressible),
            _ => Some(Stiffness::Ordinary),
        }
    }
}

/// Shapes whose meshes err alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Group {
    #[serde(rename = "concentric")]
    Concentric,
    #[serde(rename = "half disc")]
    HalfDisc,
    #[serde(rename = "block on its base")]
    BlockOnBase,
    #[serde(rename = "block held around")]
    BlockHeldAround,
}

impl Group {
    pub const ALL: [Group; 4] =
        [Group::Concentric, Group::HalfDisc, Group::BlockOnBase, Group::BlockHeldAround];

    /// `None` for shapes that were not measured.
    pub fn of(body: &Body) -> Option<Group> {
        let is = |shape: &Shape| body.shape == shape;
        if is(&annulus::SHAPE) || is(&cored_disc::SHAPE) {
            Some(Group::Concentric)
        } else if is(&half_disc::SHAPE) {
            Some(Group::HalfDisc)
        } else if is(&block::SHAPE) {
            Some(if body.support == 0 { Group::BlockOnBase } else { Group::BlockHeldAround })
        } else {
            None
        }
    }

    pub fn is_block(self) -> bool {
        matches!(self, Group::BlockOnBase | Group::BlockHeldAround)
    }

    /// The least and the greatest depth that were drawn.
    pub fn depths(self) -> [f64; 2] {
        match self {
            Group::Concentric | Group::HalfDisc => [DEPTHS[0], DEPTHS[DEPTHS.len() - 1]],
            Group::BlockOnBase | Group::BlockHeldAround => [DEPTHS[2], 2.65],
        }
    }
}

/// A kind of body whose meshes were measured: group, stiffness, and the place of its least depth among `DEPTHS`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    pub group: Group,
    pub stiffness: Stiffness,
    pub depth: usize,
}

impl Kind {
    /// `None` for bodies that were not measured, or behave otherwise.
    pub fn of(body: &Body) -> Option<Kind> {
        if !body.lining.is_empty() || body.all_around {
            return None;
        }
        let group = Group::of(body)?;
        let stiffness = Stiffness::of(body)?;
        let (least, greatest) = body.depth_range();
        let depth = DEPTHS.iter().rposition(|depth| least >= *depth)?;
        // Thin walls squeeze what is nearly incompressible along them.
        let may_be_film =
            stiffness == Stiffness::NearlyIncompressible && (group == Group::Concentric || least < THIN);
        let [shallowest, deepest] = group.depths();
        let is_measured =
            least >= shallowest && greatest <= deepest && depth < DEPTHS.len() - 1 && !may_be_film;
        is_measured.then_some(Kind { group, stiffness, depth })
    }

    fn number(self) -> usize {
        let (group, stiffness) = (self.group as usize, self.stiffness as usize);
        (group * Stiffness::ALL.len() + stiffness) * DEPTHS.len() + self.depth
    }
}

/// A row of the file: group, stiffness, least depth, level, errors.
type Row = (Group, Stiffness, f64, usize, Known);

/// A row a level, coarsest first.
pub type Table = [Known; KNOWN_LEVELS];

/// What is known of all meshes.
struct Errors {
    /// By the numbers of kinds where in `all` their tables begin; `None` for those that were not drawn often enough.
    firsts: Vec<Option<usize>>,
    /// At `NO_MESH` none.
    all: Vec<Known>,
}

/// The place among `all` of what a body leaves that is on no mesh.
pub const NO_MESH: usize = 0;

static ERRORS: LazyLock<Errors> = LazyLock::new(|| {
    let mut firsts = vec![None; Group::ALL.len() * Stiffness::ALL.len() * DEPTHS.len()];
    let mut all = vec![[0.0; _]];
    for (group, stiffness, least, level, errors) in rows::<Row>(include_str!("known_errors.csv")) {
        let depth = DEPTHS.iter().filter(|depth| **depth < least).count();
        let first = *firsts[Kind { group, stiffness, depth }.number()].get_or_insert_with(|| {
            all.extend([[f64::NAN; _]; KNOWN_LEVELS]);
            all.len() - KNOWN_LEVELS
        });
        all[first + level] = errors;
    }
    Errors { firsts, all }
});

/// What is known of all meshes, one after another.
pub fn all() -> &'static [Known] {
    &ERRORS.all
}

/// The place among `all` of what is known of a body on a mesh level.
pub fn place(body: &Body, level: usize) -> Option<usize> {
    place_from(first_place(body)?, level)
}

/// The same of the coarsest one.
pub fn first_place(body: &Body) -> Option<usize> {
    ERRORS.firsts[Kind::of(body)?.number()]
}

/// The same by the place of the coarsest one.
pub fn place_from(first: usize, level: usize) -> Option<usize> {
    (level < KNOWN_LEVELS).then_some(first + level)
}

/// Of a half angle, rad.
pub fn column(half_angle: f64) -> usize {
    COLUMNS.iter().take_while(|begin| half_angle.to_degrees() >= **begin).count()
}

/// Those of half angles, rad, from the one to the other.
pub fn columns([narrowest, widest]: [f64; 2]) -> RangeInclusive<usize> {
    column(narrowest)..=column(widest)
}

/// What is known of a body on a mesh level, by `column`.
pub type Known = [f64; COLUMNS.len() + 1];

/// Errors of the force at most, relative, of each level, by the place of the coarsest.
pub fn known_of_levels(first: usize) -> Option<&'static Table> {
    all().get(first..)?.first_chunk()
}

/// Those of one level; `None` for bodies that were not measured, or behave otherwise: nearly incompressible, nearly conformal.
pub fn known_errors(body: &Body, level: usize) -> Option<&'static Known> {
    all().get(place(body, level)?)
}

/// That at a contact half angle, rad.
pub fn known_error(body: &Body, level: usize, half_angle: f64) -> Option<f64> {
    Some(known_errors(body, level)?[column(half_angle)])
}

/// The coarsest level that is known to be good enough whatever the load and the other body.
pub fn known_level(body: &Body, accuracy: f64) -> Option<usize> {
    let is_enough = |errors: &Known| errors.iter().all(|error| *error <= accuracy);
    (0..KNOWN_LEVELS).find(|level| known_errors(body, *level).is_some_and(is_enough))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every row is read, every kind has all levels, and a finer one is never said to be worse.
    #[test]
    fn the_file_is_whole_and_monotone() {
        let rows = include_str!("known_errors.csv").lines().count() - 1;
        assert_eq!(all()[NO_MESH], [0.0; _]);
        let (tables, rest) = all()[1..].as_chunks::<KNOWN_LEVELS>();
        assert_eq!((rest.len(), tables.len() * KNOWN_LEVELS), (0, rows));
        assert_eq!(tables.len(), ERRORS.firsts.iter().flatten().count());
        assert!(tables.len() > 40, "{}", tables.len());
        for table in tables {
            assert!(table.iter().flatten().all(|error| *error > 0.0 && *error < 0.2), "{table:?}");
            for pair in table.windows(2) {
                assert!(pair[0].iter().zip(&pair[1]).all(|(coarse, fine)| fine <= coarse), "{table:?}");
            }
        }
    }
}
