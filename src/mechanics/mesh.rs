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
use crate::mechanics::real::Bodies;

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

/// Bodies of one topology side by side, one a lane; the last of them in the lanes beyond.
struct Abreast {
    bodies: Vec<Body>,
    /// Of each lane whether its body has the outlines of the one before: what follows from them is the same.
    repeats: Vec<bool>,
}

impl Abreast {
    fn new<T: Bodies>(bodies: Vec<Body>) -> Abreast {
        let repeat = |lane: usize| lane > 0 && bodies[lane].has_outlines_of(&bodies[lane - 1]);
        let repeats = (0..T::COUNT).map(|lane| lane >= bodies.len() || repeat(lane)).collect();
        Abreast { bodies, repeats }
    }

    /// A number of each that its outlines tell.
    #[inline(always)]
    fn each<T: Bodies>(&self, of: impl Fn(usize, &Body) -> f64) -> T {
        let mut last = f64::NAN;
        T::of_lanes(|lane| {
            if !self.repeats[lane] {
                last = of(lane, &self.bodies[lane]);
            }
            last
        })
    }
}

/// The radii of what is beyond linings at the ends of its layers along a line.
struct Layering<'a, T> {
    rest: &'a Abreast,
    side: Side,
    layers: Layers,
    /// Of the layer next to the lining, in the shape's measure.
    first: T,
    /// Of a shape that reaches the centre: what takes lines there (`centre_pull`), and its greatest depth.
    centre_pull: Option<(T, T)>,
    /// Of the last line, in the shape's measure; NaN before the first.
    depth: T,
    /// Its factor from one layer to the next.
    growth: T,
    /// Of its end.
    far_radius: T,
    /// Of its layers' ends the share of the way from the ring to the far boundary.
    shares: Vec<T>,
}

