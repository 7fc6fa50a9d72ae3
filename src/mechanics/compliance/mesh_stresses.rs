//! Stresses on circles around the ring of a body on a mesh.
//!
//! No mesh sees the stresses under a narrow contact, but two meshes that are the same near the ring are wrong by the same there. So, as
//! with compliances (`lined_reference`),
//!
//! ```text
//!   stresses(body) = exact stresses(reference) + [mesh stresses(body) - mesh stresses(reference)]
//! ```
//!
//! under the same pressure on the ring. What is in brackets is smooth. Radial and shear stress are taken at the 2 x 2 points of the elements
//! before a circle and from there to the circle; the hoop strain from the nodes on it, which the materials on both sides have in common.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::circle_stresses::OnCircle;
use super::condense::CondenseError;
use super::lined_reference::LinedReference;
use crate::mechanics::assembly::Assembly;
use crate::mechanics::body::{Body, Side};
use crate::mechanics::element::quadrature::TWO_POINT;
use crate::mechanics::element::stiffness::{Elasticity, strain};
use crate::mechanics::element::{ElementKind, MAX_NODES, ShapeFunctions};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::lines::coordinates;
use crate::mechanics::mesh::{Grading, RingTopology, SUPPORTED};
use crate::mechanics::solve::cholesky::CholeskyAnalysis;

/// What a body has on a circle beyond its reference.
#[derive(Clone, Debug)]
pub struct CircleDifference {
    /// Ascending, from before the load line to behind the end of the ring, rad.
    places: Vec<(f64, OnCircle)>,
}

/// Places between which values are interpolated.
const AROUND: usize = 4;

impl CircleDifference {
    /// At an angle from the load line, rad, by the cubic through the places around.
    pub fn at(&self, angle: f64) -> OnCircle {
        let behind = self.places.partition_point(|(place, _)| *place < angle);
        let from = behind.saturating_sub(AROUND / 2).min(self.places.len() - AROUND);
        let around = &self.places[from..from + AROUND];
        let mut sum = OnCircle::default();
        for (own, value) in around {
            let others = around.iter().filter(|(place, _)| place != own);
            let share: f64 = others.map(|(place, _)| (angle - place) / (own - place)).product();
            sum.radial += share * value.radial;
            sum.shear += share * value.shear;
            sum.hoop_strain += share * value.hoop_strain;
        }
        sum
    }

    /// With what lies mirrored behind the load line, and behind the far side of a ring that is whole.
    fn new(mut places: Vec<(f64, OnCircle)>, is_whole: bool) -> CircleDifference {
        places.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mirrored = |(angle, value): &(f64, OnCircle), about: f64| {
            (2.0 * about - angle, OnCircle { shear: -value.shear, ..*value })
        };
        let before: Vec<_> = places.iter().take(AROUND).rev().map(|place| mirrored(place, 0.0)).collect();
        let behind: Vec<_> = places.iter().rev().take(AROUND).map(|place| mirrored(place, PI)).collect();
        let behind = if is_whole { behind } else { Vec::new() };
        CircleDifference { places: before.into_iter().chain(places).chain(behind).collect() }
    }
}

/// A body and its reference on their meshes, under the same pressure.
pub struct MeshStresses {
    /// The concentric body whose stresses are exact.
    pub reference: Body,
    body: Loaded,
    of_reference: Loaded,
}

impl MeshStresses {
    /// Of a body on a mesh of a level. Of the pressure on the half of the ring, over the modulus there: pieces, their angles from the load
    /// line, rad, and their pressure times width, rad.
    pub fn new(body: &Body, level: usize, pressure: &[(f64, f64)]) -> Result<MeshStresses, CondenseError> {
        let class = GradingClass::of(body, ElementKind::Quad8, level);
        let LinedReference { body: reference, mesh } = LinedReference::of(body, class);
        let grading = class.grading(body.shape.end_angle);
        Ok(MeshStresses {
            body: Loaded::new(body, &grading, pressure)?,
            of_reference: Loaded::new(&reference, &mesh.grading(), pressure)?,
            reference,
        })
    }

    /// On the ring and on each interface of the body.
    pub fn differences(&self) -> Vec<CircleDifference> {
        (0..self.body.elasticity.len()).map(|circle| self.on_circle(circle)).collect()
    }

