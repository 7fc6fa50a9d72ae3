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
//! function of Poisson's ratio and is interpolated between Chebyshev nodes, which fill the lanes of one batch, or made at a ratio that
//! all bodies have in common; and of the growth of the layers where contact begins, between steps of which it is interpolated linearly.

use std::f64::consts::{FRAC_PI_2, PI};

use super::concentric_body::ConcentricBody;
use super::lane_condensation::CondensationPlan;
use super::lane_work::{LaneWork, in_lanes};
use super::ring_modes::{Push, RingModes};
use crate::mechanics::body::{Body, Shape, Side};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::layers::Layers;
use crate::mechanics::lining_rows::LiningRows;
use crate::mechanics::material::{Compressibility, Idealization};
use crate::mechanics::mesh::Grading;
use crate::mechanics::real::{LANES, Lanes, Real};

/// |ln r| of a reference's fixed circle, at most: deeper bodies bring a far field of their own.
pub const DEEPEST_REFERENCE: f64 = 1.2;

/// A part of the range of Poisson's ratio over which the error of a mesh is interpolated, in plane stress and in plane strain alike: what
/// a body yields, times E', is a function of the shear modulus over the bulk modulus of the plane alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PoissonRange {
    /// Plane stress close to -1, nearly without shear.
    Conformal,
    /// The rest of the negative ones.
    Auxetic,
    /// Positive ones, in plane strain most of them.
    Positive,
    /// Plane strain close to 1/2, nearly incompressible.
    Incompressible,
    /// One value alone, ln(mu/K) by its bits.
    One(u64),
}

/// The most nodes of a range.
pub const MOST_NODES: usize = 8;

/// The first mesh level of which more is asked than 1 %.
const FINE: usize = 2;

impl PoissonRange {
    /// That of a body by itself.
    fn one(body: &Body) -> PoissonRange {
        let ratio = body.idealization.shear_to_bulk(body.poissons_ratio);
        PoissonRange::One(ratio.clamp(Compressibility::LEAST, PoissonRange::most()).ln().to_bits())
    }

    pub fn of(poissons_ratio: f64, idealization: Idealization) -> PoissonRange {
        match Compressibility::of(poissons_ratio, idealization) {
            Compressibility::NearlyConformal => PoissonRange::Conformal,
            Compressibility::Auxetic | Compressibility::Negative => PoissonRange::Auxetic,
            Compressibility::Positive
            | Compressibility::Moderate
            | Compressibility::Stiff
            | Compressibility::VeryStiff => PoissonRange::Positive,
            Compressibility::NearlyIncompressible | Compressibility::Locking => PoissonRange::Incompressible,
        }
    }

    /// mu/K, beyond which nothing changes any more.
    fn most() -> f64 {
        Idealization::PlaneStress.shear_to_bulk(Compressibility::LEAST_SHEAR - 1.0)
    }

    /// Of ln(mu/K), in which the error of a mesh is smooth: its poles are where mu/K is negative.
    fn ends(self) -> [f64; 2] {
        use Idealization::{PlaneStrain, PlaneStress};
        let incompressible = PlaneStrain.shear_to_bulk(Compressibility::NEARLY_INCOMPRESSIBLE);
        let conformal = PlaneStress.shear_to_bulk(Compressibility::NEARLY_CONFORMAL);
        let ends = match self {
            PoissonRange::Conformal => [conformal, PoissonRange::most()],
            PoissonRange::Auxetic => [1.0, conformal],
            PoissonRange::Positive => [incompressible, 1.0],
            PoissonRange::Incompressible => [Compressibility::LEAST, incompressible],
            PoissonRange::One(bits) => return [f64::from_bits(bits); 2],
        };
        ends.map(f64::ln)
    }

