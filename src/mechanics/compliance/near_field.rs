//! What the mesh cannot see near the ring, from the exact solution of a concentric body on the same mesh.
//!
//! The error of a condensed compliance is local: it comes from elements at the ring that are as large as the contact
//! arc. It is the same for every body with those elements, so it is measured once for a class of bodies, on the
//! concentric body that stands for the class, as the difference of its exact works (`series`) and its condensed ones, and
//! added to each:
//!
//! ```text
//!   D = C_mesh(body) - C_infinite + [C_series(reference) - C_mesh(reference)].
//! ```
//!
//! Equivalently: contact sees the exact kernel of the reference, and the mesh only the smooth difference of two bodies
//! (subtraction of the singularity). What is left is the far field's error. The difference in brackets is a smooth
//! function of Poisson's ratio and is interpolated between Chebyshev nodes, which fill the lanes of one batch; and of the
//! growth of the layers where contact begins, between steps of which it is interpolated linearly.

use std::f64::consts::{FRAC_PI_2, PI};

use super::lane_condensation::CondensationPlan;
use super::ring_modes::{Push, RingModes};
use super::series::ConcentricBody;
use crate::mechanics::body::lining::Lining;
use crate::mechanics::body::{Body, MAX_PARAMETERS, Shape, Side, annulus, cored_disc};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::lining_rows::LiningRows;
use crate::mechanics::material::{Compressibility, Idealization};
use crate::mechanics::mesh::Grading;
use crate::mechanics::real::LANES;

/// |ln r| of a reference's fixed circle, at most: deeper bodies bring a far field of their own.
pub const DEEPEST_REFERENCE: f64 = 1.2;

/// A part of the range of Poisson's ratio over which the error of a mesh is interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PoissonRange {
    /// Plane stress close to -1, nearly without shear.
    Conformal,
    /// Plane stress, the rest of the negative ones.
    Auxetic,
    /// Plane stress, the positive ones.
    Positive,
    /// Plane strain, all negative ones.
    Negative,
    /// Plane strain, most of the positive ones.
    Compressible,
    /// Plane strain close to 1/2, nearly incompressible.
    Incompressible,
}

/// Of 1 - 2 nu: below it nothing changes any more.
const LEAST_COMPRESSIBILITY: f64 = 1e-5;

/// Of 1 + nu: below it nothing changes any more.
const LEAST_SHEAR: f64 = 1e-3;

impl PoissonRange {
    pub fn of(poissons_ratio: f64, idealization: Idealization) -> PoissonRange {
        match Compressibility::of(poissons_ratio, idealization) {
            Compressibility::NearlyConformal => PoissonRange::Conformal,
            Compressibility::Auxetic => PoissonRange::Auxetic,
            Compressibility::Positive => PoissonRange::Positive,
            Compressibility::Negative => PoissonRange::Negative,
            Compressibility::Moderate | Compressibility::Stiff | Compressibility::VeryStiff => {
                PoissonRange::Compressible
            }
            Compressibility::NearlyIncompressible | Compressibility::Locking => PoissonRange::Incompressible,
        }
    }

    /// What is interpolated in: the error of a mesh is a smooth function of ln(1 - 2 nu) close to 1/2, with poles just beyond, of a root
    /// of 1 - 2 nu below, and of ln(1 + nu) close to -1 in plane stress.
    pub fn coordinate(self, poissons_ratio: f64) -> f64 {
        match self {
            PoissonRange::Conformal => (1.0 + poissons_ratio).max(LEAST_SHEAR).ln(),
            PoissonRange::Compressible => (1.0 - 2.0 * poissons_ratio).powf(0.25),
            PoissonRange::Incompressible => (1.0 - 2.0 * poissons_ratio).max(LEAST_COMPRESSIBILITY).ln(),
            _ => poissons_ratio,
        }
    }

    /// The reverse of `coordinate`.
    fn poissons_ratio(self, coordinate: f64) -> f64 {
        match self {
            PoissonRange::Conformal => coordinate.exp() - 1.0,
            PoissonRange::Compressible => 0.5 * (1.0 - coordinate.powi(4)),
            PoissonRange::Incompressible => 0.5 * (1.0 - coordinate.exp()),
            _ => coordinate,
        }
    }

