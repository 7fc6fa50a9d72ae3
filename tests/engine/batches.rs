//! How a sweep is split into dispatches: limits met exactly, order kept, nothing lost or doubled. No device needed.

use std::time::Duration;

use jointsweep::internals::engine::backend::gpu::batch::{
    AssembleCounts, Batch, BatchError, BodyCounts, KernelFacts, LONGEST, MOST_BYTES, MOST_TRIPS, OnChip,
    SHORTEST, TARGET, adapted, batches,
};
use jointsweep::internals::engine::backend::gpu::context::DeviceLimits;

const LIMITS: DeviceLimits = DeviceLimits {
    binding_bytes: 128 << 20,
    buffer_bytes: 2 << 30,
    workgroups_per_dimension: 65_535,
    workgroup_bytes: 32 << 10,
    invocations_per_workgroup: 1024,
    storage_buffers: 8,
};

/// So fast that time decides nothing.
const KERNEL: KernelFacts =
    KernelFacts { bytes_per_real: 4, bytes_per_wide: 4, invocations: 64, seconds_per_iteration: 1e-12 };

const BODY: BodyCounts = BodyCounts {
    topology: 0,
    unknowns: 150,
    matrix_values: 4_000,
    assemble: AssembleCounts { lines: 21, layers: 5, elements: 50, pairs: 1_100 },
    longest_row: 42,
    ring_columns: 21,
    geometry: 900,
};

/// The batches, after the promise that holds for all of them: in order, nothing lost or doubled, one topology each.
fn split(bodies: &[BodyCounts], kernel: &KernelFacts, limits: &DeviceLimits) -> Vec<Batch> {
    let batches = batches(bodies, kernel, limits).unwrap();
    let mut next = 0;
    for batch in &batches {
        assert_eq!(batch.bodies.start, next);
        assert!(batch.bodies.end > next);
        next = batch.bodies.end;
        let inside = &bodies[batch.bodies.clone()];
        assert!(inside.iter().all(|body| body.topology == inside[0].topology));
        assert_eq!(batch.workgroups, [inside.len() as u32, inside[0].blocks() as u32]);
        assert!(batch.iterations >= 1);
        let trips = inside[0].trips(kernel.invocations) * u64::from(batch.iterations);
        assert!(trips <= MOST_TRIPS, "{trips}");
    }
    assert_eq!(next, bodies.len());
    batches
}

fn sizes(batches: &[Batch]) -> Vec<usize> {
    batches.iter().map(|batch| batch.bodies.len()).collect()
}

#[test]
fn no_bodies_are_no_batches() {
    assert_eq!(split(&[], &KERNEL, &LIMITS), []);
}

/// 10 bodies in a buffer of exactly 10, of one byte less, and of exactly 5, for each buffer that may be the fullest.
#[test]
fn a_buffer_is_filled_to_its_last_byte() {
    let many_values = BodyCounts { matrix_values: 100_000, ..BODY };
    let many_columns = BodyCounts { ring_columns: 120, unknowns: 10, longest_row: 10, ..BODY };
    let fine_mesh = BodyCounts { geometry: 50_000, ..BODY };
    for body in [BODY, many_values, many_columns, fine_mesh] {
        let bodies = [body; 10];
        let bytes = body.bytes(4, 4).iter().map(|(_, bytes)| *bytes).max().unwrap();
        for (room, expected) in [
            (10 * bytes, vec![10]),
            (10 * bytes - 1, vec![9, 1]),
            (5 * bytes, vec![5, 5]),
            (bytes, vec![1; 10]),
        ] {
            let narrow = DeviceLimits { binding_bytes: room, ..LIMITS };
            assert_eq!(sizes(&split(&bodies, &KERNEL, &narrow)), expected);
            let small = DeviceLimits { buffer_bytes: room, ..LIMITS };
            assert_eq!(sizes(&split(&bodies, &KERNEL, &small)), expected);
        }
    }
}

