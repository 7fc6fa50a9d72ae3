//! Finite-element works of the ring modes, for several bodies of one topology at a time.
//!
//! Coordinates, element stiffness, band Cholesky down to the ring, then the Gram matrix of L^-1 f: all in the lanes of
//! `Lanes`, one body a lane, in code compiled for the widest vectors of the processor.

use super::arc::{packed, packed_count};
use super::ring_modes::RingModes;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::element::MAX_NODES;
use crate::mechanics::element::stiffness::{
    Elasticity, ElementRule, element_stiffness, stiffness_operations,
};
use crate::mechanics::mesh::{Grading, RingTopology, coordinates};
use crate::mechanics::real::{LANES, Lanes, Real};
use crate::mechanics::solve::band::{BandStructure, TILE, Tile};

/// What bodies of one topology share: mesh, order of elimination, loads of the ring modes.
pub struct CondensationPlan {
    grading: Grading,
    topology: RingTopology,
    structure: BandStructure,
    rule: ElementRule,
    modes: RingModes,
    /// In the order of elimination: `[ring unknown][m]`.
    loads: Vec<f64>,
}

/// Floating-point operations of condensing one body, a multiply-add counted as two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operations {
    /// The element stiffnesses.
    pub elements: u64,
    /// The band's Cholesky factor.
    pub factorise: u64,
    /// Substitution and Gram matrix of the ring modes.
    pub modes: u64,
}

impl Operations {
    pub fn total(&self) -> u64 {
        self.elements + self.factorise + self.modes
    }
}

/// Modes that are substituted side by side: some blocks of them are a plan's.
const BLOCKS: [usize; 2] = [12, 8];

impl CondensationPlan {
    /// For bodies like `body` (same shape family, supports and class), divided by `grading`.
    pub fn new(body: &Body, grading: Grading, modes: RingModes) -> CondensationPlan {
        let topology = RingTopology::new(body, &grading);
        let structure = BandStructure::new(&topology);
        let mut loads = vec![0.0; (structure.size - structure.ring_start) * modes.count];
        for (place, load) in modes.unknown_loads(&topology) {
            let position = structure.positions[topology.ring_start + place] as usize - structure.ring_start;
            loads[position * modes.count..][..modes.count].copy_from_slice(&load);
        }
        let rule = ElementRule::new(grading.element);
        CondensationPlan { grading, topology, structure, rule, modes, loads }
    }

    pub fn unknown_count(&self) -> usize {
        self.topology.unknown_count
    }

    /// What the plan takes, but for what is small beside it.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.loads[..]) + self.structure.bytes() + self.topology.bytes()
    }

    /// What one body costs.
    pub fn operations(&self) -> Operations {
        let rows = self.loads.len() / self.modes.count / TILE;
        let products = (2 * rows * TILE * packed_count(self.modes.count)) as u64;
        Operations {
            elements: self.topology.element_count() as u64 * stiffness_operations(self.topology.element),
            factorise: self.structure.factorise_operations(),
            modes: self.structure.substitute_operations(rows, self.modes.count) + products,
        }
    }

    /// The works of the ring modes, packed, on each body; the order is kept. A body whose mesh is turned inside out or
    /// whose stiffness is not positive definite gives NaN.
    pub fn condense(&self, bodies: &[Body]) -> Vec<Vec<f64>> {
        bodies.chunks(LANES).flat_map(|bodies| in_lanes(Condense { plan: self, bodies })).collect()
    }
}

struct Condense<'a> {
    plan: &'a CondensationPlan,
    bodies: &'a [Body],
}

impl LaneWork for Condense<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<Vec<f64>> {
        let mut tiles = self.plan.structure.empty::<Lanes<FUSED>>();
        let smallest_jacobian = self.assemble(&mut tiles);
        self.plan.structure.factorise(&mut tiles);
        let count = self.plan.modes.count;
        let mut works = vec![vec![0.0; packed_count(count)]; self.bodies.len()];
        if count.is_multiple_of(BLOCKS[0]) {
            self.gram::<FUSED, { BLOCKS[0] }>(&tiles, &mut works);
        } else {
            self.gram::<FUSED, { BLOCKS[1] }>(&tiles, &mut works);
        }
        for (lane, works) in works.iter_mut().enumerate() {
            if smallest_jacobian.0[lane].is_nan() || smallest_jacobian.0[lane] <= 0.0 {
                works.fill(f64::NAN);
            }
        }
        works
    }
}

impl Condense<'_> {
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

    /// The Gram matrix of L^-1 f, in blocks of so many modes.
    #[inline(always)]
    fn gram<const FUSED: bool, const BLOCK: usize>(
        &self,
        tiles: &[Tile<Lanes<FUSED>>],
        works: &mut [Vec<f64>],
    ) {
        let CondensationPlan { structure, modes: RingModes { count, .. }, loads, .. } = self.plan;
        let rows = loads.len() / count / TILE;
        let zero = Lanes::<FUSED>::zero();
        let mut solved: Vec<Vec<[[Lanes<FUSED>; BLOCK]; TILE]>> = Vec::with_capacity(count / BLOCK);
        for first in (0..*count).step_by(BLOCK) {
            let mut block = vec![[[zero; BLOCK]; TILE]; rows];
            for (row, loads) in block.iter_mut().flatten().zip(loads.chunks_exact(*count)) {
                for (value, load) in row.iter_mut().zip(&loads[first..]) {
                    *value = Lanes::from_f64(*load);
                }
            }
            structure.substitute_ring(tiles, 0, &mut block);
            solved.push(block);
        }
        for (i, of_rows) in solved.iter().enumerate() {
            for (j, of_columns) in solved[..=i].iter().enumerate() {
                let mut matrix = [[zero; BLOCK]; BLOCK];
                for (rows, columns) in of_rows.iter().flatten().zip(of_columns.iter().flatten()) {
                    for a in 0..BLOCK {
                        for b in 0..BLOCK {
                            matrix[a][b] = matrix[a][b].minus_product(rows[a], -columns[b]);
                        }
                    }
                }
                for (a, of_row) in matrix.iter().enumerate() {
                    let row = i * BLOCK + a;
                    let columns = j * BLOCK..(j * BLOCK + BLOCK).min(row + 1);
                    for (column, value) in columns.zip(of_row) {
                        for (lane, works) in works.iter_mut().enumerate() {
                            works[packed(row, column)] = value.0[lane];
                        }
                    }
                }
            }
        }
    }
}
