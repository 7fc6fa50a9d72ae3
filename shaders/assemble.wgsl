// Twin: src/mechanics/assembly.rs (stiffness_values), src/mechanics/mesh.rs (coordinates, lines, boundary_angles),
// src/mechanics/layers.rs (growth), element/stiffness.rs (Q8).
//
// From a few numbers of each body to the values of its stiffness.
//
// One workgroup makes one body. Its invocations stride over lines of the mesh, then over halves of its elements, two points each,
// then over the pairs of nodes that have an element in common, four values each. A pair gathers from its elements, so nothing is added
// atomically and a run repeats bit for bit. What a pair reads, of either node in each element, is 32 bytes in f32, in two pieces.
//
// Coordinates are kept as the reach of a node from the ring's node of its line: an element's shape then comes from
// differences of reaches and from the ring's steps, which the host took in f64. Two coordinates are never subtracted,
// so elements far smaller than the body keep their shape in f32.
//
//   grid index = row * column_count + column        rows from the ring (0), columns from the load line, half elements

// Of the bodies of one topology in a dispatch. `_at`: where in a buffer of all topologies that which is of this one begins, in its elements.
struct AssembleParameters {
    // Workgroups of the dispatch before those of this topology.
    first_body: u32,
    // Grid points along the ring, and away from it.
    column_count: u32,
    row_count: u32,
    element_count: u32,
    // Of one body's matrix.
    value_count: u32,
    // Pairs of nodes that have values (`gather::Gather`).
    pair_count: u32,
    // Systems of one body, a multiple of four, or one.
    system_count: u32,
    // Straight sides of the far boundary; 0 where it is round and all lines of a body are alike.
    side_count: u32,
    // Else in plane stress.
    is_plane_strain: u32,
    // At the far boundary, each thinner than the one before.
    shrinking_layers: u32,
    bodies_at: u32,
    shared_numbers_at: u32,
    element_grid_at: u32,
    pair_starts_at: u32,
    sources_at: u32,
    value_places_at: u32,
    geometry_at: u32,
    values_at: u32,
    states_at: u32,
}

// [topology of the dispatch]
@group(0) @binding(0) var<storage, read> topologies: array<AssembleParameters>;
// [body][margin of Poisson's ratio, then the depth of a round boundary, or for each straight side: distance from the
// ring's centre less 1, and but for the last the angle of the corner at its end, and the column that leads there]
@group(0) @binding(1) var<storage, read> bodies: array<wide>;
// Of each topology: (first layer, thickest layer), (sign, pull of the centre), then for each column the ring's
// point, its step to the next point, how far it lies off the chord of its neighbours, and (angle from the load line, 0);
// then the derivatives of the shape functions by (xi, eta), [point][node]; then for each straight side the direction of
// its foot, and (angle of the foot, 1 where the holding changes at the corner at its end).
@group(0) @binding(2) var<storage, read> shared_numbers: array<wide2>;
// Of each topology four lists, each where its parameters say:
// element_grid: [element][node]: grid index.
// pair_starts: [pair]: its first source; the end of the last one closes the list.
// sources: [source]: (element * 8 + the row's node) * 8 + the column's node.
// value_places: [xx, xy, yx, yy][pair]: where it belongs, or NO_PLACE.
@group(0) @binding(3) var<storage, read> lists: array<u32>;
// [body]: of each grid point (its reach, the step to it from the one before on its line); then [element][node][half of the points] the
// gradients by x and y at two points, times sqrt|J|, so that their products have |J|.
@group(0) @binding(4) var<storage, read_write> geometry: array<wide4>;
// [body][value]
@group(0) @binding(5) var<storage, read_write> values: array<wide>;
// [body][system]
@group(0) @binding(6) var<storage, read_write> states: array<SystemState>;

// Of this body's topology.
var<private> parameters: AssembleParameters;

const NODES = 8u;
const POINTS = 4u;
// Two points each.
const HALVES = POINTS / 2u;

var<workgroup> sound_halves: atomic<u32>;
var<workgroup> sound_total: u32;

