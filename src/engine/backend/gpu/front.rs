//! How `eliminate` takes the bodies of a topology: the order of the unknowns, the band, where each value of the matrix goes, the loads
//! of the ring's modes as a border, and how many rows of tiles are in the front at a time. Pure arithmetic.

use bytemuck::{Pod, Zeroable};

use super::batch::MOST_TRIPS;
use super::gather::{Gather, NodePairs};
use super::layout::{AssembleParameters, MeshLayout, starts};
use crate::engine::backend::adapter::DeviceLimits;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::ring_modes::{Push, RingModes};
use crate::mechanics::mesh::{Grading, RingTopology};
use crate::mechanics::solve::band::{BandStructure, TILE};

/// Numbers of a body before its works: whether it is sound, and its worst true residual or the greatest loss of a pivot.
pub const WORKS_HEADER: usize = 2;

/// A work in f32 is off by no more than so many roundings, times the greatest loss of a pivot, times the greatest work: seen of the blocks in
/// `tests/gpu_parity/elimination.rs`, 42 on software, more on an H100, whose roots and quotients are not rounded to the last bit.
pub const AMPLIFIED: f64 = 60.0;

/// A body whose works may be off by more, relative to the greatest of them, is left to the processor. Forces feel less than a tenth of it.
pub const ROUGHEST: f64 = 1e-3;

/// What a device hands over of a body.
pub struct WorksOfBody<'a> {
    /// As the device says, and by its works: a kernel's compiler may take it that no number is NaN.
    pub is_sound: bool,
    /// The worst true residual of its systems, or the greatest loss of a pivot.
    pub spoilt: f64,
    /// Packed, one way to push after the other.
    pub works: &'a [f64],
}

impl WorksOfBody<'_> {
    /// From its numbers in `works`.
    pub fn of(numbers: &[f64]) -> WorksOfBody<'_> {
        let Some(([is_sound, spoilt], works)) = numbers.split_first_chunk::<WORKS_HEADER>() else {
            unreachable!("every body has a header")
        };
        let is_sound = *is_sound == 1.0 && works.iter().all(|work| work.is_finite());
        WorksOfBody { is_sound, spoilt: *spoilt, works }
    }
}

/// What a workgroup of `eliminate` works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Front {
    /// Rows of tiles that it has room for.
    pub rows: u32,
    /// In the workgroup's own memory, else in storage.
    pub is_on_chip: bool,
}

impl Front {
    pub const SMALLEST: Front = Front { rows: 4, is_on_chip: true };

    /// Of a workgroup on a GPU: what is right for small fronts leaves large ones waiting (measured on an H100). No more than any device has.
    pub fn invocations(self) -> u32 {
        if self.rows < 28 { 128 } else { 256 }
    }

    /// Memory of a workgroup, bytes.
    pub fn workgroup_bytes(self, wide: u64) -> u64 {
        let rows = u64::from(self.rows);
        let kept = if self.is_on_chip { self.size() } else { 1 };
        (kept + 4 * rows + rows) * 4 * wide
    }

    /// Bytes of a body in storage.
    pub fn storage_bytes(self, wide: u64) -> u64 {
        if self.is_on_chip { 0 } else { self.size() * 4 * wide }
    }

    /// Fours: the rows of the tiles of all pairs of rows.
    fn size(self) -> u64 {
        2 * u64::from(self.rows) * u64::from(self.rows + 1)
    }
}

/// What `eliminate` is told of the bodies of a topology. `_at`: the elements before those of the topology in a buffer that others share.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct EliminateParameters {
    /// In a dispatch.
    pub first_body: u32,
    pub row_count: u32,
    pub ring_row: u32,
    pub border_count: u32,
    pub mode_count: u32,
    pub four_count: u32,
    pub body_size: u32,
    pub rows_at: u32,
    pub places_at: u32,
    pub loads_at: u32,
    pub values_at: u32,
    pub states_at: u32,
    pub works_at: u32,
}

/// What bodies of one topology share, as `assemble` and `eliminate` take it.
#[derive(Clone, Debug)]
pub struct FrontLayout {
    /// Of `assemble`: the values are those of the lower triangle, tile by tile, with the zeros of each row of a tile that has a value, and
    /// a body has one state.
    pub assembly: AssembleParameters,
    pub gather: Gather,
    pub parameters: EliminateParameters,
    /// `[row of tiles]`: the last row it reaches as a pivot, and the end of the fours of the rows up to that one.
    pub rows: Vec<[u32; 2]>,
    /// `[four]`, a row of a tile: where it belongs.
    pub places: Vec<u32>,
    /// `[border row][ring unknown in the order of elimination]`
    pub loads: Vec<f64>,
    /// In the front at most.
    pub front_rows: u32,
}

