// Twin: src/mechanics/contact/pressure.rs (Evaluate, Change), loading.rs (JointCurve) and arc_state.rs.
//
// From the compliances of two bodies to the states of their joint: `sample` evaluates its curve at the smallest half
// angle and at the nodes in eps, `find` searches the half angle of each load on it.
//
// One invocation has one sample, or one load, of one design; invocations do not meet. What is proportional to b^2 for
// small arcs (versines, indentation, force, pressure) is kept divided by b^2, the energy by b^4, so that arcs of 1e-18
// rad have a state in f32 too.

struct ContactParameters {
    design_count: u32,
    // Loads of all designs together.
    step_count: u32,
    // Of a whole slot.
    slot_size: u32,
    // Of one search.
    evaluation_limit: u32,
    // TERMS, as a number that compilers do not know: loops that they unroll by hundreds take seconds to compile.
    term_count: u32,
}

@group(0) @binding(0) var<uniform> parameters: ContactParameters;
// [largest half angle, tolerance, narrowest bracket, 0], then of each node in eps [abscissa, weight, half angle], then
// cos(i pi/(2 TERMS)) for i < 4 TERMS.
@group(0) @binding(1) var<storage, read> space: array<wide>;
// [slot][1 for a sound body and 0 for any other, amplitude, greatest |b - K x|/|b|, then [node in eps][entry]]
@group(0) @binding(2) var<storage, read> slots: array<wide>;
// [design][pin, plate, what either is compared with: the same on the next coarser mesh, NOTHING, or NONE of an exact body].
@group(0) @binding(3) var<storage, read> design_slots: array<vec4<u32>>;
// [design][1/E of the pin, of the plate], then of each step the logarithm of e over what the load prescribes.
@group(0) @binding(4) var<storage, read> numbers: array<wide>;
// [step]: twice its design, and one more if the force is prescribed; else the indentation is.
@group(0) @binding(5) var<storage, read> steps: array<u32>;
// [design][sample]: the `Readings` of each state, 0 in the last where there is none.
@group(0) @binding(6) var<storage, read_write> samples: array<wide4>;
// [step][RESPONSE_SIZE]; the twin is `contact::LoadResponse`.
@group(0) @binding(7) var<storage, read_write> responses: array<wide>;

const ENTRIES = TERMS * (TERMS + 1u) / 2u;
const SAMPLES = NODES + 1u;
const RESPONSE_SIZE = 12u;
const NONE = 0xffffffffu;
const NOTHING = 0xfffffffeu;
const SMALLEST = wide(1e-18);
const FAR_BELOW = wide(-1e30);
const PI = wide(3.14159265358979323846264338327950288);
const HALF_PI = wide(1.57079632679489661923132169163975144);

// How a search ended.
const FOUND = 0u;
const TOO_WIDE = 1u;
const BROKEN = 2u;
const UNFINISHED = 3u;

// A state over e, with the powers of b taken out; its pressure is in `pressure`.
struct State {
    is_sound: bool,
    indentation: wide,
    force: wide,
    stiffness: wide,
    energy: wide,
}

// The compliance of both bodies at one half angle, lower triangle, then its Cholesky factor.
var<private> matrix: array<wide, ENTRIES>;
// Coefficients of the trial pressures over e b^2.
var<private> pressure: array<wide, TERMS>;
// Of the nodes in eps at one half angle.
var<private> weights: array<wide, NODES>;

fn entry_count() -> u32 {
    return parameters.term_count * (parameters.term_count + 1u) / 2u;
}

fn node_half_angle(node: u32) -> wide {
    return space[4u + 3u * node + 2u];
}

// Samples ascend, nodes descend.
fn sample_half_angle(index: u32) -> wide {
    if index == 0u {
        return SMALLEST;
    }
    return node_half_angle(NODES - index);
}

fn weigh(half_angle: wide) {
    let x = sqrt(half_angle / space[0]);
    var sum = wide(0.0);
    for (var node = 0u; node < NODES; node++) {
        let distance = x - space[4u + 3u * node];
        // On a node its own weight drowns the others.
        let weight = space[4u + 3u * node + 1u] / select(distance, wide(1e-30), distance == wide(0.0));
        weights[node] = weight;
        sum += weight;
    }
    for (var node = 0u; node < NODES; node++) {
        weights[node] /= sum;
    }
}

