// Joined as text in front of the kernels that take sums over a workgroup; sum_tree.wgsl is the other way to do it.
//
// Subgroups add by themselves, and one invocation adds what they have: two barriers in place of one for each level of a
// tree. How large a subgroup is and who is in it is the device's affair. `summand` is real4 or wide4.

struct Invocation {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
    @builtin(subgroup_id) subgroup: u32,
    @builtin(subgroup_invocation_id) lane: u32,
    @builtin(num_subgroups) subgroup_count: u32,
}

// Of each subgroup; there are at most as many as invocations.
var<workgroup> partial: array<summand, INVOCATIONS>;

// The sum of all invocations' own parts, the same for all of them.
fn sum_of_workgroup(invocation: Invocation, own: summand) -> summand {
    let of_subgroup = subgroupAdd(own);
    if invocation.lane == 0u {
        partial[invocation.subgroup] = of_subgroup;
    }
    workgroupBarrier();
    if invocation.index == 0u {
        var sum = of_subgroup;
        for (var other = 0u; other < invocation.subgroup_count; other++) {
            if other != invocation.subgroup {
                sum += partial[other];
            }
        }
        partial[0] = sum;
    }
    return workgroupUniformLoad(&partial[0]);
}
