//! Contact of two bodies on plain fine meshes: no exact kernel, no near field, no interpolation, no table of loads.
//!
//! A second way to the engine's figures, for tests. It shares the trial pressures, the elements and the band Cholesky.

use std::f64::consts::{FRAC_PI_2, PI};

use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::compliance::arc::ContactArc;
use jointsweep::internals::mechanics::element::quadrature::gauss_legendre;
use jointsweep::internals::mechanics::element::stiffness::{Elasticity, ElementRule, element_stiffness};
use jointsweep::internals::mechanics::element::{ElementKind, MAX_NODES, side_functions};
use jointsweep::internals::mechanics::layers::{Layers, layer_thicknesses};
use jointsweep::internals::mechanics::lines::coordinates;
use jointsweep::internals::mechanics::lining_rows::LiningDivision;
use jointsweep::internals::mechanics::mesh::{Grading, RingTopology, SUPPORTED};
use jointsweep::internals::mechanics::solve::band::{BandStructure, TILE, Tile};
use jointsweep::internals::study::design::JointDesign;

/// What meets, and along what it pushes, at angles m = (the pin's + the hole's)/2 from the load line.
#[derive(Clone, Copy)]
pub enum Pairing {
    /// The definition of docs/theory.md: on rays from the hole's centre where the pin first touches, along the hole's normal.
    AtTouch,
    /// The same points, along the pin's normal.
    AlongPin,
    /// As the first, where the pin has gone down by delta as a rigid body.
    Displaced,
}

/// What contact needs to know of one point on the arc.
struct PathPoint {
    weight: f64,
    trials: [f64; TRIALS],
    /// Of pin and hole.
    angles: [f64; 2],
    normal: [f64; 2],
    /// Negative where the bodies, undeformed, would overlap.
    gap: f64,
}

const TRIALS: usize = 12;

struct Paths {
    points: Vec<PathPoint>,
    arc: ContactArc,
    /// d(hole's angle)/dm at the load line, and the hole's angle at the edge.
    slope_at_hole: f64,
    edge_at_hole: f64,
}

impl Pairing {
    /// The pin's and the hole's angle at m, the pin's centre `offset` below the hole's.
    fn angles(self, clearance: f64, offset: f64, mean: f64) -> [f64; 2] {
        let pin_radius = 1.0 - clearance;
        let mut pin = mean;
        for _ in 0..60 {
            let (sine, cosine) = pin.sin_cos();
            let hole = (pin_radius * sine).atan2(offset + pin_radius * cosine);
            pin += 0.5 * (2.0 * mean - pin - hole);
        }
        [pin, 2.0 * mean - pin]
    }

    fn paths(self, clearance: f64, indentation: f64, half_angle: f64) -> Paths {
        let arc = ContactArc::new(half_angle);
        let offset = match self {
            Pairing::AtTouch | Pairing::AlongPin => clearance,
            Pairing::Displaced => clearance + indentation,
        };
        // Pieces of the arc in tau, short enough for any mesh below.
        let rule = gauss_legendre(12);
        let pieces = 160;
        let points = (0..pieces).flat_map(|piece| {
            let width = FRAC_PI_2 / f64::from(pieces);
            rule.iter().map(move |(x, weight)| {
                let tau = (f64::from(piece) + 0.5 + 0.5 * x) * width;
                let mean = arc.angle(tau);
                let [pin, hole] = self.angles(clearance, offset, mean);
                let (sine, cosine) = pin.sin_cos();
                let (x, y) = ((1.0 - clearance) * sine, offset + (1.0 - clearance) * cosine);
                let along = if let Pairing::AlongPin = self { pin } else { hole };
                // What is between along the ray is the longer along another normal.
                let between = (1.0 - x.hypot(y)) / (along - hole).cos();
                let gap = between - (clearance + indentation - offset) * along.cos();
                PathPoint {
                    weight: 0.5 * weight * width,
                    trials: std::array::from_fn(|k| (2.0 * k as f64 * tau).cos()),
                    angles: [pin, hole],
                    normal: [along.sin(), -along.cos()],
                    gap,
                }
            })
        });
        Paths {
            points: points.collect(),
            arc,
            slope_at_hole: self.angles(clearance, offset, 1e-6)[1] / 1e-6,
            edge_at_hole: self.angles(clearance, offset, half_angle)[1],
        }
    }
}

