// Twin: `engine/row.rs` (`Solving::respond`), `engine/accuracy`, `output/row_value.rs` and `output/reduce`.
//
// Answers: from the states of joints to what a question asks of all rows together, in f32. One workgroup has `TOGETHER` designs, whose rows
// its invocations take in turn. Numbers have a radius beside them: the processor's own number, in f64, is surely within it. Designs of
// which all is sure are counted here. All others, and those with a row that may be among the extreme ones, are told to the processor,
// which solves them itself.
//
// `condition` and `quantity` are written for each question (`engine/question/formula.rs`). Where numbers of the question (`Field`) and counts of
// all rows (`Total`) stand, and what verdicts are, comes from there, too.

// What the kernel of joints has found, and what it was given: the numbers that are for this one are behind its own.
@group(0) @binding(0) var<storage, read> found: array<f32>;
@group(0) @binding(1) var<storage, read> joints: array<f32>;
// Numbers and tables of the question, what is known of meshes, and bounds of fits. Counts and places are whole numbers.
@group(0) @binding(2) var<storage, read> asked: array<f32>;
// Of each design: where its numbers in `joints` and what is found of it begin, how many loads it has, and how many numbers its joint has
// behind those of its loads.
@group(0) @binding(3) var<storage, read> designs: array<vec4<u32>>;
// Counts, then a verdict for each design.
@group(0) @binding(4) var<storage, read_write> told: array<atomic<u32>>;

const INFINITE_BITS = 0x7f800000u;

// What all radii are multiplied by. Rows are calculated a second time when they are counted, and compilers may round otherwise there. So radii
// are half as large then: whatever was sure still is.
var<private> widened: f32 = 1.0;
const WHEN_COUNTED = 0.5;

// A radius beyond which a number is unknown.
const UNKNOWN = 1e30;
const SIXTH_OF_PI = 0.5235988;

struct Row {
    // Where the numbers of the design that the processor gives begin, and those of the load.
    givens_at: u32,
    row_givens_at: u32,
    // There is no state, or it may want one thing or another.
    is_unsure: bool,
    // What it wants of the next attempt, as a verdict; `OPEN` where nothing.
    want: u32,
    // All of it is surely good.
    is_good: bool,
    is_large: bool,
    indentation: vec2<f32>,
    offset: vec2<f32>,
    force: vec2<f32>,
    tangent_stiffness: vec2<f32>,
    half_angle: vec2<f32>,
    peak_pressure: vec2<f32>,
    energy: vec2<f32>,
    force_error: vec2<f32>,
    linearity_error: vec2<f32>,
}

// Quantities that are summed abreast: each row is made once for all of them. No more have room in a workgroup's memory.
const ABREAST = 3u;

// Of quantities in this workgroup, [quantity][sign and exponent][part]: the numbers, then 12 binary digits at a time of sums of mantissas, and
// of the three products that squares of mantissas are made of.
var<workgroup> sums: array<atomic<u32>, ABREAST * SUM_WORDS>;

// What is counted of all rows of this workgroup: one atomic operation for all its designs where all workgroups meet.
var<workgroup> totals: array<atomic<u32>, OF_ALL>;

// Of each design of this workgroup, and behind the last one, where its rows begin among those of all of them; and what is said of its rows:
// a bit for each verdict, and one where they are unsure.
var<workgroup> row_starts: array<u32, TOGETHER + 1u>;
var<workgroup> said: array<atomic<u32>, TOGETHER>;

const UNSURE = 0x80000000u;

fn whole(at: u32) -> u32 {
    return u32(asked[at]);
}

// A number with the radius that rounding leaves, and one that is exact.
fn given(at: u32) -> vec2<f32> {
    return vec2<f32>(joints[at], widened * ROUNDED * abs(joints[at]));
}

fn exact(at: u32) -> vec2<f32> {
    return vec2<f32>(joints[at], 0.0);
}

fn is_known(a: vec2<f32>) -> bool {
    return is_finite(wide(a.x)) && is_finite(wide(a.y)) && a.y < UNKNOWN;
}

fn unknown() -> vec2<f32> {
    return vec2<f32>(0.0, 2.0 * UNKNOWN);
}

fn rounded(value: f32, radius: f32) -> vec2<f32> {
    return vec2<f32>(value, radius + widened * CALCULATED * abs(value));
}

fn negate(a: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(-a.x, a.y);
}

fn add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return rounded(a.x + b.x, a.y + b.y);
}

