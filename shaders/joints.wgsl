// Twin: `contact/compliance_rows.rs`, `compliance/near_field.rs`, `engine/interpolation/fit.rs` (`FittedFamily::part`), `contact/edge.rs`, `curve.rs` and `search.rs`.
//
// Joints: from two bodies, by their coordinates in fits, by their amplitudes or by their works, to the states under some loads, in f32. Compliances are over
// that of the infinite body, so that its even part is one.
//
// One workgroup has `JOINTS` joints side by side, with `OWN` invocations each. These take products of polynomials, then members, then
// nodes of the curve, then degrees of its polynomials, then loads. A joint has no more nodes than invocations.

struct Rows {
    // Products of a fit's polynomials, and numbers of one more than their highest degree; no products where amplitudes come with the joint.
    product_count: u32,
    degree_count: u32,
    member_count: u32,
    // Numbers from one row of coefficients to the next, and fours of numbers from one row of compliances.
    coefficient_stride: u32,
    row_stride: u32,
    // How often members come among the rows: of the body itself, and times powers of a number of the joint.
    order_count: u32,
    // Where in the tables there are degrees of the products, four to a word; coefficients, [product][member]; the greatest number of each
    // row; in fours rows, [row][packed entry / 4][node].
    products_at: u32,
    coefficients_at: u32,
    sizes_at: u32,
    rows_at: u32,
    // Of the members those that are not of ring modes, where works of these may be on the device.
    before_ring: u32,
    padding: u32,
}

struct JointParameters {
    // Pin and plate.
    bodies: array<Rows, 2>,
    node_count: u32,
    // Where in the tables there are of each node b, ln b, logarithm and place; 2 cos of angles of pressures; cosines of a whole turn in
    // 4 `node_count` steps.
    space_at: u32,
    turns_at: u32,
    cosines_at: u32,
    // tan(limit/4).
    widest: f32,
    negligible: f32,
    // Joints of its kind in a workgroup.
    together: u32,
    padding: u32,
}

@group(0) @binding(0) var<storage, read> parameters: array<JointParameters>;
@group(0) @binding(1) var<storage, read> tables: array<u32>;
// The same in fours.
@group(0) @binding(2) var<storage, read> table_fours: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> places: array<Place>;
// Of a joint: of each body four coordinates from -1 to 1, even and odd of the infinite body, and its share; tilts of the pin; the
// clearance ratio, m, and the bend of the gap; two numbers a load; amplitudes of the pin, and of the plate. Where works are on the device
// only those before the ring's, and then the weights of the nodes of both near fields.
@group(0) @binding(4) var<storage, read> joints: array<f32>;
// Of a body as `eliminate.wgsl` leaves it: whether it is sound, the greatest loss of a pivot, then works, of a pin also those of its tilt.
@group(0) @binding(5) var<storage, read> works: array<f32>;
// Of a near field: works of the first node, then of the next one, `NEAR_NODES` in all.
@group(0) @binding(6) var<storage, read> near_fields: array<f32>;
// Of a joint: what the curve leaves between its nodes, then `STATE_NUMBERS` of each load.
@group(0) @binding(7) var<storage, read_write> found: array<f32>;

// Of the joint that an invocation has, and the joint's place in its workgroup.
var<private> slot: u32;
var<private> of_joint: JointParameters;
var<private> load_count: u32;
var<private> works_at: vec2<u32>;
var<private> near_fields_at: vec4<u32>;

const HALF_PI = 1.5707964;
const PI = 3.1415927;
// Entries of a compliance, packed, in whole fours.
const ENTRY_FOURS = (TERMS * (TERMS + 1u) / 2u + 3u) / 4u;
const ENTRIES = 4u * ENTRY_FOURS;
const BODY_NUMBERS = 7u;
const AROUND = 6u;
const DEGREES = 20u;

const OWN = INVOCATIONS / JOINTS;
const OWN_PRODUCTS = MOST_PRODUCTS / JOINTS;
const OWN_ROWS = MOST_ROWS / JOINTS;

