//! From bodies to dispatches: pure arithmetic, before any device is touched.
//!
//! A batch is a run of neighbouring bodies of one topology that fits the device's limits; its systems are iterated by
//! dispatches of `iterations` steps each, resumed from stored state until every system has stopped. Both are chosen
//! so that a dispatch takes about `TARGET`: long enough to hide its start, short enough for watchdogs.
//!
//! ```text
//!   bodies       0 1 2 3 4 5 6 7 8 ...       in order, each in exactly one batch
//!   batches      |--- A ---|- A -|-- B --|   A, B: topologies; the cut within A is a limit or the time
//! ```

use std::ops::Range;
use std::time::Duration;

use crate::engine::backend::adapter::DeviceLimits;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::ring_modes::MOST_MODES;
use crate::mechanics::layers::MOST_STEPS;

/// Systems (ring columns) that one workgroup of `pcg` advances abreast: the components of a WGSL vector.
pub const COLUMNS_ABREAST: u64 = 4;

/// Vectors that the iteration keeps of every system: d, r, p and q.
pub const ITERATES: u64 = 4;

/// Vectors that its rounds keep, in wide numbers: x and b - K x.
pub const SOLUTIONS: u64 = 2;

/// How long a dispatch should take. Between `SHORTEST` and `LONGEST` nothing is changed.
pub const TARGET: Duration = Duration::from_millis(100);
pub const SHORTEST: Duration = Duration::from_millis(50);
pub const LONGEST: Duration = Duration::from_millis(200);

/// Mesa 22 silently leaves all loops after 65,535 trips in total per invocation and dispatch.
pub const MOST_TRIPS: u64 = 60_000;

/// Memory of all buffers of a batch together, bytes: some thousands of bodies, which keep the largest device busy, and no
/// more than the smallest has.
pub const MOST_BYTES: u64 = 1 << 30;

/// The same of all that share a device, bytes: a machine of many threads has many crews.
const MOST_BYTES_OF_ALL: u64 = 8 << 30;

/// For each of so many that share a device.
pub fn most_bytes(sharing: usize) -> u64 {
    MOST_BYTES.min(MOST_BYTES_OF_ALL / sharing.max(1) as u64)
}

/// A dispatch of fewer steps spends too much of its time loading and storing state: fewer bodies then.
const FEWEST_STEPS: u64 = 10;

/// Rows of the ring that `works` has in a workgroup's memory.
pub(super) const fn works_tile(invocations: u64) -> u64 {
    if invocations < 16 { 1 } else { invocations / 16 }
}

/// What `assemble` goes through for one body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AssembleCounts {
    /// Lines of the mesh away from the ring, mid-side ones included, and layers of elements.
    pub lines: u64,
    pub layers: u64,
    pub elements: u64,
    /// Pairs of nodes that have values (`gather::Gather`).
    pub pairs: u64,
}

impl AssembleCounts {
    /// The most loop trips of one invocation: its lines, each with the search of its growth; the rows of bowed lines; the nodes of two
    /// points at a time, each at most two steps along the ring and two away from it; its pairs, each of at most four elements. Loops look
    /// once more than they go round.
    pub fn trips(&self, invocations: u64) -> u64 {
        let AssembleCounts { lines, layers, elements, pairs } = *self;
        let of_line = (MOST_STEPS as u64 + 1) * (2 + layers) + 2 * (2 + layers);
        let of_bow = 2 + 2 * layers + 1;
        let of_half = 2 * (1 + 8) + 8 * (3 + 3);
        lines.div_ceil(invocations) * (of_line + of_bow)
            + (2 * elements).div_ceil(invocations) * of_half
            + pairs.div_ceil(invocations) * (2 + 4)
    }
}

/// What one body asks of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyCounts {
    /// Bodies of equal `topology` share mesh and sparsity, so all counts.
    pub topology: u32,
    pub unknowns: u64,
    /// Nonzeros of the stiffness.
    pub matrix_values: u64,
    pub assemble: AssembleCounts,
    /// Nonzeros of its longest row.
    pub longest_row: u64,
    pub ring_columns: u64,
    /// Fours of numbers of the mesh, from which the matrix is made (`MeshLayout::geometry_count`).
    pub geometry: u64,
}

/// How kernels are built and what they were measured to cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelFacts {
    /// 4 or 8, of a number of the iteration.
    pub bytes_per_real: u64,
    /// 4 or 8, of a number of the other stages.
    pub bytes_per_wide: u64,
    /// Invocations of a workgroup.
    pub invocations: u64,
    /// Time of one iteration of all systems of one body, as the last dispatch had it.
    pub seconds_per_iteration: f64,
}

/// How much of the iteration a workgroup of `pcg` keeps in its own memory during a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OnChip {
    /// Of p, q, r and d the first so many.
    pub vectors: u64,
    /// Numbers of each, four systems abreast.
    pub capacity: u64,
}

/// Bodies solved together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Batch {
    pub bodies: Range<usize>,
    /// Workgroups of `pcg`: one for each body and block of columns.
    pub workgroups: [u32; 2],
    /// Steps of one dispatch.
    pub iterations: u32,
}