    /// On the ring, 0, or an interface. On the ring both have the same stresses, those of the pressure.
    fn on_circle(&self, circle: usize) -> CircleDifference {
        let Loaded { topology, coordinates, elasticity, .. } = &self.body;
        let layer =
            topology.materials.iter().filter(|material| **material < circle).count().saturating_sub(1);
        let is_outer = (self.reference.shape.side == Side::Plate) == (circle > 0);
        let (on_edge, xi) = if is_outer { ([1, 5, 2], 1.0) } else { ([0, 7, 3], -1.0) };
        let mut places = Vec::new();
        for column in 0..topology.ring_nodes.len() / 2 {
            let nodes = topology.element_at(layer, column);
            let corners: [[f64; 2]; MAX_NODES] = nodes.map(|node| coordinates[node as usize]);
            let moved = nodes.map(|node| self.difference(node));
            let ends = [topology.ring_angles[2 * column], topology.ring_angles[2 * column + 2]];
            let half = 0.5 * (ends[1] - ends[0]);
            for eta in TWO_POINT {
                let angle = ends[0] + half * (1.0 + eta);
                let (sine, cosine) = angle.sin_cos();
                let (normal, tangent) = ([sine, -cosine], [cosine, sine]);
                let slopes = [eta - 0.5, -2.0 * eta, eta + 0.5];
                let turn: f64 = (on_edge.iter().zip(slopes))
                    .map(|(node, slope)| slope / half * dot(tangent, moved[*node]))
                    .sum();
                let [x, y] = corners[on_edge[1]];
                let mut value = OnCircle { hoop_strain: turn / x.hypot(y), ..OnCircle::default() };
                if circle > 0 {
                    let [before, behind] = TWO_POINT.map(|xi| {
                        let shape = ShapeFunctions::at(ElementKind::Quad8, xi, eta);
                        elasticity[circle - 1].traction(strain(&shape, &corners, &moved), normal)
                    });
                    let traction = [0, 1].map(|axis| {
                        let (mean, change) =
                            (0.5 * (before[axis] + behind[axis]), 0.5 * (behind[axis] - before[axis]));
                        mean + xi / TWO_POINT[1] * change
                    });
                    (value.radial, value.shear) = (dot(normal, traction), dot(tangent, traction));
                }
                places.push((angle, value));
            }
        }
        CircleDifference::new(places, topology.ring_angles[topology.ring_angles.len() - 1] == PI)
    }

    /// Of the displacements of a node of the body and of that of the reference in its place.
    fn difference(&self, node: u32) -> [f64; 2] {
        let place = self.body.topology.grid[node as usize];
        let other = self.of_reference.nodes[&place];
        let (own, other) =
            (self.body.displacements[node as usize], self.of_reference.displacements[other as usize]);
        [own[0] - other[0], own[1] - other[1]]
    }
}

/// A body on a mesh under a pressure on its ring.
struct Loaded {
    topology: RingTopology,
    /// By row and column in half elements.
    nodes: HashMap<(usize, usize), u32>,
    coordinates: Vec<[f64; 2]>,
    /// Of its materials, from the ring on.
    elasticity: Vec<Elasticity<f64>>,
    /// Of all nodes.
    displacements: Vec<[f64; 2]>,
}

impl Loaded {
    fn new(body: &Body, grading: &Grading, pressure: &[(f64, f64)]) -> Result<Loaded, CondenseError> {
        let topology = RingTopology::new(body, grading);
        let coordinates = coordinates(body, grading, &topology);
        let elasticity: Vec<Elasticity<f64>> = (0..=body.lining.list().len())
            .map(|material| {
                let [modulus, poissons_ratio] = body.material(material);
                Elasticity::new(body.idealization, poissons_ratio).times(modulus)
            })
            .collect();
        let assembly = Assembly::of_ring(&topology);
        let values =
            assembly.stiffness_values_by(|element| elasticity[topology.material(element)], &coordinates)?;
        let analysis = CholeskyAnalysis::new(assembly.matrix(&values))?;
        let mut column = vec![0.0; topology.unknown_count];
        for (angle, pressed) in pressure {
            let (nodes, shares) = topology.on_ring(*angle);
            let (sine, cosine) = angle.sin_cos();
            let force = [sine, -cosine].map(|part| body.shape.side.outward() * pressed * part);
            for (node, share) in nodes.into_iter().zip(shares) {
                for (component, force) in force.into_iter().enumerate() {
                    let unknown = topology.unknowns[2 * node as usize + component];
                    if unknown != SUPPORTED {
                        column[unknown as usize] += share * force;
                    }
                }
            }
        }
        analysis.factorize(assembly.matrix(&values))?.solve_in_place(&mut column);
        let moved = |unknown: &u32| if *unknown == SUPPORTED { 0.0 } else { column[*unknown as usize] };
        let displacements = topology.unknowns.chunks_exact(2).map(|own| [moved(&own[0]), moved(&own[1])]);
        Ok(Loaded {
            displacements: displacements.collect(),
            nodes: (0..).zip(&topology.grid).map(|(node, place)| (*place, node)).collect(),
            topology,
            coordinates,
            elasticity,
        })
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