pub struct State {
    /// N.
    pub force: f64,
    /// Strength of the edge singularity, in no particular unit.
    edge: f64,
    /// MPa, per area of the hole.
    pub peak_pressure: f64,
    /// rad.
    pub angle_at_hole: f64,
}

/// The state at an indentation (mm), from meshes graded about a contact half angle (rad) near the one to be found.
pub fn meshed(joint: &JointDesign, indentation: f64, near: f64, pairing: Pairing) -> State {
    let clearance = joint.radial_clearance / joint.hole_radius;
    let bodies = [&joint.pin, &joint.plate]
        .map(|part| (FineBody::new(&joint.body(part), near), part.contact_material().youngs_modulus));
    let state = |half_angle| {
        state(joint, &bodies, &pairing.paths(clearance, indentation / joint.hole_radius, half_angle))
    };
    // The edge's singularity vanishes at the contact's half angle: secant.
    let (mut before, mut angle) = (0.998 * near, 1.002 * near);
    let mut edge_before = state(before).edge;
    for _ in 0..12 {
        let edge = state(angle).edge;
        let next = angle - edge * (angle - before) / (edge - edge_before);
        (before, angle, edge_before) = (angle, next, edge);
        if (angle - before).abs() < 1e-10 {
            break;
        }
    }
    assert!((angle - before).abs() < 1e-8, "the search for the contact's edge has not settled");
    state(angle)
}

/// The pressure that closes the gap in the weak sense.
fn state(joint: &JointDesign, bodies: &[(FineBody, f64); 2], paths: &Paths) -> State {
    let mut matrix = [[0.0; TRIALS]; TRIALS];
    for (which, (body, modulus)) in bodies.iter().enumerate() {
        let part = body.gram(paths, which);
        for (row, part) in matrix.iter_mut().zip(part) {
            row.iter_mut().zip(part).for_each(|(value, part)| *value += part / modulus);
        }
    }
    let (mut closing, mut lift) = ([0.0; TRIALS], [0.0; TRIALS]);
    for point in &paths.points {
        for (k, trial) in point.trials.iter().enumerate() {
            closing[k] -= point.weight * trial * point.gap;
            lift[k] -= 2.0 * point.weight * trial * point.normal[1];
        }
    }
    let pressure = solve(matrix, closing);
    let signed = |k: usize, c: &f64| if k.is_multiple_of(2) { *c } else { -c };
    let peak: f64 = pressure.iter().enumerate().map(|(k, c)| signed(k, c)).sum();
    State {
        force: joint.thickness
            * joint.hole_radius
            * pressure.iter().zip(lift).map(|(c, l)| c * l).sum::<f64>(),
        edge: pressure.iter().sum(),
        peak_pressure: peak / (2.0 * paths.arc.b) / paths.slope_at_hole,
        angle_at_hole: paths.edge_at_hole,
    }
}

