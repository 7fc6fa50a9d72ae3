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
use crate::mechanics::lines::coordinates_abreast;
use crate::mechanics::mesh::{Grading, RingTopology};
use crate::mechanics::real::{Alone, Bodies, LANES, Lanes, Real};
use crate::mechanics::registers::{AVX2, AVX512};
use crate::mechanics::singles::{SINGLES, Single, Singles};
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

/// So many bodies at most take no longer one after the other than in lanes, where the tiles of all lanes stay near the processor and where
/// they do not (`cargo bench --bench condense`).
const FEW: [usize; 2] = [2, 4];

/// Bytes that stay near it.
const NEAR: usize = 1 << 20;

/// From so many bytes on lanes wait for them, and any number of bodies is few, in registers of a width.
const fn far(width: usize) -> usize {
    match width {
        AVX2 => 8 << 20,
        AVX512 => 24 << 20,
        // Not measured.
        _ => usize::MAX,
    }
}

/// So many bodies of a mesh are few whose tiles take so many bytes in all lanes.
pub fn few(bytes: usize) -> usize {
    FEW[usize::from(bytes > NEAR)]
}

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
        bodies.chunks(LANES).flat_map(|bodies| in_lanes(Condense { plan: self, bodies })).collect()
    }

    /// The same in single precision, but for bodies that lose too many digits so. What a body comes to does not hang on the others.
    pub fn condense_in_singles(&self, bodies: &[Body]) -> Vec<Vec<f64>> {
        let condense = |bodies| in_lanes(InSingles(Condense { plan: self, bodies }));
        let mut works: Vec<Vec<f64>> = bodies.chunks(SINGLES).flat_map(condense).collect();
        let is_lost = |works: &Vec<f64>| works[0].is_nan();
        let lost: Vec<usize> = (0..works.len()).filter(|place| is_lost(&works[*place])).collect();
        if !lost.is_empty() {
            let bodies: Vec<Body> = lost.iter().map(|place| bodies[*place].clone()).collect();
            for (place, found) in lost.into_iter().zip(self.condense(&bodies)) {
                works[place] = found;
            }
        }
        works
    }

    /// How many bodies are few, in registers of a `WIDTH`.
    fn few<const WIDTH: usize>(&self) -> usize {
        let bytes = self.structure.tile_count * size_of::<Tile<Lanes<WIDTH>>>();
        if bytes >= far(WIDTH) { LANES } else { few(bytes) }
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
        // where it takes two and there are 16. Of a body alone a register holds several sums: all 16 take two to eight,
        // so few that each waits for the one before, unless two rows of tiles are summed at a time.
        if self.bodies.len() <= self.plan.few::<WIDTH>() {
            self.one_by_one::<Alone<WIDTH>>()
        } else if WIDTH >= LANES {
            self.works::<Lanes<WIDTH>, 4, 1>()
        } else {
            self.works::<Lanes<WIDTH>, 1, 1>()
        }
    }
}

/// In single precision: NaN for a body that loses too many digits.
struct InSingles<'a>(Condense<'a>);

/// The most that a pivot may lose of its diagonal in single precision (`BandStructure::factorise_with_loss`). What bodies that lose no more
/// are off by is held by `tests/mechanics/condensation.rs`.
const MOST_LOSS: f64 = 100.0;

impl LaneWork for InSingles<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<Vec<f64>> {
        if self.0.bodies.len() <= self.0.plan.few::<WIDTH>().min(FEW[1]) {
            self.0.one_by_one::<Single<WIDTH>>()
        } else if WIDTH >= LANES {
            self.0.works::<Singles<WIDTH>, 4, 1>()
        } else {
            self.0.works::<Singles<WIDTH>, 1, 1>()
        }
    }
}

/// Numbers that bodies are condensed in. Where nodes are is told in double precision, so that small elements keep their shape.
trait Working: Bodies {
    /// A coordinate of a node of each body.
    type Place: Copy;
    /// Whether digits may be lost.
    const MAY_LOSE: bool;

    fn nodes(bodies: &[Body], grading: &Grading, topology: &RingTopology) -> Vec<[Self::Place; 2]>;

    /// A coordinate within an element, which may begin at one of its nodes.
    fn within(place: Self::Place, origin: Self::Place) -> Self;
}

macro_rules! in_double {
    ($numbers:ident) => {
        impl<const WIDTH: usize> Working for $numbers<WIDTH> {
            type Place = Self;
            const MAY_LOSE: bool = false;

            #[inline(always)]
            fn nodes(bodies: &[Body], grading: &Grading, topology: &RingTopology) -> Vec<[Self; 2]> {
                coordinates_abreast(bodies, grading, topology)
            }
            #[inline(always)]
            fn within(place: Self, _: Self) -> Self {
                place
            }
        }
    };
}
in_double!(Lanes);
in_double!(Alone);

impl<const WIDTH: usize> Working for Single<WIDTH> {
    type Place = Alone<WIDTH>;
    const MAY_LOSE: bool = true;

