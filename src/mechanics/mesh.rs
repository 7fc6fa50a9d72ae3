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

use crate::mechanics::body::{Body, Side};
use crate::mechanics::element::{ElementKind, MAX_NODES, side_functions};
use crate::mechanics::layers::Layers;
use crate::mechanics::lining_rows::{BodyRows, LiningDivision};

/// Index of a free unknown, or `SUPPORTED`.
pub const SUPPORTED: u32 = u32::MAX;

/// What bodies meshed alike share.
#[derive(Clone, Debug, PartialEq)]
pub struct RingTopology {
    pub element: ElementKind,
    /// Angles of all ring nodes from the load line, mid-side nodes included, rad, ascending from 0.
    pub ring_angles: Vec<f64>,
    /// Points of the ring, one a column in half elements.
    ring_points: Vec<[f64; 2]>,
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
        let held = held_columns(body, grading);
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

/// The radii of what is beyond a lining at the ends of its layers along a line.
struct Layering<'a> {
    rest: &'a Body,
    layers: Layers,
    /// Of the last line, in the shape's measure; NaN before the first.
    depth: f64,
    /// Its factor from one layer to the next.
    growth: f64,
    /// Of its end.
    far_radius: f64,
    /// Of its layers' ends the share of the way from the ring to the far boundary.
    shares: Vec<f64>,
}

