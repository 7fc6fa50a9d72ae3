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
    /// `ABREAST` columns of a tile are summed at a time, in `ROWS` tile rows (1 or 2): the same bits whatever they are.
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
        const { assert!(ROWS == 1 || ROWS == 2) };
        let mut minus_loss = T::from_f64(-1.0);
        for rows in (0..self.rows.len()).step_by(ROWS) {
            // Columns of this row alone, of the next one alone, then those of both.
            let mut of_both = rows..rows;
            if ROWS == 2 && rows + 1 < self.rows.len() {
                let firsts = [self.rows[rows].0, self.rows[rows + 1].0];
                of_both.start = firsts[0].max(firsts[1]).min(rows);
                self.eliminate_columns::<T, ABREAST>(tiles, rows + 1, firsts[1]..of_both.start);
            }
            self.eliminate_columns::<T, ABREAST>(tiles, rows, self.rows[rows].0..of_both.start);
            self.eliminate_columns_of_two::<T, ABREAST>(tiles, rows, of_both);
            for row in rows..(rows + ROWS).min(self.rows.len()) {
                if row > rows {
                    self.eliminate_columns::<T, ABREAST>(tiles, row, rows.max(self.rows[row].0)..row);
                }
                let (first, offset) = self.rows[row];
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

    /// Some columns of a tile row, beside the diagonal; those before them are done.
    #[inline(always)]
    fn eliminate_columns<T: Real, const ABREAST: usize>(
        &self,
        tiles: &mut [Tile<T>],
        row: usize,
        columns: Range<usize>,
    ) {
        let (first, offset) = self.rows[row];
        let (done, current) = tiles.split_at_mut(offset);
        for column in columns {
            let (column_first, column_offset) = self.rows[column];
            let start = first.max(column_first);
            let (left, right) = current.split_at_mut(column - first);
            let row_tiles = &left[start - first..];
            let column_tiles = &done[column_offset + start - column_first..][..row_tiles.len()];
            let tile = &mut right[0];
            subtract_products::<T, ABREAST>(tile, row_tiles, column_tiles);
            divide_by_lower_transposed(tile, &done[column_offset + column - column_first]);
        }
    }

    /// The same of a tile row and the next one.
    #[inline(always)]
    fn eliminate_columns_of_two<T: Real, const ABREAST: usize>(
        &self,
        tiles: &mut [Tile<T>],
        row: usize,
        columns: Range<usize>,
    ) {
        if columns.is_empty() {
            return;
        }
        let [(first, offset), (next_first, next_offset)] = [self.rows[row], self.rows[row + 1]];
        let (done, current) = tiles.split_at_mut(offset);
        let (current, next) = current.split_at_mut(next_offset - offset);
        for column in columns {
            let (column_first, column_offset) = self.rows[column];
            let of_column = &done[column_offset..][..column - column_first + 1];
            let (left, right) = current.split_at_mut(column - first);
            let (next_left, next_right) = next.split_at_mut(column - next_first);
            let (tile, next_tile) = (&mut right[0], &mut next_right[0]);
            // What either has alone, then what both have.
            let [start, next_start] = [first, next_first].map(|first| first.max(column_first));
            let common = start.max(next_start);
            subtract_products::<T, ABREAST>(
                tile,
                &left[start - first..common - first],
                &of_column[start - column_first..],
            );
            subtract_products::<T, ABREAST>(
                next_tile,
                &next_left[next_start - next_first..common - next_first],
                &of_column[next_start - column_first..],
            );
            subtract_products_of_two::<T, ABREAST>(
                [tile, next_tile],
                [&left[common - first..], &next_left[common - next_first..]],
                &of_column[common - column_first..],
            );
            let diagonal = &of_column[column - column_first];
            divide_by_lower_transposed(tile, diagonal);
            divide_by_lower_transposed(next_tile, diagonal);
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
                    for i in 0..TILE {
                        sums[j][i] = sums[j][i].minus_product(a[k][i], b[k][first + j]);
                    }
                }
            }
        }
        *of_columns = sums;
    }
}

/// The same of two tiles with the same column.
#[inline(always)]
fn subtract_products_of_two<T: Real, const ABREAST: usize>(
    [one, other]: [&mut Tile<T>; 2],
    [one_row, other_row]: [&[Tile<T>]; 2],
    column: &[Tile<T>],
) {
    for first in (0..TILE).step_by(ABREAST) {
        let [mut one_sums, mut other_sums] = [[[T::zero(); TILE]; ABREAST]; 2];
        one_sums.copy_from_slice(&one[first..first + ABREAST]);
        other_sums.copy_from_slice(&other[first..first + ABREAST]);
        for ((one, other), b) in one_row.iter().zip(other_row).zip(column) {
            for k in 0..TILE {
                for j in 0..ABREAST {
                    for i in 0..TILE {
                        one_sums[j][i] = one_sums[j][i].minus_product(one[k][i], b[k][first + j]);
                    }
                    for i in 0..TILE {
                        other_sums[j][i] = other_sums[j][i].minus_product(other[k][i], b[k][first + j]);
                    }
                }
            }
        }
        one[first..first + ABREAST].copy_from_slice(&one_sums);
        other[first..first + ABREAST].copy_from_slice(&other_sums);
    }
}

/// tile := tile L^-T for a lower triangular L with the inverses of its diagonal.
#[inline(always)]
fn divide_by_lower_transposed<T: Real>(tile: &mut Tile<T>, lower: &Tile<T>) {
    for j in 0..TILE {
        let (done, current) = tile.split_at_mut(j);
        let column = &mut current[0];
        for (known, lower) in done.iter().zip(lower) {
            for i in 0..TILE {
                column[i] = column[i].minus_product(known[i], lower[j]);
            }
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
