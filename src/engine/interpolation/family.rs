//! Bodies that are fitted together, and the fit with its checked error.

use rayon::prelude::*;

use crate::engine::bodies::BodyLibrary;
use crate::engine::known_errors::{known_error, known_level};
use crate::engine::plan::{first_level, mesh_error};
use crate::engine::request::{BodyRequest, Fidelity, SpaceKey};
use crate::engine::unit_costs::{SERIES_SECONDS, TOPOLOGY_SECONDS, body_seconds};
use crate::mechanics::body::{Body, MAX_PARAMETERS, Shape};
use crate::mechanics::compliance::body_fit::{BodyFit, Polynomials};
use crate::mechanics::compliance::near_field::PoissonRange;
use crate::mechanics::contact::smooth_curve::at_nodes::relative_changes;
use crate::mechanics::contact::smooth_curve::nodes::CurveNodes;
use crate::mechanics::contact::smooth_curve::{CURVE_NODES, CURVE_TERMS};
use crate::mechanics::material::Idealization;

/// Shape ratios and Poisson's ratio.
pub const MOST_COORDINATES: usize = MAX_PARAMETERS + 1;

/// Bodies whose compliance is one smooth function of their coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FamilyKey {
    shape: &'static str,
    support: usize,
    idealization: Idealization,
    range: PoissonRange,
    /// Of the pressure space, for which the pin decides.
    pub half_ring: bool,
}

/// Bodies less deep than this have walls that ask for more trial pressures than a fit has.
const THINNEST: f64 = 0.15;

