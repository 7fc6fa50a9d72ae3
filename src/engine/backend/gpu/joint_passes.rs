//! The passes of a submission that solve joints and count their rows: what each is given, and in how many dispatches.

use super::context::GpuDevice;
use super::dispatch::{Argument, PassTimes};
use super::joint_load::Placed;
use super::kernel_texts::ANSWERED_TOGETHER;
use super::kernels::Stage;
use crate::engine::backend::Counts;

/// Of a dispatch at most: few enough for any device's limit, and for a watchdog.
const MOST_JOINTS: usize = 8192;

/// Bytes of the place of a design.
pub(super) const DESIGN_BYTES: usize = size_of::<[u32; 4]>();

/// What the kernel of joints is given.
pub(super) struct Bound<'a> {
    pub parameters: &'a wgpu::Buffer,
    pub tables: &'a wgpu::Buffer,
    pub places: &'a wgpu::Buffer,
    pub joints: &'a wgpu::Buffer,
    pub works: Argument<'a>,
    pub near_fields: &'a wgpu::Buffer,
    pub found: &'a wgpu::Buffer,
}

/// What that which counts rows is given beside it, with how many designs there are.
pub(super) struct Asking<'a> {
    pub asked: &'a wgpu::Buffer,
    pub designs: (&'a wgpu::Buffer, usize),
    pub told: &'a wgpu::Buffer,
}

impl Bound<'_> {
    /// So many joints whose places begin at a byte, some of them together in each workgroup.
    pub(super) fn solve(
        &self,
        gpu: &GpuDevice,
        (stage, together): (&Stage, usize),
        (at, count): (u64, usize),
        (encoder, times): (&mut wgpu::CommandEncoder, &mut PassTimes),
        counts: &mut Counts,
    ) {
        for first in (0..count).step_by(MOST_JOINTS) {
            let joints = MOST_JOINTS.min(count - first);
            let from = at + (first * size_of::<Placed>()) as u64;
            let places = from..from + (joints * size_of::<Placed>()) as u64;
            let arguments = [
                Argument::whole("parameters", self.parameters),
                Argument::whole("tables", self.tables),
                Argument::whole("table_fours", self.tables),
                Argument::part("places", self.places, places),
                Argument::whole("joints", self.joints),
                self.works.clone(),
                Argument::whole("near_fields", self.near_fields),
                Argument::whole("found", self.found),
            ];
            let mut pass = encoder.begin_compute_pass(&times.next());
            pass.set_pipeline(&stage.pipelines[0]);
            pass.set_bind_group(0, &gpu.bind(stage, &arguments), &[]);
            pass.dispatch_workgroups(stage.workgroups(joints.div_ceil(together) as u32), 1, 1);
            counts.dispatches += 1;
        }
    }

    /// What their rows come to.
    pub(super) fn count(
        &self,
        gpu: &GpuDevice,
        stage: &Stage,
        Asking { asked, designs: (designs, count), told }: &Asking,
        (encoder, times): (&mut wgpu::CommandEncoder, &mut PassTimes),
        counts: &mut Counts,
    ) {
        let arguments = [
            Argument::whole("found", self.found),
            Argument::whole("joints", self.joints),
            Argument::whole("asked", asked),
            // As many as there are: it tells the kernel how many that is.
            Argument::part("designs", designs, 0..(count * DESIGN_BYTES) as u64),
            Argument::whole("told", told),
        ];
        let mut pass = encoder.begin_compute_pass(&times.next());
        pass.set_pipeline(&stage.pipelines[0]);
        pass.set_bind_group(0, &gpu.bind(stage, &arguments), &[]);
        pass.dispatch_workgroups(stage.workgroups(count.div_ceil(ANSWERED_TOGETHER) as u32), 1, 1);
        counts.dispatches += 1;
    }
}

/// Dispatches of so many joints.
pub(super) fn pieces(joints: usize) -> usize {
    joints.div_ceil(MOST_JOINTS)
}