// The joint's compliance at the half angle of the weights.
fn interpolate(pin: u32, plate: u32, share: wide2) {
    for (var entry = 0u; entry < entry_count(); entry++) {
        var sum = wide(0.0);
        // Four nodes a trip: Mesa 22 bounds the trips of an invocation.
        for (var node = 0u; node < NODES; node += 4u) {
            let at = SLOT_HEADER + node * ENTRIES + entry;
            sum += weights[node] * (share.x * slots[pin + at] + share.y * slots[plate + at]);
            sum += weights[node + 1u]
                * (share.x * slots[pin + at + ENTRIES] + share.y * slots[plate + at + ENTRIES]);
            sum += weights[node + 2u]
                * (share.x * slots[pin + at + 2u * ENTRIES] + share.y * slots[plate + at + 2u * ENTRIES]);
            sum += weights[node + 3u]
                * (share.x * slots[pin + at + 3u * ENTRIES] + share.y * slots[plate + at + 3u * ENTRIES]);
        }
        matrix[entry] = sum;
    }
}

// The joint's compliance at a node.
fn gather(pin: u32, plate: u32, share: wide2, node: u32) {
    for (var entry = 0u; entry < entry_count(); entry++) {
        let at = SLOT_HEADER + node * ENTRIES + entry;
        matrix[entry] = share.x * slots[pin + at] + share.y * slots[plate + at];
    }
}

// The state at b from the matrix, which lacks its -pi/2 c ln b.
fn evaluate(b: wide, ln_b: wide, amplitude: wide) -> State {
    matrix[0] -= HALF_PI * amplitude * ln_b;
    let root = sqrt(wide(1.0) + b * b);
    let t = b / (wide(1.0) + root);
    var load_versine: array<wide, TERMS>;
    load_versine[0] = PI / (root * (wide(1.0) + root));
    var next_versine = PI / (root * (wide(1.0) + root) * (wide(1.0) + root));
    for (var k = 1u; k < parameters.term_count; k++) {
        load_versine[k] = next_versine;
        next_versine *= -(t * t);
    }
    var one: array<wide, TERMS>;
    var versine: array<wide, TERMS>;
    var inverse: array<wide, TERMS>;
    for (var row = 0u; row < parameters.term_count; row++) {
        let of_row = row * (row + 1u) / 2u;
        for (var column = 0u; column <= row; column++) {
            let of_column = column * (column + 1u) / 2u;
            var value = matrix[of_row + column];
            for (var k = 0u; k < column; k++) {
                value -= matrix[of_row + k] * matrix[of_column + k];
            }
            if column < row {
                value *= inverse[column];
            }
            matrix[of_row + column] = value;
        }
        let pivot = matrix[of_row + row];
        if !(pivot > wide(0.0)) || !is_finite(pivot) {
            return State();
        }
        inverse[row] = wide(1.0) / sqrt(pivot);
        var own_one = select(wide(0.0), HALF_PI, row == 0u);
        var own_versine = load_versine[row];
        for (var k = 0u; k < row; k++) {
            own_one -= matrix[of_row + k] * one[k];
            own_versine -= matrix[of_row + k] * versine[k];
        }
        one[row] = own_one * inverse[row];
        versine[row] = own_versine * inverse[row];
    }
    for (var back = 0u; back < parameters.term_count; back++) {
        let row = TERMS - 1u - back;
        var own_one = one[row];
        var own_versine = versine[row];
        for (var k = row + 1u; k < parameters.term_count; k++) {
            let entry = matrix[k * (k + 1u) / 2u + row];
            own_one -= entry * one[k];
            own_versine -= entry * versine[k];
        }
        one[row] = own_one * inverse[row];
        versine[row] = own_versine * inverse[row];
    }
    var sum_one = wide(0.0);
    var sum_versine = wide(0.0);
    for (var k = 0u; k < parameters.term_count; k++) {
        sum_one += one[k];
        sum_versine += versine[k];
    }
    var state: State;
    state.indentation = sum_versine / sum_one;
    for (var k = 0u; k < parameters.term_count; k++) {
        let load_one = select(wide(0.0), HALF_PI, k == 0u);
        let cosine = wide(2.0) * (load_one - b * b * load_versine[k]);
        pressure[k] = state.indentation * one[k] - versine[k];
        state.force += pressure[k] * cosine;
        state.stiffness += (one[k] - b * b * versine[k]) * cosine;
        state.energy += pressure[k] * (state.indentation * load_one - load_versine[k]);
    }
    state.is_sound = is_finite(state.indentation) && is_finite(state.force) && is_finite(state.energy);
    return state;
}

