//! What the kernels have to do: operations and bytes, counted from sizes and iterations before or after any device is
//! touched. What they are held against is measured in `roofline`.
//!
//! Operations are additions, multiplications, divisions and square roots of the algorithm; a multiply-add is two. Free
//! are comparisons, changes of sign, addresses, rounding to another precision, and what a device does beyond: systems
//! that have stopped, padding, sums over the invocations.
//!
//! Bytes are the compulsory traffic of a dispatch: each number that it reads or writes moves once, as with caches
//! without end, and what bodies share moves once for all of them.

use crate::engine::backend::gpu::batch::COLUMNS_ABREAST;
use crate::engine::backend::gpu::front::WORKS_HEADER;
use crate::engine::backend::gpu::kernels::Precision;
use crate::engine::backend::gpu::layout::MeshLayout;
use crate::engine::backend::gpu::system_layout::{SLICE, SystemState};
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::contact::reduced::{FUNCTIONS, OF_LOAD};

/// Bytes that do not leave the device's chip, read and written: what binds the kernels that solve. As for `Work`, each number once that the
/// algorithm asks for, whatever the invocations take at a time; sums over invocations are free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inner {
    /// Between workgroups and the cache of all of them.
    pub cached: u64,
    /// Within workgroups' own memories; `None` where that is not counted.
    pub workgroup: Option<u64>,
}

/// The most bytes that an instruction of one invocation loads or stores.
const ACCESS: u64 = 16;

impl Inner {
    /// The fewest instructions, of all invocations together, for this and for operations: each is half of a multiply-add, and
    /// each access a whole one. What else a compiler makes, for places and loops, comes on top.
    pub fn fewest_instructions(&self, operations: u64) -> u64 {
        operations.div_ceil(2) + (self.cached + self.workgroup.unwrap_or(0)).div_ceil(ACCESS)
    }
}

/// Operations and bytes of one dispatch, or of several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    pub operations: u64,
    pub bytes: u64,
}

/// The sizes of one topology that its kernels' work follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    pub unknowns: u64,
    /// Nonzeros of the stiffness, and its places on the device, zeros of short rows included.
    pub matrix_values: u64,
    pub places: u64,
    pub ring_columns: u64,
    pub elements: u64,
    /// Pairs of nodes that have values, and of nodes of one element that these are summed from.
    pub pairs: u64,
    pub sources: u64,
    /// Of the grid of half elements: points along the ring, and layers of elements.
    pub grid_columns: u64,
    pub layers: u64,
    /// Straight sides of the far boundary; where there are any, lines half-way between others are bowed.
    pub sides: u64,
    /// Numbers that make a body.
    pub body_numbers: u64,
}

/// The sizes of joints that are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointSizes {
    pub terms: u64,
    pub nodes: u64,
    /// Of both bodies, without those that add too little to be added.
    pub rows: u64,
    pub loads: u64,
    /// Bytes up and down.
    pub bytes: u64,
}

/// Steps of a search that has come to its end, at least.
const LEAST_STEPS: u64 = 2;

impl JointSizes {
    /// From their numbers to what is found of so many; what they have in common is left out.
    pub fn work(&self, items: u64) -> Work {
        let JointSizes { terms, nodes, rows, loads, bytes } = *self;
        let (entries, functions, of_load) =
            (packed_count(terms as usize) as u64, FUNCTIONS as u64, OF_LOAD as u64);
        let equations = terms - 1;
        let of_node = 2 * rows * entries
            // The factor, three right sides there and back, what they come to, the share of the pin, and the least pressure.
            + equations.pow(3) / 3
            + 6 * equations.pow(2)
            + 2 * functions * equations
            + 4 * entries
            + 2 * terms * 4 * terms;
        let of_loads = loads * 3 * nodes * (LEAST_STEPS * of_load + functions - of_load);
        // Sums and differences of opposite nodes, then products with half of the polynomials each.
        let of_transform = functions * nodes + functions * nodes * nodes;
        let operations = nodes * of_node + of_transform + of_loads;
        Work { operations: items * operations, bytes: items * bytes }
    }

    /// Rows of both bodies, which all joints share.
    pub fn inner(&self, items: u64) -> Inner {
        let row = packed_count(self.terms as usize) as u64 * self.nodes;
        Inner { cached: items * self.rows * row * Precision::F32.wide_bytes(), workgroup: None }
    }
}

/// What `eliminate` moves of one body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrontMoves {
    /// Tiles that enter the front, tiles of panels, and tiles that products are taken from.
    pub entered: u64,
    pub panels: u64,
    pub products: u64,
    pub is_on_chip: bool,
}

