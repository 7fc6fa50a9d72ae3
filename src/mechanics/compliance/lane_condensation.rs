//! Finite-element compliance to the trial pressures, for several bodies of one topology at a time.
//!
//! Coordinates, element stiffness, band Cholesky down to the ring, then for each arc the Gram matrix of L^-1 f: all in
//! the lanes of `Lanes`, one body a lane, in code compiled for the widest vectors of the processor.

use pulp::{Arch, Simd, WithSimd};

use super::arc::{MAX_TERMS, TERM_CHOICES, packed_count};
use super::pressure_space::PressureSpace;
use super::ring_loads::{ArcLoads, RingLoads};
use super::{NODE_COUNT, PressureCompliance};
use crate::mechanics::body::Body;
use crate::mechanics::element::MAX_NODES;
use crate::mechanics::element::stiffness::{
    Elasticity, ElementRule, element_stiffness, stiffness_operations,
};
use crate::mechanics::mesh::{Grading, RingTopology, SUPPORTED, coordinates};
use crate::mechanics::real::{LANES, Lanes, Real};
use crate::mechanics::solve::band::{BandStructure, TILE, Tile};

/// What bodies of one topology share: mesh, order of elimination, loads of the trial pressures.
pub struct CondensationPlan {
    grading: Grading,
    topology: RingTopology,
    structure: BandStructure,
    rule: ElementRule,
    terms: usize,
    loads: Vec<PlacedLoads>,
}

/// Loads of one arc in the order of elimination: from tile row `start` of the ring on, `[tile row][row in it][k]`.
struct PlacedLoads {
    start: usize,
    rows: usize,
    values: Vec<f64>,
}

/// Floating-point operations of condensing one body, a multiply-add counted as two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operations {
    /// The element stiffnesses.
    pub elements: u64,
    /// The band's Cholesky factor.
    pub factorise: u64,
    /// Substitution and Gram matrix at every arc.
    pub arcs: u64,
}

impl Operations {
    pub fn total(&self) -> u64 {
        self.elements + self.factorise + self.arcs
    }
}

impl CondensationPlan {
    /// For bodies like `body` (same shape family, supports and class), divided by `grading`; `rings` are those of `space`.
    pub fn new(body: &Body, grading: Grading, space: &PressureSpace, rings: &RingLoads) -> CondensationPlan {
        let topology = RingTopology::new(body, &grading);
        let structure = BandStructure::new(&topology);
        let loads = rings.with(space, grading.element, &topology.ring_angles, |arcs| {
            arcs.iter().map(|loads| place(&topology, &structure, loads, space.terms)).collect()
        });
        let rule = ElementRule::new(grading.element);
        CondensationPlan { grading, topology, structure, rule, terms: space.terms, loads }
    }

    pub fn unknown_count(&self) -> usize {
        self.topology.unknown_count
    }

    /// What the plan takes, but for what is small beside it.
    pub fn bytes(&self) -> usize {
        let loads: usize = self.loads.iter().map(|loads| size_of_val(&loads.values[..])).sum();
        loads + self.structure.bytes() + self.topology.bytes()
    }

    /// What one body costs.
    pub fn operations(&self) -> Operations {
        let of_arc = |loads: &PlacedLoads| {
            let products = (2 * loads.rows * TILE * packed_count(self.terms)) as u64;
            self.structure.substitute_operations(loads.rows, self.terms) + products
        };
        Operations {
            elements: self.topology.element_count() as u64 * stiffness_operations(self.topology.element),
            factorise: self.structure.factorise_operations(),
            arcs: self.loads.iter().map(of_arc).sum(),
        }
    }

    /// Up to `LANES` bodies at a time; the order is kept. A body whose mesh is turned inside out or
    /// whose stiffness is not positive definite gives NaN. The part -pi/2 c ln b of entry (0, 0), which
    /// `PressureCompliance` leaves out, is still in: the near field takes it out.
    pub fn condense(&self, bodies: &[Body]) -> Vec<PressureCompliance> {
        bodies
            .chunks(LANES)
            .flat_map(|bodies| Arch::new().dispatch(Condense { plan: self, bodies }))
            .collect()
    }
}

fn place(topology: &RingTopology, structure: &BandStructure, loads: &ArcLoads, terms: usize) -> PlacedLoads {
    let mut placed = Vec::new();
    for node in 0..loads.node_count {
        for component in 0..2 {
            let unknown = topology.unknowns[2 * topology.ring_nodes[node] as usize + component];
            if unknown != SUPPORTED {
                placed.push((structure.positions[unknown as usize] as usize, (node * 2 + component) * terms));
            }
        }
    }
    let first = placed.iter().map(|(position, _)| *position).min().unwrap_or(structure.ring_start);
    let start = (first - structure.ring_start) / TILE;
    let rows = (structure.size - structure.ring_start) / TILE - start;
    let mut values = vec![0.0; rows * TILE * terms];
    for (position, from) in placed {
        let to = (position - structure.ring_start - start * TILE) * terms;
        values[to..to + terms].copy_from_slice(&loads.values[from..from + terms]);
    }
    PlacedLoads { start, rows, values }
}