/// Gaussian elimination; the matrix is positive definite.
fn solve(mut matrix: [[f64; TRIALS]; TRIALS], mut right: [f64; TRIALS]) -> [f64; TRIALS] {
    for pivot in 0..TRIALS {
        for row in pivot + 1..TRIALS {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            for column in pivot..TRIALS {
                matrix[row][column] -= factor * matrix[pivot][column];
            }
            right[row] -= factor * right[pivot];
        }
    }
    for row in (0..TRIALS).rev() {
        let known: f64 = (row + 1..TRIALS).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right
}

/// A body on a Q8 mesh of its own, graded about one angle of its ring, factorised down to the ring.
struct FineBody {
    topology: RingTopology,
    structure: BandStructure,
    tiles: Vec<Tile<f64>>,
}

/// Angle, and depth, of the elements at the edge over the contact half angle; growth from there; the widest, rad.
const EDGE: f64 = 1e-3;
const GROWTH: f64 = 1.3;
const WIDEST: f64 = 0.06;

impl FineBody {
    fn new(body: &Body, edge: f64) -> FineBody {
        let first_layer = EDGE * edge;
        let depth = body.beyond_lining().0.depth_range().1;
        let reached = |count: usize| -> f64 {
            layer_thicknesses(first_layer, 2.0 * WIDEST, GROWTH).take(count).sum::<f64>()
        };
        let layer_count = (2..).find(|count| reached(*count) >= depth).unwrap();
        let end = body.shape.end_angle;
        let mut angles: Vec<f64> = graded(edge).into_iter().rev().map(|distance| edge - distance).collect();
        angles.extend(graded(end - edge).into_iter().skip(1).map(|distance| edge + distance));
        (angles[0], *angles.last_mut().unwrap()) = (0.0, end);
        let element = ElementKind::Quad8;
        let layers = Layers { first: first_layer, thickest: 2.0 * WIDEST, count: layer_count, shrinking: 0 };
        let lining = LiningDivision::of(body, layers, GROWTH, f64::INFINITY);
        let grading = Grading { element, angles, layers, lining };
        let topology = RingTopology::new(body, &grading);
        let structure = BandStructure::new(&topology);
        let mut tiles = structure.empty::<f64>();
        let rule = ElementRule::new(element);
        let nodes = coordinates(body, &grading, &topology);
        for (index, connectivity) in topology.connectivity.chunks_exact(element.node_count()).enumerate() {
            let mut corners = [[0.0; 2]; MAX_NODES];
            corners.iter_mut().zip(connectivity).for_each(|(corner, node)| *corner = nodes[*node as usize]);
            let elasticity = elasticity_at(body, &corners);
            structure.add(&mut tiles, index, &element_stiffness(&rule, &elasticity, &corners));
        }
        structure.factorise::<_, 1, 1>(&mut tiles);
        FineBody { topology, structure, tiles }
    }

    /// The integrals of p_j u[p_k] for trial pressures on the path's points, `which` body's angles.
    fn gram(&self, paths: &Paths, which: usize) -> [[f64; TRIALS]; TRIALS] {
        let angles = &self.topology.ring_angles;
        let rows = (self.structure.size - self.structure.ring_start) / TILE;
        let mut loads = vec![[[0.0; TRIALS]; TILE]; rows];
        for point in &paths.points {
            let angle = point.angles[which];
            let corners = angles.iter().step_by(2);
            let element = (corners.take_while(|a| **a <= angle).count() - 1).min(angles.len() / 2 - 1);
            let (start, end) = (angles[2 * element], angles[2 * element + 2]);
            let (functions, count) =
                side_functions(ElementKind::Quad8, (2.0 * angle - start - end) / (end - start));
            for (local, function) in functions.iter().enumerate().take(count) {
                let node = self.topology.ring_nodes[2 * element + local] as usize;
                for component in 0..2 {
                    let unknown = self.topology.unknowns[2 * node + component];
                    if unknown == SUPPORTED {
                        continue;
                    }
                    let at = self.structure.positions[unknown as usize] as usize - self.structure.ring_start;
                    let scale = point.weight * function * point.normal[component];
                    let row = &mut loads[at / TILE][at % TILE];
                    row.iter_mut().zip(&point.trials).for_each(|(load, trial)| *load += scale * trial);
                }
            }
        }
        self.structure.substitute_ring::<_, _, 1>(&self.tiles, 0, &mut loads);
        let mut matrix = [[0.0; TRIALS]; TRIALS];
        for row in loads.iter().flatten() {
            for (j, entries) in matrix.iter_mut().enumerate() {
                entries.iter_mut().zip(row).for_each(|(entry, value)| *entry += row[j] * value);
            }
        }
        matrix
    }
}

/// Of the material where the middle of an element lies.
fn elasticity_at(body: &Body, corners: &[[f64; 2]; MAX_NODES]) -> Elasticity<f64> {
    let mean = |axis: usize| 0.25 * corners[..4].iter().map(|corner| corner[axis]).sum::<f64>();
    let depth = mean(0).hypot(mean(1)).ln().abs();
    let beyond = body.lining.list().iter().rev().find(|interface| interface.radius_ratio.ln().abs() < depth);
    let (modulus, poissons_ratio) =
        beyond.map_or((1.0, body.poissons_ratio), |beyond| (beyond.modulus_ratio, beyond.poissons_ratio));
    let Elasticity { direct, cross, shear } = Elasticity::new(body.idealization, poissons_ratio);
    Elasticity { direct: modulus * direct, cross: modulus * cross, shear: modulus * shear }
}

/// Distances from the edge, 0 first, growing from `EDGE` of a typical arc to `WIDEST`, to `length` exactly.
fn graded(length: f64) -> Vec<f64> {
    assert!(length > 0.0 && length < PI);
    let mut distances = vec![0.0];
    let mut step = EDGE * length.min(1.0);
    let mut reached = 0.0;
    while reached < length {
        reached += step;
        distances.push(reached);
        step = (step * GROWTH).min(WIDEST);
    }
    distances.iter_mut().for_each(|distance| *distance *= length / reached);
    distances
}