/// All of them, and each is what fills a buffer first in one of the cases above.
#[test]
fn each_buffer_is_counted() {
    let fullest = |body: BodyCounts| body.bytes(4, 4).into_iter().max_by_key(|(_, bytes)| *bytes).unwrap();
    assert_eq!(fullest(BODY), ("iterates", 150 * 24 * 4 * 4));
    assert_eq!(fullest(BodyCounts { matrix_values: 100_000, ..BODY }), ("matrix values", 400_000));
    let wide = BodyCounts { ring_columns: 121, unknowns: 10, ..BODY };
    assert_eq!(fullest(wide), ("compliance", 121 * 124 * 4));
    assert_eq!(fullest(BodyCounts { geometry: 50_000, ..BODY }), ("geometry", 800_000));
    let total = |real, wide| -> u64 { BODY.bytes(real, wide).iter().map(|(_, bytes)| bytes).sum() };
    assert_eq!(total(8, 8), 2 * total(4, 4));
    // In mixed precision there are two sets of matrices, and only the iterates are narrow.
    let iterates = 150 * 24 * 4 * 4;
    assert_eq!(total(4, 8), total(8, 8) - iterates + 4_000 * 4);
}

#[test]
fn a_body_that_fits_no_buffer_is_named_and_those_before_it_do_not_hide_it() {
    let huge = BodyCounts { geometry: 1 << 24, ..BODY };
    let error = batches(&[BODY, BODY, huge, BODY], &KERNEL, &LIMITS).unwrap_err();
    let (needed, limit) = (1 << 28, 1 << 27);
    assert_eq!(error, BatchError::BodyTooLarge { body: 2, what: "geometry", needed, limit });
}

#[test]
fn workgroups_fill_a_dimension_and_no_more() {
    let limits = DeviceLimits { workgroups_per_dimension: 100, ..LIMITS };
    assert_eq!(sizes(&split(&[BODY; 250], &KERNEL, &limits)), [100, 100, 50]);
    assert_eq!(sizes(&split(&[BODY; 200], &KERNEL, &limits)), [100, 100]);
    let wide = BodyCounts { ring_columns: 401, ..BODY };
    let error = batches(&[wide], &KERNEL, &limits).unwrap_err();
    assert_eq!(error, BatchError::TooManyColumns { body: 0, needed: 101, limit: 100 });
    split(&[BodyCounts { ring_columns: 400, ..BODY }], &KERNEL, &limits);
}

/// Where single buffers could hold far more, all together end a batch; a body that is larger than that goes alone.
#[test]
fn a_batch_leaves_memory_to_others() {
    let roomy = DeviceLimits { binding_bytes: 1 << 40, buffer_bytes: 1 << 40, ..LIMITS };
    let all = |body: &BodyCounts| -> u64 { body.bytes(4, 4).iter().map(|(_, bytes)| bytes).sum() };
    let most = (MOST_BYTES / all(&BODY)) as usize;
    assert_eq!(sizes(&split(&vec![BODY; 2 * most + 1], &KERNEL, &roomy)), [most, most, 1]);
    let huge = BodyCounts { geometry: MOST_BYTES, ..BODY };
    assert_eq!(sizes(&split(&[huge, huge], &KERNEL, &roomy)), [1, 1]);
}

#[test]
fn topologies_are_not_mixed() {
    let other = BodyCounts { topology: 1, ring_columns: 30, ..BODY };
    assert_eq!(sizes(&split(&[BODY, BODY, other, BODY, other, other], &KERNEL, &LIMITS)), [2, 1, 1, 2]);
}

#[test]
fn a_million_bodies_are_split_in_order() {
    let bodies: Vec<BodyCounts> =
        (0..1_000_000).map(|i| BodyCounts { topology: i / 300_000, ..BODY }).collect();
    let batches = split(&bodies, &KERNEL, &LIMITS);
    // The iterates decide: 57,600 bytes a body.
    assert_eq!(batches[0].bodies.len(), (128 << 20) / 57_600);
    assert!(batches.len() < 450, "{}", batches.len());
}