/// Why bodies cannot be split into batches.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    #[error("body {body} needs {needed} bytes of {what}, this device has {limit} a buffer")]
    BodyTooLarge { body: usize, what: &'static str, needed: u64, limit: u64 },
    #[error("body {body} needs {needed} workgroups, this device has {limit} a dimension")]
    TooManyColumns { body: usize, needed: u64, limit: u64 },
    #[error("body {body}: an invocation would make {trips} loop trips, {limit} are safe in a dispatch")]
    TooManyTrips { body: usize, trips: u64, limit: u64 },
    #[error("a workgroup needs {needed} bytes of its own memory, this device has {limit}")]
    WorkgroupMemory { needed: u64, limit: u64 },
    #[error("a workgroup has {needed} invocations, this device allows {limit}")]
    WorkgroupSize { needed: u64, limit: u64 },
    #[error("{seconds} s an iteration is no time")]
    NoTime { seconds: f64 },
}

impl BodyCounts {
    /// Blocks of columns that go abreast.
    pub fn blocks(&self) -> u64 {
        self.ring_columns.div_ceil(COLUMNS_ABREAST)
    }

    /// Bytes of each buffer that grows with the bodies, for numbers of so many bytes.
    pub fn bytes(&self, real: u64, wide: u64) -> [(&'static str, u64); 6] {
        let systems = self.blocks() * COLUMNS_ABREAST;
        [
            ("matrix values", self.matrix_values * wide),
            ("narrowed values", if real == wide { 0 } else { self.matrix_values * real }),
            ("iterates", self.unknowns * systems * ITERATES * real),
            ("solutions", self.unknowns * systems * SOLUTIONS * wide),
            ("geometry", 4 * self.geometry * wide),
            ("compliance", self.ring_columns * systems * wide),
        ]
    }

    /// Loop trips of one invocation in one iteration of `pcg`, all loops together: for each of its rows one of the
    /// product and its entries, one of the update and one of the new direction; and the trees of two sums.
    pub fn trips(&self, invocations: u64) -> u64 {
        let rows = self.unknowns.div_ceil(invocations);
        1 + rows * (self.longest_row + 3) + 2 * u64::from(invocations.ilog2() + 1)
    }

    /// The most loop trips of one invocation in the kernels that are not split into steps. Beside those of `assemble`, in `refine`: its
    /// rows, once with their entries; in `condense`: its rows, each over all unknowns; in `works`: of each tile of rows of the ring its
    /// products, each over the blocks of columns, then its entries, each over the rows of the tile; and the systems of all blocks.
    pub fn whole_trips(&self, invocations: u64) -> u64 {
        // As many loops over the rows as a step has, and four over the systems of a block.
        let refine = self.trips(invocations) + 4 * COLUMNS_ABREAST;
        let condense = self.ring_columns.div_ceil(invocations) * (1 + COLUMNS_ABREAST + self.unknowns);
        let (tile, entries) = (works_tile(invocations), packed_count(MOST_MODES) as u64);
        let products = (tile * MOST_MODES as u64).div_ceil(invocations) * (1 + self.blocks());
        let of_tile = 1 + products + entries.div_ceil(invocations) * (1 + tile);
        // Entries are also set to zero and written.
        let works = self.ring_columns.div_ceil(tile) * of_tile
            + 2 * entries.div_ceil(invocations)
            + self.blocks() * (1 + COLUMNS_ABREAST);
        self.assemble.trips(invocations).max(refine).max(condense).max(works)
    }
}

impl KernelFacts {
    /// Bytes that the invocations of a workgroup share at most. In `pcg` and in `refine`: partial sums of all columns
    /// abreast, and their state; in `pcg` also what it keeps, of which there is one number if there is nothing. In `works`: a
    /// tile of products.
    pub fn workgroup_bytes(&self, on_chip: OnChip) -> u64 {
        let sums = |bytes: u64| (self.invocations + 2) * COLUMNS_ABREAST * bytes + 2 * COLUMNS_ABREAST * 4;
        let kept = (on_chip.vectors * on_chip.capacity).max(1) * COLUMNS_ABREAST * self.bytes_per_real;
        let products = works_tile(self.invocations) * MOST_MODES as u64 * self.bytes_per_wide;
        (sums(self.bytes_per_real) + kept).max(sums(self.bytes_per_wide)).max(products)
    }
}

impl OnChip {
    /// All vectors in storage.
    pub const NOTHING: OnChip = OnChip { vectors: 0, capacity: 0 };