// As in `contact/reduced.rs`.
struct Reduced {
    singular: f32,
    edge: f32,
    edge_of_versine: f32,
    edge_of_gap: f32,
    versine: f32,
    gap: f32,
    work: f32,
    mixed_work: f32,
    work_of_gap: f32,
    peak: f32,
    peak_of_versine: f32,
    peak_of_gap: f32,
}

// Its functions, four at a time: those that loads follow from are the first two.
const FOURS = 3u;

struct Node {
    // delta/e and F/e.
    load: vec2<f32>,
    truncation: f32,
    of_pin: f32,
    is_sound: bool,
    is_positive: bool,
}

var<workgroup> factors: array<f32, JOINTS * 4u * DEGREES>;
var<workgroup> products: array<f32, JOINTS * OWN_PRODUCTS>;
var<workgroup> weights: array<f32, JOINTS * OWN_ROWS>;
// Of each four functions their values at the nodes, from then on their coefficients by degree: [four][joint][node].
var<workgroup> functions: array<vec4<f32>, FOURS * INVOCATIONS>;
var<workgroup> nodes: array<Node, INVOCATIONS>;
// What the last two coefficients of a function are of its greatest.
var<workgroup> left_out: array<vec4<f32>, JOINTS * FOURS>;

fn number(at: u32) -> f32 {
    return bitcast<f32>(tables[at]);
}

fn packed(row: u32, column: u32) -> u32 {
    return row * (row + 1u) / 2u + column;
}

fn between(indentation: f32, of_versine: f32, of_gap: f32) -> f32 {
    return of_gap + indentation * (of_versine - of_gap);
}

// delta/e and F/e of the state with a free edge.
fn load_of(f: Reduced, b: f32) -> vec2<f32> {
    let b2 = b * b;
    let arm = HALF_PI - b2 * f.versine;
    let flexible = f.singular / f.edge;
    let closed = b2 * (f.gap + flexible * f.edge_of_gap);
    let indentation = closed / (arm + closed - b2 * flexible * f.edge_of_versine);
    let work = b2 * b2 * between(indentation, f.work, f.mixed_work);
    return vec2<f32>(indentation, 2.0 * (b2 * first_of(f, indentation) * arm + work));
}

// W/b^2 of a state.
fn first_of(f: Reduced, indentation: f32) -> f32 {
    return between(indentation, f.edge_of_versine, f.edge_of_gap) / f.edge;
}

// Strain energy over e^2 b^4.
fn energy_of(f: Reduced, indentation: f32) -> f32 {
    let first = first_of(f, indentation);
    let of_versine = between(indentation, f.work, f.mixed_work);
    let of_gap = between(indentation, f.mixed_work, f.work_of_gap);
    return f.singular * first * first + between(indentation, of_versine, of_gap);
}

// Integrals of 1 - cos(phi) on an arc whose b is smaller by a ratio, over b^2.
fn versines(b: f32, ratio: f32) -> array<f32, TERMS> {
    let own = b / ratio;
    let root = sqrt(1.0 + own * own);
    let inverse = 1.0 / (1.0 + root);
    let t = own * inverse;
    let scale = PI / (root * ratio * ratio);
    var values: array<f32, TERMS>;
    values[0] = scale * inverse;
    var next = scale * inverse * inverse;
    for (var k = 1u; k < TERMS; k += 1u) {
        values[k] = next;
        next = -next * t * t;
    }
    return values;
}

// Integrals of sin^2(phi) (1 - cos(phi)) over b^2.
fn bent_versines(b: f32) -> array<f32, TERMS> {
    let root = sqrt(1.0 + b * b);
    let r = 1.0 / root;
    let inverse = 1.0 / (1.0 + root);
    let t = b * inverse;
    let q = b * b * r * r;
    let square = 2.0 * r * r;
    let single = r * (2.0 + 3.0 * q);
    var values: array<f32, TERMS>;
    values[0] = 1.5 * PI * r * q * r * r;
    var factor = -PI * r * inverse * inverse;
    for (var k = 1u; k < TERMS; k += 1u) {
        let degree = f32(k);
        values[k] = factor * (degree * (degree * square - single) + 1.5 * q * q);
        factor = -factor * t * t;
    }
    return values;
}

