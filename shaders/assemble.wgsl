// Twin: src/mechanics/assembly.rs (stiffness_values), src/mechanics/mesh.rs (coordinates, lines, boundary_angles),
// src/mechanics/layers.rs (growth), element/stiffness.rs (Q8).
//
// From a few numbers of each body to the values of its stiffness.
//
// One workgroup makes one body. Its invocations stride over lines of the mesh, then over the points of its elements,
// then over the values of the matrix; every value gathers from its elements, so nothing is added atomically and a run
// repeats bit for bit.
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
    source_starts_at: u32,
    sources_at: u32,
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
// Of each topology three lists, each where its parameters say:
// element_grid: [element][node]: grid index.
// source_starts: [value]: its first source; the end of the last one closes the list.
// sources: [source]: (element * 16 + i) * 16 + j of the element entry that is added.
@group(0) @binding(3) var<storage, read> lists: array<u32>;
// [body][reach of each grid point, step to each from the one before on its line, then of each point of each element 8 gradients
// and (|J|, 0)]
@group(0) @binding(4) var<storage, read_write> geometry: array<wide2>;
// [body][value]
@group(0) @binding(5) var<storage, read_write> values: array<wide>;
// [body][system]
@group(0) @binding(6) var<storage, read_write> states: array<SystemState>;

// Of this body's topology.
var<private> parameters: AssembleParameters;

const NODES = 8u;
const POINTS = 4u;
// Gradients and |J| of one point.
const POINT_SIZE = 9u;

var<workgroup> sound_points: atomic<u32>;
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

