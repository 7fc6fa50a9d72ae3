//! Finite-element works of the ring modes, for several bodies of one topology at a time.
//!
//! Coordinates, element stiffness, band Cholesky down to the ring, then the Gram matrix of L^-1 f: all in the lanes of
//! `Lanes`, one body a lane, in code compiled for the widest vectors of the processor.

use super::arc::{packed, packed_count};
use super::ring_modes::{Push, RingModes};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::element::MAX_NODES;
use crate::mechanics::element::stiffness::{
    Elasticity, ElementRule, ElementStiffness, element_stiffness_in_room, stiffness_operations,
};
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::{Grading, RingTopology, coordinates_abreast};
use crate::mechanics::real::{Alone, Bodies, LANES, Lanes, Real};
use crate::mechanics::solve::band::{BandStructure, TILE, Tile};

/// What bodies of one topology share: mesh, order of elimination, loads of the ring modes.
pub struct CondensationPlan {
    grading: Grading,
    topology: RingTopology,
    structure: BandStructure,
    rule: ElementRule,
    modes: RingModes,
    /// Of each way to push, in the order of elimination: `[ring unknown][m]`.
    loads: Vec<Vec<f64>>,
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

/// So many bodies at most take no longer one after the other than in lanes.
const FEW: usize = 4;

/// Modes that are substituted side by side: some blocks of them are a plan's.
const BLOCKS: [usize; 2] = [12, 8];

impl CondensationPlan {
    /// For bodies like `body` (same shape family, supports and class), divided by `grading`.
    pub fn new(body: &Body, grading: Grading, modes: RingModes) -> CondensationPlan {
        let loads = modes.loads(Push::of(body.shape.side), grading.element, &grading.ring_angles());
        CondensationPlan::with_loads(body, grading, modes, &loads)
    }

    /// The same with the loads of the modes on the ring, for bodies of that side.
    pub fn with_loads(
        body: &Body,
        grading: Grading,
        modes: RingModes,
        loads: &[Vec<f64>],
    ) -> CondensationPlan {
        let topology = RingTopology::new(body, &grading);
        let structure = BandStructure::new(&topology);
        let in_order = |unknown_loads: Vec<(usize, Vec<f64>)>| {
            let mut loads = vec![0.0; (structure.size - structure.ring_start) * modes.count];
            for (place, load) in unknown_loads {
                let position =
                    structure.positions[topology.ring_start + place] as usize - structure.ring_start;
                loads[position * modes.count..][..modes.count].copy_from_slice(&load);
            }
            loads
        };
        let loads = modes.placed(loads, &topology).into_iter().map(in_order).collect();
        let rule = ElementRule::new(grading.element);
        CondensationPlan { grading, topology, structure, rule, modes, loads }
    }

    pub fn unknown_count(&self) -> usize {
        self.topology.unknown_count
    }

    /// What the plan takes, but for what is small beside it.
    pub fn bytes(&self) -> usize {
        self.loads.len() * size_of_val(&self.loads[0][..]) + self.structure.bytes() + self.topology.bytes()
    }

    /// What one body costs.
    pub fn operations(&self) -> Operations {
        let RingModes { count, .. } = self.modes;
        let rows = self.rows();
        // What tilt adds is not symmetric before it is made so.
        let entries = packed_count(count) + (self.loads.len() - 1) * count * count;
        let products = (2 * rows * TILE * entries) as u64;
        let substitutions = self.loads.len() as u64 * self.structure.substitute_operations(rows, count);
        Operations {
            elements: self.topology.element_count() as u64 * stiffness_operations(self.topology.element),
            factorise: self.structure.factorise_operations(),
            modes: substitutions + products,
        }
    }

    /// Rows of tiles on the ring.
    fn rows(&self) -> usize {
        self.loads[0].len() / self.modes.count / TILE
    }

    /// The works of the ring modes on each body, packed, one way to push after the other; the order is kept. A body whose mesh is
    /// turned inside out or whose stiffness is not positive definite gives NaN.
    pub fn condense(&self, bodies: &[Body]) -> Vec<Vec<f64>> {
        let together = |bodies: &[Body]| match bodies.len() {
            ..=FEW => bodies.iter().map(|body| self.condense_alone(body)).collect(),
            _ => in_lanes(Condense { plan: self, bodies }),
        };
        bodies.chunks(LANES).flat_map(together).collect()
    }

