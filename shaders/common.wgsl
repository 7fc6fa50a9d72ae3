// Joined as text in front of every kernel, after the lines that choose precision and size:
//
//     alias real = f32;               // or f64
//     const INVOCATIONS = 64u;        // of a workgroup

alias real2 = vec2<real>;
// Four systems side by side: one component each.
alias real4 = vec4<real>;

// How a system stands. The host's twin is `layout::SystemOutcome`.
const RUNNING = 0u;
const CONVERGED = 1u;
const ITERATION_LIMIT = 2u;
const INDEFINITE = 3u;
const NOT_FINITE = 4u;
const INVERTED = 5u;

struct SystemState {
    outcome: u32,
    // Products with K.
    iterations: u32,
}

// What pcg and condense are told.
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
    // Of a system.
    iteration_limit: u32,
    // sqrt(r.M^-1 r) to reach, over that of b.
    tolerance: f32,
}

// By its bits: compilers may turn comparisons around as if there were no NaN.
fn is_finite(value: real) -> bool {
    return (bitcast<u32>(f32(value)) & 0x7f800000u) != 0x7f800000u;
}