impl FamilyKey {
    /// Of a body; `None` where the error of a mesh is not known well enough to fit many of them.
    pub fn of(body: &Body, half_ring: bool) -> Option<FamilyKey> {
        let Body { shape, parameters, support, poissons_ratio, idealization } = *body;
        let range = PoissonRange::of(poissons_ratio, idealization);
        let trusted = !matches!(range, PoissonRange::Incompressible | PoissonRange::Conformal);
        let thick = (shape.depth_range)(&parameters).0 > THINNEST;
        (trusted && thick).then_some(FamilyKey { shape: shape.name, support, idealization, range, half_ring })
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
/// exponentially. Concentric bodies are the better for its logarithm. In plane strain what is confined yields like
/// 1 - 2 nu.
pub fn coordinates(body: &Body) -> Point {
    let mut point = [0.0; MOST_COORDINATES];
    let count = body.shape.parameters.len();
    for (coordinate, ratio) in point.iter_mut().zip(&body.parameters[..count]) {
        let depth = ratio.ln();
        *coordinate = if body.shape.concentric { depth.abs().ln() } else { depth };
    }
    point[count] = match body.idealization {
        Idealization::PlaneStress => body.poissons_ratio,
        Idealization::PlaneStrain => (1.0 - 2.0 * body.poissons_ratio).ln(),
    };
    point
}

/// The reverse of `coordinates`, for a body like `example`.
pub fn body_at(example: &Body, point: &[f64]) -> Body {
    let mut body = *example;
    let count = example.shape.parameters.len();
    for i in 0..count {
        let depth = if example.shape.concentric { point[i].exp() } else { point[i] };
        let inward = example.shape.parameters[i].below <= 1.0;
        body.parameters[i] = if inward && example.shape.concentric { (-depth).exp() } else { depth.exp() };
    }
    body.poissons_ratio = match example.idealization {
        Idealization::PlaneStress => point[count],
        Idealization::PlaneStrain => 0.5 * (1.0 - point[count].exp()),
    };
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

/// A fit with its error.
pub struct FittedFamily {
    pub fit: BodyFit,
    /// Bound of the relative error of the force at each node of a curve, of fit and meshes together.
    pub bound: [f64; CURVE_NODES],
    /// Bodies solved for it, on every mesh.
    pub solved: u64,
}

/// Degrees tried, by how many coordinates vary: of the ratios and of Poisson's ratio.
const DEGREES: [&[(usize, usize)]; MOST_COORDINATES + 1] = [
    &[(0, 0)],
    &[(6, 6), (10, 8), (16, 10)],
    &[(8, 5), (12, 6), (16, 8)],
    &[(6, 5), (8, 6), (10, 6)],
    &[(6, 6), (8, 6), (10, 6)],
];

/// Samples for each product of polynomials.
const OVERSAMPLING: usize = 2;

/// Bodies held out, besides those near corners, edges and sides.
const HELD_OUT: usize = 60;

/// Share of the bodies held out whose error is below the bound: what two bodies have is averaged in a joint, so far more
/// of the joints are (`tests/interpolation.rs`).
const BOUNDED: f64 = 0.98;

/// The fit's own error is raised by this: bodies held out are not the worst.
const SAFETY: f64 = 1.25;

/// Modes end where what is left is below this share of the accuracy.
const MODE_SHARE: f64 = 0.1;

/// A fit whose bound is below this share of the accuracy is good enough.
const GOOD: f64 = 0.6;

/// One below this share is used where a better one would cost much: the rest is for what a design adds.
const FAIR: f64 = 0.9;

/// Share of the budget from which on a better fit costs much.
const FAIR_BUDGET: f64 = 0.1;

/// Meshes whose own error is above this share of the accuracy are not worth a fit.
const MESH_SHARE: f64 = 0.7;

/// Of meshes whose error is known: a fit must also take the steps where, from shape to shape, they get a layer more.
const KNOWN_SHARE: f64 = 0.25;

/// And shapes for each product of the ratios alone, where every shape comes with several of Poisson's ratios.
const OVERSAMPLING_SHAPES: f64 = 1.2;

/// Poisson's ratios of each shape sampled.
const REPEATS: [usize; MOST_COORDINATES + 1] = [1, 1, 1, 4, 4];

/// Share of the lanes that samples of a box with so many coordinates fill, about.
const LANES_FILLED: [f64; MOST_COORDINATES + 1] = [0.2, 0.8, 0.7, 0.6, 0.4];

/// Topologies that a box with so many coordinates meets on two meshes, about.
const TOPOLOGIES: [f64; MOST_COORDINATES + 1] = [2.0, 20.0, 30.0, 60.0, 120.0];

/// Arcs beyond which contact with free edges hardly goes, rad: what a fit does there decides nothing.
const WIDEST: f64 = 1.8;

/// The finest mesh of a sample.
const FINEST: usize = 4;

/// Bodies that a library is asked for at a time.
const BATCH: usize = 1024;

impl Family {
    /// The ranges that have a width.
    fn free(&self) -> usize {
        self.ranges.iter().filter(|(low, high)| high > low).count()
    }

    fn polynomials(&self, (of_ratios, of_poisson): (usize, usize)) -> Polynomials {
        let mut degrees = vec![of_ratios; self.ranges.len()];
        if let Some(last) = degrees.last_mut() {
            *last = of_poisson;
        }
        Polynomials::new(self.ranges.clone(), &degrees)
    }

    /// Samples, besides those of the grid, that determine polynomials of these degrees.
    fn sample_count(&self, degrees: (usize, usize)) -> usize {
        let count = self.polynomials(degrees).count();
        let repeats = self.repeats();
        if repeats == 1 {
            return OVERSAMPLING * count;
        }
        let of_shape = vec![degrees.0; self.ranges.len() - 1];
        let shapes = Polynomials::new(self.ranges[..of_shape.len()].to_vec(), &of_shape).count();
        (OVERSAMPLING_SHAPES * shapes as f64) as usize * repeats
    }

    /// Poisson's ratios sampled of each shape: where shapes have meshes of their own they fill the lanes of one batch.
    fn repeats(&self) -> usize {
        if self.exact { 1 } else { REPEATS[self.free()] }
    }

    fn place(&self, unit: &[f64]) -> Vec<f64> {
        unit.iter().zip(&self.ranges).map(|(unit, (low, high))| low + unit * (high - low)).collect()
    }

    /// Where the samples are: on corners, edges and sides, where nothing holds polynomials, then points that are dense at the ends like Chebyshev's, and often on them.
    fn sample_points(&self, count: usize) -> Vec<Vec<f64>> {
        let inner = (0..count).map(|i| {
            let dense = |unit: f64| to_ends(0.5 - 0.5 * (std::f64::consts::PI * unit).cos(), 0.03, 0.0);
            self.spread(i, 0.5).into_iter().map(dense).collect::<Vec<f64>>()
        });
        self.grid([0.0, 0.5, 1.0]).into_iter().chain(inner).map(|unit| self.place(&unit)).collect()
    }

    /// Where the fit is checked: near the corners, edges and sides, where it is at its worst, and everywhere else.
    fn held_out_points(&self) -> Vec<Vec<f64>> {
        let near_ends = |unit: f64| to_ends(unit, 0.12, 0.01);
        let inner =
            (0..HELD_OUT).map(|i| self.spread(i, 0.21).into_iter().map(near_ends).collect::<Vec<f64>>());
        self.grid([0.01, 0.3, 0.99]).into_iter().chain(inner).map(|unit| self.place(&unit)).collect()
    }

    /// Point number `index` of an evenly spread sequence in the unit box.
    fn spread(&self, index: usize, offset: f64) -> Vec<f64> {
        let repeats = self.repeats();
        if repeats == 1 {
            return spread(index, self.ranges.len(), offset);
        }
        let mut point = spread(index / repeats, self.ranges.len() - 1, offset);
        point.extend(spread(index, 1, offset));
        point
    }

    /// Corners, edges and sides of the unit box: all points with these on each coordinate; one without width has one.
    fn grid(&self, along: [f64; 3]) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for (low, high) in &self.ranges {
            let along = if high > low { &along[..] } else { &along[..1] };
            let extended = points.iter().flat_map(|point: &Vec<f64>| {
                along.iter().map(move |unit| point.iter().copied().chain([*unit]).collect())
            });
            points = extended.collect();
        }
        points
    }

    /// The compliances of bodies at points, at the nodes of curves, with their amplitudes.
    fn solve(
        &self,
        library: &mut BodyLibrary,
        nodes: &CurveNodes,
        points: &[Vec<f64>],
        fidelity: Fidelity,
    ) -> Vec<Vec<f64>> {
        let space = SpaceKey { half_ring: self.key.half_ring, terms: CURVE_TERMS };
        let mut solved = Vec::with_capacity(points.len());
        for points in points.chunks(BATCH) {
            let requests: Vec<BodyRequest> = points
                .iter()
                .map(|point| BodyRequest { body: body_at(&self.example, point), fidelity, space })
                .collect();
            library.solve(&requests);
            let shared = &*library;
            let resample = |request: &BodyRequest| {
                nodes.resample(shared.space(space), &shared.compliance(&request.key()).values)
            };
            solved.par_extend(requests.par_iter().map(resample));
        }
        solved
    }

    /// The best fit for an accuracy of the force; `None` where none is good enough. `budget` is the time, s by
    /// `unit_costs`, that may be spent.
    pub fn fit(
        &self,
        accuracy: f64,
        budget: f64,
        library: &mut BodyLibrary,
        nodes: &CurveNodes,
    ) -> Option<FittedFamily> {
        let Meshes { first, known } = self.meshes(accuracy);
        let levels = if self.exact { first..=first } else { first..=FINEST };
        let mut expense = Expense::default();
        let mut held_out = HeldOut::new(self, known);
        if !known {
            held_out.solve(self, first - 1, library, nodes, &mut expense);
        }
        let mut best: Option<(f64, FittedFamily)> = None;
        // What is only fair is good enough where a better one would cost much.
        let is_enough = |best: &Option<(f64, FittedFamily)>, expense: &Expense| {
            let least = best.as_ref().map_or(f64::INFINITY, |(worst, _)| *worst) / accuracy;
            least <= GOOD || (least <= FAIR && expense.seconds > FAIR_BUDGET * budget)
        };
        for level in levels {
            held_out.solve(self, level, library, nodes, &mut expense);
            if worst_near(nodes, &quantile(&held_out.of_mesh)) > MESH_SHARE * accuracy && level < FINEST {
                continue;
            }
            let mut samples: Vec<Vec<f64>> = Vec::new();
            for degrees in DEGREES[self.free()] {
                let polynomials = self.polynomials(*degrees);
                let points = self.sample_points(self.sample_count(*degrees));
                // Those of lower degrees come first.
                let new = points.get(samples.len()..).unwrap_or_default();
                expense.add(self, new.len(), level);
                if expense.seconds > budget || is_enough(&best, &expense) {
                    break;
                }
                samples.extend(self.solve(library, nodes, new, self.fidelity(level)));
                let Some(fit) = BodyFit::new(polynomials, &points, &samples, MODE_SHARE * accuracy) else {
                    continue;
                };
                let bound = held_out.bound(&fit, nodes);
                let worst = worst_near(nodes, &bound);
                if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                    best = Some((worst, FittedFamily { fit, bound, solved: 0 }));
                }
                if worst <= GOOD * accuracy {
                    break;
                }
            }
            if expense.seconds > budget || is_enough(&best, &expense) {
                break;
            }
        }
        let (_, fitted) = best?;
        // A design at an arc whose bound is too large goes on to the meshes; not too many may.
        let near: Vec<f64> = bounds_near(nodes, &fitted.bound).collect();
        let fair = near.iter().filter(|bound| **bound <= FAIR * accuracy).count();
        (2 * fair >= near.len()).then_some(FittedFamily { solved: expense.bodies, ..fitted })
    }

    fn fidelity(&self, level: usize) -> Fidelity {
        if self.exact { Fidelity::Series } else { Fidelity::Mesh { level } }
    }

    /// The meshes of the samples: the first that are known to do all over the box, else one finer than a design would begin with.
    fn meshes(&self, accuracy: f64) -> Meshes {
        if self.exact {
            return Meshes { first: 0, known: true };
        }
        let levels = self
            .held_out_points()
            .into_iter()
            .map(|point| known_level(&body_at(&self.example, &point), KNOWN_SHARE * accuracy));
        match levels.max_by_key(|level| level.unwrap_or(usize::MAX)).flatten() {
            Some(first) => Meshes { first, known: true },
            None => Meshes { first: (first_level(accuracy) + 1).min(FINEST), known: false },
        }
    }

    /// Estimated time of one sample.
    fn sample_seconds(&self, level: usize) -> f64 {
        if self.exact {
            SERIES_SECONDS
        } else {
            body_seconds(&self.example, level) / LANES_FILLED[self.free()]
        }
    }

    /// Estimated time of the first fit, s.
    pub fn least_seconds(&self, accuracy: f64) -> f64 {
        let Meshes { first: level, known } = self.meshes(accuracy);
        let free = self.free();
        let samples = self.sample_count(DEGREES[free][0]) + 3_usize.pow(free as u32);
        let held_out = (HELD_OUT + 3_usize.pow(free as u32)) as f64;
        let coarse = if known { 0.0 } else { held_out * self.sample_seconds(level - 1) };
        let topologies = if self.exact { 0.0 } else { TOPOLOGIES[free] * TOPOLOGY_SECONDS };
        (samples as f64 + held_out) * self.sample_seconds(level) + coarse + topologies
    }
}

/// On which meshes samples are solved.
struct Meshes {
    first: usize,
    /// Whether their error is: no coarser mesh must tell it.
    known: bool,
}

/// What a fit has taken so far.
#[derive(Default)]
struct Expense {
    bodies: u64,
    /// By `unit_costs`.
    seconds: f64,
}

impl Expense {
    fn add(&mut self, family: &Family, bodies: usize, level: usize) {
        self.bodies += bodies as u64;
        self.seconds += bodies as f64 * family.sample_seconds(level);
    }
}

/// Bodies that a fit is checked on.
struct HeldOut {
    points: Vec<Vec<f64>>,
    amplitudes: Vec<f64>,
    /// Their compliances on the finest mesh so far.
    expected: Vec<Vec<f64>>,
    /// The error of that mesh.
    of_mesh: Vec<[f64; CURVE_NODES]>,
    /// Whether it is known, without a coarser one.
    known: bool,
}

impl HeldOut {
    fn new(family: &Family, known: bool) -> HeldOut {
        let points = family.held_out_points();
        let amplitude = |point: &Vec<f64>| {
            let body = body_at(&family.example, point);
            2.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio)
        };
        let amplitudes = points.iter().map(amplitude).collect();
        HeldOut { points, amplitudes, expected: Vec::new(), of_mesh: Vec::new(), known }
    }