// What a search must know of a state: ln(delta/e), ln(F/e), dR/e, and 1. The logarithms are far below all others where
// there is nothing to take them of.
fn readings_of(state: State, b: wide, ln_b: wide) -> wide4 {
    var logarithms = wide2(FAR_BELOW, FAR_BELOW);
    if state.indentation > wide(0.0) && state.force > wide(0.0) {
        logarithms = wide2(logarithm(state.indentation), logarithm(state.force)) + wide(2.0) * ln_b;
    }
    return wide4(logarithms, wide(1.0) - b * b * state.indentation, wide(1.0));
}

fn are_sound(of_design: vec4<u32>) -> bool {
    for (var i = 0u; i < 4u; i++) {
        if of_design[i] < NOTHING && slots[of_design[i] * parameters.slot_size] != wide(1.0) {
            return false;
        }
    }
    return true;
}

fn joint_amplitude(pin: u32, plate: u32, share: wide2) -> wide {
    return share.x * slots[pin + 1u] + share.y * slots[plate + 1u];
}

// How the work of a body changes by what it is compared with.
fn compared(slot: u32, with_slot: u32, ln_b: wide) -> wide {
    if with_slot == NONE {
        return wide(0.0);
    }
    if with_slot == NOTHING {
        return abs(work(slot, ln_b));
    }
    return abs(work_of_change(slot, with_slot));
}

@compute @workgroup_size(INVOCATIONS)
fn sample(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let index = (group.y * groups.x + group.x) * INVOCATIONS + invocation;
    if index >= parameters.design_count * SAMPLES {
        return;
    }
    let design = index / SAMPLES;
    let own = index % SAMPLES;
    let of_design = design_slots[design];
    let pin = of_design.x * parameters.slot_size;
    let plate = of_design.y * parameters.slot_size;
    let share = wide2(numbers[2u * design], numbers[2u * design + 1u]);
    if own == 0u {
        weigh(SMALLEST);
        interpolate(pin, plate, share);
    } else {
        gather(pin, plate, share, NODES - own);
    }
    let b = tangent(wide(0.5) * sample_half_angle(own));
    let ln_b = logarithm(b);
    let state = evaluate(b, ln_b, joint_amplitude(pin, plate, share));
    var readings = wide4();
    if state.is_sound && are_sound(of_design) {
        readings = readings_of(state, b, ln_b);
    }
    samples[index] = readings;
}

// The position at which the polynomial through (position, value), taken as position of value, has the value zero.
fn inverse_interpolation(points: array<wide2, 4>, count: u32) -> wide {
    var given = points;
    var sum = wide(0.0);
    for (var i = 0u; i < count; i++) {
        var product = given[i].x;
        for (var j = 0u; j < count; j++) {
            if j != i {
                product *= given[j].y / (given[j].y - given[i].y);
            }
        }
        sum += product;
    }
    return sum;
}

// Samples up to the first beyond a neat fit, no further than the contact grows with the load; 0 where one has no state.
fn samples_in_use(first: u32) -> u32 {
    var count = SAMPLES;
    for (var i = 0u; i < SAMPLES; i++) {
        if samples[first + i].w == wide(0.0) {
            return 0u;
        }
        if count == SAMPLES && samples[first + i].z <= wide(0.0) {
            count = i + 1u;
        }
    }
    for (var i = 1u; i < count; i++) {
        if samples[first + i].x <= samples[first + i - 1u].x {
            return i;
        }
    }
    return count;
}