impl<'a> Layering<'a> {
    fn new(rest: &'a Body, layers: Layers) -> Layering<'a> {
        let shares = Vec::with_capacity(layers.count + 1);
        Layering { rest, layers, depth: f64::NAN, growth: 1.0, far_radius: f64::NAN, shares }
    }

    /// For a line that meets the far boundary at an angle, rad. Lines of one depth, as all of a concentric body are, are alike.
    fn towards(&mut self, angle: f64) {
        let depth = (self.rest.shape.depth)(&self.rest.parameters, angle);
        if depth == self.depth {
            return;
        }
        self.depth = depth;
        self.growth = self.layers.growth(depth, self.growth);
        self.far_radius = radius(self.rest, depth);
        let mut reached = 0.0;
        self.shares.clear();
        self.shares.push(0.0);
        for thickness in self.layers.thicknesses(self.growth) {
            reached += thickness;
            self.shares.push(reached);
        }
        // The growth factor is only as good as its search; the far boundary is where it is.
        let scale = depth / reached;
        for share in &mut self.shares {
            *share = (radius(self.rest, *share * scale) - 1.0) / (self.far_radius - 1.0);
        }
    }
}

/// Points of the ring, one a column in half elements.
pub fn ring_points(grading: &Grading) -> Vec<[f64; 2]> {
    half_steps(&grading.angles, 1).into_iter().map(|angle| polar(1.0, angle)).collect()
}

/// Distance from the ring's centre at a depth.
fn radius(body: &Body, depth: f64) -> f64 {
    match body.shape.side {
        Side::Plate => concentric_radius(body, depth),
        // Like the others near the ring, whose near field it shares, and to zero at the centre.
        Side::Pin => concentric_radius(body, depth) - centre_pull(body) * (depth / deepest(body)).powi(6),
    }
}

/// The same at a share of the way from the ring to the far boundary.
fn on_radius(far_radius: f64, share: f64) -> f64 {
    1.0 + share * (far_radius - 1.0)
}

/// The same at a depth between concentric circles.
fn concentric_radius(body: &Body, depth: f64) -> f64 {
    match body.shape.side {
        Side::Plate => depth.exp(),
        Side::Pin => (-depth).exp(),
    }
}

/// What takes the lines of a shape that reaches the ring's centre to the centre: exp(-depth) of its end, else zero.
pub fn centre_pull(body: &Body) -> f64 {
    if body.shape.reaches_centre { (-deepest(body)).exp() } else { 0.0 }
}

fn deepest(body: &Body) -> f64 {
    body.depth_range().1
}

/// Coordinates of all nodes of `body`, over the ring's radius, origin at the ring's centre, y against the load.
///
/// Layers grow from `first_layer` along each line, so that every body is divided alike near the ring whatever lies
/// beyond. Those of a lining lie between circles, and beyond them is a body whose ring is the outermost interface. The collapsed centre of a solid disc is a row of coincident nodes, which are supported.
pub fn coordinates(body: &Body, grading: &Grading, topology: &RingTopology) -> Vec<[f64; 2]> {
    let (rest, scale) = body.beyond_lining();
    let wall = thinnest_wall(&rest);
    let BodyRows { starts, rest: layers } = grading.lining.divided(body, grading.layers);
    let in_lining: Vec<f64> = starts.into_iter().map(|depth| concentric_radius(body, depth)).collect();
    let has_corners = !body.shape.sides.is_empty();
    let (columns, ends) = (topology.ring_points.len(), in_lining.len() + layers.count + 1);
    let mut layering = Layering::new(&rest, layers);
    // At the ends of the layers of each column: points, and of bodies with corners how far edges bow.
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(columns * ends);
    let mut bows: Vec<f64> = Vec::with_capacity(if has_corners { columns * ends } else { 0 });
    let targets = boundary_angles(body, &grading.angles, wall);
    for (target, on_ring) in targets.into_iter().zip(&topology.ring_points) {
        layering.towards(target);
        points.extend(in_lining.iter().map(|radius| on_ring.map(|place| radius * place)));
        let Layering { far_radius, shares, .. } = &layering;
        if !has_corners {
            let beyond = shares.iter().map(|share| scale * on_radius(*far_radius, *share));
            points.extend(beyond.map(|radius| on_ring.map(|place| radius * place)));
            continue;
        }
        let course = Course::new(*on_ring, polar(*far_radius, target), *far_radius, wall);
        points.extend(shares.iter().map(|share| course.point(*share).map(|place| scale * place)));
        bows.extend(&in_lining);
        bows.extend(shares.iter().map(|share| scale * course.bow(*share)));
    }
    // Mid-side nodes of layers lie half-way between corner nodes.
    let around = |row: usize, column: usize| [row / 2, row.div_ceil(2)].map(|end| column * ends + end);
    let place = |row: usize, column: usize| {
        let [end, next] = around(row, column);
        midpoint(points[end], points[next])
    };
    // And those between two lines half-way between these, but for the bow. The layers of their own line do not matter, so
    // that elements keep their shape where the depth changes quickly.
    let bowed = |row: usize, column: usize| {
        let middle = midpoint(place(row, column - 1), place(row, column + 1));
        let chord = midpoint(topology.ring_points[column - 1], topology.ring_points[column + 1]);
        let [end, next] = around(row, column);
        let bow = 0.5 * (bows[end] + bows[next]);
        [0, 1].map(|axis| middle[axis] + bow * (topology.ring_points[column][axis] - chord[axis]))
    };
    let is_bowed = |column: usize| has_corners && !column.is_multiple_of(2);
    let node = |&(row, column): &(usize, usize)| {
        if is_bowed(column) { bowed(row, column) } else { place(row, column) }
    };
    topology.grid.iter().map(node).collect()
}

/// The course of a line from the ring to its end: near the ring that of a line of a concentric body, whose near field is to
/// be its own, then straight.
///
/// A straight line cannot leave a convex body (but can cut the ring, where it is divided too coarsely for a thin place:
/// assembly refuses such a mesh). One that runs out radially could, where it has to turn by more than the thinnest wall.
struct Course {
    on_ring: [f64; 2],
    far: [f64; 2],
    far_radius: f64,
    /// The share of the way on which the line leaves the radius is 1/`haste`.
    haste: f64,
}

/// By how much of the thinnest wall a line's end may lie off its radius before it must make haste to turn there.
pub const LEEWAY: f64 = 0.3;

impl Course {
    fn new(on_ring: [f64; 2], far: [f64; 2], far_radius: f64, wall: f64) -> Course {
        let aside = (on_ring[0] * far[1] - on_ring[1] * far[0]).abs();
        Course { on_ring, far, far_radius, haste: (aside / (LEEWAY * wall)).max(1.0) }
    }

    /// From 1 at the ring, with no slope, to 0.
    fn radial_part(&self, share: f64) -> f64 {
        let way = (share * self.haste).min(1.0);
        (1.0 - way) * (1.0 - way) * (1.0 + 2.0 * way)
    }

    fn point(&self, share: f64) -> [f64; 2] {
        let part = self.radial_part(share);
        [0, 1].map(|axis| {
            let straight = self.on_ring[axis] + share * (self.far[axis] - self.on_ring[axis]);
            straight + part * (on_radius(self.far_radius, share) * self.on_ring[axis] - straight)
        })
    }