    /// Chebyshev nodes of the range, as coordinates, and their barycentric weights.
    pub fn nodes(self) -> [(f64, f64); LANES] {
        let (low, high) = match self {
            PoissonRange::Conformal => (LEAST_SHEAR.ln(), (1.0 + Compressibility::NEARLY_CONFORMAL).ln()),
            PoissonRange::Auxetic => (Compressibility::NEARLY_CONFORMAL, 0.0),
            PoissonRange::Negative => (-1.0, 0.0),
            PoissonRange::Positive => (0.0, 0.5),
            PoissonRange::Compressible => {
                ((1.0 - 2.0 * Compressibility::NEARLY_INCOMPRESSIBLE).powf(0.25), 1.0)
            }
            PoissonRange::Incompressible => {
                (LEAST_COMPRESSIBILITY.ln(), (1.0 - 2.0 * Compressibility::NEARLY_INCOMPRESSIBLE).ln())
            }
        };
        std::array::from_fn(|i| {
            let angle = PI * (i as f64 + 0.5) / LANES as f64;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            (0.5 * (low + high) + 0.5 * (high - low) * angle.cos(), sign * angle.sin())
        })
    }
}

/// What a near field belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NearFieldClass {
    pub side: Side,
    /// Whether the ring ends at pi/2.
    pub half_ring: bool,
    pub grading: GradingClass,
    pub idealization: Idealization,
    pub range: PoissonRange,
    /// By which layers grow, in units of `GROWTH_UNIT`.
    pub growth: u32,
}

/// Between these steps of the layers' growth near fields are interpolated.
pub const GROWTH_STEP: f64 = 0.25;

/// So near to each other growths are the same.
pub const GROWTH_UNIT: f64 = 1e-6;

impl NearFieldClass {
    /// The two between which the near field of a body lies, by the growth of its layers where contact begins, and how far
    /// from the first to the second (0 to 1); of a shape whose bodies all grow alike, its own twice.
    pub fn around(body: &Body, grading: GradingClass) -> ([NearFieldClass; 2], f64) {
        let Body { shape, parameters, poissons_ratio, idealization, .. } = body;
        let depth = (shape.depth)(parameters, 0.0);
        let own = grading.layers().growth(depth, 1.0);
        // A reference needs layers.
        let steps = own.max(GROWTH_STEP) / GROWTH_STEP;
        let around = if shape.parameters.is_empty() {
            [own, own]
        } else {
            [steps.floor(), steps.floor() + 1.0].map(|steps| steps * GROWTH_STEP)
        };
        let class = |growth: f64| NearFieldClass {
            side: shape.side,
            half_ring: shape.end_angle < PI,
            grading,
            idealization: *idealization,
            range: PoissonRange::of(*poissons_ratio, *idealization),
            growth: (growth / GROWTH_UNIT).round() as u32,
        };
        (around.map(class), steps.fract())
    }

    fn growth(&self) -> f64 {
        f64::from(self.growth) * GROWTH_UNIT
    }

    /// The layers of the reference.
    fn layers(&self) -> GradingClass {
        self.grading.cut_at(DEEPEST_REFERENCE, self.growth())
    }

    /// Layers of the reference's mesh.
    pub fn layer_count(&self) -> usize {
        self.layers().layer_count
    }

    /// The concentric body that stands for the class, but for its Poisson's ratio.
    pub fn reference(&self) -> ConcentricBody {
        let depth = self.layers().depth_at_growth(self.growth());
        let fixed_radius_ratio = if self.side == Side::Plate { depth.exp() } else { (-depth).exp() };
        ConcentricBody {
            fixed_radius_ratio,
            poissons_ratio: 0.0,
            idealization: self.idealization,
            lining: Lining::NONE,
        }
    }
}

/// The difference between the exact and the condensed works of ring modes on a class's reference body.
pub struct NearField {
    range: PoissonRange,
    /// `[node of Poisson's ratio]`, as the works of bodies are.
    works: [Vec<f64>; LANES],
}

impl NearField {
    pub fn new(class: &NearFieldClass) -> NearField {
        NearField::with_loads(class, &LoadedRing::of_near_field(class).loads(), CondensationPlan::condense)
    }