// How much the state's load exceeds the one asked: the logarithm of their ratio. A force grows without bound towards a
// neat fit, where dR/e ends; so there it is the difference of dR/e and what it should be, which goes on beyond.
fn excess_of(readings: wide4, step: u32) -> wide {
    let factor = numbers[2u * parameters.design_count + step];
    if steps[step] % 2u == 0u {
        return readings.x + factor;
    }
    let wanted = readings.y + factor;
    if readings.z > wide(0.5) {
        return wanted - logarithm(readings.z);
    }
    return exponential(min(wanted, wide(80.0))) - readings.z;
}

// The quadratic form of a body's compliance, at the weights' half angle, with the pressure.
fn work(slot: u32, ln_b: wide) -> wide {
    let fine = slot * parameters.slot_size;
    var work = -HALF_PI * slots[fine + 1u] * ln_b * pressure[0] * pressure[0];
    for (var row = 0u; row < parameters.term_count; row++) {
        for (var column = 0u; column <= row; column++) {
            let entry = row * (row + 1u) / 2u + column;
            var sum = wide(0.0);
            for (var node = 0u; node < NODES; node++) {
                sum += weights[node] * slots[fine + SLOT_HEADER + node * ENTRIES + entry];
            }
            let times = select(wide(2.0), wide(1.0), row == column);
            work += times * pressure[row] * pressure[column] * sum;
        }
    }
    return work;
}

// The same of its change since a coarser mesh.
fn work_of_change(slot: u32, coarser_slot: u32) -> wide {
    let fine = slot * parameters.slot_size;
    let coarse = coarser_slot * parameters.slot_size;
    var work = wide(0.0);
    for (var row = 0u; row < parameters.term_count; row++) {
        for (var column = 0u; column <= row; column++) {
            let entry = row * (row + 1u) / 2u + column;
            var sum = wide(0.0);
            for (var node = 0u; node < NODES; node += 4u) {
                let at = SLOT_HEADER + node * ENTRIES + entry;
                sum += weights[node] * (slots[fine + at] - slots[coarse + at]);
                sum += weights[node + 1u] * (slots[fine + at + ENTRIES] - slots[coarse + at + ENTRIES]);
                sum += weights[node + 2u] * (slots[fine + at + 2u * ENTRIES] - slots[coarse + at + 2u * ENTRIES]);
                sum += weights[node + 3u] * (slots[fine + at + 3u * ENTRIES] - slots[coarse + at + 3u * ENTRIES]);
            }
            let times = select(wide(2.0), wide(1.0), row == column);
            work += times * pressure[row] * pressure[column] * sum;
        }
    }
    return work;
}

fn series_of_pressure(i: u32) -> wide {
    let cosines = 4u + 3u * NODES;
    var sum = wide(0.0);
    var turned = 0u;
    for (var k = 0u; k < parameters.term_count; k++) {
        sum += pressure[k] * space[cosines + turned];
        turned += i;
        turned -= select(0u, 4u * TERMS, turned >= 4u * TERMS);
    }
    return sum;
}

fn pressure_is_positive() -> bool {
    let least = wide(-0.01) * series_of_pressure(2u * TERMS);
    for (var i = 1u; i <= 2u * TERMS; i++) {
        if series_of_pressure(i) < least {
            return false;
        }
    }
    return true;
}

fn truncation() -> wide {
    let tail = abs(pressure[TERMS - 2u]) + abs(pressure[TERMS - 1u]);
    var most = wide(0.0);
    for (var k = 0u; k < parameters.term_count; k++) {
        most = max(most, abs(pressure[k]));
    }
    return (tail / most) * (tail / most);
}

fn worst_residual(of_design: vec4<u32>) -> wide {
    var worst = wide(0.0);
    for (var i = 0u; i < 4u; i++) {
        if of_design[i] < NOTHING {
            worst = max(worst, slots[of_design[i] * parameters.slot_size + 2u]);
        }
    }
    return worst;
}

fn finish(step: u32, outcome: u32) {
    responses[step * RESPONSE_SIZE] = wide(outcome);
}

