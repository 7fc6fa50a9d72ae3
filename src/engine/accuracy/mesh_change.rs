//! What the change from one mesh to the next finer one tells of the error of the finer.
//!
//! `mesh_changes.csv` is what `cargo run --release --example mesh_changes` prints: of random bodies of each trust the two numbers on
//! each level by which the change of the work of the contact pressure bounds its error.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::engine::accuracy::known_errors::{DEPTHS, known_error};
use crate::engine::body_request::{BodyRequest, Fidelity};
use crate::engine::csv_rows::rows;
use crate::engine::spaces::THIN;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::grading::LEVEL_COUNT;

/// How far the change between meshes can be trusted as a measure of the error, ever less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trust {
    /// Near and far field are those of the class's reference, but for its ratio: the finer mesh is far better.
    Concentric,
    Full,
    /// Layers change from one material to another, beside a reference that has them too.
    Lined,
    /// Both meshes may be wrong alike: a body is nearly incompressible in plane strain, so that they lock, or nearly without
    /// shear in plane stress; its wall is thin; or it is a block more lopsided than any that was measured.
    Wary,
    /// It is nearly incompressible and its wall is thin: no mesh here is fine enough for what is squeezed along it.
    #[serde(rename = "squeezed film")]
    SqueezedFilm,
}

/// Of a concentric body, |ln r|: narrow contacts on thinner walls are no better on the next finer mesh.
const THIN_RING: f64 = DEPTHS[2];

impl Trust {
    pub const ALL: [Trust; 5] =
        [Trust::Concentric, Trust::Full, Trust::Lined, Trust::Wary, Trust::SqueezedFilm];

    pub fn of(request: &BodyRequest) -> Trust {
        let Body { shape, idealization, lining, .. } = &request.body;
        let has = |range: PoissonRange| {
            (0..=lining.list().len())
                .any(|material| PoissonRange::of(request.body.material(material)[1], *idealization) == range)
        };
        let is_thinner_than = |depth: f64| request.body.depth_range().0 < depth;
        let is_unknown_block = || {
            let beyond = Body { all_around: false, ..request.body.beyond_lining().0 };
            !shape.sides.is_empty() && known_error(&beyond, 0, 0.0).is_none()
        };
        match request.fidelity {
            Fidelity::Mesh { .. } if has(PoissonRange::Incompressible) => {
                if is_thinner_than(THIN) {
                    Trust::SqueezedFilm
                } else {
                    Trust::Wary
                }
            }
            Fidelity::Mesh { .. } if has(PoissonRange::Conformal) || is_unknown_block() => Trust::Wary,
            Fidelity::Mesh { .. } if !lining.is_empty() => Trust::Lined,
            Fidelity::Mesh { .. } if shape.concentric && is_thinner_than(THIN_RING) => Trust::Wary,
            _ if shape.concentric => Trust::Concentric,
            _ => Trust::Full,
        }
    }

    /// Estimated error of the force, relative, on a mesh level from 1 on, by its relative change since the next coarser level,
    /// summed over the bodies.
    pub fn error(self, level: usize, change: f64) -> f64 {
        let Bound { error_per_change, floor } = BOUNDS[self as usize][level];
        error_per_change * change + floor
    }
}

/// The error is below a multiple of the change and, for changes that are small by chance, a floor.
#[derive(Clone, Copy, Debug)]
struct Bound {
    error_per_change: f64,
    /// Relative, of the force.
    floor: f64,
}

/// A row of the file: trust, level, error per change, floor.
type Row = (Trust, usize, f64, f64);

/// By trust and level; nothing tells the error of level 0.
static BOUNDS: LazyLock<[[Bound; LEVEL_COUNT]; Trust::ALL.len()]> = LazyLock::new(|| {
    let unknown = Bound { error_per_change: f64::INFINITY, floor: f64::INFINITY };
    let mut bounds = [[unknown; LEVEL_COUNT]; Trust::ALL.len()];
    for (trust, level, error_per_change, floor) in rows::<Row>(include_str!("mesh_changes.csv")) {
        bounds[trust as usize][level] = Bound { error_per_change, floor };
    }
    bounds
});

#[cfg(test)]
mod tests {
    use super::*;

    /// Each trust has all levels from 1 on, and a finer one is never said to be worse.
    #[test]
    fn the_file_is_whole_and_monotone() {
        let rows = include_str!("mesh_changes.csv").lines().count() - 1;
        assert_eq!(rows, Trust::ALL.len() * (LEVEL_COUNT - 1));
        for bounds in BOUNDS.iter() {
            let known = &bounds[1..];
            let is_sound = |value: f64| value.is_finite() && value > 0.0;
            assert!(
                known.iter().all(|bound| is_sound(bound.error_per_change) && is_sound(bound.floor)),
                "{known:?}"
            );
            for pair in known.windows(2) {
                let is_no_worse =
                    pair[1].error_per_change <= pair[0].error_per_change && pair[1].floor <= pair[0].floor;
                assert!(is_no_worse, "{known:?}");
            }
        }
    }
}
