//! Bodies of one topology as `assemble` takes them: what they share, and the numbers of each.
//!
//! Shared structs hold only `f32` and `u32`, so that no padding can differ; `tests/engine/shaders.rs` compares their offsets.
//! Numbers in the precision of the kernels travel as plain arrays.

use bytemuck::{Pod, Zeroable};

use super::batch::{AssembleCounts, BodyCounts};
use super::gather::{Gather, NodePairs};
use super::system_layout::{NoDiagonal, Sliced, SystemLayout};
use crate::mechanics::assembly::Assembly;
use crate::mechanics::body::{Body, StraightSide};
use crate::mechanics::element::ElementKind;
use crate::mechanics::element::stiffness::ElementRule;
use crate::mechanics::lines::centre_pull;
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::{Grading, RingTopology, corner_columns, holding_changes, polar, ring_points};

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
    pub pair_count: u32,
    pub system_count: u32,
    pub side_count: u32,
    pub is_plane_strain: u32,
    pub shrinking_layers: u32,
    pub bodies_at: u32,
    pub shared_numbers_at: u32,
    pub element_grid_at: u32,
    pub pair_starts_at: u32,
    pub sources_at: u32,
    pub value_places_at: u32,
    pub geometry_at: u32,
    pub values_at: u32,
    pub states_at: u32,
}

impl AssembleParameters {
    pub fn counts(&self) -> AssembleCounts {
        AssembleCounts {
            lines: self.column_count.into(),
            layers: u64::from(self.row_count) / 2,
            elements: self.element_count.into(),
            pairs: self.pair_count.into(),
        }
    }
}

/// What bodies of one topology share, as `assemble` takes it.
#[derive(Clone, Debug)]
pub struct MeshLayout {
    grading: Grading,
    pub systems: SystemLayout,
    /// By places of `systems`.
    pub gather: Gather,
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
        let gather = sliced_gather(&NodePairs::new(&topology), &systems);
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
            pair_count: gather.pair_count() as u32,
            system_count: systems.system_count() as u32,
            side_count: body.shape.sides.len() as u32,
            is_plane_strain: is_plane_strain(body.idealization),
            shrinking_layers: grading.layers.shrinking as u32,
            ..AssembleParameters::zeroed()
        };
        Ok(MeshLayout {
            grading: grading.clone(),
            systems,
            gather,
            element_grid: topology.connectivity.iter().map(place).collect(),
            shared_numbers: shared_numbers(body, grading, &topology.ring_angles),
            parameters,
        })
    }

    /// The lists of `assemble`, and where they begin.
    pub fn lists(&self) -> (Vec<u32>, AssembleParameters) {
        let Gather { starts: pair_starts, sources, places } = &self.gather;
        let lists = [&self.element_grid, pair_starts, sources, places].map(|list| &list[..]);
        let [element_grid_at, pair_starts_at, sources_at, value_places_at] = starts(lists);
        let places = AssembleParameters {
            element_grid_at,
            pair_starts_at,
            sources_at,
            value_places_at,
            ..self.parameters
        };
        (lists.concat(), places)
    }

    /// What one body asks of a device.
    pub fn counts(&self) -> BodyCounts {
        let longest_row = self.systems.row_starts.windows(2).map(|ends| ends[1] - ends[0]).max();
        BodyCounts {
            topology: 0,
            unknowns: self.systems.unknown_count() as u64,
            matrix_values: self.systems.sliced.columns.len() as u64,
            assemble: self.parameters.counts(),
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
            &self.element_grid,
        ];
        let numbers = size_of_val(&self.shared_numbers[..]);
        (lists.iter().map(|list| size_of_val(&list[..])).sum::<usize>() + self.gather.bytes() + numbers)
            as u64
    }

    /// Points of the grid of half elements: rows times columns.
    pub fn grid_count(&self) -> usize {
        (self.parameters.row_count * self.parameters.column_count) as usize
    }

    /// Fours of numbers of one body's mesh on the device: of each grid point its reach and the step to it, then of each node of each
    /// element its gradients at four points.
    pub fn geometry_count(&self) -> usize {
        self.grid_count() + 2 * 8 * self.parameters.element_count as usize
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
        let mut numbers = Vec::with_capacity(self.body_number_count());
        self.add_body_numbers(body, &mut numbers);
        numbers
    }

    /// The same behind those of others.
    pub fn add_body_numbers(&self, body: &Body, numbers: &mut Vec<f64>) {
        numbers.push(body.idealization.margin(body.poissons_ratio));
        if body.shape.sides.is_empty() {
            numbers.push((body.shape.depth)(&body.parameters, 0.0));
            return;
        }
        let corners = (body.shape.corners)(&body.parameters);
        let columns = corner_columns(&corners, &self.grading.angles);
        let mut ends = corners.into_iter().zip(columns);
        for side in body.shape.sides {
            // Less the ring's radius, which would take the digits of a thin wall.
            numbers.push(body.parameters[side.distance] - 1.0);
            numbers.extend(ends.next().into_iter().flat_map(|(angle, column)| [angle, 2.0 * column as f64]));
        }
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

/// Where the values of conjugate gradients' matrix come from.
fn sliced_gather(pairs: &NodePairs, systems: &SystemLayout) -> Gather {
    let SystemLayout { row_starts, columns, sliced, .. } = systems;
    let place = |[row, column]: [usize; 2]| {
        let own = row_starts[row] as usize..row_starts[row + 1] as usize;
        let entry = columns[own.clone()].binary_search(&(column as u32)).ok()?;
        Some(sliced.places[own.start + entry] as usize)
    };
    pairs.gather(place, sliced.columns.len())
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
    let side = |(number, &StraightSide { foot, .. }): (usize, &StraightSide)| {
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
            let body = Body::bare(shape, parameters, 0.3, Idealization::PlaneStrain);
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
}