impl<'a, T: Bodies> Layering<'a, T> {
    #[inline(always)]
    fn new(rest: &'a Abreast, layers: Layers, first: T) -> Layering<'a, T> {
        let shape = rest.bodies[0].shape;
        let pulled = || (rest.each(|_, body| centre_pull(body)), rest.each(|_, body| deepest(body)));
        let nothing = T::from_f64(f64::NAN);
        Layering {
            rest,
            side: shape.side,
            layers,
            first,
            centre_pull: shape.reaches_centre.then(pulled),
            depth: nothing,
            growth: T::from_f64(1.0),
            far_radius: nothing,
            shares: Vec::with_capacity(layers.count + 1),
        }
    }

    /// For lines that meet the far boundaries at angles, rad. Lines of one depth, as all of a concentric body are, are alike.
    #[inline(always)]
    fn towards(&mut self, angles: T) {
        let depth: T = self.rest.each(|lane, body| (body.shape.depth)(&body.parameters, angles.lane(lane)));
        if (0..T::COUNT).all(|lane| depth.lane(lane) == self.depth.lane(lane)) {
            return;
        }
        self.depth = depth;
        self.growth = self.layers.growth_from(self.first, depth, self.growth);
        self.far_radius = self.radius(depth);
        let (zero, one) = (T::zero(), T::from_f64(1.0));
        let mut reached = zero;
        self.shares.clear();
        self.shares.push(zero);
        let mut grown = self.first;
        for layer in 0..self.layers.count {
            reached += T::from_f64(self.layers.part(layer)) * grown;
            self.shares.push(reached);
            grown = (grown * self.growth).at_most(T::from_f64(self.layers.thickest));
        }
        // The growth factor is only as good as its search; the far boundary is where it is.
        let scale = depth / reached;
        for place in 0..self.shares.len() {
            self.shares[place] = (self.radius(self.shares[place] * scale) - one) / (self.far_radius - one);
        }
    }

    /// Distance from the ring's centre at a depth.
    #[inline(always)]
    fn radius(&self, depth: T) -> T {
        let concentric = concentric_radius(self.side, depth);
        match self.centre_pull {
            None => concentric,
            // Like the others near the ring, whose near field it shares, and to zero at the centre.
            Some((pull, deepest)) => {
                let share = depth / deepest;
                concentric - pull * T::of_lanes(|lane| share.lane(lane).powi(6))
            }
        }
    }
}

/// Points of the ring, one a column in half elements.
pub fn ring_points(grading: &Grading) -> Vec<[f64; 2]> {
    half_steps(&grading.angles, 1).into_iter().map(|angle| polar(1.0, angle)).collect()
}

/// The radius at a share of the way from the ring to the far boundary.
#[inline(always)]
fn on_radius<T: Bodies>(far_radius: T, share: T) -> T {
    let one = T::from_f64(1.0);
    one + share * (far_radius - one)
}

/// The same at a depth between concentric circles.
#[inline(always)]
fn concentric_radius<T: Bodies>(side: Side, depth: T) -> T {
    match side {
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
    coordinates_abreast(std::slice::from_ref(body), grading, topology)
}

/// The same of bodies of one topology, one a lane: in the lanes beyond, those of the last body.
#[inline(always)]
pub fn coordinates_abreast<T: Bodies>(
    bodies: &[Body],
    grading: &Grading,
    topology: &RingTopology,
) -> Vec<[T; 2]> {
    let shape = bodies[0].shape;
    let bodies = Abreast::new::<T>(bodies.to_vec());
    let is_lined = bodies.bodies.iter().any(|body| !body.lining.is_empty());
    let beyond = is_lined.then(|| {
        let rest: Vec<Body> = bodies.bodies.iter().map(|body| body.beyond_lining().0).collect();
        let rows: Vec<BodyRows> =
            bodies.bodies.iter().map(|body| grading.lining.divided(body, grading.layers)).collect();
        (Abreast { bodies: rest, repeats: bodies.repeats.clone() }, rows)
    });
    let rest = beyond.as_ref().map_or(&bodies, |(rest, _)| rest);
    let rows = beyond.as_ref().map_or(&[][..], |(_, rows)| rows);
    let first = bodies.each(|lane, _| rows.get(lane).map_or(grading.layers.first, |rows| rows.rest.first));
    let scale: T = bodies.each(|_, body| body.beyond_lining_radius());
    let starts = rows.first().map_or(0, |rows| rows.starts.len());
    let mut layering = Layering::new(rest, grading.layers, first);
    let mut in_lining: Vec<T> = Vec::with_capacity(starts);
    for row in 0..starts {
        in_lining.push(concentric_radius(shape.side, bodies.each(|lane, _| rows[lane].starts[row])));
    }
    let (columns, ends) = (topology.ring_points.len(), starts + grading.layers.count + 1);
    let mut nodes: Vec<[T; 2]> = Vec::with_capacity(topology.node_count);
    // Mid-side nodes of layers lie half-way between corner nodes.
    let around = |row: usize| [row / 2, row.div_ceil(2)];
    if shape.sides.is_empty() {
        layering.towards(T::zero());
        let mut radii = in_lining;
        for share in &layering.shares {
            radii.push(scale * on_radius(layering.far_radius, *share));
        }
        for &(row, column) in &topology.grid {
            let [end, next] = around(row);
            let [x, y] = on_ring::<T>(topology, column);
            nodes.push([middle(radii[end] * x, radii[next] * x), middle(radii[end] * y, radii[next] * y)]);
        }
        return nodes;
    }
    // At the ends of the layers of each column: points, and how far edges bow.
    let mut points: Vec<[T; 2]> = Vec::with_capacity(columns * ends);
    let mut bows: Vec<T> = Vec::with_capacity(columns * ends);
    let walls: T = rest.each(|_, body| thinnest_wall(body));
    let mut targets: Vec<T> = vec![T::zero(); columns];
    for lane in 0..T::COUNT {
        let angles = || boundary_angles(&bodies.bodies[lane], &grading.angles, walls.lane(lane));
        let own = (!bodies.repeats[lane]).then(angles);
        for (column, target) in targets.iter_mut().enumerate() {
            let before = lane.saturating_sub(1);
            target.set_lane(lane, own.as_ref().map_or(target.lane(before), |own| own[column]));
        }
    }
    for (column, target) in targets.iter().enumerate() {
        layering.towards(*target);
        let (far_radius, [x, y]) = (layering.far_radius, on_ring::<T>(topology, column));
        for radius in &in_lining {
            points.push([*radius * x, *radius * y]);
            bows.push(*radius);
        }
        let (mut far_x, mut far_y) = (T::zero(), T::zero());
        for lane in 0..T::COUNT {
            let [x, y] = polar(far_radius.lane(lane), target.lane(lane));
            far_x.set_lane(lane, x);
            far_y.set_lane(lane, y);
        }
        let course = Course::new([x, y], [far_x, far_y], far_radius, walls);
        for share in &layering.shares {
            let [x, y] = course.point(*share);
            points.push([scale * x, scale * y]);
            bows.push(scale * course.bow(*share));
        }
    }
    for &(row, column) in &topology.grid {
        let [end, next] = around(row);
        let place = |column: usize, axis: usize| {
            middle(points[column * ends + end][axis], points[column * ends + next][axis])
        };
        if column.is_multiple_of(2) {
            nodes.push([place(column, 0), place(column, 1)]);
            continue;
        }
        // Between two lines half-way between these, but for the bow. The layers of their own line do not matter, so
        // that elements keep their shape where the depth changes quickly.
        let bow = middle(bows[column * ends + end], bows[column * ends + next]);
        let bowed = |axis: usize| {
            let [before, own, behind] = [column - 1, column, column + 1];
            let on_ring = |column: usize| topology.ring_points[column][axis];
            let chord = 0.5 * (on_ring(before) + on_ring(behind));
            middle(place(before, axis), place(behind, axis)) + bow * T::from_f64(on_ring(own) - chord)
        };
        nodes.push([bowed(0), bowed(1)]);
    }
    nodes
}

/// Of a column of the ring.
#[inline(always)]
fn on_ring<T: Bodies>(topology: &RingTopology, column: usize) -> [T; 2] {
    let [x, y] = topology.ring_points[column];
    [T::from_f64(x), T::from_f64(y)]
}

#[inline(always)]
fn middle<T: Bodies>(a: T, b: T) -> T {
    T::from_f64(0.5) * (a + b)
}

/// The course of a line from the ring to its end: near the ring that of a line of a concentric body, whose near field is to
/// be its own, then straight.
///
/// A straight line cannot leave a convex body (but can cut the ring, where it is divided too coarsely for a thin place:
/// assembly refuses such a mesh). One that runs out radially could, where it has to turn by more than the thinnest wall.
struct Course<T> {
    on_ring: [T; 2],
    far: [T; 2],
    far_radius: T,
    /// The share of the way on which the line leaves the radius is 1/`haste`.
    haste: T,
}

/// By how much of the thinnest wall a line's end may lie off its radius before it must make haste to turn there.
pub const LEEWAY: f64 = 0.3;

impl<T: Bodies> Course<T> {
    #[inline(always)]
    fn new(on_ring: [T; 2], far: [T; 2], far_radius: T, wall: T) -> Course<T> {
        let aside = (on_ring[0] * far[1] - on_ring[1] * far[0]).size();
        let (one, turn) = (T::from_f64(1.0), aside / (T::from_f64(LEEWAY) * wall));
        Course { on_ring, far, far_radius, haste: one.if_less(turn, turn, one) }
    }

    /// From 1 at the ring, with no slope, to 0.
    #[inline(always)]
    fn radial_part(&self, share: T) -> T {
        let one = T::from_f64(1.0);
        let way = (share * self.haste).at_most(one);
        (one - way) * (one - way) * (one + T::from_f64(2.0) * way)
    }

    #[inline(always)]
    fn point(&self, share: T) -> [T; 2] {
        let part = self.radial_part(share);
        let radius = on_radius(self.far_radius, share);
        let at = |axis: usize| {
            let straight = self.on_ring[axis] + share * (self.far[axis] - self.on_ring[axis]);
            straight + part * (radius * self.on_ring[axis] - straight)
        };
        [at(0), at(1)]
    }

    /// How far a layer's edge bulges, over the ring's: like a circle near the ring, straight at the end.
    #[inline(always)]
    fn bow(&self, share: T) -> T {
        let (part, one) = (self.radial_part(share), T::from_f64(1.0));
        part * on_radius(self.far_radius, share) + (one - part) * (one - share)
    }
}

/// The point at a distance from the ring's centre, in the direction of an angle from the load line.
pub fn polar(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.sin(), -radius * angle.cos()]
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