// Whether all amplitudes of a body come with the joint.
fn is_given(side: u32) -> bool {
    return works_at[side] == ELSEWHERE;
}

// Whether the works of a body are there and good enough, of so many entries for each way to push.
fn is_good(side: u32, entries: u32) -> bool {
    let at = works_at[side];
    if at == ELSEWHERE || at == MISSING {
        return at == ELSEWHERE;
    }
    var greatest = 0.0;
    for (var mode = 0u; packed(mode, mode) < entries; mode += 1u) {
        greatest = max(greatest, works[at + WORKS_HEADER + packed(mode, mode)]);
    }
    let loss = works[at + 1u] * greatest;
    return works[at] == 1.0 && is_finite(wide(loss)) && loss <= ROUGHEST_LOSS;
}

// A work of a body, of so many, with what its near fields add.
fn corrected(side: u32, entry: u32, count: u32, weights_at: u32) -> f32 {
    if works_at[side] == MISSING {
        return 0.0;
    }
    var sum = works[works_at[side] + WORKS_HEADER + entry];
    for (var around = 0u; around < 2u; around += 1u) {
        let near_at = near_fields_at[2u * side + around] + entry;
        for (var node = 0u; node < NEAR_NODES; node += 1u) {
            sum += joints[weights_at + around * NEAR_NODES + node] * near_fields[near_at + node * count];
        }
    }
    return sum;
}

// Amplitudes of a body's members, and from them the weights of its rows.
fn weigh(side: u32, joint_at: u32, lane: u32) {
    let rows = of_joint.bodies[side];
    let body_at = joint_at + side * BODY_NUMBERS;
    let factors_at = slot * 4u * DEGREES;
    let products_at = slot * OWN_PRODUCTS;
    if lane < 4u {
        let x = joints[body_at + lane];
        var current = 1.0;
        var previous = x;
        for (var degree = 0u; degree < rows.degree_count; degree += 1u) {
            factors[factors_at + lane * DEGREES + degree] = current;
            let next = 2.0 * x * current - previous;
            previous = current;
            current = next;
        }
    }
    workgroupBarrier();
    for (var product = lane; product < rows.product_count; product += OWN) {
        let degrees = tables[rows.products_at + product];
        products[products_at + product] = factors[factors_at + (degrees & 255u)]
            * factors[factors_at + DEGREES + ((degrees >> 8u) & 255u)]
            * factors[factors_at + 2u * DEGREES + ((degrees >> 16u) & 255u)]
            * factors[factors_at + 3u * DEGREES + (degrees >> 24u)];
    }
    workgroupBarrier();
    // Those of the plate are behind those of the pin.
    var amplitudes_at = joint_at + JOINT_NUMBERS + 2u * load_count;
    if side == 1u && of_joint.bodies[0].product_count == 0u {
        let of_pin = of_joint.bodies[0];
        amplitudes_at += select(of_pin.member_count, of_pin.before_ring + 2u * NEAR_NODES, !is_given(0u));
    }
    let weights_at = amplitudes_at + rows.before_ring;
    let entries = rows.member_count - rows.before_ring;
    let share = joints[body_at + 6u];
    let row_count = rows.member_count + 2u;
    let at = joint_at + 2u * BODY_NUMBERS;
    for (var row = lane; row < row_count; row += OWN) {
        var amplitude = 0.0;
        if row < 2u {
            amplitude = joints[body_at + 4u + row];
        } else {
            let member = row - 2u;
            if !is_given(side) && member >= rows.before_ring {
                let entry = member - rows.before_ring;
                if side == 0u {
                    let of_tilt = corrected(side, entries + entry, 2u * entries, weights_at);
                    amplitude = corrected(side, entry, 2u * entries, weights_at) + joints[at] * of_tilt;
                } else {
                    amplitude = corrected(side, entry, entries, weights_at);
                }
            } else if rows.product_count == 0u {
                amplitude = joints[amplitudes_at + member];
            }
            for (var product = 0u; product < rows.product_count; product += 1u) {
                let coefficient = number(rows.coefficients_at + product * rows.coefficient_stride + row - 2u);
                amplitude += products[products_at + product] * coefficient;
            }
        }
        var of_order = share;
        for (var order = 0u; order < rows.order_count; order += 1u) {
            weights[slot * OWN_ROWS + order * row_count + row] = amplitude * of_order;
            // Tilts of the pin, powers of the clearance ratio of the plate.
            if side == 0u {
                of_order = share * joints[at + min(order, 1u)];
            } else {
                of_order *= joints[at + 2u];
            }
        }
    }
    workgroupBarrier();
}

