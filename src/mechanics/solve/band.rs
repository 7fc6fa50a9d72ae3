//! Cholesky of many bodies of one topology side by side, down to the ring.
//!
//! The unknowns are eliminated row by row of the ring mesh, from the far boundary to the ring and within each row
//! towards the load line, in tiles of 4 x 4 within a variable band. The last diagonal block of the factor is then the
//! factor of the stiffness condensed to the ring, K_ring = L L^T, so that the response to loads on the ring needs no
//! other column: f^T K_ring^-1 g = (L^-1 f)^T (L^-1 g). Its rows next to the load line are the very last, so a load
//! there costs only the square of the rows it touches.
//!
//! Written over `Real`: with `Lanes` each tile holds `LANES` bodies; with `f64` it is checked against faer.

use std::ops::Range;

use crate::mechanics::element::MAX_NODES;
use crate::mechanics::element::stiffness::ElementStiffness;
use crate::mechanics::mesh::{RingTopology, SUPPORTED};
use crate::mechanics::real::Real;

/// Unknowns along a tile's edge.
pub const TILE: usize = 4;

/// A 4 x 4 tile, column-major: of one body a column is a register.
pub type Tile<T> = [[T; TILE]; TILE];

/// The order of elimination, the band and where each element's entries go; shared by bodies of one topology.
pub struct BandStructure {
    /// First tile column of each tile row, and the tile row's offset into the tiles.
    rows: Vec<(usize, usize)>,
    pub tile_count: usize,
    /// Position of each unknown in the order of elimination.
    pub positions: Vec<u32>,
    /// Position of the ring's first unknown, a multiple of `TILE`.
    pub ring_start: usize,
    /// Positions in all, padded to whole tiles.
    pub size: usize,
    /// Positions that stand for no unknown; their diagonal is 1.
    padding: Vec<usize>,
    /// For each element, `scatter_starts[element]..` of (row and column in the element, tile, row and column in it).
    scatter: Vec<Scatter>,
    scatter_starts: Vec<usize>,
}

#[derive(Clone, Copy)]
struct Scatter {
    from: (u8, u8),
    /// Row and column in the tile.
    to: (u8, u8),
    tile: u32,
}

impl BandStructure {
    pub fn new(topology: &RingTopology) -> BandStructure {
        // Nodes by row from the far boundary, then towards the load line.
        let mut nodes: Vec<usize> = (0..topology.node_count).collect();
        nodes.sort_by_key(|&node| {
            let (row, column) = topology.grid[node];
            (std::cmp::Reverse(row), std::cmp::Reverse(column))
        });
        let mut positions = vec![SUPPORTED; topology.unknown_count];
        let mut padding = Vec::new();
        let mut ring_start = 0;
        let mut next = 0;
        let mut in_ring = false;
        for node in nodes {
            if topology.grid[node].0 == 0 && !in_ring {
                in_ring = true;
                while next % TILE != 0 {
                    padding.push(next);
                    next += 1;
                }
                ring_start = next;
            }
            for unknown in &topology.unknowns[2 * node..2 * node + 2] {
                if *unknown != SUPPORTED {
                    positions[*unknown as usize] = next as u32;
                    next += 1;
                }
            }
        }
        while next % TILE != 0 {
            padding.push(next);
            next += 1;
        }
        let mut structure = BandStructure {
            rows: Vec::new(),
            tile_count: 0,
            positions,
            ring_start,
            size: next,
            padding,
            scatter: Vec::new(),
            scatter_starts: vec![0],
        };
        structure.set_band(topology);
        structure.set_scatter(topology);
        structure
    }

