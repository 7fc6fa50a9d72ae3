// Twin: src/mechanics/assembly.rs (stiffness_values), src/mechanics/mesh.rs (coordinates), element/stiffness.rs (Q8).
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

struct AssembleParameters {
    // Grid points along the ring, and away from it.
    column_count: u32,
    row_count: u32,
    element_count: u32,
    // Of one body's matrix.
    value_count: u32,
    // Systems of one body, a multiple of four.
    system_count: u32,
    // 1 where all lines of a body are alike, else `column_count`.
    line_count: u32,
    // Whether mid-side lines lie half-way between their neighbours.
    is_bowed: u32,
    // Else in plane stress.
    is_plane_strain: u32,
}

@group(0) @binding(0) var<uniform> parameters: AssembleParameters;
// [body][margin of Poisson's ratio, then for each line: depth, growth, scale, and where lines are bowed turn]
@group(0) @binding(1) var<storage, read> bodies: array<wide>;
// Shared by the topology: (first layer, thickest layer), (sign, pull of the centre), then for each column the ring's
// point, its step to the next point, and how far it lies off the chord of its neighbours; then the derivatives of the
// shape functions by (xi, eta), [point][node].
@group(0) @binding(2) var<storage, read> shared_numbers: array<wide2>;
// [element][node]: grid index.
@group(0) @binding(3) var<storage, read> element_grid: array<u32>;
// [value]: its first source; the end of the last one closes the list.
@group(0) @binding(4) var<storage, read> source_starts: array<u32>;
// [source]: (element * 16 + i) * 16 + j of the element entry that is added.
@group(0) @binding(5) var<storage, read> sources: array<u32>;
// [body][reach of each grid point, then of each point of each element 8 gradients and (|J|, 0)]
@group(0) @binding(6) var<storage, read_write> geometry: array<wide2>;
// [body][value]
@group(0) @binding(7) var<storage, read_write> values: array<wide>;
// [body][system]
@group(0) @binding(8) var<storage, read_write> states: array<SystemState>;

const NODES = 8u;
const POINTS = 4u;
// Gradients and |J| of one point.
const POINT_SIZE = 9u;

var<workgroup> sound_points: atomic<u32>;
var<workgroup> sound_total: u32;

// Numbers of a line.
fn line_size() -> u32 {
    return select(3u, 4u, parameters.is_bowed != 0u);
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

// Reaches of all grid points of a line. Where lines are bowed, a mid-side line has (share, 0) instead, for `bow`.
fn reach_of_line(column: u32, numbers: u32, grid: u32) {
    let line = numbers + 1u + line_size() * min(column, parameters.line_count - 1u);
    let depth = bodies[line];
    let growth = bodies[line + 1u];
    let on_ring = shared_numbers[2u + column];
    var span = bodies[line + 2u] * on_ring;
    if parameters.is_bowed != 0u {
        span += bodies[line + 3u] * wide2(-on_ring.y, on_ring.x);
        if column % 2u == 1u {
            span = wide2(wide(1.0), wide(0.0));
        }
    }
    let first_layer = shared_numbers[0].x;
    let thickest = shared_numbers[0].y;
    let sign = shared_numbers[1].x;
    let pull = shared_numbers[1].y;
    let layer_count = parameters.row_count / 2u;
    // The growth factor is only as good as the host's bisection; the far boundary is where it is.
    var total = wide(0.0);
    var thickness = first_layer;
    for (var layer = 0u; layer < layer_count; layer++) {
        total += thickness;
        thickness = min(thickness * growth, thickest);
    }
    let far = exp_minus_one(sign * depth) - pull;
    var reached = wide(0.0);
    var share_before = wide(0.0);
    thickness = first_layer;
    geometry[grid + column] = wide2(wide(0.0), wide(0.0));
    for (var layer = 0u; layer < layer_count; layer++) {
        reached += thickness;
        thickness = min(thickness * growth, thickest);
        let part = reached / total;
        let share = (exp_minus_one(sign * depth * part) - pull * part * part) / far;
        let row = grid + 2u * layer * parameters.column_count + column;
        geometry[row + parameters.column_count] = wide(0.5) * (share_before + share) * span;
        geometry[row + 2u * parameters.column_count] = share * span;
        share_before = share;
    }
}

// Half-way between the lines of corner nodes, bowed at the ring and straight at the far boundary.
fn bow(column: u32, grid: u32) {
    let sagitta = shared_numbers[2u + 2u * parameters.column_count + column];
    for (var row = 0u; row < parameters.row_count; row++) {
        let place = grid + row * parameters.column_count + column;
        let share = geometry[place].x;
        geometry[place] = wide(0.5) * (geometry[place - 1u] + geometry[place + 1u]) - share * sagitta;
    }
}

// Gradients of the shape functions by x and y, and |J|, at one point of one element; whether |J| > 0.
fn gradients(item: u32, grid: u32, points: u32) -> bool {
    let element = item / POINTS;
    let rule = 2u + 3u * parameters.column_count + (item % POINTS) * NODES;
    let origin = element_grid[element * NODES];
    let first_column = origin % parameters.column_count;
    var by_xi = wide2(wide(0.0), wide(0.0));
    var by_eta = wide2(wide(0.0), wide(0.0));
    for (var node = 0u; node < NODES; node++) {
        let at = element_grid[element * NODES + node];
        var place = geometry[grid + at] - geometry[grid + origin];
        // The first node lies on the first of the element's lines.
        for (var column = first_column; column < at % parameters.column_count; column++) {
            place += shared_numbers[2u + parameters.column_count + column];
        }
        let derivative = shared_numbers[rule + node];
        by_xi += derivative.x * place;
        by_eta += derivative.y * place;
    }
    let determinant = by_xi.x * by_eta.y - by_xi.y * by_eta.x;
    let inverse = wide(1.0) / determinant;
    let out = points + item * POINT_SIZE;
    for (var node = 0u; node < NODES; node++) {
        let derivative = shared_numbers[rule + node];
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
    let body = group.x;
    let grid_size = parameters.row_count * parameters.column_count;
    let point_count = POINTS * parameters.element_count;
    let numbers = body * (1u + line_size() * parameters.line_count);
    let grid = body * (grid_size + point_count * POINT_SIZE);
    let points = grid + grid_size;

    // The memory of a workgroup begins with anything.
    if invocation == 0u {
        atomicStore(&sound_points, 0u);
    }
    for (var column = invocation; column < parameters.column_count; column += INVOCATIONS) {
        reach_of_line(column, numbers, grid);
    }
    storageBarrier();
    workgroupBarrier();
    if parameters.is_bowed != 0u {
        for (var column = 2u * invocation + 1u; column < parameters.column_count; column += 2u * INVOCATIONS) {
            bow(column, grid);
        }
    }
    storageBarrier();
    workgroupBarrier();
    for (var item = invocation; item < point_count; item += INVOCATIONS) {
        if gradients(item, grid, points) {
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
        for (var source = source_starts[value]; source < source_starts[value + 1u]; source++) {
            sum += entry(sources[source], moduli, points);
        }
        values[body * parameters.value_count + value] = sum;
    }
    for (var system = invocation; system < parameters.system_count; system += INVOCATIONS) {
        states[body * parameters.system_count + system] = SystemState(outcome, 0u);
    }
}