    /// How many nodes of ln(mu/K) there are on a mesh level. They leave 5e-5 of what a body yields on coarse ones, 1e-6 on finer ones, and 3e-4
    /// where the ratio is extreme (`tests/mechanics/condensation.rs`).
    fn node_count(self, level: usize) -> usize {
        match self {
            PoissonRange::One(_) => 1,
            PoissonRange::Auxetic | PoissonRange::Positive if level < FINE => 6,
            _ => MOST_NODES,
        }
    }

    /// Chebyshev nodes of ln(mu/K), and their barycentric weights. One node is the value itself, since its ends are.
    fn nodes(self, level: usize) -> impl Iterator<Item = (f64, f64)> {
        let (count, [low, high]) = (self.node_count(level), self.ends());
        (0..count).map(move |i| {
            let angle = PI * (i as f64 + 0.5) / count as f64;
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            (0.5 * (low + high) + 0.5 * (high - low) * angle.cos(), sign * angle.sin())
        })
    }
}

/// What all bodies of a side have in common: near fields are made for that alone, not for a range of it. Where they have not, that costs time
/// and no accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Common {
    pub poissons_ratio: bool,
    pub outline: bool,
}

/// The same of pins and of plates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InCommon {
    pub pins: Common,
    pub plates: Common,
}

impl InCommon {
    /// Of the bodies of one joint.
    pub const ALL: InCommon = InCommon { pins: Common::ALL, plates: Common::ALL };

    fn of(&self, side: Side) -> Common {
        match side {
            Side::Pin => self.pins,
            Side::Plate => self.plates,
        }
    }
}

impl Common {
    const ALL: Common = Common { poissons_ratio: true, outline: true };
}

/// What a near field belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NearFieldClass {
    pub side: Side,
    /// Whether the ring ends at pi/2.
    pub half_ring: bool,
    pub grading: GradingClass,
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
    pub fn around(body: &Body, grading: GradingClass, common: &InCommon) -> ([NearFieldClass; 2], f64) {
        NearFieldClass::of_growth(body, grading, common, grading.layers().growth(depth_at_contact(body), 1.0))
    }

    /// The same of each of some bodies of one class, as many growths at a time as there are lanes.
    pub fn around_each<'a>(
        bodies: impl ExactSizeIterator<Item = &'a Body> + Clone,
        grading: GradingClass,
        common: &InCommon,
    ) -> impl Iterator<Item = ([NearFieldClass; 2], f64)> {
        let mut growths = Vec::with_capacity(bodies.len() + LANES);
        let mut depths = bodies.clone().map(depth_at_contact);
        while growths.len() < bodies.len() {
            // In lanes without a body a depth that is soon found.
            let own = std::array::from_fn(|_| depths.next().unwrap_or(1.0));
            growths.extend(in_lanes(Growths { layers: grading.layers(), depths: own }));
        }
        let of_growth = move |(body, own)| NearFieldClass::of_growth(body, grading, common, own);
        bodies.zip(growths).map(of_growth)
    }

    /// For the growth of a body's layers where contact begins.
    fn of_growth(
        body: &Body,
        grading: GradingClass,
        common: &InCommon,
        own: f64,
    ) -> ([NearFieldClass; 2], f64) {
        let Body { shape, poissons_ratio, idealization, .. } = body;
        let common = common.of(shape.side);
        // A reference needs layers.
        let own = own.max(GROWTH_STEP);
        let steps = own / GROWTH_STEP;
        let around = if shape.parameters.is_empty() || common.outline {
            [own, own]
        } else {
            [steps.floor(), steps.floor() + 1.0].map(|steps| steps * GROWTH_STEP)
        };
        let range = match common.poissons_ratio {
            true => PoissonRange::one(body),
            false => PoissonRange::of(*poissons_ratio, *idealization),
        };
        let class = |growth: f64| NearFieldClass {
            side: shape.side,
            half_ring: shape.end_angle < PI,
            grading,
            range,
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

    /// The mesh of the reference.
    pub fn mesh(&self) -> ReferenceMesh {
        ReferenceMesh { side: self.side, half_ring: self.half_ring, layers: self.layers() }
    }

    /// The concentric bodies that stand for the class, by the nodes of its range.
    pub fn references(&self) -> impl Iterator<Item = ConcentricBody> {
        let depth = self.layers().depth_at_growth(self.growth());
        let fixed_radius_ratio = (self.side.outward() * depth).exp();
        self.range.nodes(self.grading.level).map(move |(coordinate, _)| {
            let (idealization, poissons_ratio) = Idealization::of_shear_to_bulk(coordinate.exp());
            ConcentricBody::bare(fixed_radius_ratio, poissons_ratio, idealization)
        })
    }
}

/// Of a body's far boundary where contact begins.
fn depth_at_contact(body: &Body) -> f64 {
    (body.shape.depth)(&body.parameters, 0.0)
}

/// By how much layers grow to reach depths.
struct Growths {
    layers: Layers,
    depths: [f64; LANES],
}

impl LaneWork for Growths {
    type Output = [f64; LANES];

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> [f64; LANES] {
        let Growths { layers, depths } = self;
        let (first, guess) = (Lanes::<WIDTH>::from_f64(layers.first), Lanes::from_f64(1.0));
        layers.growth_from(first, Lanes(depths), guess).0
    }
}

/// A mesh on which concentric references lie, those of many classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ReferenceMesh {
    pub side: Side,
    /// Whether the ring of the bodies they stand for ends at pi/2: it is continued by its mirror image.
    pub half_ring: bool,
    pub layers: GradingClass,
}

