// Joined as text in front of the kernels that take sums over a workgroup; sum_subgroups.wgsl is the other way to do it.
//
// As the twins do: a tree over the invocations. `summand` is real4 or wide4.

struct Invocation {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
}

var<workgroup> partial: array<summand, INVOCATIONS>;

// The sum of all invocations' own parts, the same for all of them.
fn sum_of_workgroup(invocation: Invocation, own: summand) -> summand {
    partial[invocation.index] = own;
    workgroupBarrier();
    for (var width = INVOCATIONS / 2u; width > 0u; width /= 2u) {
        if invocation.index < width {
            partial[invocation.index] += partial[invocation.index + width];
        }
        workgroupBarrier();
    }
    return workgroupUniformLoad(&partial[0]);
}