fn subtract(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return rounded(a.x - b.x, a.y + b.y);
}

fn multiply(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return rounded(a.x * b.x, abs(a.x) * b.y + abs(b.x) * a.y + a.y * b.y);
}

fn divide(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let least = abs(b.x) - b.y;
    if !(least > 0.0) {
        return unknown();
    }
    let value = a.x / b.x;
    return rounded(value, (a.y + abs(value) * b.y) / least);
}

fn absolute(a: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(abs(a.x), a.y);
}

fn square_root(a: vec2<f32>) -> vec2<f32> {
    if !(a.x > a.y) {
        return unknown();
    }
    return rounded(sqrt(a.x), a.y / sqrt(a.x - a.y));
}

fn logarithm(a: vec2<f32>) -> vec2<f32> {
    if !(a.x > a.y) {
        return unknown();
    }
    return rounded(log(a.x), a.y / (a.x - a.y) + widened * CALCULATED);
}

fn logarithm10(a: vec2<f32>) -> vec2<f32> {
    return multiply(logarithm(a), vec2<f32>(0.4342945, 0.0));
}

fn exponential(a: vec2<f32>) -> vec2<f32> {
    if !(a.y < 0.1 && abs(a.x) + a.y < 80.0) {
        return unknown();
    }
    let value = exp(a.x);
    return rounded(value, value * (1.1 * a.y + widened * CALCULATED * abs(a.x)));
}

fn power(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return exponential(multiply(b, logarithm(a)));
}

fn smaller(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(min(a.x, b.x), max(a.y, b.y));
}

fn larger(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(max(a.x, b.x), max(a.y, b.y));
}

// Conditions are 1 or 0 with a radius of zero where they are sure.
fn condition_of(is_sure: bool, is_surely_not: bool, a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    if is_known(a) && is_known(b) && (is_sure || is_surely_not) {
        return vec2<f32>(select(0.0, 1.0, is_sure), 0.0);
    }
    return unknown();
}

fn less(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let radius = a.y + b.y;
    let is_sure = b.x - a.x > radius;
    let is_surely_not = a.x - b.x >= radius;
    return condition_of(is_sure, is_surely_not, a, b);
}

fn less_or_equal(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let radius = a.y + b.y;
    let is_sure = b.x - a.x >= radius;
    let is_surely_not = a.x - b.x > radius;
    return condition_of(is_sure, is_surely_not, a, b);
}

fn equal(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let radius = a.y + b.y;
    return condition_of(radius == 0.0 && a.x == b.x, abs(a.x - b.x) > radius, a, b);
}

fn opposite(a: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(1.0 - a.x, a.y);
}

fn is_surely(a: vec2<f32>, value: f32) -> bool {
    return a.y == 0.0 && a.x == value;
}

fn both(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    if is_surely(a, 0.0) || is_surely(b, 0.0) {
        return vec2<f32>(0.0);
    }
    if is_surely(a, 1.0) && is_surely(b, 1.0) {
        return vec2<f32>(1.0, 0.0);
    }
    return unknown();
}

fn either(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return opposite(both(opposite(a), opposite(b)));
}

fn told_by(holds: bool) -> vec2<f32> {
    return vec2<f32>(select(0.0, 1.0, holds), 0.0);
}

// The bound of a body at a half angle: of its fit, and of what is known of its meshes.
fn bound_at(body_at: u32, half_angle: f32) -> f32 {
    let table_at = u32(joints[body_at]);
    let kind = u32(joints[body_at + 1u]);
    let angle_count = whole(table_at);
    var below = 0u;
    for (var angle = 0u; angle < angle_count; angle += 1u) {
        below += select(0u, 1u, asked[table_at + 1u + angle] > half_angle);
    }
    let of_fit = asked[table_at + 1u + angle_count + KINDS * below + kind];
    var column = 0u;
    for (var begin = 0u; begin + 1u < COLUMNS; begin += 1u) {
        column += select(0u, 1u, half_angle >= asked[whole(COLUMN_BEGINS_AT) + begin]);
    }
    let of_mesh = asked[whole(MESH_ERRORS_AT) + COLUMNS * u32(joints[body_at + 2u]) + column];
    return sqrt(of_fit + of_mesh * of_mesh);
}

