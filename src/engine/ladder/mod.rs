//! The climb from cheap to dear: every design is answered by the cheapest rung that is foreseen to do, judged, and answered again
//! on the next one until it is good enough or there is no more. Rungs are bodies interpolated between others, then plans of
//! ever finer meshes and pressure spaces; whatever condenses the bodies.

pub mod counting;

use std::collections::VecDeque;
use std::ops::Range;
use std::time::Duration;

use rayon::prelude::*;

use crate::engine::accuracy::Want;
use crate::engine::accuracy::single_precision::accuracy_bears_singles;
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::backend::{Device, IN_FLIGHT};
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_portions::MANY;
use crate::engine::body_request::{BodyHandle, JointBodies};
use crate::engine::contact_on_device::{GivenBody, given, judged_designs};
use crate::engine::device_joints::{JOINTS_TOGETHER, Underway, gathered};
use crate::engine::hashed::Hashed;
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::interpolation::interpolated::Interpolation;
use crate::engine::joint_contact::{Alike, ContactRoom, SolvedPlan, joint_key, own_error, solve_designs};
use crate::engine::known_bodies::RequestKey;
use crate::engine::outcome::{Answer, DesignOutcome};
use crate::engine::plan::JointPlan;
use crate::engine::question::Asker;
use crate::engine::row::{closed_form, refused};
use crate::engine::spaces::{Needs, Spaces};
use crate::engine::stopwatch::Stopwatch;
use crate::engine::whole_joints::{WholeJoints, portions};
use crate::mechanics::compliance::near_field::InCommon;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

/// The answers to the designs of a joint, and what they have taken.
type Timed = (Vec<(Answer, Want)>, Duration);

/// Designs whose bodies are solved, on their way to an attempt.
struct Attempt<'a> {
    open: &'a [(usize, JointPlan)],
    bodies: Vec<JointBodies>,
    alike: Alike,
    /// Of each joint what is kept while a device has it, where one solves joints.
    on_device: Option<Underway<f64>>,
}

impl Attempt<'_> {
    /// Of a joint its plan, with its bodies.
    fn plan(&self, joint: &Range<u32>) -> SolvedPlan<'_> {
        let place = self.alike.places(joint)[0] as usize;
        SolvedPlan { plan: &self.open[place].1, bodies: self.bodies[place] }
    }

    /// The designs of a joint.
    fn cases<'b>(
        &'b self,
        cases: &'b [DesignCase],
        joint: &Range<u32>,
    ) -> impl Iterator<Item = &'b DesignCase> + Clone {
        self.alike.places(joint).iter().map(|place| &cases[self.open[*place as usize].0])
    }
}

/// Joints that a thread takes at a time, to solve them.
const SOLVED_TOGETHER: usize = 4;

/// Solves batches of designs; keeps the bodies it has met.
pub struct Ladder<'a> {
    options: SolveOptions,
    pub library: BodyLibrary<'a>,
    pub spaces: Spaces,
    pub interpolation: Option<Interpolation>,
    /// Who asks something of all rows together, which a device may count.
    asker: Option<&'a dyn Asker>,
    times: LadderTimes,
}

#[derive(Default)]
struct LadderTimes {
    spaces: Duration,
    /// Summed over threads.
    contact: Duration,
}

