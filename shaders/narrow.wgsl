// Twin: none, it rounds.
//
// The matrices as the iteration reads them. Only where `real` is not `wide`; else it reads the very same buffer.
//
// One workgroup rounds one body's matrix. Its invocations stride over the values.

@group(0) @binding(0) var<uniform> parameters: SystemParameters;
// [body][value]
@group(0) @binding(1) var<storage, read> values: array<wide>;
// [body][value]
@group(0) @binding(2) var<storage, read_write> narrowed: array<real>;

@compute @workgroup_size(INVOCATIONS)
fn narrow(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) invocation: u32,
) {
    let first_value = group.x * parameters.value_count;
    for (var value = invocation; value < parameters.value_count; value += INVOCATIONS) {
        narrowed[first_value + value] = real(values[first_value + value]);
    }
}
