//! Coordinates of meshes: lines run from the contact ring to a body's far boundary and are divided into layers. Several bodies of one topology
//! abreast, or one alone to the same bits.

use crate::mechanics::body::{Body, Side};
use crate::mechanics::layers::Layers;
use crate::mechanics::lining_rows::BodyRows;
use crate::mechanics::mesh::{Grading, RingTopology, corner_columns, half_steps, holding_changes, polar};
use crate::mechanics::real::Bodies;

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
        let centre_pull = if shape.reaches_centre {
            Some((rest.each(|_, body| centre_pull(body)), rest.each(|_, body| deepest(body))))
        } else {
            None
        };
        let nothing = T::from_f64(f64::NAN);
        Layering {
            rest,
            side: shape.side,
            layers,
            first,
            centre_pull,
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
        if column.is_multiple_of(2) {
            nodes.push(between(&points, column * ends + end, column * ends + next));
            continue;
        }
        // Between two lines half-way between these, but for the bow. The layers of their own line do not matter, so
        // that elements keep their shape where the depth changes quickly.
        let bow = middle(bows[column * ends + end], bows[column * ends + next]);
        let [before, behind] = [(column - 1) * ends, (column + 1) * ends];
        let [before, behind] =
            [between(&points, before + end, before + next), between(&points, behind + end, behind + next)];
        let mut node = [bow; 2];
        for (axis, node) in node.iter_mut().enumerate() {
            let on_ring = |column: usize| topology.ring_points[column][axis];
            let chord = 0.5 * (on_ring(column - 1) + on_ring(column + 1));
            *node = middle(before[axis], behind[axis]) + bow * T::from_f64(on_ring(column) - chord);
        }
        nodes.push(node);
    }
    nodes
}

/// Half-way between two of the points. (A closure that is called in several places would be a function of its own, which is not compiled for
/// the vectors.)
#[inline(always)]
fn between<T: Bodies>(points: &[[T; 2]], a: usize, b: usize) -> [T; 2] {
    [middle(points[a][0], points[b][0]), middle(points[a][1], points[b][1])]
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
    let columns = corner_columns(&corners, angles);
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