@compute @workgroup_size(INVOCATIONS)
fn find(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let step = (group.y * groups.x + group.x) * INVOCATIONS + invocation;
    if step >= parameters.step_count {
        return;
    }
    let design = steps[step] / 2u;
    let of_design = design_slots[design];
    let pin = of_design.x * parameters.slot_size;
    let plate = of_design.y * parameters.slot_size;
    let share = wide2(numbers[2u * design], numbers[2u * design + 1u]);
    let amplitude = joint_amplitude(pin, plate, share);
    let first = design * SAMPLES;
    let count = samples_in_use(first);
    if count == 0u {
        finish(step, BROKEN);
        return;
    }
    var above = 0u;
    while above < count && excess_of(samples[first + above], step) < wide(0.0) {
        above += 1u;
    }
    if above == count {
        finish(step, TOO_WIDE);
        return;
    }
    if above == 0u {
        finish(step, BROKEN);
        return;
    }
    // The search is in ln(eps) from the sample below on. First guess: inverse interpolation through the neighbours as
    // well, where it stays inside the bracket.
    let below = above - 1u;
    let origin = sample_half_angle(below);
    var points: array<wide2, 4>;
    let first_point = max(below, 1u) - 1u;
    let last_point = min(above + 1u, count - 1u);
    for (var i = first_point; i <= last_point; i++) {
        let position = logarithm(sample_half_angle(i) / origin);
        points[i - first_point] = wide2(position, excess_of(samples[first + i], step));
    }
    var a = wide2(wide(0.0), excess_of(samples[first + below], step));
    var b = wide2(logarithm(sample_half_angle(above) / origin), excess_of(samples[first + above], step));
    var next = inverse_interpolation(points, last_point + 1u - first_point);
    if !(next > a.x && next < b.x) {
        next = wide(0.5) * (a.x + b.x);
    }
    var state: State;
    var half_angle = wide(0.0);
    var edge = wide(0.0);
    var ln_b = wide(0.0);
    var is_found = false;
    for (var evaluation = 0u; evaluation < parameters.evaluation_limit; evaluation++) {
        half_angle = min(origin * exponential(next), space[0]);
        edge = tangent(wide(0.5) * half_angle);
        ln_b = logarithm(edge);
        weigh(half_angle);
        interpolate(pin, plate, share);
        state = evaluate(edge, ln_b, amplitude);
        if !(state.is_sound && state.indentation > wide(0.0) && state.force > wide(0.0)) {
            finish(step, BROKEN);
            return;
        }
        let readings = readings_of(state, edge, ln_b);
        let excess = excess_of(readings, step);
        let is_narrow = b.x - a.x < space[2] * max(wide(1.0), b.x);
        if abs(excess) < space[1] || is_narrow {
            is_found = true;
            break;
        }
        // Inverse quadratic interpolation through it and the bracket, bisection where that leaves the bracket.
        var dropped = b;
        if excess < wide(0.0) {
            dropped = a;
            a = wide2(next, excess);
        } else {
            b = wide2(next, excess);
        }
        points[0] = a;
        points[1] = b;
        points[2] = dropped;
        next = inverse_interpolation(points, 3u);
        if !(next > a.x && next < b.x) {
            next = wide(0.5) * (a.x + b.x);
        }
    }
    if !is_found {
        finish(step, UNFINISHED);
        return;
    }
    let change = share.x * compared(of_design.x, of_design.z, ln_b) + share.y * compared(of_design.y, of_design.w, ln_b);
    var peak = wide(0.0);
    for (var k = 0u; k < parameters.term_count; k++) {
        peak += select(pressure[k], -pressure[k], k % 2u == 1u);
    }
    let at = step * RESPONSE_SIZE;
    responses[at] = wide(FOUND);
    responses[at + 1u] = half_angle;
    responses[at + 2u] = edge;
    responses[at + 3u] = state.indentation;
    responses[at + 4u] = state.force;
    responses[at + 5u] = state.stiffness;
    responses[at + 6u] = state.energy;
    responses[at + 7u] = peak;
    responses[at + 8u] = truncation();
    responses[at + 9u] = change / state.energy;
    responses[at + 10u] = select(wide(0.0), wide(1.0), pressure_is_positive());
    responses[at + 11u] = worst_residual(of_design);
}