    /// As many vectors of so many unknowns as a workgroup of this device has room for.
    pub fn fitting(unknowns: u64, kernel: &KernelFacts, limits: &DeviceLimits) -> OnChip {
        let capacity = capacity_class(unknowns);
        let fits = |on_chip: &OnChip| kernel.workgroup_bytes(*on_chip) <= u64::from(limits.workgroup_bytes);
        let most_first = (1..=ITERATES).rev().map(|vectors| OnChip { vectors, capacity });
        most_first.into_iter().find(fits).unwrap_or(OnChip::NOTHING)
    }
}

/// A few sizes, since each is a pipeline of its own: the next of 48, 64, 96, 128, 192 and so on.
fn capacity_class(unknowns: u64) -> u64 {
    let power = unknowns.next_power_of_two().max(64);
    if unknowns <= power / 4 * 3 { power / 4 * 3 } else { power }
}

/// Splits `bodies` into batches: in order, none lost, none twice.
pub fn batches(
    bodies: &[BodyCounts],
    kernel: &KernelFacts,
    limits: &DeviceLimits,
) -> Result<Vec<Batch>, BatchError> {
    check_kernel(kernel, limits)?;
    let mut batches = Vec::new();
    let mut first = 0;
    while first < bodies.len() {
        let batch = next_batch(bodies, first, kernel, limits)?;
        first = batch.bodies.end;
        batches.push(batch);
    }
    Ok(batches)
}

fn check_kernel(kernel: &KernelFacts, limits: &DeviceLimits) -> Result<(), BatchError> {
    let (needed, limit) = (kernel.workgroup_bytes(OnChip::NOTHING), u64::from(limits.workgroup_bytes));
    if needed > limit {
        return Err(BatchError::WorkgroupMemory { needed, limit });
    }
    let (needed, limit) = (kernel.invocations, u64::from(limits.invocations_per_workgroup));
    if needed > limit {
        return Err(BatchError::WorkgroupSize { needed, limit });
    }
    let seconds = kernel.seconds_per_iteration;
    if !(seconds > 0.0 && seconds.is_finite()) {
        return Err(BatchError::NoTime { seconds });
    }
    Ok(())
}

/// The batch that begins with body `first`.
fn next_batch(
    bodies: &[BodyCounts],
    first: usize,
    kernel: &KernelFacts,
    limits: &DeviceLimits,
) -> Result<Batch, BatchError> {
    let counts = &bodies[first];
    let limit = u64::from(limits.workgroups_per_dimension);
    if counts.blocks() > limit {
        return Err(BatchError::TooManyColumns { body: first, needed: counts.blocks(), limit });
    }
    let trips = counts.trips(kernel.invocations);
    let longest = trips.max(counts.whole_trips(kernel.invocations));
    if longest > MOST_TRIPS {
        return Err(BatchError::TooManyTrips { body: first, trips: longest, limit: MOST_TRIPS });
    }
    let most_steps = MOST_TRIPS / trips;
    let steps_in_target = TARGET.as_secs_f64() / kernel.seconds_per_iteration;
    let most_in_time = (steps_in_target / most_steps.min(FEWEST_STEPS) as f64).max(1.0) as u64;
    let most = most_in_time.min(limit);

    let buffer = limits.bound_buffer();
    let mut used = [0; 6];
    let mut total = 0;
    let all = |bytes: &[(&str, u64)]| -> u64 { bytes.iter().map(|(_, bytes)| bytes).sum() };
    let mut end = first;
    for (body, next) in bodies.iter().enumerate().skip(first) {
        let bytes = next.bytes(kernel.bytes_per_real, kernel.bytes_per_wide);
        if let Some(&(what, needed)) = bytes.iter().find(|(_, needed)| *needed > buffer) {
            // A batch before it is still good; it is met again as the first of the next one.
            if body > first {
                break;
            }
            return Err(BatchError::BodyTooLarge { body, what, needed, limit: buffer });
        }
        let fits = used.iter().zip(&bytes).all(|(used, (_, more))| used + more <= buffer)
            && (body == first || total + all(&bytes) <= MOST_BYTES);
        if next.topology != counts.topology || !fits || (body - first) as u64 == most {
            break;
        }
        used.iter_mut().zip(&bytes).for_each(|(used, (_, more))| *used += more);
        total += all(&bytes);
        end = body + 1;
    }
    let count = (end - first) as u64;
    let iterations = ((steps_in_target / count as f64) as u64).clamp(1, most_steps);
    Ok(Batch {
        bodies: first..end,
        workgroups: [count as u32, counts.blocks() as u32],
        iterations: iterations as u32,
    })
}

/// The time of an iteration of one body after a dispatch that took `taken`: for the next call of `batches`.
///
/// Kept where the dispatch was as long as it should be, so that one slow dispatch does not change the next.
pub fn adapted(kernel: &KernelFacts, batch: &Batch, taken: Duration) -> KernelFacts {
    if (SHORTEST..=LONGEST).contains(&taken) {
        return *kernel;
    }
    let work = batch.bodies.len() as f64 * f64::from(batch.iterations);
    // A clock that saw nothing still saw less than a microsecond.
    let seconds = taken.as_secs_f64().max(1e-6) / work;
    KernelFacts { seconds_per_iteration: seconds, ..*kernel }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Few share what a device has as if they were alone; many take no more than these.
    #[test]
    fn many_that_share_a_device_take_less_each() {
        assert_eq!([0, 1, 8].map(most_bytes), [MOST_BYTES; 3]);
        for sharing in [9, 16, 100] {
            let all = sharing as u64 * most_bytes(sharing);
            assert!(all <= MOST_BYTES_OF_ALL && all + sharing as u64 > MOST_BYTES_OF_ALL, "{sharing}: {all}");
        }
    }
}