// Adds a body's compliance at a node.
fn add_compliance(side: u32, node: u32, sums: ptr<function, array<f32, ENTRIES>>) {
    let rows = of_joint.bodies[side];
    let nodes_of_entry = of_joint.node_count;
    let row_count = rows.order_count * (rows.member_count + 2u);
    let weights_at = slot * OWN_ROWS;
    let least = of_joint.negligible * abs(weights[weights_at]) * number(rows.sizes_at);
    for (var row = 0u; row < row_count; row += 1u) {
        let weight = weights[weights_at + row];
        if abs(weight) * number(rows.sizes_at + row) > least {
            let at = rows.rows_at + row * rows.row_stride + node;
            for (var four = 0u; four < ENTRY_FOURS; four += 1u) {
                let added = weight * table_fours[at + four * nodes_of_entry];
                (*sums)[4u * four] += added.x;
                (*sums)[4u * four + 1u] += added.y;
                (*sums)[4u * four + 2u] += added.z;
                (*sums)[4u * four + 3u] += added.w;
            }
        }
    }
}

// What the equations of a node come to; the compliance is overwritten.
fn solve_node(
    node: u32,
    joint_at: u32,
    matrix: ptr<function, array<f32, ENTRIES>>,
    pin: ptr<function, array<f32, ENTRIES>>,
) {
    let space_at = of_joint.space_at + 4u * node;
    let b = number(space_at);
    let logarithm = HALF_PI * number(space_at + 1u);
    let at = joint_at + 2u * BODY_NUMBERS;
    let ratio = joints[at + 3u];
    let bend = joints[at + 4u];
    let versine = versines(b, ratio);
    var gap = versines(b, sqrt(ratio));
    let bent = bent_versines(b);
    // What the equations are solved for side by side: the coupling to the first trial pressure, versines, gaps.
    var sides: array<vec3<f32>, TERMS>;
    for (var k = 0u; k < TERMS; k += 1u) {
        gap[k] += bend * bent[k];
        sides[k] = vec3<f32>((*matrix)[packed(k, 0u)], versine[k], gap[k]);
    }
    let given = sides;
    let last_entries = vec2<f32>(
        (*matrix)[packed(TERMS - 2u, TERMS - 2u)],
        (*matrix)[packed(TERMS - 1u, TERMS - 1u)],
    );
    var inverse: array<f32, TERMS>;
    var is_sound = true;
    for (var row = 1u; row < TERMS; row += 1u) {
        for (var column = 1u; column <= row; column += 1u) {
            var value = (*matrix)[packed(row, column)];
            for (var k = 1u; k < column; k += 1u) {
                value -= (*matrix)[packed(row, k)] * (*matrix)[packed(column, k)];
            }
            if column < row {
                value *= inverse[column];
            }
            (*matrix)[packed(row, column)] = value;
        }
        let pivot = (*matrix)[packed(row, row)];
        is_sound = is_sound && pivot > 0.0;
        inverse[row] = inverseSqrt(max(pivot, 1e-30));
        for (var k = 1u; k < row; k += 1u) {
            sides[row] -= (*matrix)[packed(row, k)] * sides[k];
        }
        sides[row] *= inverse[row];
    }
    for (var row = TERMS - 1u; row > 0u; row -= 1u) {
        for (var k = row + 1u; k < TERMS; k += 1u) {
            sides[row] -= (*matrix)[packed(k, row)] * sides[k];
        }
        sides[row] *= inverse[row];
    }
    var f: Reduced;
    f.singular = given[0].x - logarithm;
    f.edge = 1.0;
    f.versine = given[0].y;
    f.gap = given[0].z;
    f.peak = 1.0;
    var sign = -1.0;
    for (var k = 1u; k < TERMS; k += 1u) {
        let own = sides[k];
        f.singular -= given[k].x * own.x;
        f.edge -= own.x;
        f.edge_of_versine += own.y;
        f.edge_of_gap += own.z;
        f.versine -= own.x * given[k].y;
        f.gap -= own.x * given[k].z;
        f.work += own.y * given[k].y;
        f.mixed_work += own.y * given[k].z;
        f.work_of_gap += own.z * given[k].z;
        f.peak -= sign * own.x;
        f.peak_of_versine += sign * own.y;
        f.peak_of_gap += sign * own.z;
        sign = -sign;
    }
    let load = load_of(f, b);
    let first = first_of(f, load.x);
    // Coefficients of the trial pressures over e b^2.
    var pressure: array<f32, TERMS>;
    pressure[0] = first;
    var most = abs(first);
    for (var k = 1u; k < TERMS; k += 1u) {
        pressure[k] = -(first * sides[k].x + between(load.x, sides[k].y, sides[k].z));
        most = max(most, abs(pressure[k]));
    }
    let last = abs(pressure[TERMS - 2u]) + abs(pressure[TERMS - 1u]);
    let before = abs(pressure[TERMS - 4u]) + abs(pressure[TERMS - 3u]);
    let falling = 1.0 - min(last / before, SLOWEST);
    let tail = last / (most * falling);
    let work = energy_of(f, load.x);
    let last_two = vec2<f32>(pressure[TERMS - 2u], pressure[TERMS - 1u]);
    let of_last = dot(last_entries, last_two * last_two);
    // The least pressure between the zeros of the highest trial pressure.
    var peak = 0.0;
    sign = 1.0;
    for (var k = 0u; k < TERMS; k += 1u) {
        peak += sign * pressure[k];
        sign = -sign;
    }
    var least = peak;
    for (var place = 0u; place < 2u * TERMS; place += 1u) {
        let turn = number(of_joint.turns_at + place);
        var current = 0.0;
        var previous = 0.0;
        for (var k = TERMS - 1u; k > 0u; k -= 1u) {
            let next = pressure[k] - previous + turn * current;
            previous = current;
            current = next;
        }
        least = min(least, pressure[0] - previous + 0.5 * turn * current);
    }
    // What goes into the pin.
    var of_pin = 0.0;
    for (var row = 0u; row < TERMS; row += 1u) {
        var sum = 0.0;
        for (var column = 0u; column <= row; column += 1u) {
            let twice = select(1.0, 2.0, column < row);
            sum += twice * pressure[column] * (*pin)[packed(row, column)];
        }
        of_pin += sum * pressure[row];
    }
    let even_of_pin = joints[joint_at + 4u] * joints[joint_at + 6u];
    of_pin -= even_of_pin * logarithm * first * first;
    // Polynomials go through S without its logarithm.
    is_sound = is_sound && f.singular > 0.0;
    f.singular += PI * number(space_at + 2u);
    let fours = array(
        vec4<f32>(f.singular, f.edge, f.edge_of_versine, f.edge_of_gap),
        vec4<f32>(f.versine, f.gap, f.work, f.mixed_work),
        vec4<f32>(f.work_of_gap, f.peak, f.peak_of_versine, f.peak_of_gap),
    );
    for (var four = 0u; four < FOURS; four += 1u) {
        let own = fours[four];
        functions[four * INVOCATIONS + slot * OWN + node] = own;
        for (var place = 0u; place < 4u; place += 1u) {
            is_sound = is_sound && is_finite(wide(own[place]));
        }
    }
    nodes[slot * OWN + node] = Node(
        load,
        max(of_last / (work * falling * falling), tail * tail),
        of_pin / work,
        is_sound,
        least + TENSION * peak >= 0.0,
    );
}

