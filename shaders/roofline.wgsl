// Twin: none, it does nothing but work: what a device can do at most, for others to be measured against.
//
// `copy` moves numbers from one large buffer to another: the peak of its memory. `multiply_add` runs chains of
// multiply-adds that do not wait for each other, as many as hide their latency: the peak of its arithmetic.
//
// In both one invocation has numbers of its own and meets no other.

struct RooflineParameters {
    // Links of a chain, or vectors that an invocation copies.
    trip_count: u32,
    // The numbers of a chain tend to term/(1 - factor), from where they do not move: no overflow, no denormals.
    factor: f32,
    term: f32,
}

@group(0) @binding(0) var<uniform> parameters: RooflineParameters;
@group(0) @binding(1) var<storage, read> source: array<wide4>;
@group(0) @binding(2) var<storage, read_write> copied: array<wide4>;

// Workgroups come along two dimensions; their numbers go on from row to row.
fn workgroup_number(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return group.y * groups.x + group.x;
}

// Neighbours take neighbouring vectors.
@compute @workgroup_size(INVOCATIONS)
fn copy(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let first = workgroup_number(group, groups) * INVOCATIONS * parameters.trip_count + invocation;
    for (var trip = 0u; trip < parameters.trip_count; trip++) {
        let place = first + trip * INVOCATIONS;
        copied[place] = source[place];
    }
}

// Eight chains of four numbers, a multiply-add each a trip.
@compute @workgroup_size(INVOCATIONS)
fn multiply_add(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let factor = wide4(wide(parameters.factor));
    let term = wide4(wide(parameters.term));
    var a = source[invocation];
    var b = a + term;
    var c = b + term;
    var d = c + term;
    var e = d + term;
    var f = e + term;
    var g = f + term;
    var h = g + term;
    for (var trip = 0u; trip < parameters.trip_count; trip++) {
        a = fma(a, factor, term);
        b = fma(b, factor, term);
        c = fma(c, factor, term);
        d = fma(d, factor, term);
        e = fma(e, factor, term);
        f = fma(f, factor, term);
        g = fma(g, factor, term);
        h = fma(h, factor, term);
    }
    // A result that nobody stores would not be computed; all workgroups store theirs at one place.
    copied[invocation] = a + b + c + d + e + f + g + h;
}