impl FrontLayout {
    /// For bodies like `body`, divided by `grading`, whose mesh is `mesh`.
    pub fn new(body: &Body, grading: &Grading, modes: &RingModes, mesh: &MeshLayout) -> FrontLayout {
        let topology = RingTopology::new(body, grading);
        let structure = BandStructure::new(&topology);
        let pushes = Push::of(body.shape.side);
        let PlacedValues { ends, places, gather } = placed_values(&topology, &structure);
        let loads = border(&topology, &structure, modes, pushes);
        let border_count = (pushes.len() * modes.count).div_ceil(TILE);
        let end = |last: u32| ends[(last as usize).min(ends.len() - 1)];
        let rows: Vec<[u32; 2]> =
            last_rows(&structure, border_count).into_iter().map(|last| [last, end(last)]).collect();
        // A pivot, and the rows below it that it reaches.
        let front_rows = rows.iter().zip(0..).map(|(row, pivot)| row[0] + 1 - pivot).max().unwrap_or(0);
        let parameters = EliminateParameters {
            row_count: rows.len() as u32,
            ring_row: (structure.ring_start / TILE) as u32,
            border_count: border_count as u32,
            mode_count: modes.count as u32,
            four_count: places.len() as u32,
            body_size: (WORKS_HEADER + pushes.len() * packed_count(modes.count)) as u32,
            ..EliminateParameters::zeroed()
        };
        let value_count = (TILE * places.len()) as u32;
        let pair_count = gather.pair_count() as u32;
        let assembly = AssembleParameters { value_count, pair_count, system_count: 1, ..mesh.parameters };
        FrontLayout { assembly, gather, parameters, rows, places, loads, front_rows }
    }

    /// The lists of `assemble` and `eliminate` on bodies of this mesh, and where they begin.
    pub fn lists(&self, mesh: &MeshLayout) -> (Vec<u32>, AssembleParameters, EliminateParameters) {
        let rows = self.rows.as_flattened();
        let Gather { starts: pair_starts, sources, places: value_places } = &self.gather;
        let lists = [&mesh.element_grid, pair_starts, sources, value_places, rows, &self.places];
        let [element_grid_at, pair_starts_at, sources_at, value_places_at, rows_at, places_at] =
            starts(lists);
        let assembly = AssembleParameters {
            element_grid_at,
            pair_starts_at,
            sources_at,
            value_places_at,
            ..self.assembly
        };
        let elimination = EliminateParameters { rows_at, places_at, ..self.parameters };
        (lists.concat(), assembly, elimination)
    }

    /// What a kernel must have room for: in the workgroup's own memory if that is large enough. `None` where an invocation would make too
    /// many loop trips, or places do not have the bits for so many rows. There are kernels for whole multiples of the smallest front.
    pub fn front(&self, wide: u64, invocations: u64, limits: &DeviceLimits) -> Option<Front> {
        let rows = self.front_rows.next_multiple_of(Front::SMALLEST.rows);
        let fits = |front: &Front| {
            front.workgroup_bytes(wide) <= u64::from(limits.workgroup_bytes)
                && self.trips(invocations) <= MOST_TRIPS
                && self.rows.len() <= MOST_ROWS
                && self.front_rows <= MOST_FRONT_ROWS
        };
        [true, false].map(|is_on_chip| Front { rows, is_on_chip }).into_iter().find(fits)
    }

    /// The pairs of rows of tiles below each pivot, summed over the pivots: the tiles from which products are taken.
    pub fn tile_products(&self) -> u64 {
        let below = |(row, pivot): (&[u32; 2], u32)| u64::from(row[0] - pivot);
        self.rows.iter().zip(0..).map(below).map(|below| below * (below + 1) / 2).sum()
    }

    /// Tiles of the panels below the pivots.
    pub fn panel_tiles(&self) -> u64 {
        self.rows.iter().zip(0..).map(|(row, pivot)| u64::from(row[0] - pivot)).sum()
    }

    /// Tiles that enter the front.
    pub fn entered_tiles(&self) -> u64 {
        entered_tiles(self.rows.iter().map(|row| row[0].into()))
    }

    /// The most loop trips of one invocation, in `assemble` or `eliminate`.
    pub fn trips(&self, invocations: u64) -> u64 {
        let assemble = self.assembly.counts().trips(invocations);
        // Loops look once more than they go round.
        let trips = |count: u64| 1 + count.div_ceil(invocations);
        let first = self.rows.first().copied().unwrap_or_default().map(u64::from);
        // What is there before the first pivot; the four rows of its panel are one trip, and so are those of a product.
        let mut eliminate = (first[0] + 1) * (1 + trips(first[0] + 1)) + 1 + trips(first[1]);
        let [mut last, mut end] = first;
        let following = self.rows.iter().skip(1).chain(self.rows.last());
        for ((row, next), pivot) in self.rows.iter().zip(following).zip(0..) {
            let below = u64::from(row[0] - pivot);
            // The pivots of one invocation's panel are looked at.
            eliminate += 1 + trips(below) + 5 + trips(below * (below + 1) / 2);
            let next = next.map(u64::from);
            eliminate +=
                1 + (next[0] - last) * (1 + trips(next[0] - u64::from(pivot))) + trips(next[1] - end);
            [last, end] = next;
        }
        let entries = u64::from(self.parameters.body_size).div_ceil(invocations);
        assemble.max(eliminate + entries + 2)
    }
}

