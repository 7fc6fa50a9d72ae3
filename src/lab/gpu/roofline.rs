//! What a device can do at most, measured on it: bytes a second of a copy between large buffers, of reads that its cache answers and of a
//! workgroup's own memory, and operations a second of multiply-adds that do not wait for each other.

use crate::engine::backend::gpu::context::{AdapterKind, GpuDevice, GpuError};
use crate::engine::backend::gpu::dispatch::{Argument, Dispatch, Pass};
use crate::engine::backend::gpu::kernel_texts::{ROOFLINE, Variant};
use crate::engine::backend::gpu::kernels::{Making, Precision, Stage};
use crate::lab::gpu::speed::{
    COPIED, INVOCATIONS, LINKS, OPERATIONS_PER_LINK, RooflineParameters, peak, samples,
};

/// The peaks of a device in numbers of one width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peaks {
    /// f32 or f64.
    pub precision: Precision,
    /// A second; a multiply-add is two.
    pub operations: f64,
    /// Read and written a second.
    pub bytes: f64,
    /// Of each of the two buffers of the copy.
    pub buffer_bytes: u64,
    /// Read a second of `cached_region_bytes` that all workgroups read.
    pub cached_bytes: f64,
    pub cached_region_bytes: u64,
    /// Read a second of the workgroups' own memories.
    pub workgroup_bytes: f64,
}

/// Of each buffer: beyond any cache, and small beside the memory of a GPU. Software has no other memory than the
/// processor's.
const BUFFER: u64 = 512 << 20;
const SOFTWARE_BUFFER: u64 = 64 << 20;

/// What all workgroups read: beyond the own cache of a processor of a GPU, within the one that all of them have.
const CACHED: u64 = 2 << 20;

/// Trips of reads of a workgroup's own memory, and vectors a trip.
const SHARED_TRIPS: u32 = 1024;
const SHARED_READS: u64 = 4;

/// How often a peak is timed; the best one counts.
const SAMPLES: usize = 7;

/// All peaks in numbers of one precision, which is not `Mixed`.
pub fn peaks(gpu: &GpuDevice, precision: Precision) -> Result<Peaks, GpuError> {
    precision.check(&gpu.facts)?;
    let invocations = INVOCATIONS.min(gpu.facts.limits.invocations_per_workgroup);
    let stage = Stage::new(gpu, &ROOFLINE, &Variant::plain(precision, invocations), Making::Trusted)?;
    let bytes_of_group = u64::from(invocations) * COPIED * 4 * precision.real_bytes();
    let limits = &gpu.facts.limits;
    let wanted = if gpu.facts.kind == AdapterKind::Software { SOFTWARE_BUFFER } else { BUFFER };
    let room = wanted.min(limits.binding_bytes).min(limits.buffer_bytes);
    // Two dimensions of workgroups, both as long.
    let across = (room / bytes_of_group).isqrt().min(u64::from(limits.workgroups_per_dimension)).max(1);
    let buffer_bytes = across * across * bytes_of_group;
    let vector_bytes = 4 * precision.real_bytes();
    let group_bytes = u64::from(invocations) * vector_bytes;
    // Powers of two, as the kernel asks for.
    let cached_trips = (CACHED.min(buffer_bytes) / group_bytes).max(1);
    let cached_trips = 1_u64 << cached_trips.ilog2();
    let [copy, multiply_add, read_cached, read_shared] = gpu.checked("roofline", || {
        let (source, copied) = (gpu.empty("source", buffer_bytes), gpu.empty("copied", buffer_bytes));
        let bind = |trip_count| {
            let parameters = RooflineParameters { trip_count, factor: 0.5, term: 0.5 };
            let parameters = gpu.uniform(&parameters);
            let arguments = [
                Argument::whole("parameters", &parameters),
                Argument::whole("source", &source),
                Argument::whole("copied", &copied),
            ];
            gpu.bind(&stage, &arguments)
        };
        [
            Dispatch::new(&stage, 0, &bind(COPIED as u32), [across as u32; 2]),
            Dispatch::new(&stage, 1, &bind(LINKS), [1, 1]),
            Dispatch::new(&stage, 2, &bind(cached_trips as u32), [1, 1]),
            Dispatch::new(&stage, 3, &bind(SHARED_TRIPS), [1, 1]),
        ]
    })?;
    let copied = samples(gpu, &[copy.pass()], SAMPLES)?[0];
    let operations_of_group = u64::from(invocations * LINKS) * OPERATIONS_PER_LINK;
    let cached_region_bytes = cached_trips * group_bytes;
    let shared_of_group = u64::from(SHARED_TRIPS) * SHARED_READS * group_bytes;
    Ok(Peaks {
        precision,
        operations: peak(gpu, &multiply_add, operations_of_group, SAMPLES)?,
        bytes: 2.0 * buffer_bytes as f64 / copied,
        buffer_bytes,
        cached_bytes: peak(gpu, &read_cached, cached_region_bytes, SAMPLES)?,
        cached_region_bytes,
        workgroup_bytes: peak(gpu, &read_shared, shared_of_group, SAMPLES)?,
    })
}

/// Median wall time of dispatches in order, s.
pub(super) fn seconds(gpu: &GpuDevice, passes: &[Pass], count: usize) -> Result<f64, GpuError> {
    Ok(samples(gpu, passes, count)?[count / 2])
}