struct Line {
    depth: wide,
    // From the ring to the far boundary.
    span: wide2,
    // `mesh::Course::haste`; 0 where all lines run along their radii.
    haste: wide,
}

fn shared_at(place: u32) -> wide2 {
    return shared_numbers[parameters.shared_numbers_at + place];
}

fn first_source(pair: u32) -> u32 {
    return lists[parameters.pair_starts_at + pair];
}

fn body_size() -> u32 {
    return select(2u, 3u * parameters.side_count - 1u, parameters.side_count > 0u);
}

fn ring_angle(column: u32) -> wide {
    return shared_at(2u + 3u * parameters.column_count + column).x;
}

// Direct, cross and shear modulus for Young's modulus 1, from 1 + nu in plane stress or 1 - 2 nu in plane strain.
fn elasticity(margin: wide) -> array<wide, 3> {
    if parameters.is_plane_strain != 0u {
        let shear = wide(1.0) / (wide(3.0) - margin);
        return array<wide, 3>((wide(1.0) + margin) * shear / margin, (wide(1.0) - margin) * shear / margin, shear);
    }
    let direct = wide(1.0) / (margin * (wide(2.0) - margin));
    return array<wide, 3>(direct, (margin - wide(1.0)) * direct, wide(0.5) / margin);
}

// How far outside of the ring a line is at a part of its depth, over the ring's radius.
fn beyond_ring(depth: wide, part: wide) -> wide {
    let square = part * part;
    return exp_minus_one(shared_at(1).x * depth * part) - shared_at(1).y * square * square * square;
}

fn holding_changes(side: u32) -> bool {
    return shared_at(2u + 4u * parameters.column_count + POINTS * NODES + 2u * side + 1u).y > wide(0.0);
}

// How far along a side the line of a column ends: in proportion to the ring's angles, but closer to a corner where the
// holding changes.
fn drawn_share(column: u32, side: u32, begin: wide, end: wide, numbers: u32) -> wide {
    let share = (ring_angle(column) - begin) / (end - begin);
    let begins = side > 0u && holding_changes(max(side, 1u) - 1u);
    let ends = holding_changes(side);
    if begins == ends {
        return share;
    }
    let crowding = CROWDING * min(thinnest_wall(numbers) / THICK_WALL, wide(1.0));
    if begins {
        return share * (wide(1.0) - crowding + crowding * share);
    }
    let left = wide(1.0) - share;
    return wide(1.0) - left * (wide(1.0) - crowding + crowding * left);
}

// The line of a column in a body with straight sides.
fn line_to_side(column: u32, numbers: u32) -> Line {
    var side = 0u;
    // Angles of the ring and of the boundary, where the side begins and where it ends.
    var begin = wide2(wide(0.0), wide(0.0));
    let last = ring_angle(parameters.column_count - 1u);
    var end = wide2(last, last);
    for (var corner = 0u; corner < parameters.side_count - 1u; corner++) {
        let at = numbers + 2u + 3u * corner;
        let corner_column = u32(bodies[at + 1u]);
        let angles = wide2(ring_angle(corner_column), bodies[at]);
        if column <= corner_column {
            end = angles;
            break;
        }
        begin = angles;
        side = corner + 1u;
    }
    let foot = 2u + 4u * parameters.column_count + POINTS * NODES + 2u * side;
    let outward = shared_at(foot);
    let sideways = wide2(-outward.y, outward.x);
    // A mid-side line ends half-way between its neighbours.
    let before = drawn_share(column - column % 2u, side, begin.x, end.x, numbers);
    let after = drawn_share(column + column % 2u, side, begin.x, end.x, numbers);
    let turned = begin.y - shared_at(foot + 1u).x + wide(0.5) * (before + after) * (end.y - begin.y);
    let beyond = bodies[numbers + 1u + 3u * side];
    let along = (wide(1.0) + beyond) * tangent(turned);
    // |far|^2 - 1, and far - ring outward and sideways, so that a thin wall keeps its digits: 1 - cos = sin^2/(1 + cos).
    let depth = wide(0.5) * logarithm_of_one_plus(beyond * (wide(2.0) + beyond) + along * along);
    let on_ring = shared_at(2u + column);
    let cosine = on_ring.x * outward.x + on_ring.y * outward.y;
    let sine = on_ring.x * sideways.x + on_ring.y * sideways.y;
    let span = (beyond + sine * sine / (wide(1.0) + cosine)) * outward + (along - sine) * sideways;
    let aside = abs(on_ring.x * span.y - on_ring.y * span.x);
    return Line(depth, span, max(aside / (LEEWAY * thinnest_wall(numbers)), wide(1.0)));
}