    /// The first tile column of each tile row.
    pub fn first_columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.iter().map(|(first, _)| *first)
    }

    /// Positions that stand for no unknown; their diagonal is 1.
    pub fn padding(&self) -> &[usize] {
        &self.padding
    }

    /// What it takes, but for what is small beside it.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.scatter[..]) + size_of_val(&self.positions[..]) + size_of_val(&self.rows[..])
    }

    /// Positions of an element's dofs, `SUPPORTED` where they are; of no more dofs than there are.
    fn element_positions(&self, topology: &RingTopology, element: usize) -> [u32; 2 * MAX_NODES] {
        let count = topology.element.node_count();
        let nodes = &topology.connectivity[element * count..(element + 1) * count];
        let mut positions = [SUPPORTED; 2 * MAX_NODES];
        for (own, node) in positions.as_chunks_mut::<2>().0.iter_mut().zip(nodes) {
            for axis in 0..2 {
                let unknown = topology.unknowns[2 * *node as usize + axis];
                if unknown != SUPPORTED {
                    own[axis] = self.positions[unknown as usize];
                }
            }
        }
        positions
    }

    fn set_band(&mut self, topology: &RingTopology) {
        let mut first: Vec<usize> = (0..self.size / TILE).collect();
        for element in 0..topology.element_count() {
            let positions = self.element_positions(topology, element);
            let free = || positions.iter().filter(|position| **position != SUPPORTED);
            let Some(least) = free().min() else { continue };
            for position in free() {
                let row = *position as usize / TILE;
                first[row] = first[row].min(*least as usize / TILE);
            }
        }
        // The ring's block is dense.
        for (row, first) in first.iter_mut().enumerate().skip(self.ring_start / TILE) {
            *first = (*first).min(self.ring_start / TILE).min(row);
        }
        for (row, &first) in first.iter().enumerate() {
            self.rows.push((first, self.tile_count));
            self.tile_count += row - first + 1;
        }
    }

    fn set_scatter(&mut self, topology: &RingTopology) {
        let dofs = 2 * topology.element.node_count();
        self.scatter.reserve_exact(topology.element_count() * dofs * (dofs + 1) / 2);
        for element in 0..topology.element_count() {
            let positions = self.element_positions(topology, element);
            for (i, a) in positions.iter().enumerate().filter(|(_, a)| **a != SUPPORTED) {
                for (j, b) in positions.iter().enumerate().skip(i).filter(|(_, b)| **b != SUPPORTED) {
                    let (row, column) = (*a.max(b) as usize, *a.min(b) as usize);
                    self.scatter.push(Scatter {
                        from: (i as u8, j as u8),
                        to: ((row % TILE) as u8, (column % TILE) as u8),
                        tile: self.tile(row / TILE, column / TILE) as u32,
                    });
                }
            }
            self.scatter_starts.push(self.scatter.len());
        }
    }

    /// The number of a tile within the band, row after row.
    #[inline(always)]
    pub fn tile(&self, row: usize, column: usize) -> usize {
        let (first, offset) = self.rows[row];
        offset + column - first
    }

    /// Tiles of a stiffness without elements: zero but for the padding's diagonal.
    #[inline(always)]
    pub fn empty<T: Real>(&self) -> Vec<Tile<T>> {
        // One by one: a tile that is there to be copied takes longer.
        let mut tiles = Vec::with_capacity(self.tile_count);
        for _ in 0..self.tile_count {
            tiles.push([[T::zero(); TILE]; TILE]);
        }
        for &position in &self.padding {
            let at = position % TILE;
            tiles[self.tile(position / TILE, position / TILE)][at][at] = T::from_f64(1.0);
        }
        tiles
    }

    /// Adds one element's stiffness.
    #[inline(always)]
    pub fn add<T: Real>(&self, tiles: &mut [Tile<T>], element: usize, stiffness: &ElementStiffness<T>) {
        for entry in &self.scatter[self.scatter_starts[element]..self.scatter_starts[element + 1]] {
            let value = stiffness.values[entry.from.0 as usize % (2 * MAX_NODES)]
                [entry.from.1 as usize % (2 * MAX_NODES)];
            let (row, column) = (entry.to.0 as usize % TILE, entry.to.1 as usize % TILE);
            tiles[entry.tile as usize][column][row] += value;
        }
    }

    /// K = L L^T in place, tile row by tile row: each tile less the products of its row and its column, then divided
    /// by the column's diagonal tile. In place of the diagonal is its inverse. A lane that is not positive definite ends in NaN.
    /// `ABREAST` columns of a tile are summed at a time, in `ROWS` tile rows: the same bits whatever they are.
    #[inline(always)]
    pub fn factorise<T: Real, const ABREAST: usize, const ROWS: usize>(&self, tiles: &mut [Tile<T>]) {
        self.eliminate::<T, ABREAST, ROWS, false>(tiles);
    }

    /// The same; tells the greatest of what a pivot's diagonal was over what was left of it: so many times more than the stiffness
    /// itself its condensation feels rounding. NaN where the stiffness is not positive definite.
    #[inline(always)]
    pub fn factorise_with_loss<T: Real, const ABREAST: usize, const ROWS: usize>(
        &self,
        tiles: &mut [Tile<T>],
    ) -> T {
        self.eliminate::<T, ABREAST, ROWS, true>(tiles)
    }

    #[inline(always)]
    fn eliminate<T: Real, const ABREAST: usize, const ROWS: usize, const TELLS: bool>(
        &self,
        tiles: &mut [Tile<T>],
    ) -> T {
        let mut minus_loss = T::from_f64(-1.0);
        for begin in (0..self.rows.len()).step_by(ROWS) {
            let rows = begin..(begin + ROWS).min(self.rows.len());
            // Columns that a row has alone, those of all, and those between the rows.
            let mut of_all = begin..begin;
            if ROWS > 1 && rows.len() == ROWS {
                let first = self.rows[rows.clone()].iter().map(|(first, _)| *first).max();
                of_all.start = first.unwrap_or(begin).min(begin);
            }
            for row in rows.clone() {
                self.eliminate_columns::<T, ABREAST, 1>(tiles, row, self.rows[row].0..of_all.start);
            }
            self.eliminate_columns::<T, ABREAST, ROWS>(tiles, begin, of_all);
            for row in rows {
                let (first, offset) = self.rows[row];
                self.eliminate_columns::<T, ABREAST, 1>(tiles, row, begin.max(first)..row);
                let (left, right) = tiles[offset..].split_at_mut(row - first);
                let tile = &mut right[0];
                let mut before = [T::zero(); TILE];
                for place in 0..TILE {
                    before[place] = tile[place][place];
                }
                subtract_products::<T, ABREAST>(tile, left, left);
                factorise_tile(tile);
                if TELLS {
                    for place in 0..TILE {
                        let inverse = tile[place][place];
                        minus_loss = minus_loss.least(-(before[place] * inverse * inverse));
                    }
                }
            }
        }
        -minus_loss
    }

    /// Some columns of `ROWS` tile rows, each of which has them all, beside the diagonal; those before them are done.
    #[inline(always)]
    fn eliminate_columns<T: Real, const ABREAST: usize, const ROWS: usize>(
        &self,
        tiles: &mut [Tile<T>],
        row: usize,
        columns: Range<usize>,
    ) {
        if columns.is_empty() {
            return;
        }
        let rows = &self.rows[row..row + ROWS];
        let begin = rows[0].1;
        let (done, current) = tiles.split_at_mut(begin);
        for column in columns {
            let (column_first, offset) = self.rows[column];
            let of_column = &done[offset..][..column - column_first + 1];
            let mut places = [0; ROWS];
            let mut common = column_first;
            for (place, (first, offset)) in places.iter_mut().zip(rows) {
                *place = offset - begin + column - first;
                common = common.max(*first);
            }
            // What a row has alone, then what all have.
            if ROWS > 1 {
                for (place, (first, _)) in places.iter().zip(rows) {
                    let start = column_first.max(*first);
                    let (left, right) = current.split_at_mut(*place);
                    let alone = &left[place + start - column..place + common - column];
                    subtract_products::<T, ABREAST>(&mut right[0], alone, &of_column[start - column_first..]);
                }
            }
            let (of_common, diagonal) = of_column[common - column_first..].split_at(column - common);
            subtract_products_of_rows::<T, ABREAST, ROWS>(current, places, of_common);
            for place in places {
                divide_by_lower_transposed(&mut current[place], &diagonal[0]);
            }
        }
    }

    /// L^-1 of the ring's block applied to `columns` right-hand sides, in place, from tile row `start` (counted from
    /// the ring's first) on; rows before it are taken as zero. `values` is `[ring row][column]`, from that row on.
    /// `ABREAST` columns, of which there is a multiple, are summed at a time.
    #[inline(always)]
    pub fn substitute_ring<T: Real, const COLUMNS: usize, const ABREAST: usize>(
        &self,
        tiles: &[Tile<T>],
        start: usize,
        values: &mut [[[T; COLUMNS]; TILE]],
    ) {
        const { assert!(COLUMNS.is_multiple_of(ABREAST)) };
        let ring = self.ring_start / TILE + start;
        for row in 0..values.len() {
            let (done, current) = values.split_at_mut(row);
            let current = &mut current[0];
            let row_tiles = &tiles[self.tile(ring + row, ring)..];
            for i in 0..TILE {
                let blocks = current[i].as_chunks_mut::<ABREAST>().0.iter_mut();
                for (block, first) in blocks.zip((0..).step_by(ABREAST)) {
                    let mut sums = *block;
                    for (tile, known) in row_tiles.iter().zip(done.iter()) {
                        for k in 0..TILE {
                            for c in 0..ABREAST {
                                sums[c] = sums[c].minus_product(tile[k][i], known[k][first + c]);
                            }
                        }
                    }
                    *block = sums;
                }
            }
            let diagonal = &row_tiles[row];
            for i in 0..TILE {
                for c in 0..COLUMNS {
                    let mut value = current[i][c];
                    for k in 0..i {
                        value = value.minus_product(diagonal[k][i], current[k][c]);
                    }
                    current[i][c] = value * diagonal[i][i];
                }
            }
        }
    }

    /// Floating-point operations of `factorise` a body, a fused multiply-add counted as two.
    pub fn factorise_operations(&self) -> u64 {
        let of_row = |(row, &(first, _)): (usize, &(usize, usize))| -> u64 {
            let products = (first..row).map(|column| column - first.max(self.rows[column].0) + 1);
            let divisions = (row - first) as u64 * DIVISION_OPERATIONS;
            products.sum::<usize>() as u64 * PRODUCT_OPERATIONS + divisions + FACTOR_OPERATIONS
        };
        self.rows.iter().enumerate().map(of_row).sum()
    }

    /// Floating-point operations of `substitute_ring` a body, with `rows` tile rows of `columns` right-hand sides.
    pub fn substitute_operations(&self, rows: usize, columns: usize) -> u64 {
        let (rows, columns) = (rows as u64, columns as u64);
        let tile = 2 * (TILE * TILE) as u64 * columns;
        let diagonal = (TILE * TILE) as u64 * columns;
        rows * (rows - 1) / 2 * tile + rows * diagonal
    }
}

