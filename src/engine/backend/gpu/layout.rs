//! What travels between host and device: the structs that both sides share, and the numbers of topologies and bodies.
//!
//! Shared structs hold only `f32` and `u32`, so that no padding can differ; `tests/engine/shaders.rs` compares their offsets.
//! Numbers in the precision of the kernels travel as plain arrays.

use bytemuck::{Pod, Zeroable};

use super::batch::{BodyCounts, COLUMNS_ABREAST};
use crate::mechanics::assembly::Assembly;
use crate::mechanics::body::Body;
use crate::mechanics::element::ElementKind;
use crate::mechanics::element::stiffness::ElementRule;
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::{
    Grading, RingTopology, centre_pull, corner_columns, holding_changes, polar, ring_points,
};
use crate::mechanics::solve::refine::RefineSettings;

/// What `assemble` is told of the bodies of a topology. `_at`: the elements before those of the topology in a buffer that others share.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct AssembleParameters {
    /// In a dispatch.
    pub first_body: u32,
    pub column_count: u32,
    pub row_count: u32,
    pub element_count: u32,
    pub value_count: u32,
    pub system_count: u32,
    pub side_count: u32,
    pub is_plane_strain: u32,
    pub shrinking_layers: u32,
    pub bodies_at: u32,
    pub shared_numbers_at: u32,
    pub element_grid_at: u32,
    pub source_starts_at: u32,
    pub sources_at: u32,
    pub geometry_at: u32,
    pub values_at: u32,
    pub states_at: u32,
}

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

/// What bodies of one topology share, as `assemble` takes it.
#[derive(Clone, Debug)]
pub struct MeshLayout {
    grading: Grading,
    pub systems: SystemLayout,
    pub source_starts: Vec<u32>,
    pub sources: Vec<u32>,
    /// `[element][node]`: row * column_count + column, in half elements from the ring's load line.
    pub element_grid: Vec<u32>,
    pub shared_numbers: Vec<f64>,
    pub parameters: AssembleParameters,
}

/// Why bodies cannot be laid out for `assemble`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    #[error("the kernels know {known:?} only, not {asked:?}")]
    Element { known: ElementKind, asked: ElementKind },
    #[error(transparent)]
    NoDiagonal(#[from] NoDiagonal),
}

impl MeshLayout {
    /// For bodies like `body` (same shape family, supports and class), divided by `grading`.
    pub fn new(body: &Body, grading: &Grading) -> Result<MeshLayout, LayoutError> {
        if grading.element != ElementKind::Quad8 {
            return Err(LayoutError::Element { known: ElementKind::Quad8, asked: grading.element });
        }
        let topology = RingTopology::new(body, grading);
        let assembly = Assembly::of_ring(&topology);
        let pattern = assembly.matrix::<f64>(&[]);
        let systems = SystemLayout::new(pattern.row_starts, pattern.columns, topology.ring_start)?;
        let (source_starts, sources) = sliced_sources(&systems.sliced, assembly.sources());
        let column_count = topology.ring_angles.len();
        let place = |&node: &u32| {
            let (row, column) = topology.grid[node as usize];
            (row * column_count + column) as u32
        };
        let parameters = AssembleParameters {
            column_count: column_count as u32,
            row_count: 2 * topology.layer_count as u32 + 1,
            element_count: topology.element_count() as u32,
            value_count: systems.sliced.columns.len() as u32,
            system_count: systems.system_count() as u32,
            side_count: body.shape.sides.len() as u32,
            is_plane_strain: is_plane_strain(body.idealization),
            shrinking_layers: grading.layers.shrinking as u32,
            ..AssembleParameters::zeroed()
        };
        Ok(MeshLayout {
            grading: grading.clone(),
            systems,
            source_starts,
            sources,
            element_grid: topology.connectivity.iter().map(place).collect(),
            shared_numbers: shared_numbers(body, grading, &topology.ring_angles),
            parameters,
        })
    }

    /// The lists of `assemble`, and where they begin.
    pub fn lists(&self) -> (Vec<u32>, AssembleParameters) {
        let lists = [&self.element_grid, &self.source_starts, &self.sources].map(|list| &list[..]);
        let [element_grid_at, source_starts_at, sources_at] = starts(lists);
        (
            lists.concat(),
            AssembleParameters { element_grid_at, source_starts_at, sources_at, ..self.parameters },
        )
    }

    /// What one body asks of a device.
    pub fn counts(&self) -> BodyCounts {
        let longest_row = self.systems.row_starts.windows(2).map(|ends| ends[1] - ends[0]).max();
        BodyCounts {
            topology: 0,
            unknowns: self.systems.unknown_count() as u64,
            matrix_values: self.systems.sliced.columns.len() as u64,
            longest_row: u64::from(longest_row.unwrap_or(0)),
            ring_columns: self.systems.ring_count() as u64,
            geometry: self.geometry_count() as u64,
        }
    }

    /// What it takes here, but for what is small beside it.
    pub fn bytes(&self) -> u64 {
        let SystemLayout { row_starts, columns, diagonal_places, sliced, .. } = &self.systems;
        let Sliced { starts, columns: sliced_columns, diagonal_places: sliced_places, places } = sliced;
        let lists = [
            row_starts,
            columns,
            diagonal_places,
            starts,
            sliced_columns,
            sliced_places,
            places,
            &self.source_starts,
            &self.sources,
            &self.element_grid,
        ];
        let numbers = size_of_val(&self.shared_numbers[..]);
        (lists.iter().map(|list| size_of_val(&list[..])).sum::<usize>() + numbers) as u64
    }

