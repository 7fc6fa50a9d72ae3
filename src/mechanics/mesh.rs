//! Meshes: coordinates, connectivity and supports of one body.
//!
//! Every body is meshed as a ring mesh: lines at given angles run from the contact ring (radius 1) to the body's
//! far boundary, crossed by layers. What bodies share (connectivity, numbering, supports) is the `RingTopology`;
//! what is their own are the coordinates.
//!
//! ```text
//!   far boundary   o-----o-----o      rows of nodes are numbered from the far boundary to the ring,
//!                  |     |     |      so that elimination in this order leaves the ring for last:
//!   layer          o-----o-----o      the last diagonal block of the Cholesky factor is that of the
//!                  |     |     |      stiffness condensed to the ring.
//!   contact ring   o-----o-----o
//!                phi=0       phi=end
//! ```

use crate::mechanics::body::{Body, MOST_CORNERS, OfCorners, Side};
use crate::mechanics::element::{ElementKind, MAX_NODES, side_functions};
use crate::mechanics::layers::Layers;
use crate::mechanics::lining_rows::LiningDivision;

/// Index of a free unknown, or `SUPPORTED`.
pub const SUPPORTED: u32 = u32::MAX;

/// What bodies meshed alike share.
#[derive(Clone, Debug, PartialEq)]
pub struct RingTopology {
    pub element: ElementKind,
    /// Angles of all ring nodes from the load line, mid-side nodes included, rad, ascending from 0.
    pub ring_angles: Vec<f64>,
    /// Points of the ring, one a column in half elements.
    pub ring_points: Vec<[f64; 2]>,
    pub layer_count: usize,
    /// Of each layer from the ring on its material: 0 at the ring, 1 beyond the first interface, and so on.
    pub materials: Vec<usize>,
    pub node_count: usize,
    /// Nodes of each element in the order of `ElementKind`, `element.node_count()` a piece.
    pub connectivity: Vec<u32>,
    /// Grid row (0 at the ring) and column of each node, in half elements.
    pub grid: Vec<(usize, usize)>,
    /// Unknown of each dof (2 * node + component), or `SUPPORTED`.
    pub unknowns: Vec<u32>,
    pub unknown_count: usize,
    /// Nodes of the ring, by ascending angle; their unknowns are the last.
    pub ring_nodes: Vec<u32>,
    /// The first unknown of the ring.
    pub ring_start: usize,
}

/// How a body is to be divided: see `grading` for how these are chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Grading {
    pub element: ElementKind,
    /// Angles of the ring's corner nodes, rad, ascending from 0 to the shape's end angle.
    pub angles: Vec<f64>,
    /// Beyond a lining.
    pub layers: Layers,
    pub lining: LiningDivision,
}

impl Grading {
    /// Angles of all ring nodes from the load line, mid-side nodes included, rad, ascending from 0.
    pub fn ring_angles(&self) -> Vec<f64> {
        half_steps(&self.angles, if self.element == ElementKind::Quad8 { 1 } else { 2 })
    }

    /// Of all materials.
    pub fn layer_count(&self) -> usize {
        self.lining.rows.total() + self.layers.count
    }
}

