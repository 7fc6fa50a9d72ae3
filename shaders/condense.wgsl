// Twin: src/mechanics/compliance/condense.rs (variational_compliance), and the true residual of solve/pcg.rs.
//
// From approximate columns U of K U = B to the compliance of the ring, C = B^T U + U^T (B - K U): `residual` first,
// then `condense`.
//
// One workgroup owns four columns of one body. In `residual` its invocations stride over the rows, in `condense` over
// the rows of C.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [row]: its first value; the end of the last one closes the list.
@group(0) @binding(1) var<storage, read> row_starts: array<u32>;
// [value of one matrix]
@group(0) @binding(2) var<storage, read> columns: array<u32>;
// [row]: the value on its diagonal.
@group(0) @binding(3) var<storage, read> diagonal_places: array<u32>;
// [body][value]
@group(0) @binding(4) var<storage, read> values: array<real>;
// [body][block][x, r, p, b - K x in place of q][unknown]
@group(0) @binding(5) var<storage, read_write> iterates: array<real4>;
// [body][block][rho = r.M^-1 r, |b|, |b - K x|/|b|]
@group(0) @binding(6) var<storage, read_write> norms: array<real4>;
// [body][ring unknown][block]: four columns of C, those beyond `ring_count` zero
@group(0) @binding(7) var<storage, read_write> compliance: array<real4>;

var<workgroup> partial: array<real4, INVOCATIONS>;

// b - K x, and its norm over that of b.
@compute @workgroup_size(INVOCATIONS)
fn residual(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let size = parameters.unknown_count;
    let block = group.x * parameters.block_count + group.y;
    let first_value = group.x * parameters.value_count;
    let x = 4u * size * block;
    let q = x + 3u * size;
    var own = real4();
    for (var row = invocation; row < size; row += INVOCATIONS) {
        var sum = real4();
        let ring = row - parameters.ring_start;
        if row >= parameters.ring_start && ring / 4u == group.y {
            sum[ring % 4u] = real(1.0);
        }
        for (var entry = row_starts[row]; entry < row_starts[row + 1u]; entry++) {
            sum -= values[first_value + entry] * iterates[x + columns[entry]];
        }
        iterates[q + row] = sum;
        own += sum * (sum / values[first_value + diagonal_places[row]]);
    }
    partial[invocation] = own;
    workgroupBarrier();
    for (var width = INVOCATIONS / 2u; width > 0u; width /= 2u) {
        if invocation < width {
            partial[invocation] += partial[invocation + width];
        }
        workgroupBarrier();
    }
    if invocation == 0u {
        let norm_b = norms[3u * block + 1u];
        // A load of zero is solved by zero.
        norms[3u * block + 2u] = select(sqrt(partial[0]) / norm_b, real4(), norm_b == real4());
    }
}

// The mean of both triangles, which differ by rounding.
@compute @workgroup_size(INVOCATIONS)
fn condense(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let size = parameters.unknown_count;
    let first_block = group.x * parameters.block_count;
    let x = 4u * size * (first_block + group.y);
    let q = x + 3u * size;
    for (var i = invocation; i < parameters.ring_count; i += INVOCATIONS) {
        let own_x = 4u * size * (first_block + i / 4u);
        let own_q = own_x + 3u * size;
        // Column j of four at row i, and column i at rows j.
        var upper = iterates[x + parameters.ring_start + i];
        var lower = real4();
        for (var j = 0u; j < 4u; j++) {
            let row = parameters.ring_start + 4u * group.y + j;
            if row < size {
                lower[j] = iterates[own_x + row][i % 4u];
            }
        }
        for (var row = 0u; row < size; row++) {
            upper += iterates[own_x + row][i % 4u] * iterates[q + row];
            lower += iterates[own_q + row][i % 4u] * iterates[x + row];
        }
        compliance[(group.x * parameters.ring_count + i) * parameters.block_count + group.y] =
            real(0.5) * (upper + lower);
    }
}