    #[inline(always)]
    fn nodes(bodies: &[Body], grading: &Grading, topology: &RingTopology) -> Vec<[Alone<WIDTH>; 2]> {
        coordinates_abreast(bodies, grading, topology)
    }
    #[inline(always)]
    fn within(place: Alone<WIDTH>, origin: Alone<WIDTH>) -> Self {
        Alone((place.0 - origin.0) as f32)
    }
}

impl<const WIDTH: usize> Working for Singles<WIDTH> {
    type Place = [Lanes<WIDTH>; 2];
    const MAY_LOSE: bool = true;

    #[inline(always)]
    fn nodes(bodies: &[Body], grading: &Grading, topology: &RingTopology) -> Vec<[Self::Place; 2]> {
        let (first, others) = bodies.split_at(bodies.len().min(LANES));
        // Of lanes without a body nobody asks.
        let others = if others.is_empty() { &first[first.len() - 1..] } else { others };
        let first: Vec<[Lanes<WIDTH>; 2]> = coordinates_abreast(first, grading, topology);
        let others: Vec<[Lanes<WIDTH>; 2]> = coordinates_abreast(others, grading, topology);
        let mut nodes = Vec::with_capacity(first.len());
        for (one, other) in first.iter().zip(&others) {
            nodes.push([[one[0], other[0]], [one[1], other[1]]]);
        }
        nodes
    }
    #[inline(always)]
    fn within(place: Self::Place, origin: Self::Place) -> Self {
        Singles::rounded(place[0] - origin[0], place[1] - origin[1])
    }
}

impl Condense<'_> {
    /// Each body alone, two rows of tiles at a time.
    #[inline(always)]
    fn one_by_one<T: Working>(&self) -> Vec<Vec<f64>> {
        let mut works = Vec::with_capacity(self.bodies.len());
        for bodies in self.bodies.chunks(1) {
            works.append(&mut Condense { bodies, ..*self }.works::<T, 4, 2>());
        }
        works
    }

    #[inline(always)]
    fn works<T: Working, const ABREAST: usize, const ROWS: usize>(&self) -> Vec<Vec<f64>> {
        let mut tiles = self.plan.structure.empty::<T>();
        let smallest_jacobian = self.assemble(&mut tiles);
        let loss = if T::MAY_LOSE {
            self.plan.structure.factorise_with_loss::<T, ABREAST, ROWS>(&mut tiles)
        } else {
            self.plan.structure.factorise::<T, ABREAST, ROWS>(&mut tiles);
            T::zero()
        };
        let CondensationPlan { modes: RingModes { count, .. }, loads, .. } = self.plan;
        let mut works = vec![vec![0.0; loads.len() * packed_count(*count)]; self.bodies.len()];
        if count.is_multiple_of(BLOCKS[0]) {
            self.gram::<T, { BLOCKS[0] }, ABREAST>(&tiles, &mut works);
        } else {
            self.gram::<T, { BLOCKS[1] }, ABREAST>(&tiles, &mut works);
        }
        for (lane, works) in works.iter_mut().enumerate() {
            let smallest = smallest_jacobian.lane(lane);
            let loss = loss.lane(lane);
            if smallest.is_nan() || smallest <= 0.0 || loss.is_nan() || loss > MOST_LOSS {
                works.fill(f64::NAN);
            }
        }
        works
    }

    /// The stiffness of every body in its lane, and its least Jacobian; lanes without a body repeat the one before.
    #[inline(always)]
    fn assemble<T: Working>(&self, tiles: &mut [Tile<T>]) -> T {
        let CondensationPlan { grading, topology, structure, rule, .. } = self.plan;
        let zero = T::zero();
        let nodes = T::nodes(self.bodies, grading, topology);
        let mut materials: Vec<Elasticity<T>> = Vec::new();
        for material in 0..=self.bodies[0].lining.list().len() {
            materials.push(self.elasticity(material));
        }
        let count = topology.element.node_count();
        let mut smallest_jacobian = T::from_f64(f64::INFINITY);
        let mut stiffness = ElementStiffness::room();
        for (element, connectivity) in topology.connectivity.chunks_exact(count).enumerate() {
            let mut corners = [[zero; 2]; MAX_NODES];
            let origin = nodes[connectivity[0] as usize];
            for (corner, node) in corners.iter_mut().zip(connectivity) {
                for axis in 0..2 {
                    corner[axis] = T::within(nodes[*node as usize][axis], origin[axis]);
                }
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
        let mut all = Elasticity { direct: T::zero(), cross: T::zero(), shear: T::zero() };
        for lane in 0..T::COUNT {
            let body = &self.bodies[lane.min(self.bodies.len() - 1)];
            let [modulus, poissons_ratio] = body.material(material);
            let own = Elasticity::new(body.idealization, poissons_ratio);
            let Elasticity { direct, cross, shear } = if material > 0 { own.times(modulus) } else { own };
            all.direct.set_lane(lane, direct);
            all.cross.set_lane(lane, cross);
            all.shear.set_lane(lane, shear);
        }
        all
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