// From values at the nodes to Chebyshev coefficients, of one degree. Even degrees are the same at the node opposite, odd ones its negative.
fn coefficients_of(degree: u32) -> array<vec4<f32>, FOURS> {
    let node_count = of_joint.node_count;
    let sign = select(-1.0, 1.0, degree % 2u == 0u);
    var sums: array<vec4<f32>, FOURS>;
    var step = degree;
    for (var node = 0u; node < node_count / 2u; node += 1u) {
        let cosine = number(of_joint.cosines_at + step);
        let near = slot * OWN + node;
        let far = slot * OWN + node_count - 1u - node;
        for (var four = 0u; four < FOURS; four += 1u) {
            sums[four] += cosine * (functions[four * INVOCATIONS + near] + sign * functions[four * INVOCATIONS + far]);
        }
        step += 2u * degree;
        step -= select(0u, 4u * node_count, step >= 4u * node_count);
    }
    let share = select(2.0, 1.0, degree == 0u) / f32(node_count);
    for (var four = 0u; four < FOURS; four += 1u) {
        sums[four] *= share;
    }
    return sums;
}

// Clenshaw's sums of the functions that loads follow from.
fn sum_of_load(turn: f32, logarithm: f32) -> Reduced {
    let at = slot * OWN;
    var first: vec4<f32>;
    var first_before: vec4<f32>;
    var second: vec4<f32>;
    var second_before: vec4<f32>;
    for (var degree = of_joint.node_count - 1u; degree > 0u; degree -= 1u) {
        let first_next = functions[at + degree] - first_before - turn * first;
        first_before = first;
        first = first_next;
        let second_next = functions[INVOCATIONS + at + degree] - second_before - turn * second;
        second_before = second;
        second = second_next;
    }
    first = functions[at] - first_before - 0.5 * turn * first;
    second = functions[INVOCATIONS + at] - second_before - 0.5 * turn * second;
    var f: Reduced;
    f.singular = first.x - PI * logarithm;
    f.edge = first.y;
    f.edge_of_versine = first.z;
    f.edge_of_gap = first.w;
    f.versine = second.x;
    f.gap = second.y;
    f.work = second.z;
    f.mixed_work = second.w;
    return f;
}