/// Of each row of tiles the last one that it reaches as a pivot.
fn last_rows(structure: &BandStructure, border_count: usize) -> Vec<u32> {
    let first: Vec<usize> = structure.first_columns().collect();
    // The last row whose band has begun by this column.
    let mut last = vec![0; first.len()];
    first.iter().enumerate().for_each(|(row, first)| last[*first] = row.max(last[*first]));
    let mut reached = 0;
    let reached = |(row, last): (usize, usize)| {
        reached = reached.max(last);
        if row == structure.ring_start / TILE {
            reached += border_count;
        }
        reached as u32
    };
    last.into_iter().enumerate().map(reached).collect()
}

/// The rows of the tiles that have a value of the matrix or stand for no unknown, four values each.
struct PlacedValues {
    /// `[row of tiles]`: the end of its fours.
    ends: Vec<u32>,
    /// `places` of `eliminate.wgsl`.
    places: Vec<u32>,
    gather: Gather,
}

/// That `places` have the bits for.
const MOST_ROWS: usize = 1 << 16;
const MOST_FRONT_ROWS: u32 = 1 << 12;

/// In `places`: a row of a tile that stands for no unknown.
const PADDING: usize = 4;

/// The values of the matrix, tile by tile.
fn placed_values(topology: &RingTopology, structure: &BandStructure) -> PlacedValues {
    let pairs = NodePairs::new(topology);
    // Row and column of tiles, and the row of the tile; and the column in it.
    let four_of = |[row, column]: [usize; 2]| {
        let [i, j] = [row, column].map(|unknown| structure.positions[unknown] as usize);
        // Tiles on the diagonal are whole.
        (i / TILE >= j / TILE).then_some(([i / TILE, j / TILE, i % TILE], j % TILE))
    };
    let mut fours: Vec<[usize; 3]> = pairs.values().filter_map(four_of).map(|(four, _)| four).collect();
    let padding = |position: usize| [position / TILE, position / TILE, PADDING | (position % TILE)];
    fours.extend(structure.padding().iter().map(|position| padding(*position)));
    fours.sort_unstable();
    fours.dedup();
    let mut ends = vec![0; structure.size / TILE];
    fours.iter().zip(1..).for_each(|(four, end)| ends[four[0]] = end);
    let place = |value: [usize; 2]| {
        let (four, j) = four_of(value)?;
        Some(TILE * fours.binary_search(&four).ok()? + j)
    };
    let gather = pairs.gather(place, TILE * fours.len());
    let places = fours.iter().map(|[row, column, i]| (row << 16 | (row - column) << 4 | i) as u32).collect();
    PlacedValues { ends, places, gather }
}

/// The loads of the modes on the ring's unknowns, one way to push after the other.
fn border(
    topology: &RingTopology,
    structure: &BandStructure,
    modes: &RingModes,
    pushes: &[Push],
) -> Vec<f64> {
    let ring = structure.size - structure.ring_start;
    let mut loads = vec![0.0; pushes.len() * modes.count * ring];
    let of_pushes = modes.unknown_loads(pushes, topology);
    for (of_push, loads) in of_pushes.into_iter().zip(loads.chunks_exact_mut(modes.count * ring)) {
        for (unknown, of_modes) in of_push {
            let position = structure.positions[topology.ring_start + unknown] as usize - structure.ring_start;
            of_modes.iter().enumerate().for_each(|(mode, load)| loads[mode * ring + position] = *load);
        }
    }
    loads
}

/// By the last row that each pivot reaches: of each row the tiles from the first pivot on that reaches it.
fn entered_tiles(last_rows: impl Iterator<Item = u64>) -> u64 {
    let (mut tiles, mut entered) = (0, 0);
    for (first, last) in (0..).zip(last_rows) {
        tiles += (entered..=last).map(|row| row - first + 1).sum::<u64>();
        entered = last + 1;
    }
    tiles
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the device says of it.
    #[test]
    fn a_body_with_a_work_that_is_no_number_is_not_sound() {
        let is_sound = |numbers: &[f64]| WorksOfBody::of(numbers).is_sound;
        assert!(is_sound(&[1.0, 2.0, 0.5, 0.1]) && !is_sound(&[0.0, 2.0, 0.5, 0.1]));
        assert!(!is_sound(&[1.0, 2.0, f64::NAN, 0.1]) && !is_sound(&[1.0, 2.0, 0.5, f64::INFINITY]));
    }

    /// A full matrix of four rows of tiles; and a band of six that reaches two rows on: six tiles at first, then three a row.
    #[test]
    fn each_tile_of_the_profile_enters_once() {
        assert_eq!(entered_tiles([3; 4].into_iter()), 4 * 5 / 2);
        assert_eq!(entered_tiles([2, 3, 4, 5, 5, 5].into_iter()), 6 + 3 * 3);
    }
}