fn source_start(value: u32) -> u32 {
    return lists[parameters.source_starts_at + value];
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
        if next < low || next > high {
            next = select(wide(2.0) * growth, wide(0.5) * (low + high), high < STEEPEST);
        }
        let step = abs(next - growth);
        growth = next;
        // At an end of the bracket once more: no number is better.
        if step <= TOLERANCE * growth || next == low || next == high {
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
fn reach_of_line(column: u32, numbers: u32, grid: u32, steps: u32) {
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
    geometry[grid + column] = reach;
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
        let own = reach + step;
        if !is_radial && column % 2u == 1u {
            let before = geometry[grid + row].x;
            let less = share * (wide(1.0) - part * (wide(1.0) + far));
            geometry[grid + row + parameters.column_count] = wide2(wide(0.5) * (before + less), wide(0.0));
            geometry[grid + row + 2u * parameters.column_count] = wide2(less, wide(0.0));
        } else {
            geometry[grid + row + parameters.column_count] = reach + wide(0.5) * step;
            geometry[grid + row + 2u * parameters.column_count] = own;
        }
        geometry[steps + row + parameters.column_count] = wide(0.5) * step;
        geometry[steps + row + 2u * parameters.column_count] = wide(0.5) * step;
        reach = own;
    }
}

// Half-way between the lines of corner nodes, but for the bow.
fn bow(column: u32, grid: u32, steps: u32) {
    let sagitta = shared_at(2u + 2u * parameters.column_count + column);
    var less_before = wide(0.0);
    for (var row = 0u; row < parameters.row_count; row++) {
        let at = row * parameters.column_count + column;
        let place = grid + at;
        let less = geometry[place].x;
        geometry[place] = wide(0.5) * (geometry[place - 1u] + geometry[place + 1u]) - less * sagitta;
        if row > 0u {
            let neighbours = geometry[steps + at - 1u] + geometry[steps + at + 1u];
            geometry[steps + at] = wide(0.5) * neighbours - (less - less_before) * sagitta;
        }
        less_before = less;
    }
}

// Gradients of the shape functions by x and y, and |J|, at one point of one element; whether |J| > 0.
fn gradients(item: u32, grid: u32, steps: u32, points: u32) -> bool {
    let element = item / POINTS;
    let rule = 2u + 4u * parameters.column_count + (item % POINTS) * NODES;
    let corners = vec2<u32>(lists[parameters.element_grid_at + element * NODES], lists[parameters.element_grid_at + element * NODES + 1u]);
    // Where the element begins: nearest to the ring, and to the load line.
    let first_row = min(corners.x, corners.y) / parameters.column_count;
    let first_column = corners.x % parameters.column_count;
    let row_place = grid + first_row * parameters.column_count;
    var by_xi = wide2(wide(0.0), wide(0.0));
    var by_eta = wide2(wide(0.0), wide(0.0));
    for (var node = 0u; node < NODES; node++) {
        let at = lists[parameters.element_grid_at + element * NODES + node];
        let own_column = at % parameters.column_count;
        var place = geometry[row_place + own_column] - geometry[row_place + first_column];
        for (var column = first_column; column < own_column; column++) {
            place += shared_at(2u + parameters.column_count + column);
        }
        for (var row = first_row + 1u; row <= at / parameters.column_count; row++) {
            place += geometry[steps + row * parameters.column_count + own_column];
        }
        let derivative = shared_at(rule + node);
        by_xi += derivative.x * place;
        by_eta += derivative.y * place;
    }
    let determinant = by_xi.x * by_eta.y - by_xi.y * by_eta.x;
    let inverse = wide(1.0) / determinant;
    let out = points + item * POINT_SIZE;
    for (var node = 0u; node < NODES; node++) {
        let derivative = shared_at(rule + node);
        geometry[out + node] = inverse * wide2(
            by_eta.y * derivative.x - by_xi.y * derivative.y,
            by_xi.x * derivative.y - by_eta.x * derivative.x,
        );
    }
    geometry[out + NODES] = wide2(determinant, wide(0.0));
    return is_finite(determinant) && determinant > wide(0.0);
}

// Entry (i, j) of an element's stiffness: sum over points of |J| B_i^T D B_j.
fn entry(source: u32, moduli: array<wide, 3>, points: u32) -> wide {
    let element = source / 256u;
    let i = (source / 16u) % 16u;
    let j = source % 16u;
    let is_direct = i % 2u == j % 2u;
    let along = select(moduli[1], moduli[0], is_direct);
    let shear = moduli[2];
    var sum = wide(0.0);
    for (var point = 0u; point < POINTS; point++) {
        let at = points + (element * POINTS + point) * POINT_SIZE;
        let a = geometry[at + i / 2u];
        let b = geometry[at + j / 2u];
        let determinant = geometry[at + NODES].x;
        // Written out by component: one may not index a value by a variable everywhere.
        let a_own = select(a.x, a.y, i % 2u == 1u);
        let a_other = select(a.y, a.x, i % 2u == 1u);
        let b_own = select(b.x, b.y, j % 2u == 1u);
        let b_other = select(b.y, b.x, j % 2u == 1u);
        sum += a_own * (along * determinant * b_own) + a_other * (shear * determinant * b_other);
    }
    return sum;
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
    let point_count = POINTS * parameters.element_count;
    let numbers = parameters.bodies_at + body * body_size();
    let grid = parameters.geometry_at + body * (2u * grid_size + point_count * POINT_SIZE);
    let steps = grid + grid_size;
    let points = steps + grid_size;

    // The memory of a workgroup begins with anything.
    if invocation == 0u {
        atomicStore(&sound_points, 0u);
    }
    for (var column = invocation; column < parameters.column_count; column += INVOCATIONS) {
        reach_of_line(column, numbers, grid, steps);
    }
    storageBarrier();
    workgroupBarrier();
    if parameters.side_count > 0u {
        for (var column = 2u * invocation + 1u; column < parameters.column_count; column += 2u * INVOCATIONS) {
            bow(column, grid, steps);
        }
    }
    storageBarrier();
    workgroupBarrier();
    for (var item = invocation; item < point_count; item += INVOCATIONS) {
        if gradients(item, grid, steps, points) {
            atomicAdd(&sound_points, 1u);
        }
    }
    storageBarrier();
    workgroupBarrier();
    if invocation == 0u {
        sound_total = atomicLoad(&sound_points);
    }
    let moduli = elasticity(bodies[numbers]);
    let outcome = select(INVERTED, RUNNING, workgroupUniformLoad(&sound_total) == point_count);
    for (var value = invocation; value < parameters.value_count; value += INVOCATIONS) {
        var sum = wide(0.0);
        for (var source = source_start(value); source < source_start(value + 1u); source++) {
            sum += entry(lists[parameters.sources_at + source], moduli, points);
        }
        values[parameters.values_at + body * parameters.value_count + value] = sum;
    }
    for (var system = invocation; system < parameters.system_count; system += INVOCATIONS) {
        states[parameters.states_at + body * parameters.system_count + system] = SystemState(outcome, 0u);
    }
}
