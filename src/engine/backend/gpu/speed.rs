//! How fast a device computes, measured on it: operations a second of multiply-adds that do not wait for each other, and the
//! numbers that are best to compute in.

use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};

use super::context::{AdapterKind, GpuDevice, GpuError};
use super::dispatch::{Argument, Dispatch, Pass};
use super::kernel_texts::{ROOFLINE, Variant};
use super::kernels::{Making, Precision, Stage};

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
const OPERATIONS_PER_LINK: u64 = 8 * 4 * 2;

/// What is timed takes so long at least.
const LONG_ENOUGH: Duration = Duration::from_millis(20);

/// From this accuracy on, relative, of the force, f32 alone does.
const ROUGH: f64 = 1e-3;

/// Where f64 is at least this much as fast as f32, refinement in f64 costs little.
const FAST_ENOUGH: f64 = 0.25;

/// The numbers that are best for an accuracy on a device: f32 refined in f64 where f64 is needed or fast. Consumer GPUs do f64
/// at 1/32 to 1/64 of the speed.
pub fn preferred_precision(gpu: &GpuDevice, accuracy: f64) -> Result<Precision, GpuError> {
    let is_certain = !gpu.facts.features.f64 || accuracy < ROUGH || gpu.facts.kind == AdapterKind::Software;
    // What software computes in is a matter of tests, not of speed.
    let share = if is_certain { 1.0 } else { f64_share(gpu)? };
    Ok(preferred(gpu.facts.features.f64, accuracy, share))
}

/// `f64_share`: the speed of f64 over that of f32.
fn preferred(has_f64: bool, accuracy: f64, f64_share: f64) -> Precision {
    if has_f64 && (accuracy < ROUGH || f64_share >= FAST_ENOUGH) { Precision::Mixed } else { Precision::F32 }
}

/// Multiply-adds a second in f64 over those in f32, measured briefly.
fn f64_share(gpu: &GpuDevice) -> Result<f64, GpuError> {
    let invocations = INVOCATIONS.min(gpu.facts.limits.invocations_per_workgroup);
    let operations = |precision: Precision| {
        let stage = Stage::new(gpu, &ROOFLINE, &Variant::plain(precision, invocations), Making::Trusted)?;
        let bytes = u64::from(invocations) * COPIED * 4 * precision.real_bytes();
        let chains = gpu.checked("roofline", || {
            let buffers = [gpu.empty("source", bytes), gpu.empty("copied", bytes)];
            let parameters = RooflineParameters { trip_count: LINKS, factor: 0.5, term: 0.5 };
            let parameters = gpu.uniform(&parameters);
            let arguments = [
                Argument::whole("parameters", &parameters),
                Argument::whole("source", &buffers[0]),
                Argument::whole("copied", &buffers[1]),
            ];
            let group = gpu.bind(&stage, &arguments);
            Dispatch::new(&stage, 1, &group, [1, 1])
        })?;
        arithmetic_peak(gpu, chains, invocations, 1)
    };
    Ok(operations(Precision::F64)? / operations(Precision::F32)?)
}

/// With more and more workgroups, until a dispatch is long enough; the best of some samples.
pub(crate) fn arithmetic_peak(
    gpu: &GpuDevice,
    chains: Dispatch,
    invocations: u32,
    count: usize,
) -> Result<f64, GpuError> {
    let mut groups = 16_u32;
    loop {
        let dispatch = Dispatch { workgroups: [groups, 1], ..chains.clone() };
        let (pass, work) = (dispatch.pass(), u64::from(groups) * u64::from(invocations * LINKS));
        // The first one warms up.
        run(gpu, &[pass], 1)?;
        let taken = run(gpu, &[pass], 1)?;
        if taken > LONG_ENOUGH.as_secs_f64() || 2 * groups > gpu.facts.limits.workgroups_per_dimension {
            let operations = work * OPERATIONS_PER_LINK;
            return Ok(operations as f64 / samples(gpu, &[pass], count)?[0]);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Data centre GPUs do f64 at half the speed of f32, others at a 32nd.
    #[test]
    fn f64_is_used_where_it_is_needed_or_fast() {
        for (has_f64, accuracy, share, expected) in [
            (true, 1e-2, 0.5, Precision::Mixed),
            (true, 1e-2, 1.0 / 32.0, Precision::F32),
            (true, 1e-3, 0.24, Precision::F32),
            (true, 9e-4, 1.0 / 64.0, Precision::Mixed),
            (false, 1e-5, 1.0, Precision::F32),
        ] {
            assert_eq!(preferred(has_f64, accuracy, share), expected, "{has_f64} {accuracy} {share}");
        }
    }
}