// And of the others.
fn sum_others(turn: f32, f: ptr<function, Reduced>) {
    let at = 2u * INVOCATIONS + slot * OWN;
    var sum: vec4<f32>;
    var before: vec4<f32>;
    for (var degree = of_joint.node_count - 1u; degree > 0u; degree -= 1u) {
        let next = functions[at + degree] - before - turn * sum;
        before = sum;
        sum = next;
    }
    sum = functions[at] - before - 0.5 * turn * sum;
    (*f).work_of_gap = sum.x;
    (*f).peak = sum.y;
    (*f).peak_of_versine = sum.z;
    (*f).peak_of_gap = sum.w;
}

// delta/e and F/e at a node, and its place; zero behind the last one.
fn load_at(node: u32) -> vec2<f32> {
    if node < of_joint.node_count {
        return nodes[slot * OWN + node].load;
    }
    return vec2<f32>(0.0);
}

fn place_of(node: u32) -> f32 {
    if node < of_joint.node_count {
        return number(of_joint.space_at + 4u * node + 3u);
    }
    return 0.0;
}

// P and W of `contact/search.rs`.
fn inverse_at(
    y: ptr<function, array<f32, AROUND>>,
    weight: ptr<function, array<f32, AROUND>>,
    wanted: f32,
) -> vec2<f32> {
    var sum = 0.0;
    var before = 1.0;
    for (var i = 0u; i < AROUND; i += 1u) {
        let distance = (*y)[i] - wanted;
        sum = sum * distance + before * (*weight)[i];
        before *= distance;
    }
    return vec2<f32>(sum, before);
}