    /// Goes on to a mesh; where its error is not known the change since the one before tells it.
    fn solve(
        &mut self,
        family: &Family,
        level: usize,
        library: &mut BodyLibrary,
        nodes: &CurveNodes,
        expense: &mut Expense,
    ) {
        let coarse = std::mem::take(&mut self.expected);
        self.expected = family.solve(library, nodes, &self.points, family.fidelity(level));
        expense.add(family, self.points.len(), level);
        self.of_mesh = if family.exact {
            vec![[0.0; CURVE_NODES]; self.points.len()]
        } else if self.known {
            let known = |point: &Vec<f64>| {
                let body = body_at(&family.example, point);
                nodes.arcs.map(|arc| known_error(&body, level, arc.half_angle).unwrap_or(f64::INFINITY))
            };
            self.points.iter().map(known).collect()
        } else {
            (self.expected.par_iter().zip(&coarse).zip(&self.amplitudes))
                .map(|((fine, coarse), amplitude)| {
                    changes(nodes, *amplitude, fine, coarse).map(|change| mesh_error(level, change))
                })
                .collect()
        };
    }

    /// Of the errors of a fit and of the meshes together.
    fn bound(&self, fit: &BodyFit, nodes: &CurveNodes) -> [f64; CURVE_NODES] {
        let errors: Vec<[f64; CURVE_NODES]> = (self.points.par_iter().zip(&self.expected))
            .zip(self.of_mesh.par_iter().zip(&self.amplitudes))
            .map(|((point, expected), (of_mesh, amplitude))| {
                let changes = changes(nodes, *amplitude, expected, &fit.at(point));
                std::array::from_fn(|node| SAFETY * changes[node] + of_mesh[node])
            })
            .collect();
        quantile(&errors)
    }
}