impl ReferenceMesh {
    /// Its ring.
    pub fn ring(&self) -> LoadedRing {
        let ReferenceMesh { side, half_ring, layers } = self;
        LoadedRing {
            grading: without_layers(layers),
            side: *side,
            half_ring: *half_ring,
            is_whole: *half_ring,
        }
    }

    /// For references on it, of which one is an example, with the loads of the modes on its ring.
    pub fn plan(&self, example: &Body, loads: &[Vec<f64>]) -> CondensationPlan {
        CondensationPlan::with_loads(example, self.grading(), RingModes::of(&self.layers), loads)
    }

    /// The division of its bodies.
    pub fn grading(&self) -> Grading {
        whole_ring(&self.layers, end_angle(self.half_ring))
    }

    fn body(&self, of: &ConcentricBody) -> Body {
        let all_around = self.layers.all_around;
        Body { all_around, ..Body::concentric(of.fixed_radius_ratio, of.poissons_ratio, of.idealization) }
    }
}

/// The difference between the exact and the condensed works of ring modes on a class's references.
pub struct NearField {
    /// Of ln(mu/K): beyond them nothing changes any more.
    ends: [f64; 2],
    /// Of ln(mu/K), each with its barycentric weight.
    nodes: Vec<(f64, f64)>,
    /// `[node]`, as the works of bodies are, times E'.
    works: Vec<Vec<f64>>,
}

impl NearField {
    /// Those of classes whose references lie on one mesh, with the loads of the modes on its ring, and with how bodies are condensed.
    pub fn on_mesh(
        mesh: &ReferenceMesh,
        classes: &[NearFieldClass],
        loads: &[Vec<f64>],
        condense: impl Fn(&CondensationPlan, &[Body]) -> Vec<Vec<f64>>,
    ) -> Vec<NearField> {
        let modes = RingModes::of(&mesh.layers);
        let references: Vec<ConcentricBody> = classes.iter().flat_map(NearFieldClass::references).collect();
        let bodies: Vec<Body> = references.iter().map(|reference| mesh.body(reference)).collect();
        let condensed = condense(&mesh.plan(&bodies[0], loads), &bodies);
        // How many modes there are hangs on the radius alone. Together with others a reference would not come to the same bits.
        let alike = references.chunk_by(|one, other| one.fixed_radius_ratio == other.fixed_radius_ratio);
        let exact = alike.flat_map(|references| {
            let boundaries: Vec<_> = references.iter().map(ConcentricBody::boundary_modes).collect();
            modes.works_of_modes(mesh.side, &boundaries)
        });
        let mut works = exact.zip(condensed).zip(&references).map(|((mut works, condensed), of)| {
            let scale = of.idealization.plane_modulus_ratio(of.poissons_ratio);
            works
                .iter_mut()
                .zip(condensed)
                .for_each(|(exact, condensed)| *exact = scale * (*exact - condensed));
            works
        });
        let near_field = |class: &NearFieldClass| {
            let nodes: Vec<(f64, f64)> = class.range.nodes(class.grading.level).collect();
            let works = works.by_ref().take(nodes.len()).collect();
            NearField { ends: class.range.ends(), nodes, works }
        };
        classes.iter().map(near_field).collect()
    }