impl FrontMoves {
    /// Tiles of 4 x 4 numbers: a panel's is made of its own and the pivot's; a product takes two of the panel.
    pub fn inner(&self, bodies: u64, precision: Precision) -> Inner {
        let tile = 16 * precision.wide_bytes();
        let of_front = bodies * tile * (self.entered + 2 * self.panels + 2 * self.products);
        let of_panel = bodies * tile * (self.panels + 2 * self.products);
        match self.is_on_chip {
            true => Inner { cached: 0, workgroup: Some(of_front + of_panel) },
            false => Inner { cached: of_front, workgroup: Some(of_panel) },
        }
    }
}

const POINTS: u64 = 4;
const NODES: u64 = 8;

/// `exp_minus_one` of an argument that need not be halved, and the elementary functions that rest on it.
const EXPONENTIAL: u64 = 40;
const LOGARITHM: u64 = EXPONENTIAL + 12;
const TANGENT: u64 = 108;

/// Steps of the search of a line's growth where layers grow by one to two, about; each adds up the layers, and so does what
/// follows the search.
const SEARCH_STEPS: u64 = 7;

impl Sizes {
    pub fn of(layout: &MeshLayout) -> Sizes {
        let (systems, parameters) = (&layout.systems, &layout.parameters);
        Sizes {
            unknowns: systems.unknown_count() as u64,
            matrix_values: systems.columns.len() as u64,
            places: systems.sliced.columns.len() as u64,
            ring_columns: systems.ring_count() as u64,
            elements: u64::from(parameters.element_count),
            pairs: layout.gather.pair_count() as u64,
            sources: layout.gather.sources.len() as u64,
            grid_columns: u64::from(parameters.column_count),
            layers: u64::from(parameters.row_count / 2),
            sides: u64::from(parameters.side_count),
            body_numbers: layout.body_number_count() as u64,
        }
    }

    fn blocks(&self) -> u64 {
        self.ring_columns.div_ceil(COLUMNS_ABREAST)
    }

    fn systems(&self) -> u64 {
        self.blocks() * COLUMNS_ABREAST
    }

    fn grid(&self) -> u64 {
        (2 * self.layers + 1) * self.grid_columns
    }

    /// Starts of slices, columns and places of diagonals.
    fn pattern_bytes(&self) -> u64 {
        4 * (self.unknowns.div_ceil(SLICE as u64) + 1 + self.places + self.unknowns)
    }

    /// Three norms and a state of each system.
    fn system_bytes(&self, precision: Precision) -> u64 {
        self.systems() * (3 * precision.wide_bytes() + size_of::<SystemState>() as u64)
    }

    /// `assemble`: of each line its span, growth and layers, of each point of an element the gradients, of each source four sums
    /// over the points, of each pair four values.
    pub fn assemble(&self, bodies: u64, precision: Precision) -> Work {
        let wide = precision.wide_bytes();
        // Thickness and its sum, twice; the step's share of the far boundary; the reach of two grid points.
        let layer = 6 + (14 + EXPONENTIAL) + 10;
        // The shares that two lines are drawn to, angle, length along the side, depth, the span's two parts, and how far
        // aside it ends; or the ring's point, scaled.
        let span = if self.sides > 0 { 22 + 6 + (TANGENT + 2) + (LOGARITHM + 5) + 17 + 5 } else { 2 };
        // How far a layer keeps to the radius, and its place; between the lines of corner nodes its bow.
        let (mid_sides, corners) = (self.grid_columns / 2, self.grid_columns.div_ceil(2));
        let courses = if self.sides > 0 { self.layers * (16 * corners + 18 * mid_sides) } else { 0 };
        let growth = (SEARCH_STEPS + 1) * (7 * self.layers + 1) + 15 * SEARCH_STEPS;
        let line = span + growth + (7 + EXPONENTIAL) + self.layers * layer;
        let bows =
            if self.sides > 0 { mid_sides * ((2 * self.layers + 1) * 8 + 2 * self.layers * 9) } else { 0 };
        // Of two points: where the eight nodes are, by 16 steps along the ring and 16 away from it; of each the derivatives, |J|, what they
        // are scaled by, and the gradients.
        let point = NODES * 8 + 3 + 2 + 4 + NODES * 6;
        let half = NODES * 2 + 32 + 2 * point;
        let operations = self.grid_columns * line
            + courses
            + bows
            + POINTS / 2 * self.elements * half
            + self.sources * 4 * (2 * POINTS)
            + self.pairs * 4 * 3;
        let shared_numbers = 2 * (2 + 4 * self.grid_columns + POINTS * NODES + 2 * self.sides) * wide
            + 4 * (NODES * self.elements + self.pairs + 1 + self.sources + 4 * self.pairs);
        let geometry = 4 * self.grid() + 2 * POINTS * NODES * self.elements;
        let own = (self.body_numbers + geometry + self.places) * wide
            + self.systems() * size_of::<SystemState>() as u64;
        Work { operations: bodies * operations, bytes: shared_numbers + bodies * own }
    }

