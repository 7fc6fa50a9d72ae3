// Twin: `study/sampling.rs`, `study/values.rs`, `engine/interpolation/on_device.rs` (`Interpolation::begin_counting`) and `engine/question/tables.rs`.
//
// Designs: from their numbers to what `joints.wgsl` and `answers.wgsl` are given of them, in f64. One invocation has one design: it draws
// its values by the sampler of the study, finds its bodies in their fits, and writes its numbers as f32. What is not in a fit, and what is not
// sure, has no loads: it is left to the processor.
//
// `given_of_design` and `given_of_row` are written for each question (`engine/question/drawn.rs`).

struct Settings {
    first: u32,
    design_count: u32,
    // Of the sampler, and the mixed seed of its Sobol sequence.
    count: u32,
    load_count: u32,
    seed: vec2<u32>,
    // Numbers of a design, and of what is found of it.
    stride: u32,
    found_stride: u32,
    given_of_design: u32,
    given_of_row: u32,
    // Numbers of a row behind what is given of it.
    behind_row: u32,
    plate_fit_count: u32,
    // Where in `words` the tables of pin and plate begin.
    sides_at: vec2<u32>,
    // Kinds of the loads, in `words`, and their values, in `numbers`.
    loads_at: vec2<u32>,
    // Where in `words` there are parameters of joints and, from 2^24 on, their trial pressures: [pin's fit][plate's][wide][shallow].
    pairs_at: u32,
    padding: u32,
    more_padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> settings: Settings;
// Entries of quantities (`study/draw_tables.rs`), then what `backend/drawn.rs` has of bodies and pairs.
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read> numbers: array<wide>;
@group(0) @binding(3) var<storage, read_write> joints: array<f32>;
@group(0) @binding(4) var<storage, read_write> places: array<Place>;
@group(0) @binding(5) var<storage, read_write> designs: array<vec4<u32>>;

// Of the design that an invocation has.
var<private> design: u32;
var<private> drawn: array<wide, SLOT_COUNT>;
var<private> at: u32;
var<private> is_known: bool;

// --- Whole numbers of 64 binary digits: the low half, then the high one. ---

fn product(a: u32, b: u32) -> vec2<u32> {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let first = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let second = (a & 0xffffu) * (b >> 16u) + (first & 0xffffu);
    return vec2<u32>(a * b, (a >> 16u) * (b >> 16u) + (first >> 16u) + (second >> 16u));
}

fn times(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = product(a.x, b.x);
    return vec2<u32>(low.x, low.y + a.x * b.y + a.y * b.x);
}

fn plus(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn shifted(a: vec2<u32>, count: u32) -> vec2<u32> {
    return vec2<u32>((a.x >> count) | (a.y << (32u - count)), a.y >> count);
}

// One step of SplitMix64.
fn mix64(state: vec2<u32>) -> vec2<u32> {
    var z = plus(state, vec2<u32>(0x7f4a7c15u, 0x9e3779b9u));
    z = times(z ^ shifted(z, 30u), vec2<u32>(0x1ce4e5b9u, 0xbf58476du));
    z = times(z ^ shifted(z, 27u), vec2<u32>(0x133111ebu, 0x94d049bbu));
    return z ^ shifted(z, 31u);
}

// --- Samplers. ---

fn permuted(position: u32, count: u32, key: vec2<u32>) -> u32 {
    let half = max((33u - countLeadingZeros(count)) / 2u, 4u);
    let mask = (1u << half) - 1u;
    var current = position;
    loop {
        var left = current >> half;
        var right = current & mask;
        for (var round = 0u; round < 6u; round += 1u) {
            let next = left ^ (mix64(key ^ vec2<u32>(right, round << 24u)).x & mask);
            left = right;
            right = next;
        }
        current = (left << half) | right;
        if current < count {
            break;
        }
    }
    return current;
}

fn slice(count: u32, key: vec2<u32>) -> wide {
    let position = permuted(design, count, key);
    let random = shifted(mix64(key ^ mix64(vec2<u32>(~design, 0xffffffffu))), 11u);
    let jitter = (wide(random.y) * 4294967296.0 + wide(random.x)) / 9007199254740992.0;
    return (wide(position) + jitter) / wide(count);
}

fn hash(number: u32) -> u32 {
    var n = number ^ 0xe6fe3bebu;
    n ^= n >> 16u;
    n *= 0x7feb352du;
    n ^= n >> 15u;
    n *= 0x846ca68bu;
    return n ^ (n >> 16u);
}

fn owen_scramble(number: u32, scramble: u32) -> u32 {
    var n = number;
    n ^= n * 0x3d20adeau;
    n += scramble;
    n *= (scramble >> 16u) | 1u;
    n ^= n * 0x05526c56u;
    return n ^ (n * 0x53a22864u);
}

fn sobol(rank: u32, vectors_at: u32) -> wide {
    let seed = mix64(settings.seed ^ vec2<u32>(design >> SOBOL_BITS, 0u)).y;
    let index = design & ((1u << SOBOL_BITS) - 1u);
    let shuffled = owen_scramble(reverseBits(index), hash(seed ^ 0x79c68e4au));
    var point = 0u;
    for (var bit = 0u; bit < SOBOL_BITS; bit += 1u) {
        point ^= select(0u, words[vectors_at + bit], ((shuffled << bit) & 0x80000000u) != 0u);
    }
    var of_dimensions = array<u32, 4>(0x912f69bau, 0x174f18abu, 0x691e72cau, 0xb40cc1b8u);
    let scramble = (rank >> 2u) ^ (seed * 0x9c8f2d3bu) ^ of_dimensions[rank & 3u];
    let digits = reverseBits(owen_scramble(point, hash(scramble)));
    return wide(digits >> 9u) / 8388608.0;
}

// --- Values. ---

fn value_of(slot: u32) -> wide {
    let entry = ENTRY_WORDS * slot;
    let source = words[entry];
    let key = vec2<u32>(words[entry + 3u], words[entry + 4u]);
    let kind = words[entry + 7u];
    let values_at = words[entry + 8u];
    let value_count = words[entry + 9u];
    var index = 0u;
    var fraction = wide(0.0);
    let is_fraction = source == SLICES || source == SOBOL;
    if source == GRID {
        index = (design / words[entry + 1u]) % words[entry + 2u];
    } else if source == ZIP {
        index = design;
    } else if source == SLICES {
        fraction = slice(settings.count, key);
    } else if source == SOBOL {
        fraction = sobol(words[entry + 5u], words[entry + 6u]);
    }
    if kind == LIST {
        if is_fraction {
            index = u32(fraction * wide(value_count));
        }
        return numbers[values_at + min(index, value_count - 1u)];
    }
    let low = numbers[values_at];
    let high = numbers[values_at + 1u];
    var value = low * (1.0 - fraction) + high * fraction;
    if kind == LOGARITHMIC {
        // The binary digits of the fraction, the highest first; one that was rounded up to 1 is the one before.
        let leading = fraction * 2097152.0;
        var first = u32(leading);
        var second = u32((leading - wide(first)) * 4294967296.0);
        if first >= 2097152u {
            first = 2097151u;
            second = 0xffffffffu;
        }
        value = low;
        for (var bit = 0u; bit < ROOTS; bit += 1u) {
            let digits = select(second << (bit - 21u), first << (bit + 11u), bit < 21u);
            if (digits & 0x80000000u) != 0u {
                value *= numbers[values_at + 2u + bit];
            }
        }
    }
    return clamp(value, low, high);
}

fn load_value(load: u32) -> wide {
    return numbers[settings.loads_at.y + load];
}

fn told(holds: bool) -> wide {
    return select(wide(0.0), wide(1.0), holds);
}

// Of numbers that are known to rounding.
fn told_apart(holds: bool, a: wide, b: wide) -> wide {
    is_known = is_known && abs(a - b) > 1e-13 * max(abs(a), abs(b));
    return told(holds);
}

// Of a positive number; no device has it in f64.
fn logarithm(number: wide) -> wide {
    let bits = bitcast<u32>(f32(number));
    var exponent = i32(bits >> 23u) - 127;
    // Between the roots of 1/2 and 2.
    if (bits & 0x7fffffu) > 0x3504f3u {
        exponent += 1;
    }
    let mantissa = number * wide(bitcast<f32>(u32(127 - exponent) << 23u));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let square = s * s;
    var sum = wide(0.0);
    for (var odd = 21; odd > 0; odd -= 2) {
        sum = sum * square + 1.0 / wide(odd);
    }
    return 2.0 * s * sum + wide(exponent) * 0.6931471805599453;
}

// --- Bodies. ---

// A body of a joint.
struct Side {
    // Its place among the fits of its side.
    fit: u32,
    // Of the infinite body, and what they are multiplied by, 1/MPa.
    even: wide,
    odd: wide,
    share: wide,
    // |ln r| of its thinnest wall.
    least_depth: wide,
    // E', MPa.
    plane_modulus: wide,
}

fn plane_modulus_ratio(is_strain: bool, nu: wide) -> wide {
    return select(wide(1.0), 1.0 / (1.0 - nu * nu), is_strain);
}

fn kolosov(is_strain: bool, nu: wide) -> wide {
    return select((3.0 - nu) / (1.0 + nu), 3.0 - 4.0 * nu, is_strain);
}

// Writes the next number of the design.
fn put(number: wide) {
    let rounded = f32(number);
    is_known = is_known && is_finite(wide(rounded));
    joints[at] = rounded;
    at += 1u;
}

// Finds the body of a side (0 the pin, 1 the plate) in its fit. Its coordinates over the box of that go to `joints_at`, what is known of its
// errors to `bounds_at`.
fn side_of(side: u32, joints_at: u32, bounds_at: u32) -> Side {
    let table = settings.sides_at[side];
    let parameter_count = words[table];
    let shape = words[table + 1u];
    let first = select(PLATE, PIN, side == 0u);
    let modulus = drawn[first + YOUNGS_MODULUS];
    let is_strain = drawn[IDEALIZATION] != 0.0;
    let own_nu = drawn[first + POISSONS_RATIO];
    // The body of either plane state that stands for it.
    let ratio = select((1.0 - own_nu) / (1.0 + own_nu), 1.0 - 2.0 * own_nu, is_strain);
    let stands_in_strain = ratio <= 1.0;
    let is_itself = stands_in_strain == is_strain;
    var nu = select((1.0 - ratio) / (1.0 + ratio), 0.5 * (1.0 - ratio), stands_in_strain);
    nu = select(nu, own_nu, is_itself);
    let own_modulus_ratio = plane_modulus_ratio(is_strain, own_nu);
    let modulus_ratio = plane_modulus_ratio(stands_in_strain, nu);
    var body: Side;
    body.plane_modulus = modulus * own_modulus_ratio;
    body.share = select(modulus_ratio / own_modulus_ratio, wide(1.0), is_itself) / modulus;
    body.even = 2.0 / modulus_ratio;
    let kappa = kolosov(stands_in_strain, nu);
    body.odd = select(wide(1.0), wide(-1.0), side == 0u) * body.even * (kappa - 1.0) / (kappa + 1.0);

    var coordinates: array<wide, MOST_COORDINATES>;
    // Without parameters all bodies are as deep.
    body.least_depth = numbers[words[table + 7u] + DEPTH_COUNT];
    var greatest = body.least_depth;
    if parameter_count > 0u {
        body.least_depth = wide(1e30);
        greatest = wide(0.0);
    }
    for (var own = 0u; own < parameter_count; own += 1u) {
        let depth = logarithm(drawn[first + own]);
        body.least_depth = min(body.least_depth, abs(depth));
        greatest = max(greatest, abs(depth));
        coordinates[own] = depth;
        if shape == CONCENTRIC {
            coordinates[own] = logarithm(max(abs(depth), wide(1e-30)));
        }
    }
    if shape == BLOCK {
        let half_width = drawn[first];
        let end = max(drawn[first + 1u], drawn[first + 2u]);
        greatest = 0.5 * logarithm(half_width * half_width + end * end);
    }
    coordinates[parameter_count] = logarithm(ratio);

    // Its kind by Poisson's ratio, of which there are as many as cuts, and one more.
    let cuts = table + 2u + 2u * select(0u, 1u, stands_in_strain);
    let cuts_at = words[cuts];
    var kind = 0u;
    for (var cut = 0u; cut < words[cuts + 1u]; cut += 1u) {
        kind += select(0u, 1u, nu >= numbers[cuts_at + cut]);
    }
    let support = u32(drawn[first + SUPPORT]);
    let row = table + SIDE_WORDS + 2u * ((2u * support + select(0u, 1u, stands_in_strain)) * MOST_KINDS + kind);
    body.fit = words[row];
    let known_at = words[row + 1u];
    if body.fit == NOWHERE || body.least_depth <= THIN || greatest >= DEEPEST_MESHED {
        is_known = false;
        return body;
    }

    let fits_at = words[table + 6u] + FIT_WORDS * body.fit;
    var is_inside = true;
    for (var own = 0u; own < MOST_COORDINATES; own += 1u) {
        var place = wide(0.0);
        if own <= parameter_count {
            let low = numbers[words[fits_at] + 2u * own];
            let high = numbers[words[fits_at] + 2u * own + 1u];
            let value = coordinates[own];
            if high > low {
                place = (2.0 * value - low - high) / (high - low);
                is_known = is_known && low <= value && value <= high;
                is_inside = is_inside && min(value - low, high - value) > NEAR_END * (high - low);
            } else {
                // Equal to rounding.
                is_known = is_known && abs(value - low) <= 1e-12 * max(wide(1.0), abs(low));
            }
        }
        joints[joints_at + own] = f32(place);
    }

    joints[bounds_at] = f32(words[fits_at + 1u]);
    joints[bounds_at + 1u] = f32(select(select(1u, 0u, is_inside), 2u, body.least_depth < THIN_END));
    // Of the meshes the fit was made on: the deepest body that is known, then by depths where errors stand.
    is_known = is_known && greatest <= numbers[known_at];
    var depth = 0u;
    for (var begin = 1u; begin < DEPTH_COUNT; begin += 1u) {
        depth += select(0u, 1u, body.least_depth >= numbers[words[table + 7u] + begin]);
    }
    let errors_at = numbers[known_at + 1u + depth];
    is_known = is_known && errors_at >= 0.0;
    joints[bounds_at + 2u] = f32(errors_at);
    return body;
}

// Writes the numbers of the design whose values are drawn; tells what its joint has in common with others, or `NOWHERE`.
fn describe() -> u32 {
    let hole_radius = drawn[HOLE_RADIUS];
    let radial_clearance = drawn[RADIAL_CLEARANCE];
    let thickness = drawn[THICKNESS];
    let clearance = radial_clearance / hole_radius;
    is_known = is_known && clearance >= 0.0 && clearance <= NARROW;
    let numbers_at = at;
    let bounds_at = numbers_at + JOINT_NUMBERS + 2u * settings.load_count + SCENE_NUMBERS;
    let pin = side_of(0u, numbers_at, bounds_at);
    let plate = side_of(1u, numbers_at + BODY_NUMBERS, bounds_at + BODY_BOUND_NUMBERS);
    if !is_known {
        return NOWHERE;
    }
    let even = pin.share * pin.even + plate.share * plate.even;
    at = numbers_at + MOST_COORDINATES;
    put(pin.even);
    put(pin.odd);
    put(pin.share / even);
    at += MOST_COORDINATES;
    put(plate.even);
    put(plate.odd);
    put(plate.share / even);
    let ratio = 1.0 / (1.0 - clearance);
    let square = clearance * clearance;
    put(0.5 * (ratio - 1.0 / ratio));
    put(square);
    put(clearance);
    put(ratio);
    put(0.25 * square);

    let effective = 1.0 / (1.0 / pin.plane_modulus + 1.0 / plate.plane_modulus);
    var is_wide = false;
    var loads_at = bounds_at + 2u * BODY_BOUND_NUMBERS + settings.given_of_design;
    let of_row = 2u + settings.given_of_row + settings.behind_row;
    for (var load = 0u; load < settings.load_count; load += 1u) {
        let kind = words[settings.loads_at.x + load];
        var value = load_value(load);
        if kind == OFFSET {
            value -= radial_clearance;
        }
        is_known = is_known && value > 0.0;
        if kind == FORCE {
            let force = value / (thickness * hole_radius);
            put(wide(1.0));
            // A neat fit has one half angle, whatever the load.
            put(clearance / force / even);
            let square_of_tangent = value / thickness / (PI * effective * radial_clearance);
            is_wide = is_wide || radial_clearance == 0.0 || square_of_tangent >= WIDE_TANGENT * WIDE_TANGENT;
            joints[loads_at] = 0.0;
            joints[loads_at + 1u] = f32(force);
        } else {
            let length = value / hole_radius;
            put((clearance + length) / length);
            put(wide(0.0));
            is_wide = is_wide || radial_clearance <= WIDE_COSINE * (radial_clearance + value);
            joints[loads_at] = f32(clearance + length);
            joints[loads_at + 1u] = 0.0;
        }
        loads_at += of_row;
    }

    put(hole_radius);
    put(thickness);
    put(even);
    put(clearance);
    put(min(drawn[PIN + YOUNGS_MODULUS], drawn[PLATE + YOUNGS_MODULUS]));
    // What outlines leave.
    let of_pin = plate.plane_modulus / (pin.plane_modulus + plate.plane_modulus);
    let kappa = kolosov(drawn[IDEALIZATION] != 0.0, drawn[PIN + POISSONS_RATIO]);
    let resistance = min((kappa + 1.0) / (kappa - 1.0), STIFFEST);
    let wall = min(wide(exp(f32(2.0 * (WALL - pin.least_depth)))), wide(1.0));
    let is_concentric = words[settings.sides_at.x + 1u] == CONCENTRIC;
    let all = select(OF_HELD * of_pin, wide(0.0), is_concentric);
    let shear = select(wide(0.0), clearance * OF_SHEAR * of_pin * resistance * wall, is_concentric);
    put(square * (clearance * OF_CUBE + all));
    put(square * shear);

    at = bounds_at + 2u * BODY_BOUND_NUMBERS;
    for (var number = 0u; number < settings.given_of_design; number += 1u) {
        put(given_of_design(number, 0u));
    }
    for (var load = 0u; load < settings.load_count; load += 1u) {
        at += 2u;
        for (var number = 0u; number < settings.given_of_row; number += 1u) {
            put(given_of_row(number, load));
        }
        for (var number = 0u; number < settings.behind_row; number += 1u) {
            put(wide(0.0));
        }
    }
    let is_shallow = min(pin.least_depth, plate.least_depth) <= DEEP;
    let pair = pin.fit * settings.plate_fit_count + plate.fit;
    return words[settings.pairs_at + 4u * pair + 2u * select(0u, 1u, is_wide) + select(0u, 1u, is_shallow)];
}

@compute @workgroup_size(INVOCATIONS)
fn draw(@builtin(global_invocation_id) place: vec3<u32>) {
    if place.x >= settings.design_count {
        return;
    }
    design = settings.first + place.x;
    for (var slot = 0u; slot < SLOT_COUNT; slot += 1u) {
        drawn[slot] = value_of(slot);
    }
    let numbers_at = settings.stride * place.x;
    at = numbers_at;
    is_known = true;
    let parameters = describe();
    var own: Place;
    own.numbers_at = numbers_at;
    own.found_at = settings.found_stride * place.x;
    own.works_at = vec2<u32>(ELSEWHERE);
    if is_known && parameters != NOWHERE {
        own.parameters = parameters & 0xffffffu;
        own.terms = parameters >> 24u;
        own.load_count = settings.load_count;
    }
    places[place.x] = own;
    designs[place.x] = vec4<u32>(own.numbers_at, own.found_at, own.load_count, 0u);
}