    /// One body, to the same bits, in a fraction of the memory that lanes take.
    pub fn condense_alone(&self, body: &Body) -> Vec<f64> {
        in_lanes(Condense { plan: self, bodies: std::slice::from_ref(body) }).swap_remove(0)
    }
}

struct Condense<'a> {
    plan: &'a CondensationPlan,
    bodies: &'a [Body],
}

impl LaneWork for Condense<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<Vec<f64>> {
        // As many sums at a time as stay in registers: all 16 of a tile where a register holds one in all lanes and there are 32, 4
        // where it takes two and there are 16. Of a body alone a register holds several sums: all 16 take two to eight.
        if self.bodies.len() == 1 {
            self.works::<Alone<WIDTH>, 4>()
        } else if WIDTH >= LANES {
            self.works::<Lanes<WIDTH>, 4>()
        } else {
            self.works::<Lanes<WIDTH>, 1>()
        }
    }
}

impl Condense<'_> {
    #[inline(always)]
    fn works<T: Bodies, const ABREAST: usize>(&self) -> Vec<Vec<f64>> {
        let mut tiles = self.plan.structure.empty::<T>();
        let smallest_jacobian = self.assemble(&mut tiles);
        self.plan.structure.factorise::<T, ABREAST>(&mut tiles);
        let CondensationPlan { modes: RingModes { count, .. }, loads, .. } = self.plan;
        let mut works = vec![vec![0.0; loads.len() * packed_count(*count)]; self.bodies.len()];
        if count.is_multiple_of(BLOCKS[0]) {
            self.gram::<T, { BLOCKS[0] }, ABREAST>(&tiles, &mut works);
        } else {
            self.gram::<T, { BLOCKS[1] }, ABREAST>(&tiles, &mut works);
        }
        for (lane, works) in works.iter_mut().enumerate() {
            let smallest = smallest_jacobian.lane(lane);
            if smallest.is_nan() || smallest <= 0.0 {
                works.fill(f64::NAN);
            }
        }
        works
    }

    /// The stiffness of every body in its lane, and its least Jacobian; lanes without a body repeat the one before.
    #[inline(always)]
    fn assemble<T: Bodies>(&self, tiles: &mut [Tile<T>]) -> T {
        let CondensationPlan { grading, topology, structure, rule, .. } = self.plan;
        let zero = T::zero();
        let nodes: Vec<[T; 2]> = coordinates_abreast(self.bodies, grading, topology);
        let materials: Vec<Elasticity<T>> =
            (0..=self.bodies[0].lining.list().len()).map(|material| self.elasticity(material)).collect();
        let count = topology.element.node_count();
        let mut smallest_jacobian = T::from_f64(f64::INFINITY);
        let mut stiffness = ElementStiffness::room();
        for (element, connectivity) in topology.connectivity.chunks_exact(count).enumerate() {
            let mut corners = [[zero; 2]; MAX_NODES];
            for (corner, node) in corners.iter_mut().zip(connectivity) {
                *corner = nodes[*node as usize];
            }
            let elasticity = &materials[topology.material(element)];
            element_stiffness_in_room(rule, elasticity, &corners, &mut stiffness);
            smallest_jacobian = smallest_jacobian.least(stiffness.smallest_jacobian);
            structure.add(tiles, element, &stiffness);
        }
        smallest_jacobian
    }

    /// Of a material of every body in its lane, 0 that at the ring: bodies in plane stress and in plane strain share a topology.
    #[inline(always)]
    fn elasticity<T: Bodies>(&self, material: usize) -> Elasticity<T> {
        let body = |lane: usize| &self.bodies[lane.min(self.bodies.len() - 1)];
        let mut poissons_ratio = T::zero();
        let mut modulus = T::from_f64(1.0);
        for lane in 0..T::COUNT {
            let [own, ratio] = body(lane).material(material);
            modulus.set_lane(lane, own);
            poissons_ratio.set_lane(lane, ratio);
        }
        let mut elasticity = Elasticity::new(Idealization::PlaneStress, poissons_ratio);
        let plane_strain = Elasticity::new(Idealization::PlaneStrain, poissons_ratio);
        for lane in 0..T::COUNT {
            if body(lane).idealization == Idealization::PlaneStrain {
                elasticity.direct.set_lane(lane, plane_strain.direct.lane(lane));
                elasticity.cross.set_lane(lane, plane_strain.cross.lane(lane));
            }
        }
        if material > 0 { elasticity.times(modulus) } else { elasticity }
    }

    /// Products of L^-1 f, in blocks of so many modes.
    #[inline(always)]
    fn gram<T: Bodies, const BLOCK: usize, const ABREAST: usize>(
        &self,
        tiles: &[Tile<T>],
        works: &mut [Vec<f64>],
    ) {
        let CondensationPlan { modes: RingModes { count, .. }, loads, .. } = self.plan;
        let normal = self.substituted::<T, BLOCK, ABREAST>(tiles, &loads[0]);
        for (push, loads) in loads.iter().enumerate() {
            let own;
            let pushed = if push == 0 {
                &normal
            } else {
                own = self.substituted::<T, BLOCK, ABREAST>(tiles, loads);
                &own
            };
            let from = push * packed_count(*count);
            for (i, of_rows) in pushed.iter().enumerate() {
                // The works of the normal loads are symmetric, those of others are made so.
                let blocks = if push == 0 { i + 1 } else { normal.len() };
                for (j, of_columns) in normal[..blocks].iter().enumerate() {
                    let matrix = products::<T, BLOCK, ABREAST>(of_rows, of_columns);
                    for (a, of_row) in matrix.iter().enumerate() {
                        let row = i * BLOCK + a;
                        for (b, value) in of_row.iter().enumerate() {
                            let column = j * BLOCK + b;
                            let share = match push {
                                0 if column > row => continue,
                                0 => 1.0,
                                _ if column == row => 1.0,
                                _ => 0.5,
                            };
                            let at = from + packed(row.max(column), row.min(column));
                            for (lane, works) in works.iter_mut().enumerate() {
                                works[at] += share * value.lane(lane);
                            }
                        }
                    }
                }
            }
        }
    }

    /// L^-1 f on the ring: `[block of modes][row of tiles][row][mode]`.
    #[inline(always)]
    fn substituted<T: Bodies, const BLOCK: usize, const ABREAST: usize>(
        &self,
        tiles: &[Tile<T>],
        loads: &[f64],
    ) -> Vec<Vec<Rows<T, BLOCK>>> {
        let count = self.plan.modes.count;
        let mut blocks = Vec::with_capacity(count / BLOCK);
        for first in (0..count).step_by(BLOCK) {
            let mut block = Vec::with_capacity(self.plan.rows());
            for loads in loads.chunks_exact(TILE * count) {
                block.push([[T::zero(); BLOCK]; TILE]);
                let own = block.len() - 1;
                for i in 0..TILE {
                    for (value, load) in block[own][i].iter_mut().zip(&loads[i * count + first..]) {
                        *value = T::from_f64(*load);
                    }
                }
            }
            if ABREAST == 1 {
                self.plan.structure.substitute_ring::<T, BLOCK, TILE>(tiles, 0, &mut block);
            } else {
                self.plan.structure.substitute_ring::<T, BLOCK, BLOCK>(tiles, 0, &mut block);
            }
            blocks.push(block);
        }
        blocks
    }
}

/// A row of tiles of so many modes.
type Rows<T, const BLOCK: usize> = [[T; BLOCK]; TILE];

/// The sum over rows of the products of two blocks of modes, `ABREAST` times `TILE` of them at a time.
#[inline(always)]
fn products<T: Real, const BLOCK: usize, const ABREAST: usize>(
    one: &[Rows<T, BLOCK>],
    other: &[Rows<T, BLOCK>],
) -> [[T; BLOCK]; BLOCK] {
    let mut matrix = [[T::zero(); BLOCK]; BLOCK];
    for (of_rows, a) in matrix.as_chunks_mut::<ABREAST>().0.iter_mut().zip((0..).step_by(ABREAST)) {
        for b in (0..BLOCK).step_by(TILE) {
            let mut sums = [[T::zero(); TILE]; ABREAST];
            for (rows, columns) in one.iter().flatten().zip(other.iter().flatten()) {
                for i in 0..ABREAST {
                    for j in 0..TILE {
                        sums[i][j] = sums[i][j].minus_product(rows[a + i], -columns[b + j]);
                    }
                }
            }
            for (row, sums) in of_rows.iter_mut().zip(sums) {
                row[b..b + TILE].copy_from_slice(&sums);
            }
        }
    }
    matrix
}