    /// The gradients of half elements as they are stored; of each source those of two nodes; of each pair where its sources begin and end,
    /// four places, and the values that have one.
    pub fn assemble_inner(&self, bodies: u64, precision: Precision) -> Inner {
        let node = 2 * POINTS * precision.wide_bytes();
        let cached = NODES * self.elements * node
            + self.sources * (4 + 2 * node)
            + self.pairs * 4 * (2 + 4)
            + self.places * precision.wide_bytes();
        Inner { cached: bodies * cached, workgroup: None }
    }

    /// `narrow`: no operations.
    pub fn narrow(&self, bodies: u64, precision: Precision) -> Work {
        let each = precision.wide_bytes() + precision.real_bytes();
        Work { operations: 0, bytes: bodies * self.places * each }
    }

    /// The steps of `pcg` that took systems from nothing to `states`, `[body][system]`, in dispatches of `step_count`.
    /// In each dispatch the matrix of a body that still steps is read, and p, r and d of its blocks go both ways.
    pub fn iterate(&self, states: &[SystemState], step_count: u32, precision: Precision) -> Work {
        let steps: u64 = states.iter().map(|state| u64::from(state.iterations)).sum();
        let mut bytes = 0;
        let real = precision.real_bytes();
        for body in states.chunks_exact(self.systems() as usize) {
            let blocks = body.chunks_exact(COLUMNS_ABREAST as usize);
            let dispatches = blocks.map(|block| {
                let longest = block.iter().map(|state| state.iterations).max().unwrap_or(0);
                u64::from(longest.div_ceil(step_count))
            });
            let (mut all, mut most) = (0, 0);
            for dispatches in dispatches {
                all += dispatches;
                most = most.max(dispatches);
            }
            bytes += most * self.places * real;
            bytes += all * 2 * 3 * COLUMNS_ABREAST * self.unknowns * real;
            bytes += all * 2 * self.system_bytes(precision) / self.blocks();
        }
        let longest = states.iter().map(|state| state.iterations).max().unwrap_or(0);
        bytes += u64::from(longest.div_ceil(step_count)) * self.pattern_bytes();
        Work { operations: steps * (2 * self.matrix_values + 12 * self.unknowns), bytes }
    }

    /// The same steps on the chip, of a kernel that keeps `vectors` of p, q, r and d, in this order, in the workgroup's own memory. A step of
    /// a block reads the matrix with its pattern, and gathers p by its columns.
    pub fn iterate_inner(&self, states: &[SystemState], vectors: u64, precision: Precision) -> Inner {
        let blocks = states.chunks_exact(COLUMNS_ABREAST as usize);
        let steps: u64 = blocks
            .map(|block| block.iter().map(|state| u64::from(state.iterations)).max().unwrap_or(0))
            .sum();
        let (real, rows) = (precision.real_bytes(), self.unknowns);
        let matrix = self.places * (real + 4) + rows * 2 * (4 + real) + rows.div_ceil(SLICE as u64) * 4;
        let of_vectors = [self.places + 4 * rows, 2 * rows, 3 * rows, 2 * rows];
        let (on_chip, in_storage) = of_vectors.split_at(vectors.min(4) as usize);
        let bytes = |of_vectors: &[u64]| of_vectors.iter().sum::<u64>() * COLUMNS_ABREAST * real;
        Inner { cached: steps * (matrix + bytes(in_storage)), workgroup: Some(steps * bytes(on_chip)) }
    }

    /// `refine` where another round follows: the step, the residual and its norm, and the round's begin.
    pub fn refine(&self, bodies: u64, precision: Precision) -> Work {
        let (real, wide) = (precision.real_bytes(), precision.wide_bytes());
        let system = 2 * self.matrix_values + (2 + 3 + 4) * self.unknowns;
        // d is read; p, r and d are written; x goes both ways, and the residual is written.
        let vectors = self.systems() * self.unknowns * (4 * real + 3 * wide);
        let own = self.places * wide + vectors + 2 * self.system_bytes(precision);
        Work { operations: bodies * self.ring_columns * system, bytes: self.pattern_bytes() + bodies * own }
    }

