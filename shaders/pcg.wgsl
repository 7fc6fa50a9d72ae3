// Twin: src/mechanics/solve/pcg.rs.
//
// Conjugate gradients with Jacobi's preconditioner M = diag K, for systems of many bodies; algorithm and norm as in the
// twin. refine.wgsl begins and ends the rounds.
//
// One workgroup advances four systems of one body: a value of K is read once for all four. Its invocations stride
// over the rows; sums are taken over the strides and then over the invocations. A system that has stopped goes along unchanged,
// and a workgroup whose four have stopped ends.
//
// p, r, d and the numbers of a system stay in storage, so that a dispatch of `step_count` steps goes on where the
// one before has ended: how the steps are split over dispatches does not change a bit. During a dispatch the first
// ON_CHIP vectors, of at most CAPACITY unknowns, are in the workgroup's own memory: p first, which is gathered.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [slice of SLICE rows]: its first value; the end of the last one closes the list. In a slice the first values of all
// rows come first, then the second ones and so on.
@group(0) @binding(1) var<storage, read> slice_starts: array<u32>;
// [value of one matrix]
@group(0) @binding(2) var<storage, read> columns: array<u32>;
// [row]: the value on its diagonal.
@group(0) @binding(3) var<storage, read> diagonal_places: array<u32>;
// [body][value]
@group(0) @binding(4) var<storage, read> values: array<real>;
// [body][block][p, q, r, d][unknown]
@group(0) @binding(5) var<storage, read_write> iterates: array<real4>;
// [body][block][rho = r.M^-1 r, |b|, |b - K x|/|b| as the round began]
@group(0) @binding(6) var<storage, read_write> norms: array<wide4>;
// [body][block][system]
@group(0) @binding(7) var<storage, read_write> states: array<SystemState>;

// Four systems, as their workgroup holds them.
struct Systems {
    rho: real4,
    // The |r| to reach.
    stop: real4,
    outcome: vec4<u32>,
    iterations: vec4<u32>,
}

var<workgroup> held: Systems;
// [p, q, r, d][unknown], as many as there are; one number where there is none.
var<workgroup> chip: array<real4, max(ON_CHIP * CAPACITY, 1u)>;

const P = 0u;
const Q = 1u;
const R = 2u;
const D = 3u;

// Of one of the vectors of a block that begins at `first` in storage. Compilers know on which side each call is.
fn of_vector(vector: u32, first: u32, row: u32) -> real4 {
    if vector < ON_CHIP {
        return chip[vector * CAPACITY + row];
    }
    return iterates[first + vector * parameters.unknown_count + row];
}

fn keep(vector: u32, first: u32, row: u32, value: real4) {
    if vector < ON_CHIP {
        chip[vector * CAPACITY + row] = value;
    } else {
        iterates[first + vector * parameters.unknown_count + row] = value;
    }
}

// Between storage and chip. q is made anew in each step.
fn fetch(first: u32, invocation: Invocation) {
    for (var row = invocation.index; row < parameters.unknown_count; row += INVOCATIONS) {
        for (var vector = P; vector < ON_CHIP; vector++) {
            if vector != Q {
                chip[vector * CAPACITY + row] = iterates[first + vector * parameters.unknown_count + row];
            }
        }
    }
}

fn put_back(first: u32, invocation: Invocation) {
    for (var row = invocation.index; row < parameters.unknown_count; row += INVOCATIONS) {
        for (var vector = P; vector < ON_CHIP; vector++) {
            if vector != Q {
                iterates[first + vector * parameters.unknown_count + row] = chip[vector * CAPACITY + row];
            }
        }
    }
}

// Which systems take a step: those that neither broke down nor ended their round.
fn are_stepping(systems: Systems) -> vec4<bool> {
    return (systems.outcome == vec4<u32>(RUNNING))
        & (sqrt(systems.rho) > systems.stop)
        & (systems.iterations < vec4<u32>(parameters.iteration_limit));
}

// What p.K p says of a system that steps.
fn bent(outcome: u32, is_stepping: bool, curvature: real) -> u32 {
    if !is_stepping {
        return outcome;
    }
    if !is_finite(wide(curvature)) {
        return NOT_FINITE;
    }
    return select(INDEFINITE, RUNNING, curvature > real(0.0));
}