impl RingTopology {
    /// What it takes, but for what is small beside it.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.connectivity[..]) + size_of_val(&self.grid[..]) + size_of_val(&self.unknowns[..])
    }

    /// The topology of `body` divided by `grading`.
    pub fn new(body: &Body, grading: &Grading) -> RingTopology {
        let quadratic = grading.element == ElementKind::Quad8;
        let step = if quadratic { 1 } else { 2 };
        let (rows, columns) = (2 * grading.layer_count(), 2 * (grading.angles.len() - 1));
        let index = |row: usize, column: usize| row * (columns + 1) + column;
        let mut numbers = vec![u32::MAX; (rows + 1) * (columns + 1)];
        let mut grid = Vec::new();
        for row in (0..=rows).rev().step_by(step) {
            for column in (0..=columns).step_by(step) {
                if row % 2 == 1 && column % 2 == 1 {
                    continue;
                }
                numbers[index(row, column)] = grid.len() as u32;
                grid.push((row, column));
            }
        }
        let node = |row: usize, column: usize| numbers[index(row, column)];
        let mut connectivity = Vec::new();
        for row in (0..rows).step_by(2).rev() {
            for column in (0..columns).step_by(2) {
                // Counter-clockwise in the plane: a plate's layers lead away from the centre, a pin's towards it.
                let (inner, outer) = match body.shape.side {
                    Side::Plate => (row, row + 2),
                    Side::Pin => (row + 2, row),
                };
                connectivity.extend([
                    node(inner, column),
                    node(outer, column),
                    node(outer, column + 2),
                    node(inner, column + 2),
                ]);
                if quadratic {
                    connectivity.extend([
                        node(row + 1, column),
                        node(outer, column + 1),
                        node(row + 1, column + 2),
                        node(inner, column + 1),
                    ]);
                }
            }
        }
        let held = held_columns(body, &grading.angles);
        let mut unknowns = vec![SUPPORTED; 2 * grid.len()];
        let mut unknown_count = 0;
        let mut ring_start = 0;
        for (number, &(row, column)) in grid.iter().enumerate() {
            if row == 0 && column == 0 {
                ring_start = unknown_count;
            }
            let held_far = row == rows && held[column];
            let held_face = column == columns && body.shape.end_face_held;
            let on_symmetry = column == 0 || column == columns;
            for component in 0..2 {
                if !(held_far || held_face || (on_symmetry && component == 0)) {
                    unknowns[2 * number + component] = unknown_count as u32;
                    unknown_count += 1;
                }
            }
        }
        let ring_nodes: Vec<u32> = (0..=columns).step_by(step).map(|column| node(0, column)).collect();
        RingTopology {
            element: grading.element,
            ring_angles: grading.ring_angles(),
            ring_points: ring_points(grading),
            layer_count: grading.layer_count(),
            materials: materials(body, grading),
            node_count: grid.len(),
            connectivity,
            grid,
            unknowns,
            unknown_count,
            ring_nodes,
            ring_start,
        }
    }

    pub fn element_count(&self) -> usize {
        self.connectivity.len() / self.element.node_count()
    }

    /// The material of an element. They are numbered by layers, from the far boundary to the ring.
    pub fn material(&self, element: usize) -> usize {
        let of_layer = self.element_count() / self.layer_count;
        self.materials[self.layer_count - 1 - element / of_layer]
    }

    /// Nodes of the Q8 of a layer, counted from the ring, and a column of them.
    pub fn element_at(&self, layer: usize, column: usize) -> [u32; MAX_NODES] {
        let columns = self.element_count() / self.layer_count;
        let element = (self.layer_count - 1 - layer) * columns + column;
        let nodes = &self.connectivity[element * MAX_NODES..][..MAX_NODES];
        std::array::from_fn(|place| nodes[place])
    }

    /// The nodes of the ring's side at an angle, rad, with what each has of a value there.
    pub fn on_ring(&self, angle: f64) -> ([u32; 3], [f64; 3]) {
        let last = self.ring_nodes.len() - 3;
        let behind = self.ring_angles.partition_point(|own| *own <= angle);
        let from = (behind.saturating_sub(1) / 2 * 2).min(last);
        let (start, end) = (self.ring_angles[from], self.ring_angles[from + 2]);
        let (shares, _) = side_functions(ElementKind::Quad8, 2.0 * (angle - start) / (end - start) - 1.0);
        ([0, 1, 2].map(|place| self.ring_nodes[from + place]), shares)
    }

    /// Unknowns of the ring; they are the last ones.
    pub fn ring_unknown_count(&self) -> usize {
        self.unknown_count - self.ring_start
    }
}

fn materials(body: &Body, grading: &Grading) -> Vec<usize> {
    let last = body.lining.list().len();
    grading.lining.rows.materials().chain(std::iter::repeat_n(last, grading.layers.count)).collect()
}

/// Points of the ring, one a column in half elements.
pub fn ring_points(grading: &Grading) -> Vec<[f64; 2]> {
    half_steps(&grading.angles, 1).into_iter().map(|angle| polar(1.0, angle)).collect()
}

/// The point at a distance from the ring's centre, in the direction of an angle from the load line.
pub fn polar(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.sin(), -radius * angle.cos()]
}

/// `values` with the mid-points between them (`step` 1), or alone (`step` 2).
pub fn half_steps(values: &[f64], step: usize) -> Vec<f64> {
    let at = |i: usize| {
        if i.is_multiple_of(2) { values[i / 2] } else { 0.5 * (values[i / 2] + values[i / 2 + 1]) }
    };
    (0..2 * values.len() - 1).step_by(step).map(at).collect()
}

/// The ring's corner column nearest to each corner of the far boundary, both by their angles, strictly between the ends and ascending.
pub fn corner_columns(corners: &[f64], angles: &[f64]) -> OfCorners<usize> {
    let last = angles.len() - 1;
    let mut columns = OfCorners::new();
    for (i, &corner) in corners.iter().enumerate() {
        let behind = angles.partition_point(|angle| *angle < corner).min(last);
        let before = behind.saturating_sub(1);
        let is_nearer = corner - angles[before] <= angles[behind] - corner;
        let nearest = if is_nearer { before } else { behind };
        let least = columns.last().map_or(1, |previous| previous + 1);
        columns.push(nearest.clamp(least, last - (corners.len() - i)));
    }
    columns
}

