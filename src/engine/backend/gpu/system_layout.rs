//! Systems of equations as the kernels take them: sizes, sparsity in slices, and how each one ended. Shared structs hold only `f32` and `u32`, as in `layout`.

use bytemuck::{Pod, Zeroable};

use super::batch::COLUMNS_ABREAST;
use crate::mechanics::solve::refine::RefineSettings;

/// What `pcg`, `refine` and `condense` are told.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SystemParameters {
    pub unknown_count: u32,
    pub value_count: u32,
    pub block_count: u32,
    pub ring_start: u32,
    pub ring_count: u32,
    pub step_count: u32,
    pub iteration_limit: u32,
    pub tolerance: f32,
    pub goal: f32,
}

/// How one system stands; `outcome` is a `SystemOutcome`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct SystemState {
    pub outcome: u32,
    pub iterations: u32,
}

/// How a system ended.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SystemOutcome {
    Running = 0,
    Converged = 1,
    IterationLimit = 2,
    Indefinite = 3,
    NotFinite = 4,
    /// An element is turned inside out, or a coordinate is not finite.
    Inverted = 5,
    /// Rounding, or the limit on rounds, keeps the true residual above the goal.
    Stagnated = 6,
}

impl SystemOutcome {
    /// All of them, with their names in kernels.
    pub const ALL: [(&'static str, SystemOutcome); 7] = [
        ("RUNNING", SystemOutcome::Running),
        ("CONVERGED", SystemOutcome::Converged),
        ("ITERATION_LIMIT", SystemOutcome::IterationLimit),
        ("INDEFINITE", SystemOutcome::Indefinite),
        ("NOT_FINITE", SystemOutcome::NotFinite),
        ("INVERTED", SystemOutcome::Inverted),
        ("STAGNATED", SystemOutcome::Stagnated),
    ];
}

impl SystemState {
    /// `None` for a number that stands for nothing.
    pub fn outcome(&self) -> Option<SystemOutcome> {
        SystemOutcome::ALL
            .map(|(_, outcome)| outcome)
            .into_iter()
            .find(|outcome| *outcome as u32 == self.outcome)
    }
}

/// Sizes and sparsity that the systems of a batch share: all that solving and condensing know.
#[derive(Clone, Debug)]
pub struct SystemLayout {
    pub row_starts: Vec<u32>,
    pub columns: Vec<u32>,
    /// The value on the diagonal of each row.
    pub diagonal_places: Vec<u32>,
    pub sliced: Sliced,
    pub ring_start: u32,
}

/// The sparsity as the device has it: slices of `SLICE` rows, the first values of all rows of a slice, then the second
/// ones and so on, so that neighbouring invocations read neighbouring numbers (sliced ELLPACK; Monakov, Lokhmotov &
/// Avetisyan, HiPEAC 2010). Rows shorter than the longest of their slice end with zeros.
#[derive(Clone, Debug)]
pub struct Sliced {
    /// First place of each slice, and the end of the last.
    pub starts: Vec<u32>,
    /// The column of each place; the row itself where there is a zero.
    pub columns: Vec<u32>,
    /// The place of the value on the diagonal of each row.
    pub diagonal_places: Vec<u32>,
    /// The place of each value of the rows one after the other.
    pub places: Vec<u32>,
}

/// Rows of a slice, the common size of a subgroup.
pub const SLICE: usize = 32;

impl Sliced {
    fn new(row_starts: &[u32], columns: &[u32], diagonal_places: &[u32]) -> Sliced {
        let rows: Vec<std::ops::Range<usize>> =
            row_starts.windows(2).map(|ends| ends[0] as usize..ends[1] as usize).collect();
        let mut sliced = Sliced {
            starts: vec![0],
            columns: vec![],
            diagonal_places: vec![],
            places: vec![0; columns.len()],
        };
        for (slice, rows) in rows.chunks(SLICE).enumerate() {
            let longest = rows.iter().map(|row| row.len()).max().unwrap_or(0);
            for entry in 0..longest {
                for lane in 0..SLICE {
                    let value = rows.get(lane).and_then(|row| row.clone().nth(entry));
                    if let Some(value) = value {
                        sliced.places[value] = sliced.columns.len() as u32;
                    }
                    // Beyond the last row, some column that there is.
                    let own = (slice * SLICE + lane.min(rows.len() - 1)) as u32;
                    sliced.columns.push(value.map_or(own, |value| columns[value]));
                }
            }
            sliced.starts.push(sliced.columns.len() as u32);
        }
        sliced.diagonal_places = diagonal_places.iter().map(|value| sliced.places[*value as usize]).collect();
        sliced
    }

