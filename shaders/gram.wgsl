// Twin: src/mechanics/compliance/lane_condensation.rs (gram) and near_field.rs (correct).
//
// From the compliance C of a ring to that of the trial pressures: for each arc G = F^T C F, F being the nodal loads of
// its trial pressures, and to it the near field of the body's class, interpolated in Poisson's ratio and in the growth of
// the layers.
//
// One workgroup makes one arc of one body. It goes through the ring's rows in tiles: of each tile W = C F first, then
// its share F^T W in all entries.

struct GramParameters {
    // Of the ring.
    ring_count: u32,
    // Groups of four columns of C.
    block_count: u32,
    arc_count: u32,
    // Of a whole slot.
    slot_size: u32,
    // Of the first body; the others follow.
    first_slot: u32,
    // Else in plane stress.
    is_plane_strain: u32,
}

@group(0) @binding(0) var<uniform> parameters: GramParameters;
// [body][ring unknown][block]: four columns of C
@group(0) @binding(1) var<storage, read> compliance: array<wide4>;
// [arc][ring unknown][k]
@group(0) @binding(2) var<storage, read> loads: array<wide>;
// Of each node in Poisson's ratio [coordinate, barycentric weight]; then [growth][node][arc][entry].
@group(0) @binding(3) var<storage, read> near_fields: array<wide>;
// [body][margin of Poisson's ratio, 1 + nu in plane stress and 1 - 2 nu in plane strain; its coordinate among the nodes;
// place among the growths, the fraction being how far from one to the next]
@group(0) @binding(4) var<storage, read> bodies: array<wide>;
// [body][system]
@group(0) @binding(5) var<storage, read> states: array<SystemState>;
// [body][block][rho, |b|, |b - K x|/|b|]
@group(0) @binding(6) var<storage, read> norms: array<wide4>;
// [slot][1 for a sound body and 0 for any other, amplitude, greatest |b - K x|/|b|, then [arc][entry]]
@group(0) @binding(7) var<storage, read_write> slots: array<wide>;

const ENTRIES = TERMS * (TERMS + 1u) / 2u;
// Entries that one invocation sums.
const OWN = (ENTRIES + INVOCATIONS - 1u) / INVOCATIONS;
const TILE_ROWS = 16u;
const BEYOND = wide(1e30);

var<workgroup> products: array<wide, TILE_ROWS * TERMS>;

// 2 E/E': 2 in plane stress, 2 (1 - nu^2) in plane strain.
fn amplitude_of(margin: wide) -> wide {
    let of_strain = wide(0.5) * (wide(1.0) + margin) * (wide(3.0) - margin);
    return select(wide(2.0), of_strain, parameters.is_plane_strain != 0u);
}

// The share of each node in the near field of a body.
fn shares_of(coordinate: wide) -> array<wide, NEAR_FIELD_NODES> {
    var shares: array<wide, NEAR_FIELD_NODES>;
    var sum = wide(0.0);
    for (var node = 0u; node < NEAR_FIELD_NODES; node++) {
        let distance = coordinate - near_fields[2u * node];
        // On a node its own share drowns the others.
        shares[node] = near_fields[2u * node + 1u] / select(distance, wide(1e-30), distance == wide(0.0));
        sum += shares[node];
    }
    for (var node = 0u; node < NEAR_FIELD_NODES; node++) {
        shares[node] /= sum;
    }
    return shares;
}

// Row and column of a packed entry.
fn place_of(entry: u32) -> vec2<u32> {
    var row = 0u;
    while (row + 1u) * (row + 2u) / 2u <= entry {
        row += 1u;
    }
    return vec2<u32>(row, entry - row * (row + 1u) / 2u);
}

// The greatest |b - K x|/|b| of a body's systems; BEYOND where one of them has failed.
fn worst_residual(body: u32) -> wide {
    var worst = wide(0.0);
    for (var block = 0u; block < parameters.block_count; block++) {
        let residuals = norms[3u * (body * parameters.block_count + block) + 2u];
        for (var i = 0u; i < 4u; i++) {
            let outcome = states[4u * (body * parameters.block_count + block) + i].outcome;
            if outcome != CONVERGED {
                return BEYOND;
            }
            worst = max(worst, residuals[i]);
        }
    }
    return worst;
}

@compute @workgroup_size(INVOCATIONS)
fn gram(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let body = group.x;
    let arc = group.y;
    let ring_count = parameters.ring_count;
    let slot = (parameters.first_slot + body) * parameters.slot_size;
    let margin = bodies[3u * body];
    var shares = shares_of(bodies[3u * body + 1u]);
    let growth = u32(bodies[3u * body + 2u]);
    let between = bodies[3u * body + 2u] - wide(growth);
    let arc_loads = arc * ring_count * TERMS;
    var sums: array<wide, OWN>;
    for (var own = 0u; own < OWN; own++) {
        sums[own] = wide(0.0);
    }
    for (var first = 0u; first < ring_count; first += TILE_ROWS) {
        let rows = min(TILE_ROWS, ring_count - first);
        workgroupBarrier();
        for (var item = invocation; item < rows * TERMS; item += INVOCATIONS) {
            let row = first + item / TERMS;
            let k = item % TERMS;
            var sum = wide(0.0);
            for (var block = 0u; block < parameters.block_count; block++) {
                let columns = compliance[(body * ring_count + row) * parameters.block_count + block];
                for (var i = 0u; i < 4u; i++) {
                    let column = 4u * block + i;
                    if column < ring_count {
                        sum += columns[i] * loads[arc_loads + column * TERMS + k];
                    }
                }
            }
            products[item] = sum;
        }
        workgroupBarrier();
        for (var own = 0u; own < OWN; own++) {
            let entry = invocation + own * INVOCATIONS;
            if entry < ENTRIES {
                let place = place_of(entry);
                var sum = sums[own];
                for (var row = 0u; row < rows; row++) {
                    sum += loads[arc_loads + (first + row) * TERMS + place.x] * products[row * TERMS + place.y];
                }
                sums[own] = sum;
            }
        }
    }
    for (var own = 0u; own < OWN; own++) {
        let entry = invocation + own * INVOCATIONS;
        if entry < ENTRIES {
            var sum = sums[own];
            for (var node = 0u; node < NEAR_FIELD_NODES; node++) {
                let value = ((growth * NEAR_FIELD_NODES + node) * parameters.arc_count + arc) * ENTRIES + entry;
                let at = 2u * NEAR_FIELD_NODES + value;
                let next = at + NEAR_FIELD_NODES * parameters.arc_count * ENTRIES;
                sum += shares[node] * ((wide(1.0) - between) * near_fields[at] + between * near_fields[next]);
            }
            slots[slot + SLOT_HEADER + arc * ENTRIES + entry] = sum;
        }
    }
    if arc == 0u && invocation == 0u {
        let residual = worst_residual(body);
        slots[slot] = select(wide(1.0), wide(0.0), residual == BEYOND);
        slots[slot + 1u] = amplitude_of(margin);
        slots[slot + 2u] = residual;
    }
}
