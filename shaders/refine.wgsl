// Twin: src/mechanics/solve/refine.rs.
//
// Rounds around the iteration of pcg.wgsl. `start` once; then in each round `solve` until it has stopped, and
// `refine`, or `settle` in the last: x += d, the residual b - K x, and whether the system has ended. All of it in
// `wide`: the iteration solves K d = (b - K x)/scale in `real`, so that small residuals do not underflow.
//
// One workgroup owns four systems of one body. Its invocations stride over the rows.
//
// A system whose iteration broke down keeps the x of the round before.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [slice of SLICE rows]: its first value; the end of the last one closes the list. In a slice the first values of all
// rows come first, then the second ones and so on.
@group(0) @binding(1) var<storage, read> slice_starts: array<u32>;
// [value of one matrix]
@group(0) @binding(2) var<storage, read> columns: array<u32>;
// [row]: the value on its diagonal.
@group(0) @binding(3) var<storage, read> diagonal_places: array<u32>;
// [body][value]
@group(0) @binding(4) var<storage, read> values: array<wide>;
// [body][block][p, q, r, d][unknown]
@group(0) @binding(5) var<storage, read_write> iterates: array<real4>;
// [body][block][rho = r.M^-1 r, at last over that of the round's begin; |b|; |b - K x|/|b|]
@group(0) @binding(6) var<storage, read_write> norms: array<wide4>;
// [body][block][system]
@group(0) @binding(7) var<storage, read_write> states: array<SystemState>;
// [body][block][x, b - K x][unknown]
@group(0) @binding(8) var<storage, read_write> solutions: array<wide4>;

// Four systems, as their workgroup holds them.
struct Systems {
    norm_b: wide4,
    // |b - K x|/|b|
    distance: wide4,
    outcome: vec4<u32>,
    iterations: vec4<u32>,
}

var<workgroup> held: Systems;

// Where a block's numbers are.
struct Place {
    block: u32,
    first_value: u32,
    // Of the block's vectors.
    iterates: u32,
    solutions: u32,
}

fn place_of(group: vec3<u32>) -> Place {
    let block = group.x * parameters.block_count + group.y;
    let size = parameters.unknown_count;
    return Place(block, group.x * parameters.value_count, 4u * size * block, 2u * size * block);
}

// Unit forces on the ring's unknowns of this block.
fn load_at(row: u32, block_of_body: u32) -> wide4 {
    var load = wide4();
    let ring = row - parameters.ring_start;
    if row >= parameters.ring_start && ring / 4u == block_of_body {
        load[ring % 4u] = wide(1.0);
    }
    return load;
}

fn load_systems(block: u32) -> Systems {
    var systems: Systems;
    systems.norm_b = norms[3u * block + 1u];
    systems.distance = norms[3u * block + 2u];
    for (var system = 0u; system < 4u; system++) {
        let state = states[4u * block + system];
        systems.outcome[system] = state.outcome;
        systems.iterations[system] = state.iterations;
    }
    return systems;
}

fn store_systems(block: u32, systems: Systems) {
    norms[3u * block + 1u] = systems.norm_b;
    norms[3u * block + 2u] = systems.distance;
    var stored = systems;
    for (var system = 0u; system < 4u; system++) {
        states[4u * block + system] = SystemState(stored.outcome[system], stored.iterations[system]);
    }
}

// d = 0, r = (b - K x)/scale, p = M^-1 r of the systems that go on; nothing of the others, whose r may be NaN.
fn begin_round(place: Place, invocation: Invocation, systems: Systems) {
    let size = parameters.unknown_count;
    let is_running = systems.outcome == vec4<u32>(RUNNING);
    let scale = power_of_two(systems.distance * systems.norm_b);
    var own = wide4();
    for (var row = invocation.index; row < size; row += INVOCATIONS) {
        let scaled = real4(solutions[place.solutions + size + row] / scale);
        let r = select(real4(), scaled, is_running);
        let z = r / real(values[place.first_value + diagonal_places[row]]);
        iterates[place.iterates + row] = z;
        iterates[place.iterates + 2u * size + row] = r;
        iterates[place.iterates + 3u * size + row] = real4();
        own += wide4(r * z);
    }
    let rho = sum_of_workgroup(invocation, own);
    if invocation.index == 0u {
        let kept = norms[3u * place.block];
        norms[3u * place.block] = select(kept, rho, is_running);
    }
}