// Twin: `ForceError::want`.
fn want_of(bodies: f32, pressure: f32, curve: f32, outlines: f32, pressure_is_positive: bool) -> u32 {
    let allowed = asked[ACCURACY];
    let accuracy = allowed - select(0.0, outlines, outlines < 0.5 * allowed);
    if LEAST_ERROR + bodies > accuracy {
        return FINER_MESH;
    }
    if pressure_is_positive && bodies + pressure + curve <= accuracy {
        return OPEN;
    }
    return select(MORE_TERMS, MORE_NODES, pressure_is_positive && curve > pressure);
}

fn found_number(value: f32) -> vec2<f32> {
    return vec2<f32>(value, widened * FOUND * abs(value));
}

// The angle of which half has a tangent, which is not negative. WGSL's `atan` may be off by 4,096 roundings.
fn angle_of(tangent_of_half: f32) -> f32 {
    let of_quarter = tangent_of_half / (1.0 + sqrt(1.0 + tangent_of_half * tangent_of_half));
    // At most tan(pi/8): a ninth term of the series would be 4e-8.
    let of_eighth = of_quarter / (1.0 + sqrt(1.0 + of_quarter * of_quarter));
    let square = of_eighth * of_eighth;
    var sum = 0.0;
    for (var odd = 15; odd > 0; odd -= 2) {
        sum = 1.0 / f32(odd) - square * sum;
    }
    return 8.0 * of_eighth * sum;
}

fn row_of(design: vec4<u32>, load: u32) -> Row {
    // Behind all numbers of the joint.
    let at = design.x + JOINT_NUMBERS + 2u * design.z + design.w;
    let ratio = joints[design.x + JOINT_NUMBERS - 2u];
    let hole_radius = joints[at];
    let thickness = joints[at + 1u];
    let even = joints[at + 2u];
    let clearance = joints[at + 3u];
    let softest = joints[at + 4u];
    let of_all = joints[at + 5u];
    let of_shear = joints[at + 6u];
    var row: Row;
    row.givens_at = at + DESIGN_NUMBERS;
    let load_at = row.givens_at + whole(GIVEN_OF_DESIGN) + load * (3u + whole(GIVEN_OF_ROW) + whole(AXIS_COUNT));
    row.row_givens_at = load_at + 2u;
    let found_at = design.y + 1u + STATE_NUMBERS * load;
    let state_force = found[found_at + 3u] / even;
    let state_stiffness = found[found_at + 4u] / even;
    let state_energy = found[found_at + 5u] / even;
    let state_peak = found[found_at + 6u] / even;
    let truncation = found[found_at + 7u];
    let tangent_of_half = found[found_at + 1u] / ratio;
    let half_angle = angle_of(tangent_of_half);
    // Lengths are over this times the hole's radius.
    var unit = joints[load_at];
    if joints[load_at + 1u] > 0.0 {
        unit = joints[load_at + 1u] / state_force;
    }
    let length = hole_radius * unit;
    let indentation = length * found[found_at + 2u];
    let peak = unit * state_peak;
    row.indentation = found_number(indentation);
    row.offset = add(found_number(indentation), found_number(clearance * hole_radius));
    row.force = found_number(thickness * length * state_force);
    row.tangent_stiffness = found_number(thickness * state_stiffness);
    row.half_angle = found_number(degrees(half_angle));
    row.peak_pressure = found_number(peak);
    row.energy = found_number(thickness * length * length * state_energy);
    let linearity = OF_STRAIN * max(indentation / hole_radius, peak / softest);
    row.linearity_error = found_number(linearity);

    // Angles where bounds change are met from both sides.
    let above = found[found_at + 9u];
    let below = found[found_at + 10u];
    let shares = vec2<f32>(max(above, below), 1.0 - min(above, below));
    var least = 0.0;
    var most = 0.0;
    for (var side = 0u; side < 2u; side += 1u) {
        let body_at = at + SCENE_NUMBERS + side * BODY_BOUND_NUMBERS;
        let wide_end = shares[side] * bound_at(body_at, half_angle * (1.0 + FOUND));
        let narrow_end = shares[side] * bound_at(body_at, half_angle * (1.0 - FOUND));
        least += min(wide_end, narrow_end);
        most += max(wide_end, narrow_end);
    }
    let sine = 2.0 * tangent_of_half / (1.0 + tangent_of_half * tangent_of_half);
    let of_width = select(1.0, OF_SINE * sine, half_angle < SIXTH_OF_PI);
    let of_outlines = of_width * (of_all + of_shear * sine * sine);
    let of_curve = LEAST_ERROR + ROUGH * found[design.y];
    let total = vec2<f32>(least, most) + truncation + of_curve + of_outlines;
    let is_positive = found[found_at + 8u] > 0.0;
    row.want = want_of(most, truncation, of_curve, of_outlines, is_positive);
    let is_close = row.want != want_of(least, truncation, of_curve, of_outlines, is_positive);
    row.force_error = vec2<f32>(
        0.5 * (total.x + total.y),
        widened * (0.5 * (total.y - total.x) + OF_ERRORS * total.y + NOISE),
    );
    // A little less than is allowed; what outlines leave counts in full.
    let is_accurate = total.y <= asked[ACCURACY] * (1.0 - OF_ERRORS);
    let is_a_push = state_force > 0.0 && state_stiffness > 0.0 && state_energy > 0.0 && state_peak > 0.0;
    let remarked = max(asked[ACCURACY], LARGE_DISPLACEMENT);
    let is_sure = abs(linearity - remarked) > row.linearity_error.y + ROUNDED * remarked;
    row.is_large = linearity > remarked;
    let is_there = found[found_at] == ENDED && is_a_push && is_finite(wide(total.y)) && is_finite(wide(peak))
        && is_finite(wide(indentation));
    row.is_unsure = is_close || !is_there;
    row.is_good = is_there && is_positive && is_accurate && is_sure;
    return row;
}

