// Twin: none, it does nothing but work: what a device can do at most, for others to be measured against.
//
// `copy` moves numbers from one large buffer to another: the peak of its memory. `multiply_add` runs chains of
// multiply-adds that do not wait for each other, as many as hide their latency: the peak of its arithmetic. `read_cached` reads what all
// workgroups read, more than one processor's own cache holds and less than the cache of all: the peak of that. `read_shared` reads the
// workgroup's own memory: the peak of that.
//
// In all of them an invocation has numbers of its own and waits for no other, but for those that fill a workgroup's memory.

struct RooflineParameters {
    // Links of a chain, or vectors that an invocation copies or reads.
    trip_count: u32,
    // The numbers of a chain tend to term/(1 - factor), from where they do not move: no overflow, no denormals.
    factor: f32,
    term: f32,
}

@group(0) @binding(0) var<uniform> parameters: RooflineParameters;
@group(0) @binding(1) var<storage, read> source: array<wide4>;
@group(0) @binding(2) var<storage, read_write> copied: array<wide4>;

// Neighbours have neighbouring vectors.
var<workgroup> shared_vectors: array<wide4, SHARED>;

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

// Each workgroup from another place on, and round, so that no two read the same at a time. INVOCATIONS and the count of trips are powers
// of two.
@compute @workgroup_size(INVOCATIONS)
fn read_cached(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = parameters.trip_count * INVOCATIONS;
    let first = workgroup_number(group, groups) * STRIDE * INVOCATIONS + invocation;
    var sum = wide4();
    for (var trip = 0u; trip < parameters.trip_count; trip++) {
        sum += source[(first + trip * INVOCATIONS) & (count - 1u)];
    }
    copied[invocation] = sum;
}

// Four reads a trip, so that they do not wait for each other.
@compute @workgroup_size(INVOCATIONS)
fn read_shared(@builtin(local_invocation_index) invocation: u32) {
    for (var place = invocation; place < SHARED; place += INVOCATIONS) {
        shared_vectors[place] = source[place];
    }
    workgroupBarrier();
    var a = wide4();
    var b = wide4();
    var c = wide4();
    var d = wide4();
    for (var trip = 0u; trip < parameters.trip_count; trip++) {
        let place = invocation + trip;
        a += shared_vectors[place & (SHARED - 1u)];
        b += shared_vectors[(place + SHARED / 4u) & (SHARED - 1u)];
        c += shared_vectors[(place + SHARED / 2u) & (SHARED - 1u)];
        d += shared_vectors[(place + 3u * SHARED / 4u) & (SHARED - 1u)];
    }
    copied[invocation] = a + b + c + d;
}