    /// Shares of the nodes in the near field of a body; they sum to one, and there are as many as nodes.
    fn shares(&self, body: &Body) -> [f64; MOST_NODES] {
        let [low, high] = self.ends;
        let coordinate = body.idealization.shear_to_bulk(body.poissons_ratio).ln().clamp(low, high);
        let mut shares = [0.0; MOST_NODES];
        let own = shares.iter_mut().zip(&self.nodes);
        if self.nodes.iter().any(|(node, _)| *node == coordinate) {
            own.for_each(|(share, (node, _))| *share = f64::from(*node == coordinate));
            return shares;
        }
        own.for_each(|(share, (node, weight))| *share = weight / (coordinate - node));
        let sum: f64 = shares[..self.nodes.len()].iter().sum();
        shares.iter_mut().for_each(|share| *share /= sum);
        shares
    }

    /// What the works of the nodes of two classes, between (0 to 1) which the near field of a body lies, are to be multiplied by and added to
    /// its own; zero beyond the nodes.
    pub fn weights(around: [&NearField; 2], between: f64, body: &Body) -> [[f64; MOST_NODES]; 2] {
        let shares = around[0].shares(body);
        let scale = 1.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio);
        [1.0 - between, between].map(|part| shares.map(|share| scale * part * share))
    }

    /// Adds to the condensed works of a body the near field that lies `between` (0 to 1) the first and the second of two
    /// classes.
    pub fn correct(around: [&NearField; 2], between: f64, body: &Body, works: &mut [f64]) {
        let weights = NearField::weights(around, between, body);
        let mut rows = [(0.0, &[][..]); 2 * MOST_NODES];
        let mut count = 0;
        for (near_field, weights) in around.into_iter().zip(weights) {
            for (weight, works) in weights.into_iter().zip(&near_field.works) {
                rows[count] = (weight, &works[..]);
                count += 1;
            }
        }
        in_lanes(AddRows { rows: &rows[..count], sums: works });
    }

    /// The works of each node, times E'.
    pub fn works(&self) -> &[Vec<f64>] {
        &self.works
    }

    /// What it takes.
    pub fn bytes(&self) -> usize {
        self.works.iter().map(|works| size_of_val(&works[..])).sum()
    }
}

/// Adds rows, each times its weight, to sums.
struct AddRows<'a> {
    rows: &'a [(f64, &'a [f64])],
    sums: &'a mut [f64],
}

impl LaneWork for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        let AddRows { rows, sums } = self;
        let (chunks, rest) = sums.as_chunks_mut::<LANES>();
        let first_of_rest = LANES * chunks.len();
        for (chunk, sums) in chunks.iter_mut().enumerate() {
            let mut sum = Lanes::<WIDTH>(*sums);
            for (weight, row) in rows {
                sum += Lanes::from_f64(*weight) * Lanes::from_slice(&row[chunk * LANES..]);
            }
            *sums = sum.0;
        }
        for (place, sum) in rest.iter_mut().enumerate() {
            for (weight, row) in rows {
                *sum += weight * row[first_of_rest + place];
            }
        }
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

fn end_angle(half_ring: bool) -> f64 {
    if half_ring { FRAC_PI_2 } else { PI }
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