fn thinnest_wall(numbers: u32) -> wide {
    var least = bodies[numbers + 1u];
    for (var side = 1u; side < parameters.side_count; side++) {
        least = min(least, bodies[numbers + 1u + 3u * side]);
    }
    return least;
}

// Depth of all layers that grow by a factor, and d ln depth/d ln growth: only layers below the thickest grow with it.
fn depth_and_power(growth: wide) -> wide2 {
    let layers = parameters.row_count / 2u;
    var depth = wide(0.0);
    var moment = wide(0.0);
    var grown = shared_at(0).x;
    var part = wide(1.0);
    for (var layer = 0u; layer < layers; layer++) {
        if layers - layer <= parameters.shrinking_layers {
            part *= SHRINK;
        }
        depth += part * grown;
        if grown < shared_at(0).y {
            moment += wide(layer) * part * grown;
        }
        grown = min(grown * growth, shared_at(0).y);
    }
    return wide2(depth, moment / depth);
}

// The one factor by which layers grow, from the first on and up to the thickest allowed, to be `depth` in all.
fn layer_growth(depth: wide) -> wide {
    var low = wide(0.0);
    var high = STEEPEST;
    var growth = wide(1.0);
    for (var steps = 0u; steps < MOST_STEPS; steps++) {
        let at = depth_and_power(growth);
        if at.x < depth {
            low = growth;
        } else {
            high = growth;
        }
        let ratio = depth / at.x;
        let over = (at.y + wide(1.0)) * ratio + at.y - wide(1.0);
        let under = (at.y - wide(1.0)) * ratio + at.y + wide(1.0);
        var next = wide(-1.0);
        if under > wide(0.0) {
            next = growth * over / under;
        }
        // Rounding may take the last step out of the bracket, the far end of which is anywhere.
        if abs(next - growth) <= select(SINGLE_TOLERANCE, TOLERANCE, IS_WIDE_DOUBLE) * growth {
            return next;
        }
        if next < low || next > high {
            next = select(wide(2.0) * growth, wide(0.5) * (low + high), high < STEEPEST);
        }
        growth = next;
        // At an end of the bracket once more: no number is better.
        if next == low || next == high {
            break;
        }
    }
    return growth;
}

fn sixth_power(value: wide) -> wide {
    let square = value * value;
    return square * square * square;
}

// `mesh::Course::radial_part`.
fn radial_part(line: Line, share: wide) -> wide {
    let way = min(share * line.haste, wide(1.0));
    let left = wide(1.0) - way;
    return left * left * (wide(1.0) + wide(2.0) * way);
}