// Operations of one tile in the functions below.
pub const PRODUCT_OPERATIONS: u64 = 2 * (TILE * TILE * TILE) as u64;
const DIVISION_OPERATIONS: u64 = (TILE * TILE * TILE) as u64;
const FACTOR_OPERATIONS: u64 = (TILE * (2 * TILE * TILE + 3 * TILE + 7)) as u64 / 6;

/// tile -= sum of a b^T.
#[inline(always)]
fn subtract_products<T: Real, const ABREAST: usize>(tile: &mut Tile<T>, row: &[Tile<T>], column: &[Tile<T>]) {
    for (of_columns, first) in tile.as_chunks_mut::<ABREAST>().0.iter_mut().zip((0..).step_by(ABREAST)) {
        let mut sums = *of_columns;
        for (a, b) in row.iter().zip(column) {
            for k in 0..TILE {
                for j in 0..ABREAST {
                    sums[j] = T::four_minus_products(sums[j], a[k], b[k][first + j]);
                }
            }
        }
        *of_columns = sums;
    }
}

/// The same of the tiles in some places, each with the tiles before it in its row, and with the same column.
#[inline(always)]
fn subtract_products_of_rows<T: Real, const ABREAST: usize, const ROWS: usize>(
    tiles: &mut [Tile<T>],
    places: [usize; ROWS],
    column: &[Tile<T>],
) {
    for first in (0..TILE).step_by(ABREAST) {
        let mut sums = [[[T::zero(); TILE]; ABREAST]; ROWS];
        let mut rows = [column; ROWS];
        for (at, place) in places.into_iter().enumerate() {
            sums[at].copy_from_slice(&tiles[place][first..first + ABREAST]);
            rows[at] = &tiles[place - column.len()..place];
        }
        for (place, b) in column.iter().enumerate() {
            for k in 0..TILE {
                for j in 0..ABREAST {
                    for at in 0..ROWS {
                        sums[at][j] =
                            T::four_minus_products(sums[at][j], rows[at][place][k], b[k][first + j]);
                    }
                }
            }
        }
        for (place, sums) in places.into_iter().zip(sums) {
            tiles[place][first..first + ABREAST].copy_from_slice(&sums);
        }
    }
}

/// tile := tile L^-T for a lower triangular L with the inverses of its diagonal.
#[inline(always)]
fn divide_by_lower_transposed<T: Real>(tile: &mut Tile<T>, lower: &Tile<T>) {
    for j in 0..TILE {
        let (done, current) = tile.split_at_mut(j);
        let column = &mut current[0];
        for (known, lower) in done.iter().zip(lower) {
            *column = T::four_minus_products(*column, *known, lower[j]);
        }
        for value in column {
            *value = *value * lower[j][j];
        }
    }
}

/// tile := its lower Cholesky factor, with the inverses of the diagonal.
#[inline(always)]
fn factorise_tile<T: Real>(tile: &mut Tile<T>) {
    for j in 0..TILE {
        let mut diagonal = tile[j][j];
        for k in 0..j {
            diagonal = diagonal.minus_product(tile[k][j], tile[k][j]);
        }
        let inverse = T::from_f64(1.0) / diagonal.sqrt();
        tile[j][j] = inverse;
        for i in j + 1..TILE {
            let mut value = tile[j][i];
            for k in 0..j {
                value = value.minus_product(tile[k][i], tile[k][j]);
            }
            tile[j][i] = value * inverse;
        }
    }
}