// The state under a load, from the widest node that loads reach on.
fn search(joint_at: u32, load: u32, first_node: u32, found_at: u32) {
    let wanted_at = joint_at + JOINT_NUMBERS + 2u * load;
    let wanted = vec2<f32>(joints[wanted_at], joints[wanted_at + 1u]);
    let node_count = of_joint.node_count;
    var above = node_count;
    for (var node = first_node; node < node_count; node += 1u) {
        if dot(wanted, load_at(node)) >= 1.0 {
            above = node;
        }
    }
    for (var place = 0u; place < STATE_NUMBERS; place += 1u) {
        found[found_at + place] = 0.0;
    }
    // No node is: the contact would be too wide.
    if above == node_count {
        return;
    }
    let from_ = min(max(max(above, 2u) - 2u, first_node), node_count + 1u - AROUND);
    var own_places: array<f32, AROUND>;
    var y: array<f32, AROUND>;
    for (var i = 0u; i < AROUND; i += 1u) {
        own_places[i] = place_of(from_ + i);
        y[i] = sqrt(max(dot(wanted, load_at(from_ + i)), 0.0));
    }
    var weight = own_places;
    for (var i = 0u; i < AROUND; i += 1u) {
        var product = 1.0;
        for (var j = 0u; j < AROUND; j += 1u) {
            if j != i {
                product *= y[j] - y[i];
            }
        }
        weight[i] /= product;
    }
    var low = place_of(above + 1u);
    var high = place_of(above);
    let start = inverse_at(&y, &weight, 1.0);
    var next = start.x;
    var y_before = 0.0;
    var left_before = 0.0;
    var b = 0.0;
    var turn = 0.0;
    var f: Reduced;
    var has_ended = false;
    for (var step = 0u; step < MOST_STEPS && !has_ended; step += 1u) {
        let is_within = step < MOST_OF_POLYNOMIALS && next >= low && next <= high;
        let place = select(0.5 * (low + high), next, is_within);
        let unit = sqrt(place);
        let quarter = of_joint.widest * place;
        b = 2.0 * quarter / (1.0 - quarter * quarter);
        turn = 2.0 - 4.0 * unit;
        f = sum_of_load(turn, log(unit));
        let own = load_of(f, b);
        let sum = dot(wanted, own);
        let is_near = abs(sum - 1.0) < SEARCH_TOLERANCE;
        if sum < 1.0 {
            low = place;
        } else {
            high = place;
        }
        let is_sound = f.singular > 0.0 && own.x > 0.0 && is_finite(wide(sum));
        has_ended = is_sound && (is_near || high - low <= NARROWEST * high);
        let own_y = sqrt(max(sum, 0.0));
        let at = inverse_at(&y, &weight, own_y);
        let left = (place - at.x) / at.y;
        var left_at_one = left;
        if step > 0u {
            left_at_one += (left - left_before) * (1.0 - own_y) / (own_y - y_before);
        }
        next = start.x + start.y * left_at_one;
        y_before = own_y;
        left_before = left;
    }
    sum_others(turn, &f);
    let own = load_of(f, b);
    let b2 = b * b;
    let arm = HALF_PI - b2 * f.versine;
    let first = b2 * first_of(f, own.x);
    let peak = between(own.x, f.peak_of_versine, f.peak_of_gap);
    let ratio = joints[joint_at + 2u * BODY_NUMBERS + 3u];
    let of_above = nodes[slot * OWN + above];
    let of_below = nodes[slot * OWN + min(above + 1u, node_count - 1u)];
    found[found_at] = select(1.0, 2.0, has_ended);
    found[found_at + 1u] = b;
    found[found_at + 2u] = own.x;
    found[found_at + 3u] = own.y;
    found[found_at + 4u] = 2.0 * (arm * arm / f.singular + b2 * b2 * f.work);
    found[found_at + 5u] = b2 * b2 * energy_of(f, own.x);
    found[found_at + 6u] = (first * f.peak - b2 * peak) * 0.5 * ratio / b;
    found[found_at + 7u] = max(of_above.truncation, of_below.truncation);
    found[found_at + 8u] = select(0.0, 1.0, of_above.is_positive && of_below.is_positive);
    found[found_at + 9u] = of_above.of_pin;
    found[found_at + 10u] = of_below.of_pin;
}

