//! How fast a device is, measured on it: times of dispatches, and what workgroups do a second where there are enough of them.

use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};

use crate::engine::backend::gpu::context::{AdapterKind, GpuDevice, GpuError};
use crate::engine::backend::gpu::dispatch::{Dispatch, Pass};

/// What `roofline` is told.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct RooflineParameters {
    pub trip_count: u32,
    pub factor: f32,
    pub term: f32,
}

pub(crate) const INVOCATIONS: u32 = 256;

/// Vectors that one invocation copies.
pub(crate) const COPIED: u64 = 16;

/// Trips of a chain: the start of an invocation is nothing beside them, and Mesa 22 bounds them.
pub(crate) const LINKS: u32 = 4096;

/// Operations of one trip: eight chains of four numbers, two operations each.
pub(crate) const OPERATIONS_PER_LINK: u64 = 8 * 4 * 2;

/// What is timed takes so long at least.
const LONG_ENOUGH: Duration = Duration::from_millis(20);

/// What workgroups do a second of which each does `of_group`: with more and more of them, until a dispatch is long enough; the best of
/// some samples.
pub(crate) fn peak(gpu: &GpuDevice, one: &Dispatch, of_group: u64, count: usize) -> Result<f64, GpuError> {
    // Software is filled by one for each thread, and is slow enough for that.
    let mut groups = match gpu.facts.kind {
        AdapterKind::Software => available_parallelism().map_or(1, |threads| threads.get() as u32),
        _ => 16,
    };
    loop {
        let dispatch = Dispatch { workgroups: [groups, 1], ..one.clone() };
        let pass = dispatch.pass();
        // The first one warms up.
        run(gpu, &[pass], 1)?;
        let taken = run(gpu, &[pass], 1)?;
        if taken > LONG_ENOUGH.as_secs_f64() || 2 * groups > gpu.facts.limits.workgroups_per_dimension {
            let work = u64::from(groups) * of_group;
            return Ok(work as f64 / samples(gpu, &[pass], count)?[0]);
        }
        groups *= 2;
    }
}

/// Wall times of dispatches in order, the shortest first, s: after a first time, as often in one submission as makes it
/// long enough.
pub(crate) fn samples(gpu: &GpuDevice, passes: &[Pass], count: usize) -> Result<Vec<f64>, GpuError> {
    run(gpu, passes, 1)?;
    let once = run(gpu, passes, 1)?;
    let times = (LONG_ENOUGH.as_secs_f64() / once).ceil().clamp(1.0, 1000.0) as usize;
    let mut taken = (0..count)
        .map(|_| Ok(run(gpu, passes, times)? / times as f64))
        .collect::<Result<Vec<f64>, GpuError>>()?;
    taken.sort_by(f64::total_cmp);
    Ok(taken)
}

/// Wall time of so many times these dispatches, from their submission to their end, s.
pub(crate) fn run(gpu: &GpuDevice, passes: &[Pass], times: usize) -> Result<f64, GpuError> {
    let started = Instant::now();
    gpu.checked("timing", || gpu.submit((0..times).flat_map(|_| passes.iter().copied())))?;
    gpu.wait()?;
    // A clock that saw nothing still saw less than a microsecond.
    Ok(started.elapsed().as_secs_f64().max(1e-6))
}
