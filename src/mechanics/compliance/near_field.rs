//! What the mesh cannot see near the ring, from the exact solution of a concentric body on the same mesh.
//!
//! The error of a condensed compliance is local: it comes from elements at the ring that are as large as the contact
//! arc. It is the same for every body with those elements, so it is measured once for a class of bodies, on the
//! concentric body that stands for the class, as the difference of its exact compliance (`series`) and its condensed
//! one, and added to each:
//!
//! ```text
//!   A = A_mesh(body) + [A_series(reference) - A_mesh(reference)].
//! ```
//!
//! Equivalently: contact sees the exact kernel of the reference, and the mesh only the smooth difference of two bodies
//! (subtraction of the singularity). What is left is the far field's error. The difference in brackets is a smooth
//! function of Poisson's ratio and is interpolated between Chebyshev nodes, which fill the lanes of one batch.

use std::f64::consts::{FRAC_PI_2, PI};

use pulp::{Arch, Simd, WithSimd};

use super::lane_condensation::CondensationPlan;
use super::pressure_space::PressureSpace;
use super::series::ConcentricBody;
use super::{NODE_COUNT, PressureCompliance};
use crate::mechanics::body::{Body, MAX_PARAMETERS, Side, annulus, cored_disc};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::Grading;
use crate::mechanics::real::LANES;

/// |ln r| of a reference's fixed circle, at most: deeper bodies bring a far field of their own.
const DEEPEST_REFERENCE: f64 = 1.2;

/// A part of the range of Poisson's ratio over which the error of a mesh is interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PoissonRange {
    /// Plane stress close to -1, nearly without shear.
    Conformal,
    /// Plane stress, the rest of the negative ones.
    Auxetic,
    /// Plane strain, all negative ones.
    Negative,
    Positive,
    /// Plane strain close to 1/2, nearly incompressible.
    Incompressible,
}

/// From this Poisson's ratio on, plane strain is nearly incompressible: the error of a mesh is no polynomial of Poisson's
/// ratio any more, but a smooth function of ln(1 - 2 nu).
const NEARLY_INCOMPRESSIBLE: f64 = 0.47;

/// Of 1 - 2 nu: below it nothing changes any more.
const LEAST_COMPRESSIBILITY: f64 = 1e-5;

/// Up to this Poisson's ratio a mesh in plane stress resists shear as one in plane strain does compression close to 1/2: its
/// error is a smooth function of ln(1 + nu).
const NEARLY_CONFORMAL: f64 = -0.75;

/// Of 1 + nu: below it nothing changes any more.
const LEAST_SHEAR: f64 = 1e-3;

impl PoissonRange {
    pub fn of(poissons_ratio: f64, idealization: Idealization) -> PoissonRange {
        match idealization {
            Idealization::PlaneStress if poissons_ratio < NEARLY_CONFORMAL => PoissonRange::Conformal,
            Idealization::PlaneStress if poissons_ratio < 0.0 => PoissonRange::Auxetic,
            Idealization::PlaneStrain if poissons_ratio < 0.0 => PoissonRange::Negative,
            Idealization::PlaneStrain if poissons_ratio > NEARLY_INCOMPRESSIBLE => {
                PoissonRange::Incompressible
            }
            _ => PoissonRange::Positive,
        }
    }

    /// Where the logarithm of `Idealization::margin` is interpolated in: the margin below which nothing changes any more.
    pub fn least_margin(self) -> Option<f64> {
        match self {
            PoissonRange::Conformal => Some(LEAST_SHEAR),
            PoissonRange::Incompressible => Some(LEAST_COMPRESSIBILITY),
            _ => None,
        }
    }

    /// What is interpolated in.
    fn coordinate(self, poissons_ratio: f64) -> f64 {
        match self {
            PoissonRange::Conformal => (1.0 + poissons_ratio).max(LEAST_SHEAR).ln(),
            PoissonRange::Incompressible => (1.0 - 2.0 * poissons_ratio).max(LEAST_COMPRESSIBILITY).ln(),
            _ => poissons_ratio,
        }
    }

    /// The reverse of `coordinate`.
    fn poissons_ratio(self, coordinate: f64) -> f64 {
        match self {
            PoissonRange::Conformal => coordinate.exp() - 1.0,
            PoissonRange::Incompressible => 0.5 * (1.0 - coordinate.exp()),
            _ => coordinate,
        }
    }

    /// Chebyshev nodes of the range, as coordinates, and their barycentric weights.
    pub fn nodes(self) -> [(f64, f64); LANES] {
        let (low, high) = match self {
            PoissonRange::Conformal => (LEAST_SHEAR.ln(), (1.0 + NEARLY_CONFORMAL).ln()),
            PoissonRange::Auxetic => (NEARLY_CONFORMAL, 0.0),
            PoissonRange::Negative => (-1.0, 0.0),
            PoissonRange::Positive => (0.0, 0.5),
            PoissonRange::Incompressible => {
                (LEAST_COMPRESSIBILITY.ln(), (1.0 - 2.0 * NEARLY_INCOMPRESSIBLE).ln())
            }
        };
        std::array::from_fn(|i| {
            let angle = PI * (i as f64 + 0.5) / LANES as f64;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            (0.5 * (low + high) + 0.5 * (high - low) * angle.cos(), sign * angle.sin())
        })
    }
}