// What the new rho says.
fn shortened(outcome: u32, rho: real) -> u32 {
    return select(outcome, NOT_FINITE, outcome == RUNNING && !is_finite(wide(rho)));
}

fn load(block: u32) -> Systems {
    var systems: Systems;
    systems.rho = real4(norms[3u * block]);
    // In the scale of the round. It need not go below the goal; half of that is left to rounding.
    let norm_b = norms[3u * block + 1u];
    let begin = norms[3u * block + 2u] * norm_b;
    let enough = max(wide(parameters.tolerance) * begin, wide(0.5) * wide(parameters.goal) * norm_b);
    systems.stop = real4(enough / power_of_two(begin));
    for (var system = 0u; system < 4u; system++) {
        let state = states[4u * block + system];
        systems.outcome[system] = state.outcome;
        systems.iterations[system] = state.iterations;
    }
    return systems;
}

fn store(block: u32, systems: Systems) {
    norms[3u * block] = wide4(systems.rho);
    var stored = systems;
    for (var system = 0u; system < 4u; system++) {
        states[4u * block + system] = SystemState(stored.outcome[system], stored.iterations[system]);
    }
}

// The next `step_count` steps.
@compute @workgroup_size(INVOCATIONS)
fn solve(invocation: Invocation) {
    let size = parameters.unknown_count;
    let block = invocation.group.x * parameters.block_count + invocation.group.y;
    let first_value = invocation.group.x * parameters.value_count;
    let first = 4u * size * block;
    if invocation.index == 0u {
        held = load(block);
    }
    var systems = workgroupUniformLoad(&held);
    if !any(are_stepping(systems)) {
        return;
    }
    fetch(first, invocation);
    workgroupBarrier();
    for (var step = 0u; step < parameters.step_count; step++) {
        let is_stepping = are_stepping(systems);
        if !any(is_stepping) {
            break;
        }
        // q = K p
        var own = real4();
        for (var row = invocation.index; row < size; row += INVOCATIONS) {
            var sum = real4();
            let end = slice_starts[row / SLICE + 1u];
            for (var entry = slice_starts[row / SLICE] + row % SLICE; entry < end; entry += SLICE) {
                sum += values[first_value + entry] * of_vector(P, first, columns[entry]);
            }
            keep(Q, first, row, sum);
            own += of_vector(P, first, row) * sum;
        }
        let curvature = sum_of_workgroup(invocation, own);
        systems.iterations += select(vec4<u32>(), vec4<u32>(1u), is_stepping);
        systems.outcome = vec4<u32>(
            bent(systems.outcome.x, is_stepping.x, curvature.x),
            bent(systems.outcome.y, is_stepping.y, curvature.y),
            bent(systems.outcome.z, is_stepping.z, curvature.z),
            bent(systems.outcome.w, is_stepping.w, curvature.w),
        );
        let goes_on = is_stepping & (systems.outcome == vec4<u32>(RUNNING));
        // d += alpha p, r -= alpha q, z = M^-1 r
        let alpha = select(real4(), systems.rho / curvature, goes_on);
        own = real4();
        for (var row = invocation.index; row < size; row += INVOCATIONS) {
            keep(D, first, row, of_vector(D, first, row) + alpha * of_vector(P, first, row));
            let residual = of_vector(R, first, row) - alpha * of_vector(Q, first, row);
            keep(R, first, row, residual);
            own += residual * (residual / values[first_value + diagonal_places[row]]);
        }
        let next = sum_of_workgroup(invocation, own);
        // p = z + beta p
        let beta = select(real4(), next / systems.rho, goes_on);
        systems.rho = select(systems.rho, next, goes_on);
        for (var row = invocation.index; row < size; row += INVOCATIONS) {
            let z = of_vector(R, first, row) / values[first_value + diagonal_places[row]];
            keep(P, first, row, z + beta * of_vector(P, first, row));
        }
        storageBarrier();
        workgroupBarrier();
        systems.outcome = vec4<u32>(
            shortened(systems.outcome.x, systems.rho.x),
            shortened(systems.outcome.y, systems.rho.y),
            shortened(systems.outcome.z, systems.rho.z),
            shortened(systems.outcome.w, systems.rho.w),
        );
    }
    put_back(first, invocation);
    if invocation.index == 0u {
        store(block, systems);
    }
}
