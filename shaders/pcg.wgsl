// Twin: src/mechanics/solve/pcg.rs.
//
// Conjugate gradients with Jacobi's preconditioner M = diag K, for unit forces on the ring's unknowns of many bodies;
// algorithm and norm as in the twin. `start` once, then `solve` until every system has stopped.
//
// One workgroup advances four systems of one body: a value of K is read once for all four. Its invocations stride
// over the rows; sums are taken over the strides and then as a tree. A system that has stopped goes along unchanged,
// and a workgroup whose four have stopped ends.
//
// x, r, p and the four numbers of a system stay in storage, so that a dispatch of `step_count` steps goes on where the
// one before has ended: how the steps are split over dispatches does not change a bit.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [row]: its first value; the end of the last one closes the list.
@group(0) @binding(1) var<storage, read> row_starts: array<u32>;
// [value of one matrix]
@group(0) @binding(2) var<storage, read> columns: array<u32>;
// [row]: the value on its diagonal.
@group(0) @binding(3) var<storage, read> diagonal_places: array<u32>;
// [body][value]
@group(0) @binding(4) var<storage, read> values: array<real>;
// [body][block][x, r, p, q][unknown]
@group(0) @binding(5) var<storage, read_write> iterates: array<real4>;
// [body][block][rho = r.M^-1 r, |b|, |b - K x|/|b| (of condense)]
@group(0) @binding(6) var<storage, read_write> norms: array<real4>;
// [body][block][system]
@group(0) @binding(7) var<storage, read_write> states: array<SystemState>;

// Four systems, as their workgroup holds them.
struct Systems {
    rho: real4,
    norm_b: real4,
    outcome: vec4<u32>,
    iterations: vec4<u32>,
}

var<workgroup> partial: array<real4, INVOCATIONS>;
var<workgroup> held: Systems;

// The sum of all invocations' own parts, the same for all of them.
fn sum_of_workgroup(invocation: u32, own: real4) -> real4 {
    partial[invocation] = own;
    workgroupBarrier();
    for (var width = INVOCATIONS / 2u; width > 0u; width /= 2u) {
        if invocation < width {
            partial[invocation] += partial[invocation + width];
        }
        workgroupBarrier();
    }
    return workgroupUniformLoad(&partial[0]);
}

// What becomes of a running system, in the twin's order.
fn judged(outcome: u32, rho: real, norm_b: real, iterations: u32) -> u32 {
    if outcome != RUNNING {
        return outcome;
    }
    if !is_finite(rho) {
        return NOT_FINITE;
    }
    if sqrt(rho) <= real(parameters.tolerance) * norm_b {
        return CONVERGED;
    }
    return select(RUNNING, ITERATION_LIMIT, iterations == parameters.iteration_limit);
}

fn all_judged(systems: Systems) -> vec4<u32> {
    return vec4<u32>(
        judged(systems.outcome.x, systems.rho.x, systems.norm_b.x, systems.iterations.x),
        judged(systems.outcome.y, systems.rho.y, systems.norm_b.y, systems.iterations.y),
        judged(systems.outcome.z, systems.rho.z, systems.norm_b.z, systems.iterations.z),
        judged(systems.outcome.w, systems.rho.w, systems.norm_b.w, systems.iterations.w),
    );
}

// What p.K p says of a running system.
fn bent(outcome: u32, curvature: real) -> u32 {
    if outcome != RUNNING {
        return outcome;
    }
    if !is_finite(curvature) {
        return NOT_FINITE;
    }
    return select(INDEFINITE, RUNNING, curvature > real(0.0));
}

fn load(block: u32) -> Systems {
    var systems: Systems;
    systems.rho = norms[3u * block];
    systems.norm_b = norms[3u * block + 1u];
    for (var system = 0u; system < 4u; system++) {
        let state = states[4u * block + system];
        systems.outcome[system] = state.outcome;
        systems.iterations[system] = state.iterations;
    }
    return systems;
}

fn store(block: u32, systems: Systems) {
    norms[3u * block] = systems.rho;
    norms[3u * block + 1u] = systems.norm_b;
    var stored = systems;
    for (var system = 0u; system < 4u; system++) {
        states[4u * block + system] = SystemState(stored.outcome[system], stored.iterations[system]);
    }
}

