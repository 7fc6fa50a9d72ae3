//! A device that tells what it was given, and may leave bodies to the processor.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::time::Duration;

use jointsweep::internals::engine::backend::device_solver::DeviceSolver;
use jointsweep::internals::engine::backend::gpu::solver::GpuCondenser;
use jointsweep::internals::engine::backend::joints::{JointBatch, SolvedJoints};
use jointsweep::internals::engine::backend::{Counts, Device, Works};
use jointsweep::internals::engine::body_request::Group;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::question::counted::Told;
use jointsweep::internals::study::design::DesignCase;

use super::*;

/// What a device was given.
#[derive(Debug, Default)]
pub struct Given {
    /// In one go: bodies and joints. Nothing where it took none.
    pub whole: Vec<Option<[usize; 2]>>,
    /// Bodies whose works were to come back.
    pub long: usize,
    /// Joints that a workgroup has alone, and two at a time.
    pub together: [usize; 2],
}

impl Given {
    fn meet(&mut self, batch: &JointBatch) {
        for joint in &batch.joints {
            self.together[batch.tables[joint.tables as usize].kind().together - 1] += 1;
        }
    }
}

/// In f32, with kernels that are watched.
struct Watched<'a> {
    condenser: GpuCondenser<'a>,
    given: &'a Mutex<Given>,
    /// Then all bodies are the processor's, so that those of both sides are the same; and what is begun and not finished.
    leaves_bodies: bool,
    left: VecDeque<Works>,
}

impl Device for Watched<'_> {
    fn rounding(&self) -> f64 {
        if self.leaves_bodies { 0.0 } else { self.condenser.rounding() }
    }

    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        self.given.lock().unwrap().long += count(groups);
        if self.leaves_bodies {
            self.left.push_back(groups.iter().map(|(_, group)| vec![None; group.len()]).collect());
            return Ok(());
        }
        self.condenser.begin(groups)
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        if self.leaves_bodies { Ok(self.left.pop_front().unwrap()) } else { self.condenser.finish() }
    }

    fn solves_joints(&self) -> SolvedJoints {
        self.condenser.solves_joints()
    }

    fn begin_whole(&mut self, groups: &[Group], batch: &JointBatch) -> Result<bool, GpuError> {
        let is_begun = !self.leaves_bodies && self.condenser.begin_whole(groups, batch)?;
        let mut given = self.given.lock().unwrap();
        given.whole.push(is_begun.then_some([count(groups), batch.joints.len()]));
        given.meet(batch);
        Ok(is_begun)
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        self.given.lock().unwrap().meet(batch);
        self.condenser.begin_joints(batch)
    }

    fn finish_joints(&mut self) -> Result<Vec<f32>, GpuError> {
        self.condenser.finish_joints()
    }

    fn finish_answers(&mut self) -> Result<Vec<Told>, GpuError> {
        self.condenser.finish_answers()
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        self.condenser.stages()
    }

    fn counts(&self) -> Counts {
        self.condenser.counts()
    }

    fn worst_residual(&self) -> f64 {
        0.0
    }

    fn solves(&self) -> u64 {
        0
    }
}

fn count(groups: &[Group]) -> usize {
    groups.iter().map(|(_, group)| group.len()).sum()
}

/// How a device is watched.
pub struct Watching {
    pub joints: SolvedJoints,
    pub leaves_bodies: bool,
}

impl Watching {
    /// The outcomes of some designs and then of others by a ladder on a device, what that was given, and what was asked of it.
    pub fn solve<'c>(
        &self,
        gpu: &GpuDevice,
        ladder: Ladder,
        cases: impl IntoIterator<Item = &'c [DesignCase]>,
    ) -> (Vec<Vec<DesignOutcome>>, Given, Counts) {
        self.ask(gpu, ladder, |ladder| cases.into_iter().map(|cases| ladder.solve(cases)).collect())
    }

    /// What comes of a ladder on a device, what that was given, and what was asked of it.
    pub fn ask<T>(
        &self,
        gpu: &GpuDevice,
        ladder: Ladder,
        ask: impl FnOnce(&mut Ladder) -> T,
    ) -> (T, Given, Counts) {
        let kernels = Kernels::with_tree(gpu, Precision::F32, INVOCATIONS, Making::Checked).unwrap();
        let condenser = GpuCondenser::with(kernels, DeviceSolver::Auto).solving_joints(self.joints);
        let given = Mutex::default();
        let left = VecDeque::new();
        let device = Watched { condenser, given: &given, leaves_bodies: self.leaves_bodies, left };
        let mut ladder = ladder.on(Box::new(device));
        let found = ask(&mut ladder);
        assert_eq!(ladder.library.lost(), None);
        let counts = ladder.library.device().unwrap().counts();
        drop(ladder);
        (found, given.into_inner().unwrap(), counts)
    }
}