    /// Points of the grid of half elements: rows times columns.
    pub fn grid_count(&self) -> usize {
        (self.parameters.row_count * self.parameters.column_count) as usize
    }

    /// Pairs of numbers of one body's mesh on the device: of each grid point its reach and the step to it, then for each of the
    /// four points of each element eight gradients and |J|.
    pub fn geometry_count(&self) -> usize {
        2 * self.grid_count() + 4 * 9 * self.parameters.element_count as usize
    }

    /// How many numbers one body has.
    pub fn body_number_count(&self) -> usize {
        match self.parameters.side_count as usize {
            0 => 2,
            sides => 3 * sides - 1,
        }
    }

    /// The numbers of one body: the margin of its Poisson's ratio, then the depth of a round boundary, or of each
    /// straight side how far beyond the ring it lies, and of each but the last the corner at its end: its angle, and the
    /// column that leads to it.
    pub fn body_numbers(&self, body: &Body) -> Vec<f64> {
        let depth = |angle: f64| (body.shape.depth)(&body.parameters, angle);
        let mut numbers = vec![body.idealization.margin(body.poissons_ratio)];
        if body.shape.sides.is_empty() {
            numbers.push(depth(0.0));
        }
        let corners = (body.shape.corners)(&body.parameters);
        let columns = corner_columns(body, &self.grading.angles);
        let mut ends = corners.into_iter().zip(columns);
        for &foot in body.shape.sides {
            // Less the ring's radius, which would take the digits of a thin wall.
            numbers.push(depth(foot).exp_m1());
            numbers.extend(ends.next().into_iter().flat_map(|(angle, column)| [angle, 2.0 * column as f64]));
        }
        numbers
    }
}

/// Elements before each of some lists that follow each other.
pub(super) fn starts<const N: usize>(lists: [&[u32]; N]) -> [u32; N] {
    let mut end = 0;
    lists.map(|list| {
        end += list.len() as u32;
        end - list.len() as u32
    })
}

/// As the kernels are told.
pub(super) fn is_plane_strain(idealization: Idealization) -> u32 {
    u32::from(idealization == Idealization::PlaneStrain)
}

/// The element entries of every place: where each list starts, with the end of the last, and the entries. A zero has none.
fn sliced_sources(sliced: &Sliced, (starts, sources): (&[u32], &[u32])) -> (Vec<u32>, Vec<u32>) {
    let mut lists: Vec<&[u32]> = vec![&[]; sliced.columns.len()];
    for (place, ends) in sliced.places.iter().zip(starts.windows(2)) {
        lists[*place as usize] = &sources[ends[0] as usize..ends[1] as usize];
    }
    let ends = lists.iter().scan(0, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    });
    (std::iter::once(0).chain(ends).collect(), lists.concat())
}

/// `shared_numbers` of `assemble.wgsl`.
fn shared_numbers(body: &Body, grading: &Grading, ring_angles: &[f64]) -> Vec<f64> {
    let ring = ring_points(grading);
    let difference = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
    let step = |column: usize| match ring.get(column + 1) {
        Some(next) => difference(*next, ring[column]),
        None => [0.0; 2],
    };
    let sagitta = |column: usize| {
        if column.is_multiple_of(2) {
            return [0.0; 2];
        }
        let [before, after] = [ring[column - 1], ring[column + 1]];
        difference(ring[column], [0.5 * (before[0] + after[0]), 0.5 * (before[1] + after[1])])
    };
    let sign = body.shape.side.outward();
    let rule = ElementRule::new(grading.element);
    let derivatives = rule.points.iter().flat_map(|point| point.by_xi.into_iter().zip(point.by_eta));
    let side = |(number, &foot): (usize, &f64)| {
        let changes = number + 1 < body.shape.sides.len() && holding_changes(body, number);
        [polar(1.0, foot), [foot, f64::from(u8::from(changes))]]
    };
    [[grading.layers.first, grading.layers.thickest], [sign, centre_pull(body)]]
        .into_iter()
        .chain(ring.iter().copied())
        .chain((0..ring.len()).map(step))
        .chain((0..ring.len()).map(sagitta))
        .chain(ring_angles.iter().map(|&angle| [angle, 0.0]))
        .chain(derivatives.map(|(by_xi, by_eta)| [by_xi, by_eta]))
        .chain(body.shape.sides.iter().enumerate().flat_map(side))
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two numbers make a concentric body, eight a block, however fine its mesh: millions of them are soon told.
    #[test]
    fn few_numbers_make_a_body() {
        use crate::mechanics::body::{annulus, block};
        use crate::mechanics::grading::GradingClass;
        let of = |shape, parameters, level| {
            let (idealization, poissons_ratio) = (Idealization::PlaneStrain, 0.3);
            let body = Body {
                shape,
                parameters,
                support: 0,
                poissons_ratio,
                idealization,
                lining: Default::default(),
                all_around: false,
            };
            let class = GradingClass::of(&body, ElementKind::Quad8, level);
            let layout = MeshLayout::new(&body, &class.grading(shape.end_angle)).unwrap();
            assert_eq!(layout.body_numbers(&body).len(), layout.body_number_count());
            layout.body_number_count()
        };
        for level in [1, 5] {
            assert_eq!(of(&annulus::SHAPE, [3.0, 0.0, 0.0], level), 2);
            assert_eq!(of(&block::SHAPE, [3.0, 4.0, 2.0], level), 8);
        }
    }

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
