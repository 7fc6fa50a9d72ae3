// Joined as text in front of every kernel, after the lines that choose precision and size:
//
//     alias real = f32;               // or f64: of the iteration
//     alias wide = f64;               // of all else; f64 where `real` is, else either
//     const IS_WIDE_DOUBLE = true;
//     const INVOCATIONS = 64u;        // of a workgroup
//     const ON_CHIP = 4u;             // vectors that pcg holds in a workgroup's own memory
//     const CAPACITY = 512u;          // numbers of each of them, four systems abreast
//     const RUNNING = 0u;             // and so on: how a system stands, `system_layout::SystemOutcome`
//     const SLICE = 32u;              // rows that lie side by side in a matrix
//     const MOST_MODES = 48u;         // of a ring
//     const WORKS_HEADER = 2u;        // numbers of a body before its works
//     const TILE_ROWS = 4u;           // rows of the ring that works has in a workgroup's own memory
//     const TERMS = 6u;               // trial pressures of joints
//     const JOINTS = 2u;              // that a workgroup has side by side
//     alias summand = real4;          // what the kernel takes sums of, if any
//
// and constants that a kernel has from its twin (`KernelFile::constants`).

alias wide2 = vec2<wide>;
// Four systems side by side: one component each.
alias real4 = vec4<real>;
alias wide4 = vec4<wide>;

struct SystemState {
    outcome: u32,
    // Products with K.
    iterations: u32,
}

// What pcg, refine and condense are told.
struct SystemParameters {
    unknown_count: u32,
    // Of one body's matrix.
    value_count: u32,
    // Groups of four systems a body.
    block_count: u32,
    // The first unknown of the ring, and how many there are: the systems beyond have no load.
    ring_start: u32,
    ring_count: u32,
    // Of this dispatch.
    step_count: u32,
    // Of a system, all rounds together.
    iteration_limit: u32,
    // |r| that a round has to reach, over the one it began with; |v| = sqrt(v.M^-1 v).
    tolerance: f32,
    // |b - K x|/|b| that ends a system.
    goal: f32,
}

// By its bits: compilers may turn comparisons around as if there were no NaN.
fn is_finite(value: wide) -> bool {
    return (bitcast<u32>(f32(value)) & 0x7f800000u) != 0x7f800000u;
}

// Not above a positive value, and 2^-126 at least: to scale by it rounds nothing.
fn power_of_two(values: wide4) -> wide4 {
    let exponents = bitcast<vec4<u32>>(vec4<f32>(values)) & vec4<u32>(0x7f800000u);
    return wide4(bitcast<vec4<f32>>(max(exponents, vec4<u32>(0x00800000u))));
}

// Row and column of a packed entry: the first one of a row has sqrt(8 entry + 1) = 2 row + 1. What is added under the root is
// far more than its rounding, and too little for the next row. A loop would take too many trips (`MOST_TRIPS`).
fn packed_place(entry: u32) -> vec2<u32> {
    let row = u32(0.5 * (sqrt(f32(8u * entry + 3u)) - 1.0));
    return vec2<u32>(row, entry - row * (row + 1u) / 2u);
}