/// Relative changes of the work of a body alone at each node; infinite where they have no value.
fn changes(nodes: &CurveNodes, amplitude: f64, expected: &[f64], found: &[f64]) -> [f64; CURVE_NODES] {
    let difference: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| found - expected).collect();
    relative_changes(nodes, amplitude, expected, &difference)
        .map(|change| if change.is_finite() { change.abs() } else { f64::INFINITY })
}

/// At each node what few of the bounds exceed.
fn quantile(bounds: &[[f64; CURVE_NODES]]) -> [f64; CURVE_NODES] {
    std::array::from_fn(|node| {
        let mut of_node: Vec<f64> = bounds.iter().map(|of_body| of_body[node]).collect();
        of_node.sort_by(f64::total_cmp);
        let place = (BOUNDED * of_node.len() as f64) as usize;
        of_node.get(place.min(of_node.len().saturating_sub(1))).copied().unwrap_or(f64::INFINITY)
    })
}

/// Those of the arcs that contact comes to.
fn bounds_near(nodes: &CurveNodes, bound: &[f64; CURVE_NODES]) -> impl Iterator<Item = f64> {
    let near = nodes.arcs.iter().zip(bound).filter(|(arc, _)| arc.half_angle < WIDEST);
    near.map(|(_, bound)| *bound)
}

fn worst_near(nodes: &CurveNodes, bound: &[f64; CURVE_NODES]) -> f64 {
    bounds_near(nodes, bound).fold(0.0, f64::max)
}

/// What is close to an end of the unit interval goes to a margin from it.
fn to_ends(unit: f64, close: f64, margin: f64) -> f64 {
    match unit {
        low if low < close => margin,
        high if high > 1.0 - close => 1.0 - margin,
        between => between,
    }
}

/// Point number `index` of an evenly spread sequence in the unit box (multiples of the powers of the root of
/// x^(d+1) = x + 1: M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018).
fn spread(index: usize, dimensions: usize, offset: f64) -> Vec<f64> {
    let mut root: f64 = 2.0;
    for _ in 0..64 {
        root = (1.0 + root).powf(1.0 / (dimensions as f64 + 1.0));
    }
    let along = |dimension: usize| {
        let step = root.powi(-(dimension as i32 + 1));
        (offset + step * (index as f64 + 1.0)).fract()
    };
    (0..dimensions).map(along).collect()
}
