// Twin: src/mechanics/compliance/lane_condensation.rs (gram) and near_field.rs (correct).
//
// From the compliance C of a ring to that of the trial pressures: for each arc G = F^T C F, F being the nodal loads of
// its trial pressures, and to it the near field of the body's class, interpolated in Poisson's ratio.
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
}

@group(0) @binding(0) var<uniform> parameters: GramParameters;
// [body][ring unknown][block]: four columns of C
@group(0) @binding(1) var<storage, read> compliance: array<wide4>;
// [arc][ring unknown][k]
@group(0) @binding(2) var<storage, read> loads: array<wide>;
// [node of Poisson's ratio][arc][entry]
@group(0) @binding(3) var<storage, read> near_field: array<wide>;
// [body]: where its compliance goes.
@group(0) @binding(4) var<storage, read> targets: array<u32>;
// [body][amplitude, then the share of each node of Poisson's ratio]
@group(0) @binding(5) var<storage, read> shares: array<wide>;
// [body][system]
@group(0) @binding(6) var<storage, read> states: array<SystemState>;
// [body][block][rho, |b|, |b - K x|/|b|]
@group(0) @binding(7) var<storage, read> norms: array<wide4>;
// [slot][1 for a sound body and 0 for any other, amplitude, greatest |b - K x|/|b|, then [arc][entry]]
@group(0) @binding(8) var<storage, read_write> slots: array<wide>;

const ENTRIES = TERMS * (TERMS + 1u) / 2u;
// Entries that one invocation sums.
const OWN = (ENTRIES + INVOCATIONS - 1u) / INVOCATIONS;
const TILE_ROWS = 16u;
const BEYOND = wide(1e30);

var<workgroup> products: array<wide, TILE_ROWS * TERMS>;

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
    let slot = targets[body] * parameters.slot_size;
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
                let share = shares[body * (1u + NEAR_FIELD_NODES) + 1u + node];
                sum += share * near_field[(node * parameters.arc_count + arc) * ENTRIES + entry];
            }
            slots[slot + SLOT_HEADER + arc * ENTRIES + entry] = sum;
        }
    }
    if arc == 0u && invocation == 0u {
        let residual = worst_residual(body);
        slots[slot] = select(wide(1.0), wide(0.0), residual == BEYOND);
        slots[slot + 1u] = shares[body * (1u + NEAR_FIELD_NODES)];
        slots[slot + 2u] = residual;
    }
}