// Reaches of all grid points of a line, and steps to them from the points before: `mesh::Course::point`. In a body with straight
// sides a mid-side line has (1 less its bow, 0) instead of its reaches, for `bow`.
fn reach_of_line(column: u32, numbers: u32, grid: u32) {
    var line: Line;
    if parameters.side_count > 0u {
        line = line_to_side(column, numbers);
    } else {
        let depth = bodies[numbers + 1u];
        line = Line(depth, beyond_ring(depth, wide(1.0)) * shared_at(2u + column), wide(0.0));
    }
    let is_radial = line.haste == wide(0.0);
    let growth = layer_growth(line.depth);
    // The growth factor is only as good as its search; the far boundary is where it is.
    let total = depth_and_power(growth).x;
    let far = beyond_ring(line.depth, wide(1.0));
    let aside = far * shared_at(2u + column) - line.span;
    var thickness = shared_at(0).x;
    var shrunk = wide(1.0);
    // Of the way: by depth, and by distance; and the distance from the ring's centre.
    var reached = wide(0.0);
    var share = wide(0.0);
    var distance = wide(1.0);
    var part = wide(1.0);
    var reach = wide2(wide(0.0), wide(0.0));
    var less = wide(0.0);
    geometry[grid + column] = wide4();
    for (var layer = 0u; layer < parameters.row_count / 2u; layer++) {
        // From one point to the next, so that thin layers far from the ring keep their digits.
        if parameters.row_count / 2u - layer <= parameters.shrinking_layers {
            shrunk *= SHRINK;
        }
        let deeper = thickness * shrunk / total;
        thickness = min(thickness * growth, shared_at(0).y);
        let farther = distance * exp_minus_one(shared_at(1).x * line.depth * deeper);
        let pulled = shared_at(1).y * (sixth_power(reached + deeper) - sixth_power(reached));
        let more = (farther - pulled) / far;
        reached += deeper;
        distance += farther;
        var step = more * line.span;
        let row = 2u * layer * parameters.column_count + column;
        if !is_radial {
            let part_before = part;
            part = radial_part(line, share + more);
            step += (more * part + share * (part - part_before)) * aside;
        }
        share += more;
        let half = wide(0.5) * step;
        var middle = reach + half;
        var end = reach + step;
        reach = end;
        if !is_radial && column % 2u == 1u {
            let before = less;
            less = share * (wide(1.0) - part * (wide(1.0) + far));
            middle = wide2(wide(0.5) * (before + less), wide(0.0));
            end = wide2(less, wide(0.0));
        }
        geometry[grid + row + parameters.column_count] = wide4(middle, half);
        geometry[grid + row + 2u * parameters.column_count] = wide4(end, half);
    }
}

// Half-way between the lines of corner nodes, but for the bow.
fn bow(column: u32, grid: u32) {
    let sagitta = shared_at(2u + 2u * parameters.column_count + column);
    var less_before = wide(0.0);
    for (var row = 0u; row < parameters.row_count; row++) {
        let place = grid + row * parameters.column_count + column;
        let less = geometry[place].x;
        // Reach and step alike; there is no step to the ring.
        let change = select(less - less_before, wide(0.0), row == 0u);
        let bows = wide4(less * sagitta, change * sagitta);
        geometry[place] = wide(0.5) * (geometry[place - 1u] + geometry[place + 1u]) - bows;
        less_before = less;
    }
}

// Gradients of the shape functions by x and y at two points of one element, times sqrt|J|; whether |J| > 0 at both.
fn gradients(item: u32, grid: u32, nodes: u32) -> bool {
    let element = item / HALVES;
    let half = item % HALVES;
    let own_grid = parameters.element_grid_at + element * NODES;
    let rule = 2u + 4u * parameters.column_count + half * 2u * NODES;
    let corners = vec2<u32>(lists[own_grid], lists[own_grid + 1u]);
    // Where the element begins: nearest to the ring, and to the load line.
    let first_row = min(corners.x, corners.y) / parameters.column_count;
    let first_column = corners.x % parameters.column_count;
    let row_place = grid + first_row * parameters.column_count;
    // (x, y) at one point, (x, y) at the other.
    var by_xi = wide4();
    var by_eta = wide4();
    for (var node = 0u; node < NODES; node++) {
        let at = lists[own_grid + node];
        let own_column = at % parameters.column_count;
        var place = geometry[row_place + own_column].xy - geometry[row_place + first_column].xy;
        for (var column = first_column; column < own_column; column++) {
            place += shared_at(2u + parameters.column_count + column);
        }
        for (var row = first_row + 1u; row <= at / parameters.column_count; row++) {
            place += geometry[grid + row * parameters.column_count + own_column].zw;
        }
        let a = shared_at(rule + node);
        let b = shared_at(rule + NODES + node);
        by_xi += wide4(a.x * place, b.x * place);
        by_eta += wide4(a.y * place, b.y * place);
    }
    let determinants = by_xi.xz * by_eta.yw - by_xi.yw * by_eta.xz;
    let scales = wide(1.0) / sqrt(determinants);
    by_xi *= scales.xxyy;
    by_eta *= scales.xxyy;
    for (var node = 0u; node < NODES; node++) {
        let a = shared_at(rule + node);
        let b = shared_at(rule + NODES + node);
        geometry[nodes + (element * NODES + node) * HALVES + half] = wide4(
            by_eta.y * a.x - by_xi.y * a.y,
            by_xi.x * a.y - by_eta.x * a.x,
            by_eta.w * b.x - by_xi.w * b.y,
            by_xi.z * b.y - by_eta.z * b.x,
        );
    }
    return all(determinants > wide2()) && is_finite(determinants.x) && is_finite(determinants.y);
}