    /// The same with the loads of the modes on the class's ring, and with how its bodies are condensed.
    pub fn with_loads(
        class: &NearFieldClass,
        loads: &[Vec<f64>],
        condense: impl Fn(&CondensationPlan, &[Body]) -> Vec<Vec<f64>>,
    ) -> NearField {
        let NearFieldClass { side, half_ring, idealization, range, .. } = *class;
        let modes = RingModes::of(&class.grading);
        let reference = class.reference();
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = reference.fixed_radius_ratio;
        let bodies = range.nodes().map(|(coordinate, _)| Body {
            shape: if side == Side::Plate { &annulus::SHAPE } else { &cored_disc::SHAPE },
            parameters,
            support: 0,
            poissons_ratio: range.poissons_ratio(coordinate),
            idealization,
            lining: Lining::NONE,
        });
        let grading = whole_ring(&class.layers(), end_angle(half_ring));
        let plan = CondensationPlan::with_loads(&bodies[0], grading, modes, loads);
        let condensed = condense(&plan, &bodies);
        let exact = bodies.map(|body| {
            ConcentricBody { poissons_ratio: body.poissons_ratio, ..reference.clone() }.boundary_modes()
        });
        let mut works = modes.works_of_modes(side, &exact);
        for (works, mesh) in works.iter_mut().zip(condensed) {
            works.iter_mut().zip(mesh).for_each(|(exact, mesh)| *exact -= mesh);
        }
        NearField { range, works }
    }

    /// Shares of the `LANES` nodes of Poisson's ratio in the near field of a body; they sum to one.
    fn shares(range: PoissonRange, poissons_ratio: f64) -> [f64; LANES] {
        let nodes = range.nodes();
        let coordinate = range.coordinate(poissons_ratio);
        if let Some(node) = nodes.iter().position(|(node, _)| *node == coordinate) {
            return std::array::from_fn(|i| if i == node { 1.0 } else { 0.0 });
        }
        let weights = nodes.map(|(node, weight)| weight / (coordinate - node));
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }

    /// Adds to the condensed works of a body the near field that lies `between` (0 to 1) the first and the second of two
    /// classes.
    pub fn correct(around: [&NearField; 2], between: f64, poissons_ratio: f64, works: &mut [f64]) {
        for (near_field, share) in around.into_iter().zip([1.0 - between, between]) {
            let shares = NearField::shares(near_field.range, poissons_ratio).map(|of_node| share * of_node);
            for (share, of_node) in shares.iter().zip(&near_field.works) {
                works.iter_mut().zip(of_node).for_each(|(work, near)| *work += share * near);
            }
        }
    }

    /// What it takes.
    pub fn bytes(&self) -> usize {
        self.works.iter().map(|works| size_of_val(&works[..])).sum()
    }
}

/// A ring as loads know it: bodies have the same ring, whatever their layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LoadedRing {
    side: Side,
    half_ring: bool,
    /// Without what tells layers.
    grading: GradingClass,
    /// Whether half a ring is continued by its mirror image, as near fields have it.
    is_whole: bool,
}

impl LoadedRing {
    /// Of bodies of a shape on meshes of a class.
    pub fn of(shape: &Shape, class: &GradingClass) -> LoadedRing {
        let half_ring = shape.end_angle < PI;
        LoadedRing { side: shape.side, half_ring, grading: without_layers(class), is_whole: false }
    }

    /// Of the references of a class of near fields.
    pub fn of_near_field(class: &NearFieldClass) -> LoadedRing {
        LoadedRing::of_reference(class.side, class.half_ring, class.grading)
    }

    /// Of references on meshes of a class, of bodies of a side whose ring may end at pi/2.
    pub fn of_reference(side: Side, half_ring: bool, class: GradingClass) -> LoadedRing {
        LoadedRing { side, half_ring, grading: without_layers(&class), is_whole: half_ring }
    }

    /// As `RingModes::loads` has them, of its class's modes.
    pub fn loads(&self) -> Vec<Vec<f64>> {
        let end_angle = end_angle(self.half_ring);
        let grading = if self.is_whole {
            whole_ring(&self.grading, end_angle)
        } else {
            self.grading.grading(end_angle)
        };
        let modes = RingModes::of(&self.grading);
        modes.loads(Push::of(self.side), grading.element, &grading.ring_angles())
    }
}

fn without_layers(class: &GradingClass) -> GradingClass {
    let lining = LiningRows::default();
    GradingClass { layer_count: 0, shrinking: 0, lining, rest_depth_class: 0, ..*class }
}

pub fn end_angle(half_ring: bool) -> f64 {
    if half_ring { FRAC_PI_2 } else { PI }
}

/// The class's division of a ring that ends at `end_angle`, continued by its mirror image where that is pi/2.
pub fn whole_ring(class: &GradingClass, end_angle: f64) -> Grading {
    let mut grading = class.grading(end_angle);
    if end_angle < PI {
        let mirror: Vec<f64> =
            grading.angles.iter().rev().skip(1).map(|angle| 2.0 * end_angle - angle).collect();
        grading.angles.extend(mirror);
    }
    grading
}
