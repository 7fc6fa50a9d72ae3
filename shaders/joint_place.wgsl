// Joined as text in front of `joints.wgsl` and `draw.wgsl`. Shared with `backend/gpu/joint_load.rs` (`Placed`).

// Of a joint: its parameters, where its numbers and what is found of it begin, and how many loads it has; of pin and plate where works
// begin, or `ELSEWHERE` or `MISSING`, and the two near fields between which they lie. Its trial pressures tell which kernel it is for.
struct Place {
    parameters: u32,
    numbers_at: u32,
    found_at: u32,
    load_count: u32,
    works_at: vec2<u32>,
    terms: u32,
    padding: u32,
    near_fields_at: vec4<u32>,
}