    /// `condense`: of each entry of C two products over the unknowns, and the mean.
    pub fn condense(&self, bodies: u64, precision: Precision) -> Work {
        let wide = precision.wide_bytes();
        let entry = 4 * self.unknowns + 2;
        let own = self.systems() * (2 * self.unknowns + self.ring_columns) * wide;
        Work { operations: bodies * self.ring_columns * self.ring_columns * entry, bytes: bodies * own }
    }

    /// `works`, of so many modes and ways to push: C F, then the symmetric part of P^T C F in its entries.
    pub fn works(&self, [modes, pushes]: [u64; 2], bodies: u64, precision: Precision) -> Work {
        let wide = precision.wide_bytes();
        let entries = packed_count(modes as usize) as u64;
        let of_push =
            2 * self.ring_columns * self.ring_columns * modes + (4 * self.ring_columns + 1) * entries;
        let operations = pushes * of_push;
        let own = (self.ring_columns * self.systems() + WORKS_HEADER as u64 + pushes * entries) * wide
            + self.system_bytes(precision);
        let shared = pushes * self.systems() * modes * wide;
        Work { operations: bodies * operations, bytes: shared + bodies * own }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One block of four systems, of which three are of the ring.
    const SIZES: Sizes = Sizes {
        unknowns: 5,
        matrix_values: 13,
        places: 64,
        ring_columns: 3,
        elements: 1,
        pairs: 16,
        sources: 20,
        grid_columns: 3,
        layers: 1,
        sides: 0,
        body_numbers: 2,
    };

    fn states(iterations: &[u32]) -> Vec<SystemState> {
        iterations.iter().map(|&iterations| SystemState { outcome: 1, iterations }).collect()
    }

    #[test]
    fn steps_are_counted_by_system_and_their_traffic_by_dispatch() {
        // A step: 2 x 13 operations of the product, 12 x 5 of the vectors. Two bodies: 7 + 12 + 3 + 0 and 4 + 4 + 4 + 0.
        let work = SIZES.iterate(&states(&[7, 12, 3, 0, 4, 4, 4, 0]), 10, Precision::F32);
        assert_eq!(work.operations, 34 * (26 + 60));
        // Two dispatches of the first body and one of the second: 64 places, p, r and d of four systems in and out, three
        // norms and a state of 8 bytes in and out; and twice the pattern of 2 + 64 + 5 numbers.
        let block = 4 * 64 + 2 * 3 * 4 * 5 * 4 + 2 * 4 * (3 * 4 + 8);
        assert_eq!(work.bytes, 3 * block + 2 * 4 * (2 + 64 + 5));
        // In mixed precision norms alone are wide.
        let mixed = SIZES.iterate(&states(&[7, 12, 3, 0]), 10, Precision::Mixed);
        assert_eq!(mixed.bytes, 2 * (block + 2 * 4 * 3 * 4 + 4 * (2 + 64 + 5)));
    }

    #[test]
    fn what_stays_on_the_chip_is_counted_by_hand() {
        // Tiles of 64 bytes: 3 + 2 x 2 + 2 x 3 of the front and 2 + 2 x 3 of the panels, of two bodies.
        let moves = FrontMoves { entered: 3, panels: 2, products: 3, is_on_chip: true };
        assert_eq!(moves.inner(2, Precision::F32), Inner { cached: 0, workgroup: Some(2 * 64 * (13 + 8)) });
        let in_storage = FrontMoves { is_on_chip: false, ..moves }.inner(2, Precision::F32);
        assert_eq!(in_storage, Inner { cached: 2 * 64 * 13, workgroup: Some(2 * 64 * 8) });
        // Blocks of 12 and 4 steps. A step reads 64 places and their columns, twice five diagonals and their places, and the start of a
        // slice; it gathers 64 times from p and touches it four times a row, q twice, r three times, d twice, each for four systems.
        let matrix = 64 * 8 + 2 * 5 * 8 + 4;
        let of_vectors = [(64 + 20) * 16, 10 * 16, 15 * 16, 10 * 16];
        for vectors in 0..=4 {
            let (own, others) = of_vectors.split_at(vectors);
            let [own, others] = [own, others].map(|of_vectors| of_vectors.iter().sum::<u64>());
            let found =
                SIZES.iterate_inner(&states(&[7, 12, 3, 0, 4, 4, 4, 0]), vectors as u64, Precision::F32);
            assert_eq!(
                found,
                Inner { cached: 16 * (matrix + others), workgroup: Some(16 * own) },
                "{vectors}"
            );
        }
        // Three rows of six entries at four nodes, of seven joints.
        let joints = JointSizes { terms: 3, nodes: 4, rows: 3, loads: 10, bytes: 0 };
        let of_joints = Inner { cached: 7 * 3 * 6 * 4 * 4, workgroup: None };
        assert_eq!(joints.inner(7), of_joints);
        assert_eq!(of_joints.fewest_instructions(9), 5 + 7 * 3 * 6);
        assert_eq!(Inner { cached: 0, workgroup: Some(17) }.fewest_instructions(0), 2);
    }

    #[test]
    fn a_body_that_took_no_step_has_no_work() {
        assert_eq!(SIZES.iterate(&states(&[0; 4]), 10, Precision::F64), Work::default());
    }

    #[test]
    fn the_other_stages_of_a_body_are_counted_by_hand() {
        let of = |work: Work| (work.operations, work.bytes);
        // 64 places, from 8 bytes to 4.
        assert_eq!(of(SIZES.narrow(2, Precision::Mixed)), (0, 2 * 64 * 12));
        // x += s d; b - K x; r (r/k); then r/s, r/k and r z: 2 + 26/5 + 3 + 4 a row, three systems.
        // The pattern; 64 places; d in, p, r and d out; x in and out, b - K x out; norms and states both ways.
        let refined = (3 * (26 + 9 * 5), 4 * 71 + 64 * 8 + 4 * 5 * (4 * 8 + 3 * 8) + 2 * 4 * (3 * 8 + 8));
        assert_eq!(of(SIZES.refine(1, Precision::F64)), refined);
        // Nine entries of two products of length 5, a sum and a half; x and residuals in, three rows of four out.
        assert_eq!(of(SIZES.condense(1, Precision::F32)), (9 * 22, 4 * (2 * 5 + 3) * 4));
        // Two modes, three entries: C F 2 x 9 x 2, P^T C F twice 2 x 3 x 3, and half of each. Three rows of four, norms and states
        // in; a header of two and the entries out; the loads of four rows, once for both bodies.
        let works = (2 * (36 + 36 + 3), 4 * 2 * 4 + 2 * ((3 * 4 + 2 + 3) * 4 + 4 * (3 * 4 + 8)));
        assert_eq!(of(SIZES.works([2, 1], 2, Precision::F32)), works);
        let wide = (4 * (36 + 36 + 3), 2 * 4 * 2 * 8 + 2 * ((3 * 4 + 2 + 6) * 8 + 4 * (3 * 8 + 8)));
        assert_eq!(of(SIZES.works([2, 2], 2, Precision::Mixed)), wide);
    }

    #[test]
    fn the_assembly_of_one_element_is_counted_by_hand() {
        // Three lines of one layer each: 8 sums of it with their powers and 7 steps for its growth, radii of the boundary and
        // the layer, the span. Two halves of one element, 20 sources, four sums over four points each, and four values of 16 pairs.
        let operations =
            3 * (8 * (7 + 1) + 7 * 15 + 47 + 70 + 2) + 2 * (48 + 2 * (64 + 9 + 48)) + 20 * 32 + 16 * 12;
        // Twice 2 + 12 + 32 shared numbers; grid, starts, sources and places; fours of nine grid points and of 16 half nodes, 64 places,
        // 2 numbers.
        let bytes = 2 * 46 * 8 + 4 * (8 + 17 + 20 + 64) + (4 * (9 + 16) + 64 + 2) * 8 + 4 * 8;
        assert_eq!(SIZES.assemble(1, Precision::F64), Work { operations, bytes });
        // Eight nodes of eight numbers; 20 sources of two of them; 16 pairs of six words; 64 values. Of two bodies.
        let cached = 2 * (8 * 32 + 20 * (4 + 2 * 32) + 16 * 24 + 64 * 4);
        assert_eq!(SIZES.assemble_inner(2, Precision::F32), Inner { cached, workgroup: None });
        // Twice two numbers of each side, and six numbers more of the body; of one mid-side line three points. A line's
        // shares 2 x 11 and angle 6; length along the side; |far|^2 - 1; cosine and sine 3 + 3, the two parts 4 + 1, and 6
        // to add them; how far aside 3 + 2. Of two lines a point that keeps to its radius, of one its bow, and its steps.
        let block = Sizes { sides: 3, body_numbers: 8, ..SIZES }.assemble(1, Precision::F64);
        let span = 22 + 6 + 110 + 57 + 17 + 5;
        assert_eq!(block.operations - operations, 3 * (span - 2) + 2 * 16 + 18 + 3 * 8 + 2 * 9);
        assert_eq!(block.bytes - bytes, (2 * 6 + 6) * 8);
    }
}