// x = 0, r = b, p = M^-1 b; systems that assembly refused stay refused.
@compute @workgroup_size(INVOCATIONS)
fn start(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let size = parameters.unknown_count;
    let block = group.x * parameters.block_count + group.y;
    let first_value = group.x * parameters.value_count;
    let x = 4u * size * block;
    let r = x + size;
    let p = r + size;
    var own = real4();
    var own_not_positive = real4();
    for (var row = invocation; row < size; row += INVOCATIONS) {
        let diagonal = values[first_value + diagonal_places[row]];
        if is_finite(diagonal) && diagonal <= real(0.0) {
            own_not_positive += real4(real(1.0));
        }
        var load = real4();
        let ring = row - parameters.ring_start;
        if row >= parameters.ring_start && ring / 4u == group.y {
            load[ring % 4u] = real(1.0);
        }
        let z = load / diagonal;
        iterates[x + row] = real4();
        iterates[r + row] = load;
        iterates[p + row] = z;
        own += load * z;
    }
    let rho = sum_of_workgroup(invocation, own);
    let not_positive = sum_of_workgroup(invocation, own_not_positive).x;
    if invocation == 0u {
        var systems = load(block);
        systems.rho = rho;
        systems.norm_b = sqrt(rho);
        if not_positive > real(0.0) {
            systems.outcome = select(systems.outcome, vec4<u32>(INDEFINITE), systems.outcome == vec4<u32>(RUNNING));
        }
        systems.outcome = all_judged(systems);
        store(block, systems);
    }
}

// The next `step_count` steps.
@compute @workgroup_size(INVOCATIONS)
fn solve(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let size = parameters.unknown_count;
    let block = group.x * parameters.block_count + group.y;
    let first_value = group.x * parameters.value_count;
    let x = 4u * size * block;
    let r = x + size;
    let p = r + size;
    let q = p + size;
    if invocation == 0u {
        held = load(block);
    }
    var systems = workgroupUniformLoad(&held);
    for (var step = 0u; step < parameters.step_count; step++) {
        if !any(systems.outcome == vec4<u32>(RUNNING)) {
            break;
        }
        // q = K p
        var own = real4();
        for (var row = invocation; row < size; row += INVOCATIONS) {
            var sum = real4();
            for (var entry = row_starts[row]; entry < row_starts[row + 1u]; entry++) {
                sum += values[first_value + entry] * iterates[p + columns[entry]];
            }
            iterates[q + row] = sum;
            own += iterates[p + row] * sum;
        }
        let curvature = sum_of_workgroup(invocation, own);
        systems.iterations += select(vec4<u32>(), vec4<u32>(1u), systems.outcome == vec4<u32>(RUNNING));
        systems.outcome = vec4<u32>(
            bent(systems.outcome.x, curvature.x),
            bent(systems.outcome.y, curvature.y),
            bent(systems.outcome.z, curvature.z),
            bent(systems.outcome.w, curvature.w),
        );
        let running = systems.outcome == vec4<u32>(RUNNING);
        // x += alpha p, r -= alpha q, z = M^-1 r
        let alpha = select(real4(), systems.rho / curvature, running);
        own = real4();
        for (var row = invocation; row < size; row += INVOCATIONS) {
            iterates[x + row] += alpha * iterates[p + row];
            let residual = iterates[r + row] - alpha * iterates[q + row];
            iterates[r + row] = residual;
            own += residual * (residual / values[first_value + diagonal_places[row]]);
        }
        let next = sum_of_workgroup(invocation, own);
        // p = z + beta p
        let beta = select(real4(), next / systems.rho, running);
        systems.rho = select(systems.rho, next, running);
        for (var row = invocation; row < size; row += INVOCATIONS) {
            let z = iterates[r + row] / values[first_value + diagonal_places[row]];
            iterates[p + row] = z + beta * iterates[p + row];
        }
        storageBarrier();
        workgroupBarrier();
        systems.outcome = all_judged(systems);
    }
    if invocation == 0u {
        store(block, systems);
    }
}
