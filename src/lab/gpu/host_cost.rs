//! What processors do around a GPU: a sweep whose bodies go the whole way to a device and back, with kernels that do nothing.
//!
//! In place of the works that such kernels leave out, each body has those of the first body of its topology, so that contact has
//! something to solve. Making them is not counted. Joints that are the device's have one state in place of all that are left out, and of a study that
//! asks for answers alone all designs are told to be counted; their fits, which the processor makes, are not counted, either.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use foldhash::HashMap;
use rayon::ThreadPool;

use crate::engine::backend::adapter::GpuError;
use crate::engine::backend::choice::joints_in;
use crate::engine::backend::device_solver::DeviceSolver;
use crate::engine::backend::drawn::DrawnDesigns;
use crate::engine::backend::gpu::context::GpuDevice;
use crate::engine::backend::gpu::kernels::Making;
use crate::engine::backend::gpu::solver::GpuCondenser;
use crate::engine::backend::joints::{BatchedJoint, ENDED, JointBatch, STATE_NUMBERS, SolvedJoints};
use crate::engine::backend::precision::Precision;
use crate::engine::backend::{Counts, Device, IN_FLIGHT, Works};
use crate::engine::body_request::{Group, TopologyKey};
use crate::engine::drawing::{Chosen, Drawer};
use crate::engine::interpolation::drawn_on_device::Drawing;
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::ladder::Ladder;
use crate::engine::ladder::counting::Counting;
use crate::engine::outcome::{Answer, BackendKind};
use crate::engine::question::Asker;
use crate::engine::question::counted::{Told, Total, Verdict};
use crate::engine::sweep::keep_blocks;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::output::host::processor_seconds;
use crate::output::sinks::Sinks;
use crate::study::config::Study;

/// Processor time of all threads, s, and what was asked of the device. But for `beginning` and `counts` the first batches are left out: they make
/// buffers, near fields and spaces for all that come behind them.
#[derive(Clone, Debug, Default)]
pub struct HostCost {
    /// What the first batches took.
    pub beginning: f64,
    pub designs: u64,
    /// Whose bodies went to the device.
    pub on_device: u64,
    /// Drawing the designs, and telling how many bodies are different.
    pub drawing: f64,
    /// From the bodies of a batch to their works, or to the states of joints, by the device's driver too: on software that is what runs
    /// the empty kernels, of which each dispatch has one workgroup.
    pub condensing: f64,
    /// From designs to answers, `condensing` included.
    pub solving: f64,
    /// Wall times as a sweep tells them, summed over threads, of all batches.
    pub stages: Vec<(&'static str, Duration)>,
    /// Of all batches.
    pub counts: Counts,
    /// Calls of the device.
    pub calls: u64,
}

impl HostCost {
    /// Of the designs of a study in batches of so many; nothing is written. Of one that asks for answers alone the device counts the rows, of
    /// designs that it `draws` itself, if it can. The threads of `pool` solve, as in a sweep; the caller draws.
    pub fn of(
        study: &Study,
        gpu: &GpuDevice,
        precision: Precision,
        pool: &ThreadPool,
        batch_size: usize,
        draws: bool,
    ) -> Result<HostCost, GpuError> {
        keep_blocks();
        let (seen, plan) = (Mutex::default(), InterpolationPlan::of_study(study));
        // As on a device that is no software.
        let solves_joints = joints_in(precision);
        let condenser = EmptyCondenser {
            condenser: GpuCondenser::new(gpu, precision, DeviceSolver::Auto, Making::Empty)?
                .solving_joints(solves_joints),
            works: HashMap::default(),
            stand_ins: VecDeque::new(),
            stand_in_states: VecDeque::new(),
            interpolates: plan.is_some(),
            seen: &seen,
        };
        let sinks = Sinks::of(study);
        let asking = sinks.asking();
        let asker = asking.as_ref().map(|asking| asking as &dyn Asker);
        let mut ladder = Ladder::new(study.solve)
            .sharing(study.in_common())
            .interpolating(plan)
            .asked_by(asker)
            .on(Box::new(condenser));
        let chosen = Chosen::All;
        let Ok(mut drawer) = Drawer::new(study, &chosen, pool.current_num_threads()) else {
            unreachable!("what is sampled can be drawn")
        };
        if ladder.interpolation.is_some() {
            let first = drawer.draw(UNCOUNTED).unwrap_or_default();
            pool.install(|| ladder.answers(&first));
        }
        let drawing = asker.filter(|_| draws).and_then(|asker| Drawing::of(study, asker.question()));
        let numbers = 0..if drawing.is_some() { study.design_count() } else { 0 };
        let mut batches = Batches { study, pool, ladder, begun: None, cost: HostCost::default() };
        let mut numbered = numbers.clone().step_by(batch_size).map(|first| {
            let end = numbers.end.min(first + batch_size as u64);
            first..end
        });
        let mut next = |batches: &mut Batches| match (&drawing, numbered.next()) {
            (Some(drawing), Some(numbers)) => batches.take_drawn(drawing, numbers),
            (Some(_), None) => false,
            (None, _) => batches.take(&mut drawer, batch_size),
        };
        // As many as a device has at a time, each of which has buffers of its own.
        let mut left = IN_FLIGHT;
        while left > 0 && next(&mut batches) {
            left -= 1;
        }
        batches.finish();
        let first = std::mem::take(&mut batches.cost);
        let of_first = std::mem::take(&mut *seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
        while next(&mut batches) {}
        batches.finish();
        let Batches { ladder, mut cost, .. } = batches;
        cost.beginning = first.drawing + first.solving - of_first.standing_in;
        if let Some(error) = ladder.library.lost() {
            return Err(error.clone());
        }
        cost.stages = ladder.stages();
        let seen = seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        cost.condensing = seen.condensing;
        cost.solving -= seen.standing_in;
        (cost.counts, cost.calls) = (seen.counts, seen.calls);
        Ok(cost)
    }
}

/// A sweep that is solved batch by batch.
struct Batches<'a> {
    study: &'a Study,
    pool: &'a ThreadPool,
    ladder: Ladder<'a>,
    /// What is counted comes back when the next batch is begun, as in a sweep.
    begun: Option<Counting>,
    cost: HostCost,
}

impl Batches<'_> {
    /// The next so many designs; tells whether there are any.
    fn take(&mut self, drawer: &mut Drawer, batch_size: usize) -> bool {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let batch = drawer.draw(batch_size).unwrap_or_default();
        let drawn = processor_seconds().unwrap_or(f64::NAN);
        self.cost.drawing += drawn - before;
        if batch.is_empty() {
            return false;
        }
        self.cost.designs += batch.len() as u64;
        self.pool.install(|| match self.ladder.begin_count(batch) {
            Ok(counting) => self.follow(Some(counting)),
            Err(batch) => {
                let answers = self.ladder.answers(&batch);
                let is_there = |answer: &&Answer| answer.backend == BackendKind::Gpu;
                self.cost.on_device += answers.iter().filter(is_there).count() as u64;
            }
        });
        self.cost.solving += processor_seconds().unwrap_or(f64::NAN) - drawn;
        true
    }