// Where a number has its place among sums and in a sketch, positive ones first; 2 `EXPONENTS` where there is none.
fn exponent_of(value: f32) -> u32 {
    let exponent = ((bitcast<u32>(value) >> 23u) & 255u) - LEAST_EXPONENT;
    return select(2u * EXPONENTS, exponent + select(0u, EXPONENTS, value < 0.0), exponent < EXPONENTS);
}

// Whether a number surely has one.
fn has_exponent(value: vec2<f32>) -> bool {
    return max(exponent_of(value.x - value.y), exponent_of(value.x + value.y)) < 2u * EXPONENTS;
}

struct Bin {
    // Below the first edge, in one of the bins, or above the last: counted from 0.
    place: u32,
    // The number is on no other side of an edge.
    is_sure: bool,
}

fn bin_of(histogram_at: u32, value: vec2<f32>) -> Bin {
    let edge_count = whole(histogram_at + 1u);
    let edges_at = whole(histogram_at + 2u);
    let radius = value.y + CALCULATED * abs(value.x);
    // Edges that are not above it.
    var low = 0u;
    var high = edge_count;
    while low < high {
        let middle = (low + high) / 2u;
        if asked[edges_at + middle] <= value.x {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let is_sure = (low == 0u || value.x - asked[edges_at + low - 1u] > radius)
        && (low == edge_count || asked[edges_at + low] - value.x > radius);
    return Bin(low, is_sure);
}

// Whether a row's values are sure enough to be counted.
fn is_countable(row: Row) -> bool {
    let quantity_count = whole(QUANTITY_COUNT);
    for (var number = 0u; number < quantity_count; number += 1u) {
        let value = quantity(number, row);
        if !is_known(value) {
            return false;
        }
        let is_counted = whole(whole(QUANTITIES_AT) + 2u * number + 1u) > 0u;
        if is_counted && (value.y > TRUSTED * abs(value.x) || !has_exponent(value)) {
            return false;
        }
    }
    for (var histogram = 0u; histogram < whole(HISTOGRAM_COUNT); histogram += 1u) {
        let histogram_at = whole(HISTOGRAMS_AT) + 4u * histogram;
        if !bin_of(histogram_at, quantity(whole(histogram_at), row)).is_sure {
            return false;
        }
    }
    return true;
}

// Whether a row may be among those that are told by themselves. What is given has been compared by the processor.
fn is_candidate(row: Row) -> bool {
    if joints[row.row_givens_at + whole(GIVEN_OF_ROW)] > 0.0 {
        return true;
    }
    for (var watch = 0u; watch < whole(WATCH_COUNT); watch += 1u) {
        let watch_at = whole(WATCHES_AT) + 3u * watch;
        let value = quantity(whole(watch_at), row);
        if asked[watch_at + 1u] * value.x - value.y <= asked[watch_at + 2u] {
            return true;
        }
    }
    let axis_count = whole(AXIS_COUNT);
    if axis_count == 0u {
        return false;
    }
    let axes_at = whole(AXES_AT);
    var scores: array<f32, 3>;
    for (var axis = 0u; axis < axis_count; axis += 1u) {
        let sign = asked[axes_at + 2u * axis + 1u];
        let source = whole(axes_at + 2u * axis);
        if sign == 0.0 {
            // Ranks are whole: one that is as large beats.
            scores[axis] = joints[row.row_givens_at + source] + 0.5;
        } else {
            let value = quantity(source, row);
            scores[axis] = sign * value.x - value.y;
        }
    }
    for (var point = 0u; point < whole(POINT_COUNT); point += 1u) {
        let point_at = axes_at + 2u * axis_count + axis_count * point;
        var beats = true;
        for (var axis = 0u; axis < axis_count; axis += 1u) {
            beats = beats && asked[point_at + axis] < scores[axis];
        }
        if beats {
            return false;
        }
    }
    return true;
}

// Of one that has a state.
fn verdict_of_row(row: Row) -> u32 {
    if !row.is_good {
        return OPEN;
    }
    let wanted = condition(row);
    if wanted.y != 0.0 {
        return OPEN;
    }
    if wanted.x == 0.0 {
        return COUNTED;
    }
    if !is_countable(row) {
        return OPEN;
    }
    return select(COUNTED, CANDIDATE, is_candidate(row));
}

// The bits of what a row says of its design.
fn bits_of(row: Row) -> u32 {
    if row.is_unsure {
        return UNSURE;
    }
    return (1u << verdict_of_row(row)) | select(1u << row.want, 0u, row.want == OPEN);
}

// From what all rows of a design say: it is counted where none is open. One that was drawn here and is in no fit has no rows.
fn verdict_of(bits: u32) -> u32 {
    if bits == 0u || (bits & UNSURE) != 0u {
        return OPEN;
    }
    let of_counted = (1u << COUNTED) | (1u << CANDIDATE);
    var own = bits & of_counted;
    if (bits & (1u << OPEN)) != 0u {
        own = select(bits & ~of_counted, 1u << OPEN, asked[ON_MESHES] == 0.0);
    }
    // The greatest of these.
    return 31u - countLeadingZeros(own);
}

// The design of this workgroup that has a row.
fn design_of(row: u32) -> u32 {
    var low = 0u;
    var high = TOGETHER;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if row_starts[middle] <= row {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// What is asked of all rows together, of those that an invocation has.
struct Totals {
    rows: u32,
    kept: u32,
    large: u32,
    // Of the estimates of errors, then of forces.
    greatest: vec3<f32>,
    least_force: f32,
}

fn add_row(row: Row, is_kept: bool, totals: ptr<function, Totals>) {
    (*totals).rows += 1u;
    (*totals).kept += select(0u, 1u, is_kept);
    (*totals).large += select(0u, 1u, row.is_large);
    let own = vec3<f32>(row.force_error.x, row.linearity_error.x, row.force.x);
    (*totals).greatest = max((*totals).greatest, own);
    (*totals).least_force = min((*totals).least_force, row.force.x);
}

fn count_totals(own: Totals) {
    if own.rows == 0u {
        return;
    }
    atomicAdd(&totals[COUNTED_ROWS], own.rows);
    atomicAdd(&totals[KEPT_ROWS], own.kept);
    atomicAdd(&totals[LARGE_ROWS], own.large);
    atomicMax(&totals[GREATEST_ERROR], bitcast<u32>(own.greatest.x));
    atomicMax(&totals[GREATEST_LINEARITY], bitcast<u32>(own.greatest.y));
    atomicMax(&totals[GREATEST_FORCE], bitcast<u32>(own.greatest.z));
    atomicMax(&totals[LEAST_FORCE], INFINITE_BITS - bitcast<u32>(own.least_force));
}

fn count_bins(row: Row) {
    for (var histogram = 0u; histogram < whole(HISTOGRAM_COUNT); histogram += 1u) {
        let histogram_at = whole(HISTOGRAMS_AT) + 4u * histogram;
        let bin = bin_of(histogram_at, quantity(whole(histogram_at), row));
        atomicAdd(&told[whole(histogram_at + 3u) + bin.place], 1u);
    }
}

fn add_halves(at: u32, number: u32) {
    atomicAdd(&sums[at], number & 0xfffu);
    atomicAdd(&sums[at + 1u], number >> 12u);
}

// Adds a number to sums of its workgroup, and to a sketch.
fn count_value(value: f32, own_sums: u32, sketch_at: u32) {
    let exponent = exponent_of(value);
    let mantissa = (bitcast<u32>(value) & 0x7fffffu) | 0x800000u;
    if sketch_at > 0u {
        atomicAdd(&told[sketch_at + exponent * LEADING + ((mantissa >> 13u) & (LEADING - 1u))], 1u);
    }
    let at = own_sums + exponent * PARTS;
    atomicAdd(&sums[at], 1u);
    add_halves(at + 1u, mantissa);
    let high = mantissa >> 12u;
    let low = mantissa & 0xfffu;
    add_halves(at + 3u, high * high);
    add_halves(at + 5u, high * low);
    add_halves(at + 7u, low * low);
}

// Some quantities of a row; with the first ones what asks for none of them alone.
fn count_row(row: Row, first: u32, end: u32, totals: ptr<function, Totals>) {
    let is_kept = condition(row).x == 1.0;
    if first == 0u {
        add_row(row, is_kept, totals);
    }
    if !is_kept {
        return;
    }
    if first == 0u {
        count_bins(row);
    }
    for (var number = first; number < end; number += 1u) {
        let quantity_at = whole(QUANTITIES_AT) + 2u * number;
        if whole(quantity_at + 1u) > 0u {
            count_value(quantity(number, row).x, (number - first) * SUM_WORDS, whole(quantity_at));
        }
    }
}

@compute @workgroup_size(INVOCATIONS)
fn answer(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let first_design = TOGETHER * group.x;
    let design_count = min(TOGETHER, arrayLength(&designs) - first_design);
    for (var word = invocation; word < OF_ALL; word += INVOCATIONS) {
        atomicStore(&totals[word], 0u);
    }
    for (var own = invocation; own < TOGETHER; own += INVOCATIONS) {
        atomicStore(&said[own], 0u);
        var rows = 0u;
        if own < design_count {
            rows = designs[first_design + own].z;
        }
        row_starts[own + 1u] = rows;
    }
    workgroupBarrier();
    if invocation == 0u {
        row_starts[0] = 0u;
        for (var own = 0u; own < TOGETHER; own += 1u) {
            row_starts[own + 1u] += row_starts[own];
        }
    }
    workgroupBarrier();
    let row_count = row_starts[TOGETHER];
    for (var place = invocation; place < row_count; place += INVOCATIONS) {
        let own = design_of(place);
        let row = row_of(designs[first_design + own], place - row_starts[own]);
        atomicOr(&said[own], bits_of(row));
    }
    workgroupBarrier();
    for (var own = invocation; own < design_count; own += INVOCATIONS) {
        let verdict = verdict_of(atomicLoad(&said[own]));
        atomicStore(&told[whole(VERDICTS_AT) + first_design + own], verdict);
        let is_counted = verdict == COUNTED || verdict == CANDIDATE;
        // From here on whether it is.
        atomicStore(&said[own], select(0u, 1u, is_counted));
        atomicAdd(&totals[COUNTED_DESIGNS], select(0u, 1u, is_counted));
    }
    widened = WHEN_COUNTED;
    let quantity_count = whole(QUANTITY_COUNT);
    // Once where none is summed.
    for (var first = 0u; first == 0u || first < quantity_count; first += ABREAST) {
        for (var word = invocation; word < ABREAST * SUM_WORDS; word += INVOCATIONS) {
            atomicStore(&sums[word], 0u);
        }
        workgroupBarrier();
        var counted = Totals(0u, 0u, 0u, vec3<f32>(0.0), 3e38);
        for (var place = invocation; place < row_count; place += INVOCATIONS) {
            let own = design_of(place);
            if atomicLoad(&said[own]) == 1u {
                let row = row_of(designs[first_design + own], place - row_starts[own]);
                count_row(row, first, min(quantity_count, first + ABREAST), &counted);
            }
        }
        count_totals(counted);
        workgroupBarrier();
        for (var number = first; number < min(quantity_count, first + ABREAST); number += 1u) {
            let sums_at = whole(whole(QUANTITIES_AT) + 2u * number + 1u);
            for (var word = invocation; sums_at > 0u && word < SUM_WORDS; word += INVOCATIONS) {
                let own = atomicLoad(&sums[(number - first) * SUM_WORDS + word]);
                if own > 0u {
                    atomicAdd(&told[sums_at + word], own);
                }
            }
        }
        workgroupBarrier();
    }
    for (var word = invocation; word < OF_ALL; word += INVOCATIONS) {
        let own = atomicLoad(&totals[word]);
        if word <= LARGE_ROWS {
            atomicAdd(&told[word], own);
        } else {
            atomicMax(&told[word], own);
        }
    }
}