struct Condense<'a> {
    plan: &'a CondensationPlan,
    bodies: &'a [Body],
}

impl WithSimd for Condense<'_> {
    type Output = Vec<PressureCompliance>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}

impl Condense<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<PressureCompliance> {
        let mut tiles = self.plan.structure.empty::<Lanes<FUSED>>();
        let smallest_jacobian = self.assemble(&mut tiles);
        self.plan.structure.factorise(&mut tiles);
        let entries = packed_count(self.plan.terms);
        let mut compliances: Vec<PressureCompliance> = self
            .bodies
            .iter()
            .map(|body| PressureCompliance {
                terms: self.plan.terms,
                amplitude: 2.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio),
                bed: 0.0,
                values: Vec::with_capacity(NODE_COUNT * entries),
            })
            .collect();
        match self.plan.terms {
            3 => self.gram::<FUSED, 3>(&tiles, &mut compliances),
            6 => self.gram::<FUSED, 6>(&tiles, &mut compliances),
            10 => self.gram::<FUSED, 10>(&tiles, &mut compliances),
            16 => self.gram::<FUSED, 16>(&tiles, &mut compliances),
            MAX_TERMS => self.gram::<FUSED, MAX_TERMS>(&tiles, &mut compliances),
            other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
        }
        for (lane, compliance) in compliances.iter_mut().enumerate() {
            if smallest_jacobian.0[lane].is_nan() || smallest_jacobian.0[lane] <= 0.0 {
                compliance.values.fill(f64::NAN);
            }
        }
        compliances
    }

    /// The stiffness of every body in its lane, and its least Jacobian; lanes without a body repeat the last one.
    #[inline(always)]
    fn assemble<const FUSED: bool>(&self, tiles: &mut [Tile<Lanes<FUSED>>]) -> Lanes<FUSED> {
        let CondensationPlan { grading, topology, structure, rule, .. } = self.plan;
        let body = |lane: usize| &self.bodies[lane.min(self.bodies.len() - 1)];
        let zero = Lanes::<FUSED>::zero();
        let mut nodes = vec![[zero; 2]; topology.node_count];
        let mut poissons_ratio = zero;
        for lane in 0..LANES {
            if lane < self.bodies.len() {
                for (node, point) in nodes.iter_mut().zip(coordinates(body(lane), grading, topology)) {
                    node[0].0[lane] = point[0];
                    node[1].0[lane] = point[1];
                }
            } else {
                for node in &mut nodes {
                    node[0].0[lane] = node[0].0[lane - 1];
                    node[1].0[lane] = node[1].0[lane - 1];
                }
            }
            poissons_ratio.0[lane] = body(lane).poissons_ratio;
        }
        let elasticity = Elasticity::new(self.bodies[0].idealization, poissons_ratio);
        let count = topology.element.node_count();
        let mut smallest_jacobian = Lanes::from_f64(f64::INFINITY);
        for (element, connectivity) in topology.connectivity.chunks_exact(count).enumerate() {
            let mut corners = [[zero; 2]; MAX_NODES];
            for (corner, node) in corners.iter_mut().zip(connectivity) {
                *corner = nodes[*node as usize];
            }
            let stiffness = element_stiffness(rule, &elasticity, &corners);
            smallest_jacobian = smallest_jacobian.least(stiffness.smallest_jacobian);
            structure.add(tiles, element, &stiffness);
        }
        smallest_jacobian
    }

    /// The Gram matrices of L^-1 f at every arc, with the part -pi/2 c ln b of entry (0, 0) still in them.
    #[inline(always)]
    fn gram<const FUSED: bool, const TERMS: usize>(
        &self,
        tiles: &[Tile<Lanes<FUSED>>],
        compliances: &mut [PressureCompliance],
    ) {
        let mut work = Vec::new();
        for loads in &self.plan.loads {
            work.clear();
            work.resize(loads.rows, [[Lanes::<FUSED>::zero(); TERMS]; TILE]);
            for (row, values) in work.iter_mut().flatten().zip(loads.values.chunks_exact(TERMS)) {
                for (value, load) in row.iter_mut().zip(values) {
                    *value = Lanes::from_f64(*load);
                }
            }
            self.plan.structure.substitute_ring(tiles, loads.start, &mut work);
            let mut matrix = [[Lanes::<FUSED>::zero(); TERMS]; TERMS];
            for rows in &work {
                for j in 0..TERMS {
                    for k in 0..=j {
                        let mut sum = matrix[j][k];
                        for row in rows {
                            sum = sum.minus_product(row[j], -row[k]);
                        }
                        matrix[j][k] = sum;
                    }
                }
            }
            for (lane, compliance) in compliances.iter_mut().enumerate() {
                for (j, row) in matrix.iter().enumerate() {
                    compliance.values.extend(row[..=j].iter().map(|value| value.0[lane]));
                }
            }
        }
    }
}
