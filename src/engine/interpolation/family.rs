//! Bodies whose compliance is one smooth function of a few coordinates.

use crate::engine::spaces::THIN;
use crate::mechanics::body::{Body, DEEPEST_MESHED, MAX_PARAMETERS, Shape};
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::material::Idealization;

/// Shape ratios and Poisson's ratio.
pub const MOST_COORDINATES: usize = MAX_PARAMETERS + 1;

/// Bodies whose compliance is one smooth function of their coordinates, in either plane state but for E'.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FamilyKey {
    shape: &'static str,
    support: usize,
    range: PoissonRange,
    /// Of the pressure space, for which the pin decides.
    pub half_ring: bool,
}

impl FamilyKey {
    /// Of a body; `None` where the error of a mesh is not known well enough to fit many of them, where walls are so thin that
    /// they ask for more trial pressures than a fit has, where the far boundary is beyond what meshes carry, and where there are layers.
    pub fn of(body: &Body, half_ring: bool) -> Option<FamilyKey> {
        let Body { shape, support, poissons_ratio, idealization, .. } = *body;
        let range = PoissonRange::of(poissons_ratio, idealization);
        let trusted = !matches!(range, PoissonRange::Incompressible | PoissonRange::Conformal);
        let (least, greatest) = body.depth_range();
        let thick = least > THIN && greatest < DEEPEST_MESHED;
        (trusted && thick && body.lining.is_empty()).then_some(FamilyKey {
            shape: shape.name,
            support,
            range,
            half_ring,
        })
    }
}

/// A body as a point: measures in which its compliance is close to a polynomial.
pub type Point = [f64; MOST_COORDINATES];

/// How many coordinates a body of a shape has.
pub fn coordinate_count(shape: &Shape) -> usize {
    shape.parameters.len() + 1
}

/// The coordinates of a body, Poisson's ratio last; those beyond `coordinate_count` are zero.
///
/// A ratio counts by its depth |ln r|: a thin wall's compliance grows with it, a distant boundary's influence goes down
/// exponentially. Concentric bodies are the better for its logarithm. Poisson's ratio counts by the logarithm of the shear modulus over the
/// bulk modulus of the plane, as meshes feel it.
pub fn coordinates(body: &Body) -> Point {
    let mut point = [0.0; MOST_COORDINATES];
    let count = body.shape.parameters.len();
    for (coordinate, ratio) in point.iter_mut().zip(&body.parameters[..count]) {
        let depth = ratio.ln();
        *coordinate = if body.shape.concentric { depth.abs().ln() } else { depth };
    }
    point[count] = body.idealization.shear_to_bulk(body.poissons_ratio).ln();
    point
}

/// The reverse of `coordinates`, for a body like `example`.
pub fn body_at(example: &Body, point: &[f64]) -> Body {
    let mut body = example.clone();
    let count = example.shape.parameters.len();
    for i in 0..count {
        let depth = if example.shape.concentric { point[i].exp() } else { point[i] };
        let inward = example.shape.parameters[i].below <= 1.0;
        body.parameters[i] = if inward && example.shape.concentric { (-depth).exp() } else { depth.exp() };
    }
    (body.idealization, body.poissons_ratio) = Idealization::of_shear_to_bulk(point[count].exp());
    body
}

/// What is to be fitted: a box of bodies like `example`.
#[derive(Clone, Debug)]
pub struct Family {
    pub key: FamilyKey,
    pub example: Body,
    /// Of each coordinate.
    pub ranges: Vec<(f64, f64)>,
    /// Whether the samples are exact; else on meshes.
    pub exact: bool,
}

impl Family {
    /// The ranges that have a width.
    pub(super) fn free(&self) -> usize {
        self.ranges.iter().filter(|(low, high)| high > low).count()
    }
}
