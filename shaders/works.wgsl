// Twin: src/mechanics/compliance/ring_modes.rs (works_on_ring).
//
// From the compliance C of a ring to the works of its modes: the symmetric part of P^T C F, F being the nodal loads of the modes along
// the normal and P those of one way to push.
//
// One workgroup makes one way of one body. It goes through the ring's rows in tiles: of each tile W = C F first, then its share
// P^T W in all entries.

struct WorksParameters {
    // Of the ring.
    ring_count: u32,
    // Groups of four columns of C.
    block_count: u32,
    mode_count: u32,
    // Numbers of one body in `works`.
    body_size: u32,
}

@group(0) @binding(0) var<uniform> parameters: WorksParameters;
// [body][ring unknown][block]: four columns of C
@group(0) @binding(1) var<storage, read> compliance: array<wide4>;
// [way to push, the normal first][ring unknown, with zeros up to a whole block][mode]
@group(0) @binding(2) var<storage, read> loads: array<wide>;
// [body][system]
@group(0) @binding(3) var<storage, read> states: array<SystemState>;
// [body][block][rho, |b|, |b - K x|/|b|]
@group(0) @binding(4) var<storage, read> norms: array<wide4>;
// [body][1 for a sound body and 0 for any other, greatest |b - K x|/|b|, then packed entries, one way to push after the other]
@group(0) @binding(5) var<storage, read_write> works: array<wide>;

// Entries that one invocation sums.
const OWN = (MOST_MODES * (MOST_MODES + 1u) / 2u + INVOCATIONS - 1u) / INVOCATIONS;
const BEYOND = wide(1e30);

var<workgroup> products: array<wide, TILE_ROWS * MOST_MODES>;

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
fn sum_works(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let body = group.x;
    // Where the loads of this way begin.
    let pushed = group.y * 4u * parameters.block_count * parameters.mode_count;
    let ring_count = parameters.ring_count;
    let modes = parameters.mode_count;
    let entries = modes * (modes + 1u) / 2u;
    var sums: array<wide, OWN>;
    for (var own = 0u; own < OWN; own++) {
        sums[own] = wide(0.0);
    }
    for (var first = 0u; first < ring_count; first += TILE_ROWS) {
        let rows = min(TILE_ROWS, ring_count - first);
        workgroupBarrier();
        for (var item = invocation; item < rows * modes; item += INVOCATIONS) {
            let row = first + item / modes;
            let mode = item % modes;
            var sum = wide(0.0);
            for (var block = 0u; block < parameters.block_count; block++) {
                let columns = compliance[(body * ring_count + row) * parameters.block_count + block];
                let at = 4u * block * modes + mode;
                sum += columns.x * loads[at] + columns.y * loads[at + modes];
                sum += columns.z * loads[at + 2u * modes] + columns.w * loads[at + 3u * modes];
            }
            products[item] = sum;
        }
        workgroupBarrier();
        for (var own = 0u; own < OWN; own++) {
            let entry = invocation + own * INVOCATIONS;
            if entry < entries {
                let place = packed_place(entry);
                var sum = sums[own];
                for (var row = 0u; row < rows; row++) {
                    let at = pushed + (first + row) * modes;
                    sum += loads[at + place.x] * products[row * modes + place.y];
                    sum += loads[at + place.y] * products[row * modes + place.x];
                }
                sums[own] = sum;
            }
        }
    }
    let at = body * parameters.body_size;
    for (var own = 0u; own < OWN; own++) {
        let entry = invocation + own * INVOCATIONS;
        if entry < entries {
            works[at + WORKS_HEADER + group.y * entries + entry] = 0.5 * sums[own];
        }
    }
    if invocation == 0u && group.y == 0u {
        let residual = worst_residual(body);
        works[at] = select(wide(1.0), wide(0.0), residual == BEYOND);
        works[at + 1u] = residual;
    }
}