    /// Values of matrices, row after row, at their places.
    pub fn place(&self, values: &[f64]) -> Vec<f64> {
        let mut placed = Vec::with_capacity(values.len() / self.places.len() * self.columns.len());
        for values in values.chunks_exact(self.places.len()) {
            let first = placed.len();
            placed.resize(first + self.columns.len(), 0.0);
            self.places
                .iter()
                .zip(values)
                .for_each(|(place, value)| placed[first + *place as usize] = *value);
        }
        placed
    }

    /// The reverse of `place`.
    pub fn collect(&self, placed: &[f64]) -> Vec<f64> {
        let matrices = placed.chunks_exact(self.columns.len());
        matrices.flat_map(|matrix| self.places.iter().map(|place| matrix[*place as usize])).collect()
    }
}

/// The sparsity has a row without a diagonal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("row {row} has no value on its diagonal")]
pub struct NoDiagonal {
    pub row: usize,
}

impl SystemLayout {
    pub fn new(row_starts: &[u32], columns: &[u32], ring_start: usize) -> Result<SystemLayout, NoDiagonal> {
        let place = |row: usize| {
            let start = row_starts[row] as usize;
            let own = &columns[start..row_starts[row + 1] as usize];
            own.iter().position(|&column| column as usize == row).map(|place| (start + place) as u32)
        };
        let places = (0..row_starts.len() - 1).map(|row| place(row).ok_or(NoDiagonal { row }));
        let diagonal_places = places.collect::<Result<Vec<u32>, _>>()?;
        Ok(SystemLayout {
            sliced: Sliced::new(row_starts, columns, &diagonal_places),
            diagonal_places,
            row_starts: row_starts.to_vec(),
            columns: columns.to_vec(),
            ring_start: ring_start as u32,
        })
    }

    pub fn unknown_count(&self) -> usize {
        self.row_starts.len() - 1
    }

    pub fn ring_count(&self) -> usize {
        self.unknown_count() - self.ring_start as usize
    }

    pub fn block_count(&self) -> usize {
        self.ring_count().div_ceil(COLUMNS_ABREAST as usize)
    }

    pub fn system_count(&self) -> usize {
        self.block_count() * COLUMNS_ABREAST as usize
    }

    pub fn parameters(&self, settings: &RefineSettings, step_count: u32) -> SystemParameters {
        SystemParameters {
            unknown_count: self.unknown_count() as u32,
            value_count: self.sliced.columns.len() as u32,
            block_count: self.block_count() as u32,
            ring_start: self.ring_start,
            ring_count: self.ring_count() as u32,
            step_count,
            iteration_limit: settings.iteration_limit as u32,
            tolerance: settings.tolerance as f32,
            goal: settings.goal as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of one to five values, more than two slices of them: multiplied by way of the slices as row by row, and back.
    #[test]
    fn slices_hold_every_row() {
        let size = 2 * SLICE + 7;
        let mut row_starts = vec![0];
        let mut columns = Vec::new();
        for row in 0..size {
            columns.extend((0..1 + row % 5).map(|entry| ((row + 3 * entry) % size) as u32));
            row_starts.push(columns.len() as u32);
        }
        let layout = SystemLayout::new(&row_starts, &columns, size - 4).unwrap();
        let sliced = &layout.sliced;
        assert_eq!(sliced.columns.len(), sliced.starts[3] as usize);
        assert_eq!(sliced.starts, [0, 5, 10, 15].map(|entries| entries * SLICE as u32));
        // Two matrices, without a zero.
        let values: Vec<f64> = (0..2 * columns.len()).map(|value| 1.0 + value as f64).collect();
        let placed = sliced.place(&values);
        assert_eq!(placed.len(), 2 * sliced.columns.len());
        assert_eq!(sliced.collect(&placed), values);
        let vector = |column: u32| f64::from(column * column % 11);
        for (values, placed) in
            values.chunks_exact(columns.len()).zip(placed.chunks_exact(sliced.columns.len()))
        {
            for row in 0..size {
                let own = row_starts[row] as usize..row_starts[row + 1] as usize;
                let expected: f64 = own.map(|value| values[value] * vector(columns[value])).sum();
                let (start, end) =
                    (sliced.starts[row / SLICE] as usize, sliced.starts[row / SLICE + 1] as usize);
                let places = (start + row % SLICE..end).step_by(SLICE);
                let found: f64 = places.map(|place| placed[place] * vector(sliced.columns[place])).sum();
                assert_eq!(found, expected, "{row}");
                let diagonal = sliced.diagonal_places[row] as usize;
                assert_eq!(
                    (placed[diagonal], sliced.columns[diagonal]),
                    (values[row_starts[row] as usize], row as u32)
                );
            }
        }
    }
}
