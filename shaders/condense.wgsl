// Twin: src/mechanics/compliance/condense.rs (variational_compliance).
//
// From approximate columns U of K U = B and their residuals to the compliance of the ring,
// C = B^T U + U^T (B - K U).
//
// One workgroup makes four columns of one body's C. Its invocations stride over the rows of C.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [body][block][x, b - K x][unknown]
@group(0) @binding(1) var<storage, read> solutions: array<wide4>;
// [body][ring unknown][block]: four columns of C, those beyond `ring_count` zero
@group(0) @binding(2) var<storage, read_write> compliance: array<wide4>;

// The mean of both triangles, which differ by rounding.
@compute @workgroup_size(INVOCATIONS)
fn condense(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let size = parameters.unknown_count;
    let first_block = group.x * parameters.block_count;
    let x = 2u * size * (first_block + group.y);
    let residual = x + size;
    for (var i = invocation; i < parameters.ring_count; i += INVOCATIONS) {
        let own_x = 2u * size * (first_block + i / 4u);
        let own_residual = own_x + size;
        // Column j of four at row i, and column i at rows j.
        var upper = solutions[x + parameters.ring_start + i];
        var lower = wide4();
        for (var j = 0u; j < 4u; j++) {
            let row = parameters.ring_start + 4u * group.y + j;
            if row < size {
                lower[j] = solutions[own_x + row][i % 4u];
            }
        }
        for (var row = 0u; row < size; row++) {
            upper += solutions[own_x + row][i % 4u] * solutions[residual + row];
            lower += solutions[own_residual + row][i % 4u] * solutions[x + row];
        }
        compliance[(group.x * parameters.ring_count + i) * parameters.block_count + group.y] =
            wide(0.5) * (upper + lower);
    }
}