/// Columns (in half elements) of a ring divided at these angles at which the far boundary of `body` is held: with shape, support and grading, all
/// that its topology depends on.
pub fn held_columns(body: &Body, angles: &[f64]) -> Vec<bool> {
    let corners = corner_columns(&(body.shape.corners)(&body.parameters), angles);
    let last = 2 * (angles.len() - 1);
    let mut held = vec![false; last + 1];
    for side in (0..=corners.len()).filter(|side| (body.shape.boundary_held)(body.support, *side)) {
        // A corner is of both its sides.
        let first = side.checked_sub(1).map_or(0, |before| 2 * corners[before]);
        let last = corners.get(side).map_or(last, |corner| 2 * corner);
        held[first..=last].fill(true);
    }
    held
}

/// What tells `held_columns` of bodies whose rings are divided alike: whether the far boundary is held at the load line, and the corner columns at
/// which that changes, ascending, then zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Held {
    at_load_line: bool,
    changes: [usize; MOST_CORNERS],
}

impl Held {
    /// The angles of the ring's corner columns are asked for where something changes.
    pub fn of<'a>(body: &Body, angles: impl FnOnce() -> &'a [f64]) -> Held {
        let at_load_line = (body.shape.boundary_held)(body.support, 0);
        let mut changes = [0; MOST_CORNERS];
        let corners = 0..body.shape.sides.len().saturating_sub(1);
        let mut changing = corners.filter(|corner| holding_changes(body, *corner)).peekable();
        if changing.peek().is_some() {
            let columns = corner_columns(&(body.shape.corners)(&body.parameters), angles());
            changes.iter_mut().zip(changing).for_each(|(change, corner)| *change = columns[corner]);
        }
        Held { at_load_line, changes }
    }
}

/// Whether the far boundary is held on one side of a corner and free on the other: the stress is singular there.
pub fn holding_changes(body: &Body, corner: usize) -> bool {
    let held = |side: usize| (body.shape.boundary_held)(body.support, side);
    held(corner) != held(corner + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::body::{SHAPES, Shape, block};
    use crate::mechanics::material::Idealization;

    /// Against the sides that each column lies on, for corners anywhere on the ring and whichever sides are held.
    #[test]
    fn columns_are_held_where_one_of_their_sides_is() {
        // A support is a set of sides here.
        let shape = Shape { boundary_held: |support, side| support >> side & 1 == 1, ..block::SHAPE };
        let shape: &'static Shape = Box::leak(Box::new(shape));
        let angles: Vec<f64> =
            (0..=9).map(|place| std::f64::consts::PI * (f64::from(place) / 9.0).powf(1.2)).collect();
        let mut seen = std::collections::HashSet::new();
        let mut told = std::collections::HashMap::new();
        for ratios in [[2.0, 3.0, 1.6], [1.02, 40.0, 3.0], [30.0, 1.1, 1.001], [1.001, 900.0, 900.0]] {
            let corners = (block::SHAPE.corners)(&ratios);
            let columns = corner_columns(&corners, &angles);
            assert!(columns[0] > 0 && columns[0] < columns[1] && columns[1] < 9, "{columns:?}");
            for (corner, column) in corners.iter().zip(&columns) {
                let distance = |column: usize| (angles[column] - corner).abs();
                let is_nearest = (0..10).all(|other| distance(*column) <= distance(other));
                // Two corners may not share a column, and none is at an end.
                assert!(is_nearest || columns[1] == columns[0] + 1 || [1, 8].contains(column), "{columns:?}");
            }
            for support in 0..8 {
                let body = Body { support, ..Body::bare(shape, ratios, 0.3, Idealization::PlaneStress) };
                let held = held_columns(&body, &angles);
                assert_eq!(held.len(), 19);
                // One `Held`, one list.
                let own = told.entry(Held::of(&body, || &angles)).or_insert_with(|| held.clone());
                assert_eq!(*own, held, "{ratios:?} {support}");
                for (column, held) in held.into_iter().enumerate() {
                    let is_on = |side: usize| {
                        (side == 0 || 2 * columns[side - 1] <= column)
                            && (side == 2 || column <= 2 * columns[side])
                    };
                    let expected = (0..3).any(|side| is_on(side) && (shape.boundary_held)(support, side));
                    assert_eq!(held, expected, "{ratios:?} {support} {column}");
                    seen.insert((support, held));
                }
            }
        }
        assert_eq!(seen.len(), 2 + 6 * 2);
        let lists: std::collections::HashSet<&Vec<bool>> = told.values().collect();
        assert!(told.len() == lists.len() && lists.len() > 8, "{told:?}");
        assert!(SHAPES.iter().all(|shape| shape.sides.len() <= MOST_CORNERS + 1));
    }
}
