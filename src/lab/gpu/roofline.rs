//! What a device can do at most, measured on it: bytes a second of a copy between large buffers, and operations a second
//! of multiply-adds that do not wait for each other.

use crate::engine::backend::gpu::context::{AdapterKind, GpuDevice, GpuError};
use crate::engine::backend::gpu::dispatch::{Argument, Dispatch, Pass};
use crate::engine::backend::gpu::kernel_texts::{ROOFLINE, Variant};
use crate::engine::backend::gpu::kernels::{Making, Precision, Stage};
use crate::lab::gpu::speed::{COPIED, INVOCATIONS, LINKS, RooflineParameters, arithmetic_peak, samples};

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
}

/// Of each buffer: beyond any cache, and small beside the memory of a GPU. Software has no other memory than the
/// processor's.
const BUFFER: u64 = 512 << 20;
const SOFTWARE_BUFFER: u64 = 64 << 20;

/// How often a peak is timed; the best one counts.
const SAMPLES: usize = 7;

/// Both peaks in numbers of one precision, which is not `Mixed`.
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
    let (copy, multiply_add) = gpu.checked("roofline", || {
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
        let copy = Dispatch::new(&stage, 0, &bind(COPIED as u32), [across as u32; 2]);
        (copy, Dispatch::new(&stage, 1, &bind(LINKS), [1, 1]))
    })?;
    let copied = samples(gpu, &[copy.pass()], SAMPLES)?[0];
    let operations = arithmetic_peak(gpu, multiply_add, invocations, SAMPLES)?;
    Ok(Peaks { precision, operations, bytes: 2.0 * buffer_bytes as f64 / copied, buffer_bytes })
}

/// Median wall time of dispatches in order, s.
pub(super) fn seconds(gpu: &GpuDevice, passes: &[Pass], count: usize) -> Result<f64, GpuError> {
    Ok(samples(gpu, passes, count)?[count / 2])
}
