//! The kernels of the trial pressures, for one count of them: from the compliances of rings to those of slots
//! (`gram.wgsl`), and from slots to the states of joints (`contact.wgsl`).

use super::context::{GpuDevice, GpuError};
use super::kernels::{CONTACT, GRAM, KernelFile, Precision, Stage};
use crate::mechanics::compliance::NODE_COUNT;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::real::LANES;

/// Numbers of a slot before its compliance: whether it is sound, its amplitude, its worst true residual.
pub const SLOT_HEADER: usize = 3;

/// Numbers of the slot of one body.
pub const fn slot_size(terms: usize) -> usize {
    SLOT_HEADER + NODE_COUNT * packed_count(terms)
}

/// The pipelines for one count of trial pressures.
pub struct TrialKernels<'a> {
    pub gpu: &'a GpuDevice,
    pub precision: Precision,
    pub invocations: u32,
    pub terms: usize,
    pub gram: Stage,
    pub contact: Stage,
}

/// The text of a kernel of the trial pressures.
pub fn source(file: &KernelFile, precision: Precision, invocations: u32, terms: usize) -> String {
    let text = file.source(precision, invocations);
    format!(
        "{text}\nconst TERMS = {terms}u;\nconst NODES = {NODE_COUNT}u;\nconst NEAR_FIELD_NODES = {LANES}u;\n\
         const SLOT_HEADER = {SLOT_HEADER}u;\n"
    )
}

impl<'a> TrialKernels<'a> {
    pub fn new(
        gpu: &'a GpuDevice,
        precision: Precision,
        invocations: u32,
        terms: usize,
    ) -> Result<TrialKernels<'a>, GpuError> {
        let stage = |file: &KernelFile| {
            let source = source(file, precision, invocations, terms);
            Stage::from_source(gpu, file, &source, false)
        };
        Ok(TrialKernels {
            gpu,
            precision,
            invocations,
            terms,
            gram: stage(&GRAM)?,
            contact: stage(&CONTACT)?,
        })
    }
}