    /// Designs that the device draws.
    fn take_drawn(&mut self, drawing: &Drawing, numbers: Range<u64>) -> bool {
        let before = processor_seconds().unwrap_or(f64::NAN);
        self.cost.designs += numbers.end - numbers.start;
        self.pool.install(|| {
            let counting = self.ladder.begin_drawn(drawing, numbers);
            self.follow(counting);
        });
        self.cost.solving += processor_seconds().unwrap_or(f64::NAN) - before;
        true
    }

    /// Takes what was begun before.
    fn follow(&mut self, next: Option<Counting>) {
        let begun = std::mem::replace(&mut self.begun, next);
        let finished = begun.and_then(|begun| self.ladder.finish_count(self.study, begun)?.ok());
        self.cost.on_device += finished.map_or(0, |(counted, _)| counted.designs);
    }

    fn finish(&mut self) {
        let before = processor_seconds().unwrap_or(f64::NAN);
        self.pool.install(|| self.follow(None));
        self.cost.solving += processor_seconds().unwrap_or(f64::NAN) - before;
    }
}

fn stand_in_states(batch: &JointBatch) -> Vec<f32> {
    let mut states = Vec::with_capacity(batch.joints.iter().map(BatchedJoint::found).sum());
    for joint in &batch.joints {
        states.push(0.0);
        (0..joint.load_count).for_each(|_| states.extend(STAND_IN));
    }
    states
}

/// Designs that fits are made for.
const UNCOUNTED: usize = 64;

/// In place of all that the kernel leaves out of a state: it meets any accuracy.
const STAND_IN: [f32; STATE_NUMBERS] = [ENDED, 0.25, 0.5, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.5, 0.5];

/// What a condenser has to say of itself.
#[derive(Default)]
struct Seen {
    condensing: f64,
    /// For works in place of those that were left out.
    standing_in: f64,
    counts: Counts,
    calls: u64,
}