/// The count of steps is the largest that stays below the bound; a body without one step is an error.
#[test]
fn steps_stay_below_the_bound_on_loop_trips() {
    for unknowns in [1, 63, 64, 65, 150, 1_000, 4_000, 20_000] {
        let body = BodyCounts { unknowns, ..BODY };
        let batch = &split(&[body], &KERNEL, &LIMITS)[0];
        let trips = body.trips(64);
        assert_eq!(u64::from(batch.iterations), 60_000 / trips, "{unknowns}");
    }
    // 64 x 45 rows in trips, and the trees.
    assert_eq!(BodyCounts { unknowns: 4_096, ..BODY }.trips(64), 1 + 64 * 45 + 14);
    let deep = BodyCounts { unknowns: 55_000, longest_row: 70, ..BODY };
    // Of `refine`, which has a few more than a step of the iteration.
    let trips = deep.trips(64) + 16;
    let error = batches(&[deep], &KERNEL, &LIMITS).unwrap_err();
    assert_eq!(error, BatchError::TooManyTrips { body: 0, trips, limit: 60_000 });
    // Twice the invocations halve the rows of each.
    split(&[deep], &KernelFacts { invocations: 128, ..KERNEL }, &LIMITS);
    // Kernels that are not split into steps: 101 looks at 7 layers, 14 more for the line and 13 of its bow, 66 of each half element, and six
    // for each of 9,856 pairs are one trip too many; and so are 2 x 30,001 unknowns.
    let pairs = |pairs: u64| BodyCounts { assemble: AssembleCounts { pairs, ..BODY.assemble }, ..BODY };
    assert_eq!(pairs(64).assemble.trips(64), 101 * 7 + 14 + 13 + 2 * 66 + 6);
    for body in
        [pairs(64 * 9_855 + 1), BodyCounts { unknowns: 29_996, ring_columns: 65, longest_row: 1, ..BODY }]
    {
        let error = batches(&[body], &KERNEL, &LIMITS).unwrap_err();
        assert!(matches!(error, BatchError::TooManyTrips { trips: 60_001..60_100, .. }), "{error}");
    }
    split(&[pairs(64 * 9_855)], &KERNEL, &LIMITS);
    split(&[BodyCounts { unknowns: 29_995, ring_columns: 65, longest_row: 1, ..BODY }], &KERNEL, &LIMITS);
    // The works of 48 modes: of 126 tiles of four rows each 3 products over 126 blocks and 19 entries over the rows; the entries
    // twice more, and five for each block.
    let long_ring = BodyCounts { unknowns: 600, ring_columns: 501, longest_row: 1, ..BODY };
    let trips = 126 * (1 + 3 * (1 + 126) + 19 * 5) + 2 * 19 + 126 * 5;
    let error = batches(&[long_ring], &KERNEL, &LIMITS).unwrap_err();
    assert_eq!(error, BatchError::TooManyTrips { body: 0, trips, limit: 60_000 });
    split(&[BodyCounts { ring_columns: 500, ..long_ring }], &KERNEL, &LIMITS);
}

/// Whatever a body costs, a dispatch is as long as it should be, unless there is too little work or a single step of a
/// single body is longer.
#[test]
fn dispatches_take_their_time() {
    let bodies = [BODY; 20_000];
    let most_steps = f64::from(split(&[BODY], &KERNEL, &LIMITS)[0].iterations);
    for seconds in [1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.02, 0.09] {
        let kernel = KernelFacts { seconds_per_iteration: seconds, ..KERNEL };
        let mut long = 0;
        for batch in split(&bodies, &kernel, &LIMITS) {
            let time = batch.bodies.len() as f64 * f64::from(batch.iterations) * seconds;
            assert!(time <= 0.2, "{seconds}: {time}");
            let limited = f64::from(batch.iterations) == most_steps;
            assert!(time >= 0.05 || limited || batch.bodies.end == bodies.len(), "{seconds}: {time}");
            long += usize::from(time >= 0.05);
        }
        // Faster kernels leave too little work.
        assert_eq!(long > 0, seconds >= 1e-7, "{seconds}: {long}");
    }
    let slow = KernelFacts { seconds_per_iteration: 3.0, ..KERNEL };
    for batch in split(&bodies[..3], &slow, &LIMITS) {
        assert_eq!((batch.bodies.len(), batch.iterations), (1, 1));
    }
}