@compute @workgroup_size(INVOCATIONS)
fn solve_joints(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    slot = invocation / OWN;
    let lane = invocation % OWN;
    let index = group.x * JOINTS + slot;
    var place: Place;
    var is_there = index < arrayLength(&places);
    if is_there {
        place = places[index];
        of_joint = parameters[place.parameters];
        is_there = place.terms == TERMS && of_joint.together == JOINTS;
    }
    if !is_there {
        // One of another kernel, or none: it has no nodes and no loads.
        of_joint = JointParameters();
        place = Place();
    }
    load_count = place.load_count;
    works_at = place.works_at;
    near_fields_at = place.near_fields_at;
    let joint_at = place.numbers_at;
    let found_at = place.found_at;
    let node_count = of_joint.node_count;
    var pin: array<f32, ENTRIES>;
    var both: array<f32, ENTRIES>;
    weigh(0u, joint_at, lane);
    if lane < node_count {
        add_compliance(0u, lane, &pin);
    }
    workgroupBarrier();
    both = pin;
    weigh(1u, joint_at, lane);
    if lane < node_count {
        add_compliance(1u, lane, &both);
        solve_node(lane, joint_at, &both, &pin);
    }
    workgroupBarrier();
    var coefficients: array<vec4<f32>, FOURS>;
    if lane < node_count {
        coefficients = coefficients_of(lane);
    }
    workgroupBarrier();
    if lane < node_count {
        for (var four = 0u; four < FOURS; four += 1u) {
            functions[four * INVOCATIONS + slot * OWN + lane] = coefficients[four];
        }
    }
    workgroupBarrier();
    if lane < FOURS && is_there {
        let at = lane * INVOCATIONS + slot * OWN;
        var most = vec4<f32>(1e-30);
        for (var degree = 0u; degree < node_count; degree += 1u) {
            most = max(most, abs(functions[at + degree]));
        }
        let last = abs(functions[at + node_count - 2u]) + abs(functions[at + node_count - 1u]);
        left_out[slot * FOURS + lane] = last / most;
    }
    workgroupBarrier();
    // From the narrowest contact on up to the first beyond a neat fit, as far as it grows with the load.
    var first_node = node_count;
    var grown = 0.0;
    var is_whole = true;
    for (var side = 0u; side < 2u; side += 1u) {
        let rows = of_joint.bodies[side];
        is_whole = is_whole && is_good(side, rows.member_count - rows.before_ring);
    }
    for (var node = node_count; node > 0u; node -= 1u) {
        let own = nodes[slot * OWN + node - 1u];
        is_whole = is_whole && own.is_sound && own.load.x > grown && grown < 1.0;
        if is_whole {
            first_node = node - 1u;
            grown = own.load.x;
        }
    }
    if lane == 0u && is_there {
        var most = 0.0;
        for (var function_ = 0u; function_ < DECISIVE; function_ += 1u) {
            most = max(most, left_out[slot * FOURS + function_ / 4u][function_ % 4u]);
        }
        found[found_at] = most;
    }
    for (var load = lane; load < load_count; load += OWN) {
        search(joint_at, load, first_node, found_at + 1u + STATE_NUMBERS * load);
    }
}