// x = 0; systems that assembly refused stay refused.
@compute @workgroup_size(INVOCATIONS)
fn start(invocation: Invocation) {
    let place = place_of(invocation.group);
    let size = parameters.unknown_count;
    if invocation.index == 0u {
        held = load_systems(place.block);
    }
    var systems = workgroupUniformLoad(&held);
    var own = wide4();
    var own_not_positive = wide4();
    for (var row = invocation.index; row < size; row += INVOCATIONS) {
        let diagonal = values[place.first_value + diagonal_places[row]];
        if is_finite(diagonal) && diagonal <= wide(0.0) {
            own_not_positive += wide4(wide(1.0));
        }
        let load = load_at(row, invocation.group.y);
        solutions[place.solutions + row] = wide4();
        solutions[place.solutions + size + row] = load;
        own += load * (load / diagonal);
    }
    systems.norm_b = sqrt(sum_of_workgroup(invocation, own));
    let has_bad_diagonal = sum_of_workgroup(invocation, own_not_positive).x > wide(0.0);
    // A load of zero is solved by zero.
    systems.distance = select(wide4(wide(1.0)), wide4(), systems.norm_b == wide4());
    systems.iterations = vec4<u32>();
    for (var system = 0u; system < 4u; system++) {
        if systems.outcome[system] == INVERTED {
            continue;
        }
        let is_sound = is_finite(systems.norm_b[system]);
        systems.outcome[system] = select(select(NOT_FINITE, RUNNING, is_sound), INDEFINITE, has_bad_diagonal);
    }
    if invocation.index == 0u {
        store_systems(place.block, systems);
    }
    begin_round(place, invocation, systems);
}

// What becomes of a running system at the end of a round.
fn judged(distance: wide, iterations: u32, is_last: bool) -> u32 {
    if !is_finite(distance) {
        return NOT_FINITE;
    }
    if distance <= wide(parameters.goal) {
        return CONVERGED;
    }
    if iterations >= parameters.iteration_limit {
        return ITERATION_LIMIT;
    }
    return select(RUNNING, STAGNATED, is_last);
}

fn end_round(invocation: Invocation, is_last: bool) {
    let place = place_of(invocation.group);
    let size = parameters.unknown_count;
    if invocation.index == 0u {
        held = load_systems(place.block);
    }
    var systems = workgroupUniformLoad(&held);
    var was_running = systems.outcome == vec4<u32>(RUNNING);
    if !any(was_running) {
        return;
    }
    let begin = systems.distance * systems.norm_b;
    let scale = power_of_two(begin);
    for (var row = invocation.index; row < size; row += INVOCATIONS) {
        let step = scale * wide4(iterates[place.iterates + 3u * size + row]);
        solutions[place.solutions + row] += select(wide4(), step, was_running);
    }
    storageBarrier();
    workgroupBarrier();
    var own = wide4();
    for (var row = invocation.index; row < size; row += INVOCATIONS) {
        var sum = load_at(row, invocation.group.y);
        let end = slice_starts[row / SLICE + 1u];
        for (var entry = slice_starts[row / SLICE] + row % SLICE; entry < end; entry += SLICE) {
            sum -= values[place.first_value + entry] * solutions[place.solutions + columns[entry]];
        }
        solutions[place.solutions + size + row] = sum;
        own += sum * (sum / values[place.first_value + diagonal_places[row]]);
    }
    let norm = sqrt(sum_of_workgroup(invocation, own));
    var distance = select(norm / systems.norm_b, wide4(), systems.norm_b == wide4());
    for (var system = 0u; system < 4u; system++) {
        if was_running[system] {
            systems.outcome[system] = judged(distance[system], systems.iterations[system], is_last);
        }
    }
    systems.distance = select(systems.distance, distance, was_running);
    if invocation.index == 0u {
        store_systems(place.block, systems);
        let rho = norms[3u * place.block] / max(begin * begin / (scale * scale), wide4(wide(1.0)));
        norms[3u * place.block] = select(norms[3u * place.block], rho, was_running);
    }
    if any(systems.outcome == vec4<u32>(RUNNING)) {
        begin_round(place, invocation, systems);
    }
}

@compute @workgroup_size(INVOCATIONS)
fn refine(invocation: Invocation) {
    end_round(invocation, false);
}

// No round follows: what has not reached the goal by now does not.
@compute @workgroup_size(INVOCATIONS)
fn settle(invocation: Invocation) {
    end_round(invocation, true);
}