    /// How far a layer's edge bulges, over the ring's: like a circle near the ring, straight at the end.
    fn bow(&self, share: f64) -> f64 {
        let part = self.radial_part(share);
        part * on_radius(self.far_radius, share) + (1.0 - part) * (1.0 - share)
    }
}

/// The point at a distance from the ring's centre, in the direction of an angle from the load line.
pub fn polar(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.sin(), -radius * angle.cos()]
}

fn midpoint(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

/// `values` with the mid-points between them (`step` 1), or alone (`step` 2).
fn half_steps(values: &[f64], step: usize) -> Vec<f64> {
    let at = |i: usize| {
        if i.is_multiple_of(2) { values[i / 2] } else { 0.5 * (values[i / 2] + values[i / 2 + 1]) }
    };
    (0..2 * values.len() - 1).step_by(step).map(at).collect()
}

/// The ring's corner column nearest to each corner of the far boundary, strictly between the ends and ascending.
pub fn corner_columns(body: &Body, angles: &[f64]) -> Vec<usize> {
    let corners = (body.shape.corners)(&body.parameters);
    let last = angles.len() - 1;
    let mut columns: Vec<usize> = Vec::with_capacity(corners.len());
    for (i, &corner) in corners.iter().enumerate() {
        let nearest = (0..=last)
            .min_by(|&a, &b| (angles[a] - corner).abs().total_cmp(&(angles[b] - corner).abs()))
            .unwrap_or(0);
        let least = columns.last().map_or(1, |previous| previous + 1);
        columns.push(nearest.clamp(least, last - (corners.len() - i)));
    }
    columns
}

/// Columns (in half elements) at which the far boundary of `body` is held: with shape, support and grading, all that
/// its topology depends on.
pub fn held_columns(body: &Body, grading: &Grading) -> Vec<bool> {
    let corners = corner_columns(body, &grading.angles);
    (0..=2 * (grading.angles.len() - 1)).map(|column| far_boundary_held(body, &corners, column)).collect()
}

/// Whether the far-boundary node at `column` (in half elements) is held, by the sides of the boundary it lies on.
fn far_boundary_held(body: &Body, corners: &[usize], column: usize) -> bool {
    let side_before = corners.iter().filter(|&&corner| 2 * corner < column).count();
    let side_after = corners.iter().filter(|&&corner| 2 * corner <= column).count();
    let held = |side: usize| (body.shape.boundary_held)(body.support, side);
    held(side_before) || held(side_after)
}

/// Whether the far boundary is held on one side of a corner and free on the other: the stress is singular there.
pub fn holding_changes(body: &Body, corner: usize) -> bool {
    let held = |side: usize| (body.shape.boundary_held)(body.support, side);
    held(corner) != held(corner + 1)
}

/// How much closer than evenly lines end to each other at corners where the holding changes.
pub const CROWDING: f64 = 0.5;

/// From this wall on, over the ring's radius: lines of thin ones, which turn on a short way, would cross.
pub const THICK_WALL: f64 = 0.3;

/// The distance from the ring to the nearest place of the far boundary of a plate, over the ring's radius.
fn thinnest_wall(body: &Body) -> f64 {
    body.depth_range().0.exp_m1()
}

/// Angle at which the line of each ring column meets the far boundary: the ring's own angle, drawn so that the
/// boundary's corners fall on corner columns, and closer to those where the holding changes.
fn boundary_angles(body: &Body, angles: &[f64], wall: f64) -> Vec<f64> {
    let corners = (body.shape.corners)(&body.parameters);
    let columns = corner_columns(body, angles);
    let end = angles[angles.len() - 1];
    let mut from = vec![0.0];
    let mut to = vec![0.0];
    for (&column, &corner) in columns.iter().zip(&corners) {
        from.push(angles[column]);
        to.push(corner);
    }
    from.push(end);
    to.push(end);
    let crowding = CROWDING * (wall / THICK_WALL).min(1.0);
    let crowded = |share: f64| share * (1.0 - crowding + crowding * share);
    let targets: Vec<f64> = angles
        .iter()
        .map(|&angle| {
            let piece = (1..from.len() - 1).filter(|&i| angle > from[i]).count();
            let share = (angle - from[piece]) / (from[piece + 1] - from[piece]);
            let at = |corner: usize| corner < corners.len() && holding_changes(body, corner);
            let share = match (piece > 0 && at(piece - 1), at(piece)) {
                (true, false) => crowded(share),
                (false, true) => 1.0 - crowded(1.0 - share),
                _ => share,
            };
            to[piece] + share * (to[piece + 1] - to[piece])
        })
        .collect();
    half_steps(&targets, 1)
}