/// A device whose kernels do nothing.
struct EmptyCondenser<'a> {
    condenser: GpuCondenser<'a>,
    works: HashMap<TopologyKey, Arc<Vec<f64>>>,
    /// Those of each group that was begun and is not finished.
    stand_ins: VecDeque<Vec<Arc<Vec<f64>>>>,
    /// And what is found of the joints of a batch.
    stand_in_states: VecDeque<Vec<f32>>,
    /// Then it leaves the bodies of fits to the processor.
    interpolates: bool,
    seen: &'a Mutex<Seen>,
}

impl EmptyCondenser<'_> {
    /// That a call took from one time of the processor to another, and what stands in for its works since then.
    fn tell_call(&self, before: f64, between: f64) {
        let mut seen = self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        seen.condensing += between - before;
        seen.standing_in += processor_seconds().unwrap_or(f64::NAN) - between;
        seen.calls += 1;
    }
}

impl Device for EmptyCondenser<'_> {
    fn begin(&mut self, groups: &[Group]) -> Result<(), GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        self.condenser.begin(groups)?;
        let between = processor_seconds().unwrap_or(f64::NAN);
        let mut stand_ins = Vec::with_capacity(groups.len());
        for (key, requests) in groups.iter().filter(|_| !self.interpolates) {
            let works = self.works.entry(key.clone()).or_insert_with(|| {
                let body = &requests[0].body;
                let plan = CondensationPlan::new(body, key.grading(body), RingModes::of(&key.class));
                Arc::new(plan.condense_alone(body))
            });
            stand_ins.push(Arc::clone(works));
        }
        self.stand_ins.push_back(stand_ins);
        self.tell_call(before, between);
        Ok(())
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let mut condensed = self.condenser.finish()?;
        let between = processor_seconds().unwrap_or(f64::NAN);
        let stand_ins = self.stand_ins.pop_front().unwrap_or_default();
        for (condensed, works) in condensed.iter_mut().zip(stand_ins) {
            condensed.iter_mut().for_each(|own| *own = Some(works.to_vec()));
        }
        let mut seen = self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        seen.condensing += between - before;
        seen.standing_in += processor_seconds().unwrap_or(f64::NAN) - between;
        seen.counts = self.condenser.counts();
        Ok(condensed)
    }

    fn solves_joints(&self) -> SolvedJoints {
        self.condenser.solves_joints()
    }

    fn begin_whole(&mut self, groups: &[Group], batch: &JointBatch) -> Result<bool, GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let is_begun = self.condenser.begin_whole(groups, batch)?;
        let between = processor_seconds().unwrap_or(f64::NAN);
        let has_states = is_begun && batch.asked.is_none();
        self.stand_in_states.extend(has_states.then(|| stand_in_states(batch)));
        self.tell_call(before, between);
        Ok(is_begun)
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        self.condenser.begin_joints(batch)?;
        let between = processor_seconds().unwrap_or(f64::NAN);
        self.stand_in_states.extend(batch.asked.is_none().then(|| stand_in_states(batch)));
        self.tell_call(before, between);
        Ok(())
    }

    fn begin_drawn(&mut self, drawn: &DrawnDesigns) -> Result<bool, GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let is_begun = self.condenser.begin_drawn(drawn)?;
        self.tell_call(before, processor_seconds().unwrap_or(f64::NAN));
        Ok(is_begun)
    }

    fn finish_joints(&mut self) -> Result<Vec<f32>, GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let found = self.condenser.finish_joints()?;
        let stand_ins = self.stand_in_states.pop_front().unwrap_or_default();
        assert_eq!(found.len(), stand_ins.len(), "a state for each load");
        let mut seen = self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        seen.condensing += processor_seconds().unwrap_or(f64::NAN) - before;
        seen.counts = self.condenser.counts();
        Ok(stand_ins)
    }

    fn finish_answers(&mut self) -> Result<Vec<Told>, GpuError> {
        let before = processor_seconds().unwrap_or(f64::NAN);
        let mut told = self.condenser.finish_answers()?;
        for Told { designs, all, .. } in &mut told {
            // Verdicts come last.
            all[Total::CountedDesigns as usize] = *designs as u32;
            let verdicts = all.len() - *designs;
            all[verdicts..].fill(Verdict::Counted as u32);
        }
        let mut seen = self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        seen.condensing += processor_seconds().unwrap_or(f64::NAN) - before;
        seen.counts = self.condenser.counts();
        Ok(told)
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        self.condenser.stages()
    }

    fn worst_residual(&self) -> f64 {
        self.condenser.worst_residual()
    }

    fn solves(&self) -> u64 {
        self.condenser.solves()
    }
}