impl<'a> Ladder<'a> {
    pub fn new(options: SolveOptions) -> Ladder<'a> {
        let mut library = BodyLibrary::default();
        library.in_singles = accuracy_bears_singles(options.accuracy);
        Ladder {
            options,
            library,
            spaces: Spaces::default(),
            interpolation: None,
            asker: None,
            times: LadderTimes::default(),
        }
    }

    /// For other answers, with the bodies it has met, where these are good enough.
    pub fn with_options(mut self, options: SolveOptions) -> Ladder<'a> {
        let in_singles = accuracy_bears_singles(options.accuracy);
        if in_singles != self.library.in_singles {
            self.library.forget();
            self.library.in_singles = in_singles;
        }
        Ladder { options, ..self }
    }

    /// Another one for other designs, with the spaces and fits that this one has made, and the near fields that either will make.
    pub fn twin(&self) -> Ladder<'a> {
        let library = self.library.twin();
        let (options, asker, spaces) = (self.options, self.asker, self.spaces.clone());
        let interpolation = self.interpolation.as_ref().map(Interpolation::twin);
        Ladder { options, library, spaces, interpolation, asker, times: LadderTimes::default() }
    }

    /// With bodies interpolated where there is a plan for it.
    pub fn interpolating(self, plan: Option<InterpolationPlan>) -> Ladder<'a> {
        Ladder { interpolation: plan.map(Interpolation::new), ..self }
    }

    /// With rows counted on a device for somebody who asks for nothing but what `count` gives back.
    pub fn asked_by(self, asker: Option<&'a dyn Asker>) -> Ladder<'a> {
        Ladder { asker, ..self }
    }

    /// With bodies condensed on a device as long as that lasts.
    pub fn on(self, device: Box<dyn Device + 'a>) -> Ladder<'a> {
        Ladder { library: self.library.on(device), ..self }
    }

    /// For bodies that have something in common.
    pub fn sharing(mut self, in_common: InCommon) -> Ladder<'a> {
        self.library.share(in_common);
        self
    }

    /// With all bodies that the processor condenses in double precision.
    pub fn in_double(mut self) -> Ladder<'a> {
        self.library.in_singles = false;
        self
    }

    /// Outcomes of `cases`, in their order.
    pub fn solve(&mut self, cases: &[DesignCase]) -> Vec<DesignOutcome> {
        let answers = self.answers(cases);
        cases.iter().zip(answers).map(|(case, answer)| DesignOutcome::new(case.clone(), answer)).collect()
    }

    /// Answers to `cases`, in their order.
    pub fn answers(&mut self, cases: &[DesignCase]) -> Vec<Answer> {
        self.answers_beyond(cases, |_| Want::Nothing)
    }

    /// The same where it is known of some what their first attempts leave to be wanted, by their places.
    pub fn answers_beyond(
        &mut self,
        cases: &[DesignCase],
        want: impl Fn(usize) -> Want + Sync,
    ) -> Vec<Answer> {
        let SolveOptions { method, accuracy } = self.options;
        if method == MethodChoice::ClosedForm {
            return cases.par_iter().map(closed_form).collect();
        }
        let mut answers: Vec<Option<Answer>> = vec![None; cases.len()];
        if let Some(interpolation) = &mut self.interpolation {
            answers = interpolation.solve(&mut self.library, &mut self.spaces, cases, self.asker.is_none());
        }
        let left: Vec<usize> = (0..cases.len()).filter(|index| answers[*index].is_none()).collect();
        let first = |index: &usize| {
            let cheapest = JointPlan::cheapest(&cases[*index], method, accuracy);
            (*index, cheapest.map(|plan| plan.next(want(*index)).unwrap_or(plan)))
        };
        let plans: Vec<_> = left.par_iter().with_min_len(MANY).map(first).collect();
        let mut open = Vec::with_capacity(plans.len());
        for (index, plan) in plans {
            match plan {
                Ok(plan) => open.push((index, plan)),
                Err(refusal) => answers[index] = Some(refused(&cases[index], refusal)),
            }
        }
        for (index, _, answer) in self.climb(cases, open) {
            answers[index] = Some(answer);
        }
        answers.into_iter().flatten().collect()
    }

    /// Designs by their numbers, each from a plan on, with the last plan that it came to and the answer there.
    pub fn climb(
        &mut self,
        cases: &[DesignCase],
        mut open: Vec<(usize, JointPlan)>,
    ) -> Vec<(usize, JointPlan, Answer)> {
        let mut settled = Vec::with_capacity(open.len());
        while !open.is_empty() {
            let solved = self.attempts(cases, &open);
            let mut unsettled = Vec::new();
            for ((index, plan), (answer, want)) in open.into_iter().zip(solved) {
                match plan.next(want) {
                    Some(next) => unsettled.push((index, next)),
                    None => settled.push((index, plan, answer)),
                }
            }
            open = unsettled;
        }
        settled
    }

    /// One attempt at each of some designs: those first whose joints a device solves from the numbers of their bodies on.
    fn attempts(&mut self, cases: &[DesignCase], open: &[(usize, JointPlan)]) -> Vec<(Answer, Want)> {
        if self.library.solves_joints() != SolvedJoints::All {
            return self.long_attempts(cases, open);
        }
        let Ladder { library, spaces, options, times, .. } = self;
        let mut whole = WholeJoints { library, spaces, accuracy: options.accuracy, contact: Duration::ZERO };
        let solved = whole.solve(cases, open);
        times.contact += whole.contact;
        let is_left = |(_, solved): &(_, &Option<_>)| solved.is_none();
        let left = open.iter().zip(&solved).filter(is_left).map(|(open, _)| open.clone());
        let mut others = self.long_attempts(cases, &left.collect::<Vec<_>>()).into_iter();
        solved.into_iter().filter_map(|solved| solved.or_else(|| others.next())).collect()
    }

    /// One attempt at each of some designs. A device has the bodies of up to two portions, and the joints of another, while the processor
    /// judges those of one more, or solves them.
    fn long_attempts(&mut self, cases: &[DesignCase], open: &[(usize, JointPlan)]) -> Vec<(Answer, Want)> {
        if self.library.device().is_none() || self.library.lost().is_some() {
            let bodies = self.prepare(open);
            let attempt = self.begin_attempt(cases, open, bodies);
            return self.finish_attempt(cases, attempt);
        }
        let requested: Vec<Vec<RequestKey>> = portions(open).map(requests).collect();
        self.library.keep_used(requested.iter().flatten());
        let mut ahead = requested.iter();
        let begin = |requests: &Vec<RequestKey>| self.library.begin(requests);
        let mut handles: VecDeque<Vec<BodyHandle>> = ahead.by_ref().take(IN_FLIGHT).map(begin).collect();
        let mut solved = Vec::with_capacity(open.len());
        let mut begun: Option<Attempt> = None;
        for portion in portions(open) {
            let own = handles.pop_front().unwrap_or_default();
            let bodies = self.solve_bodies(portion, |library| {
                library.finish();
                own
            });
            let attempt = self.begin_attempt(cases, portion, bodies);
            handles.extend(ahead.next().map(|requests| self.library.begin(requests)));
            let before = begun.replace(attempt);
            solved.extend(before.into_iter().flat_map(|attempt| self.finish_attempt(cases, attempt)));
        }
        solved.extend(begun.into_iter().flat_map(|attempt| self.finish_attempt(cases, attempt)));
        solved
    }

    /// Solves the bodies of plans and makes their spaces.
    pub fn prepare(&mut self, open: &[(usize, JointPlan)]) -> Vec<JointBodies> {
        let requests = requests(open);
        self.solve_bodies(open, |library| library.solve_keyed(&requests))
    }

    /// `solve` gives back the handles of the bodies, in the order in which the plans request them.
    fn solve_bodies(
        &mut self,
        open: &[(usize, JointPlan)],
        solve: impl FnOnce(&mut BodyLibrary<'a>) -> Vec<BodyHandle> + Send,
    ) -> Vec<JointBodies> {
        let Ladder { library, spaces, .. } = self;
        let make_spaces = || {
            let started = Stopwatch::start();
            spaces.make(open.iter().map(|(_, plan)| plan.space));
            started.elapsed()
        };
        let (handles, time) = rayon::join(|| solve(library), make_spaces);
        self.times.spaces += time;
        let started = Stopwatch::start();
        let mut handles = handles.into_iter();
        let bodies: Vec<JointBodies> =
            open.iter().filter_map(|(_, plan)| plan.bodies(&mut handles)).collect();
        let library = &*library;
        let in_spaces =
            open.par_iter().with_min_len(MANY).zip(&bodies).flat_map_iter(|((_, plan), bodies)| {
                bodies.all().map(|handle| (plan.space, &library.body(handle).compliance))
            });
        spaces.meet(in_spaces.fold(Needs::default, Needs::with).reduce(Needs::default, Needs::and));
        self.times.spaces += started.elapsed();
        bodies
    }

    /// Finds which designs have a joint in common, by their numbers and plans, and gives a device those that it solves.
    fn begin_attempt<'b>(
        &mut self,
        cases: &[DesignCase],
        open: &'b [(usize, JointPlan)],
        bodies: Vec<JointBodies>,
    ) -> Attempt<'b> {
        let key = |((index, plan), bodies): (&(usize, JointPlan), &JointBodies)| {
            joint_key(bodies.own, plan, &cases[*index])
        };
        let keys = open.par_iter().with_min_len(MANY).zip(&bodies).map(key);
        let alike = Alike::of(keys.collect());
        let mut attempt = Attempt { open, bodies, alike, on_device: None };
        if self.library.solves_joints() == SolvedJoints::All {
            let (library, spaces) = (&self.library, &self.spaces);
            let give = |joint: &Range<u32>, numbers: &mut Vec<f32>| {
                let SolvedPlan { plan, bodies } = attempt.plan(joint);
                let bodies = bodies.own.map(|handle| GivenBody::Solved(&library.body(handle).compliance));
                given(spaces, plan, bodies, attempt.cases(cases, joint), numbers)
            };
            let (batch, underway) = gathered(&attempt.alike.joints, JOINTS_TOGETHER, give);
            self.library.begin_joints(&batch);
            attempt.on_device = Some(underway);
        }
        attempt
    }

    /// The answers of an attempt, those first that a device has.
    fn finish_attempt(&mut self, cases: &[DesignCase], mut attempt: Attempt) -> Vec<(Answer, Want)> {
        let underway = attempt.on_device.take();
        let found = underway.and_then(|underway| Some((underway, self.library.finish_joints()?)));
        let (library, spaces, accuracy) = (&self.library, &self.spaces, self.options.accuracy);
        let (attempt, joints) = (&attempt, &attempt.alike.joints[..]);
        let judge = |joint: &Range<u32>, even: f64, found: &[f32]| {
            let started = Stopwatch::start();
            let SolvedPlan { plan, bodies } = attempt.plan(joint);
            let known = |side: usize, request| own_error(request, library.body(bodies.own[side]), true);
            let cases = attempt.cases(cases, joint);
            let judged = judged_designs(spaces, plan, known, cases, accuracy, (even, found))?;
            Some((judged, started.elapsed()))
        };
        let mut judged: Vec<Option<Timed>> = found.map_or_else(Vec::new, |(underway, found)| {
            underway.judged(joints, JOINTS_TOGETHER, &found, judge)
        });
        judged.resize_with(joints.len(), || None);
        // Of some joints the answers, in their order, and what these have taken.
        let solve =
            |room: &mut ContactRoom, (joints, judged): (&[Range<u32>], &mut [Option<Timed>])| -> Timed {
                let started = Stopwatch::start();
                let mut answers = Vec::with_capacity(joints.iter().map(Range::len).sum());
                let mut before = Duration::ZERO;
                for (joint, judged) in joints.iter().zip(judged) {
                    if let Some((own, time)) = judged.take() {
                        before += time;
                        answers.extend(own);
                        continue;
                    }
                    let (plan, own) = (attempt.plan(joint), attempt.cases(cases, joint));
                    answers.extend(solve_designs(library, spaces, plan, own, accuracy, room));
                }
                (answers, started.elapsed() + before)
            };
        let portions = joints.par_chunks(SOLVED_TOGETHER).zip(judged.par_chunks_mut(SOLVED_TOGETHER));
        let solved: Vec<Timed> = portions.map_init(ContactRoom::default, solve).collect();
        self.times.contact += solved.iter().map(|(_, time)| *time).sum::<Duration>();
        let mut in_order: Vec<Option<(Answer, Want)>> = vec![None; attempt.open.len()];
        for (place, answer) in
            attempt.alike.places.iter().zip(solved.into_iter().flat_map(|(answers, _)| answers))
        {
            in_order[*place as usize] = Some(answer);
        }
        in_order.into_iter().flatten().collect()
    }

    /// Time spent on what bodies and joints share.
    pub fn shared_time(&self) -> Duration {
        self.library.times.shared + self.times.spaces
    }

    /// Where the time went, summed over threads of the processor, in the order the stages run.
    pub fn stages(&self) -> Vec<(&'static str, Duration)> {
        let times = self.library.times;
        let mut stages = vec![("preparation", self.shared_time())];
        stages.extend(self.library.device().map(Device::stages).unwrap_or_default());
        stages.extend([
            ("series", times.series),
            ("condensation", times.condense),
            ("contact", self.times.contact),
            ("fits", self.interpolation.as_ref().map_or(Duration::ZERO, |rung| rung.fit_time)),
            ("interpolation", self.interpolation.as_ref().map_or(Duration::ZERO, |rung| rung.design_time)),
        ]);
        stages
    }
}

/// The bodies of plans, in their order.
fn requests(open: &[(usize, JointPlan)]) -> Vec<RequestKey> {
    let plans = open.par_iter().with_min_len(MANY);
    plans.flat_map_iter(|(_, plan)| plan.requests().map(Hashed::new)).collect()
}