#[test]
fn the_measured_time_is_taken_over_only_where_a_dispatch_was_too_long_or_too_short() {
    let batch = Batch { bodies: 10..110, workgroups: [100, 6], iterations: 20 };
    for fine in [SHORTEST, TARGET, LONGEST] {
        assert_eq!(adapted(&KERNEL, &batch, fine), KERNEL);
    }
    for (milliseconds, seconds) in [(400, 2e-4), (2, 1e-6)] {
        let taken = adapted(&KERNEL, &batch, Duration::from_millis(milliseconds)).seconds_per_iteration;
        assert!((taken / seconds - 1.0).abs() < 1e-12, "{taken}");
    }
    assert!(adapted(&KERNEL, &batch, Duration::ZERO).seconds_per_iteration > 0.0);
}

#[test]
fn a_kernel_that_a_device_cannot_run_is_refused() {
    let exact = DeviceLimits { workgroup_bytes: 67 * 16 + 32, ..LIMITS };
    split(&[BODY], &KERNEL, &exact);
    let one_less = DeviceLimits { workgroup_bytes: 67 * 16 + 31, ..LIMITS };
    let error = BatchError::WorkgroupMemory { needed: 1104, limit: 1103 };
    assert_eq!(batches(&[BODY], &KERNEL, &one_less), Err(error));
    let narrow = DeviceLimits { invocations_per_workgroup: 63, ..LIMITS };
    let error = BatchError::WorkgroupSize { needed: 64, limit: 63 };
    assert_eq!(batches(&[BODY], &KERNEL, &narrow), Err(error));
    for seconds in [0.0, -1.0, f64::INFINITY] {
        let kernel = KernelFacts { seconds_per_iteration: seconds, ..KERNEL };
        assert_eq!(batches(&[BODY], &kernel, &LIMITS), Err(BatchError::NoTime { seconds }));
    }
    let kernel = KernelFacts { seconds_per_iteration: f64::NAN, ..KERNEL };
    assert!(matches!(batches(&[BODY], &kernel, &LIMITS), Err(BatchError::NoTime { .. })));
}

/// As many vectors as fit, never a byte more, of a capacity that wastes at most a third; few capacities.
#[test]
fn vectors_go_on_the_chip_as_far_as_they_fit() {
    let kernel = KernelFacts { bytes_per_wide: 8, ..KERNEL };
    for kib in [16, 32, 48] {
        let limits = DeviceLimits { workgroup_bytes: kib << 10, ..LIMITS };
        let room = u64::from(limits.workgroup_bytes);
        let mut capacities = Vec::new();
        for unknowns in 1..5_000 {
            let on_chip = OnChip::fitting(unknowns, &kernel, &limits);
            assert!(kernel.workgroup_bytes(on_chip) <= room);
            if on_chip == OnChip::NOTHING {
                // Not even one vector of the next capacity.
                assert!(unknowns * 16 + kernel.workgroup_bytes(OnChip::NOTHING) > room * 2 / 3, "{unknowns}");
                continue;
            }
            let OnChip { vectors, capacity } = on_chip;
            assert!(
                capacity >= unknowns && (capacity <= 64 || capacity * 2 < unknowns * 3),
                "{unknowns} {capacity}"
            );
            let more = OnChip { vectors: vectors + 1, capacity };
            assert!(vectors == 4 || kernel.workgroup_bytes(more) > room);
            capacities.push(capacity);
        }
        capacities.dedup();
        assert!(capacities.is_sorted() && capacities.len() <= 14, "{capacities:?}");
    }
    // 64 partial sums and a state of f32 leave room for 4 x 448 or 1 x 1,536 unknowns on 32 KiB.
    let chosen = |unknowns| OnChip::fitting(unknowns, &KERNEL, &LIMITS);
    assert_eq!(chosen(384), OnChip { vectors: 4, capacity: 384 });
    assert_eq!(chosen(385), OnChip { vectors: 3, capacity: 512 });
    assert_eq!(chosen(1_536), OnChip { vectors: 1, capacity: 1_536 });
    assert_eq!(chosen(1_537), OnChip::NOTHING);
}