/// Bodies of one class share a near field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NearFieldClass {
    pub side: Side,
    /// Whether the ring ends at pi/2.
    pub half_ring: bool,
    pub grading: GradingClass,
    pub idealization: Idealization,
    pub range: PoissonRange,
}

impl NearFieldClass {
    /// The concentric body that stands for the class, but for its Poisson's ratio.
    fn reference(&self) -> ConcentricBody {
        let depth = self.grading.cut_at(DEEPEST_REFERENCE).nominal_depth();
        let fixed_radius = if self.side == Side::Plate { depth.exp() } else { (-depth).exp() };
        ConcentricBody { fixed_radius, poissons_ratio: 0.0, idealization: self.idealization }
    }

    /// The highest mode whose moments the near field needs.
    pub fn highest_mode(&self) -> usize {
        self.reference().highest_mode()
    }
}

/// The difference between the exact and the condensed compliance of a class's reference body.
pub struct NearField {
    pub range: PoissonRange,
    /// `[node of Poisson's ratio][node in eps][packed lower triangle]`.
    pub values: [Vec<f64>; LANES],
}

impl NearField {
    /// `moments` are `space.moments(highest)` with `highest` at least the class's `highest_mode()`.
    pub fn new(
        class: &NearFieldClass,
        space: &PressureSpace,
        moments: &[[f64; NODE_COUNT]],
        highest: usize,
    ) -> NearField {
        let NearFieldClass { side, half_ring, grading, idealization, range } = *class;
        let reference = class.reference();
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = reference.fixed_radius;
        let bodies = range.nodes().map(|(coordinate, _)| Body {
            shape: if side == Side::Plate { &annulus::SHAPE } else { &cored_disc::SHAPE },
            parameters,
            support: 0,
            poissons_ratio: range.poissons_ratio(coordinate),
            idealization,
        });
        let end_angle = if half_ring { FRAC_PI_2 } else { PI };
        let plan = CondensationPlan::new(
            &bodies[0],
            whole_ring(&grading.cut_at(DEEPEST_REFERENCE), end_angle),
            space,
        );
        let mut condensed = plan.condense(&bodies).into_iter();
        let values = bodies.map(|body| {
            let exact = ConcentricBody { poissons_ratio: body.poissons_ratio, ..reference };
            let exact = exact.compliance(space, moments, highest);
            let Some(mesh) = condensed.next() else { unreachable!("one compliance a body") };
            exact.values.iter().zip(&mesh.values).map(|(exact, mesh)| exact - mesh).collect()
        });
        NearField { range, values }
    }

    /// Shares of the `LANES` nodes of Poisson's ratio in the near field of a body; they sum to one.
    pub fn shares(range: PoissonRange, poissons_ratio: f64) -> [f64; LANES] {
        let nodes = range.nodes();
        let coordinate = range.coordinate(poissons_ratio);
        if let Some(node) = nodes.iter().position(|(node, _)| *node == coordinate) {
            return std::array::from_fn(|i| if i == node { 1.0 } else { 0.0 });
        }
        let weights = nodes.map(|(node, weight)| weight / (coordinate - node));
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }

    /// Adds the near field to a condensed compliance of a body of the class.
    ///
    /// The exact compliance comes without its -pi/2 c ln b, so the sum does too: c is a polynomial of Poisson's ratio.
    pub fn correct(&self, poissons_ratio: f64, compliance: &mut PressureCompliance) {
        let shares = NearField::shares(self.range, poissons_ratio);
        Arch::new().dispatch(AddShares { shares, nodes: &self.values, values: &mut compliance.values });
    }
}

/// Adds to `values` the shares of what belongs to each node of Poisson's ratio.
struct AddShares<'a> {
    shares: [f64; LANES],
    nodes: &'a [Vec<f64>; LANES],
    values: &'a mut [f64],
}

impl WithSimd for AddShares<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let AddShares { shares, nodes, values } = self;
        for (share, of_node) in shares.iter().zip(nodes) {
            for (value, near) in values.iter_mut().zip(of_node) {
                *value += share * near;
            }
        }
    }
}

/// The class's division of a ring that ends at `end_angle`, continued by its mirror image where that is pi/2.
fn whole_ring(class: &GradingClass, end_angle: f64) -> Grading {
    let mut grading = class.grading(end_angle);
    if end_angle < PI {
        let mirror: Vec<f64> =
            grading.angles.iter().rev().skip(1).map(|angle| 2.0 * end_angle - angle).collect();
        grading.angles.extend(mirror);
    }
    grading
}