// Of the gradients of a source's two nodes the products xx, xy, yx and yy, summed over the points.
fn products(source: u32, nodes: u32) -> wide4 {
    let row = nodes + source / NODES * HALVES;
    let column = nodes + (source / (NODES * NODES) * NODES + source % NODES) * HALVES;
    let a = geometry[row];
    let b = geometry[column];
    let c = geometry[row + 1u];
    let d = geometry[column + 1u];
    return a.xxyy * b.xyxy + a.zzww * b.zwzw + c.xxyy * d.xyxy + c.zzww * d.zwzw;
}

fn put(value: wide, of_pair: u32, pair: u32, body_values: u32) {
    let place = lists[parameters.value_places_at + of_pair * parameters.pair_count + pair];
    if place != NO_PLACE {
        values[body_values + place] = value;
    }
}

@compute @workgroup_size(INVOCATIONS)
fn assemble(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    parameters = topologies[topology_of(group.x)];
    // Of its topology in the dispatch.
    let body = group.x - parameters.first_body;
    let grid_size = parameters.row_count * parameters.column_count;
    let half_count = HALVES * parameters.element_count;
    let numbers = parameters.bodies_at + body * body_size();
    let grid = parameters.geometry_at + body * (grid_size + NODES * half_count);
    let nodes = grid + grid_size;

    // The memory of a workgroup begins with anything.
    if invocation == 0u {
        atomicStore(&sound_halves, 0u);
    }
    for (var column = invocation; column < parameters.column_count; column += INVOCATIONS) {
        reach_of_line(column, numbers, grid);
    }
    storageBarrier();
    workgroupBarrier();
    if parameters.side_count > 0u {
        for (var column = 2u * invocation + 1u; column < parameters.column_count; column += 2u * INVOCATIONS) {
            bow(column, grid);
        }
    }
    storageBarrier();
    workgroupBarrier();
    for (var item = invocation; item < half_count; item += INVOCATIONS) {
        if gradients(item, grid, nodes) {
            atomicAdd(&sound_halves, 1u);
        }
    }
    storageBarrier();
    workgroupBarrier();
    if invocation == 0u {
        sound_total = atomicLoad(&sound_halves);
    }
    let outcome = select(INVERTED, RUNNING, workgroupUniformLoad(&sound_total) == half_count);
    let moduli = elasticity(bodies[numbers]);
    let along = wide4(moduli[0], moduli[1], moduli[1], moduli[0]);
    let body_values = parameters.values_at + body * parameters.value_count;
    for (var pair = invocation; pair < parameters.pair_count; pair += INVOCATIONS) {
        var sum = wide4();
        let end = first_source(pair + 1u);
        for (var source = first_source(pair); source < end; source++) {
            sum += products(lists[parameters.sources_at + source], nodes);
        }
        // Sum over points of |J| B^T D B.
        let block = along * sum + moduli[2] * sum.wzyx;
        put(block.x, 0u, pair, body_values);
        put(block.y, 1u, pair, body_values);
        put(block.z, 2u, pair, body_values);
        put(block.w, 3u, pair, body_values);
    }
    for (var system = invocation; system < parameters.system_count; system += INVOCATIONS) {
        states[parameters.states_at + body * parameters.system_count + system] = SystemState(outcome, 0u);
    }
}
