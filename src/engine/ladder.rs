//! The climb from cheap to dear: every design is answered by the cheapest rung that is foreseen to do, judged, and answered again
//! on the next one until it is good enough or there is no more. Rungs are bodies interpolated between others, then plans of
//! ever finer meshes and pressure spaces; whatever condenses the bodies.

use std::time::Duration;

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::Want;
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::backend::{Device, IN_FLIGHT};
use crate::engine::bodies::{BodyLibrary, MANY};
use crate::engine::body_request::BodyRequest;
use crate::engine::contact_on_device::{given, judged_designs};
use crate::engine::device_joints::{Underway, gathered};
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::interpolation::interpolated::Interpolation;
use crate::engine::joint_contact::{JointKey, joint_key, solve_designs};
use crate::engine::outcome::{Answer, DesignOutcome};
use crate::engine::plan::JointPlan;
use crate::engine::question::Asker;
use crate::engine::question::counted::{Counted, Verdict};
use crate::engine::row::{closed_form, refused};
use crate::engine::spaces::Spaces;
use crate::engine::stopwatch::Stopwatch;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

/// Designs of one joint that a thread solves.
const TOGETHER: usize = 64;

/// Designs tried together go to a device in so many portions, none smaller than `FEWEST` but the last: each keeps a large device busy.
const PORTIONS: usize = 4;
const FEWEST: usize = 1024;

/// An attempt, with the place of its design among those tried together.
type Placed = (usize, (Answer, Want));

/// The answers to the designs of a joint, and what they have taken.
type Timed = (Vec<(Answer, Want)>, Duration);

/// Designs whose bodies are solved, on their way to an attempt.
struct Attempt<'a> {
    open: &'a [(usize, JointPlan)],
    /// Those with a joint in common, by their places: no more to a joint than a thread solves.
    joints: Vec<Vec<usize>>,
    /// Of each joint what is kept while a device has it, where one solves joints.
    on_device: Option<Underway<f64>>,
}

/// Designs whose rows a device counts.
pub struct Counting {
    cases: Vec<DesignCase>,
    /// Of each whether the device has it.
    are_there: Vec<bool>,
}

/// Joints that a thread takes at a time.
const JOINTS_TOGETHER: usize = 16;

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
        Ladder {
            options,
            library: BodyLibrary::default(),
            spaces: Spaces::default(),
            interpolation: None,
            asker: None,
            times: LadderTimes::default(),
        }
    }

    /// For other answers, with the bodies it has met.
    pub fn with_options(self, options: SolveOptions) -> Ladder<'a> {
        Ladder { options, ..self }
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
        Ladder { library: BodyLibrary::on(device), ..self }
    }

    /// Outcomes of `cases`, in their order.
    pub fn solve(&mut self, cases: &[DesignCase]) -> Vec<DesignOutcome> {
        let answers = self.answers(cases);
        cases.iter().zip(answers).map(|(case, answer)| DesignOutcome::new(case.clone(), answer)).collect()
    }

    /// Has a device begin to count the rows of `cases` for who asks; nothing where nobody does, or no device counts.
    pub fn begin_count(&mut self, cases: Vec<DesignCase>) -> Result<Counting, Vec<DesignCase>> {
        let Ladder { interpolation, library, spaces, asker, .. } = self;
        let (Some(interpolation), Some(asker)) = (interpolation, *asker) else { return Err(cases) };
        match interpolation.begin_count(library, spaces, &cases, asker) {
            Some(are_there) => Ok(Counting { cases, are_there }),
            None => Err(cases),
        }
    }

    /// What is counted of the designs that were begun before all others, and those of them that something is left to do of: all where the
    /// device is lost.
    pub fn finish_count(
        &mut self,
        Counting { cases, are_there }: Counting,
    ) -> Option<(Counted, Vec<(DesignCase, Verdict)>)> {
        let question = self.asker?.question();
        let (mut counted, mut verdicts) = (Counted::none(question), Vec::with_capacity(cases.len()));
        for told in self.library.finish_answers().unwrap_or_default() {
            let (more, own) = question.read(&told);
            counted.merge(&more);
            verdicts.extend(own);
        }
        let mut verdicts = verdicts.into_iter();
        let verdict = |is_there: bool| is_there.then(|| verdicts.next()).flatten().unwrap_or(Verdict::Open);
        let verdicts: Vec<Verdict> = are_there.into_iter().map(verdict).collect();
        let all = cases.into_par_iter().zip(verdicts).with_min_len(MANY);
        Some((counted, all.filter(|(_, verdict)| *verdict != Verdict::Counted).collect()))
    }

    /// Answers to `cases`, in their order.
    pub fn answers(&mut self, cases: &[DesignCase]) -> Vec<Answer> {
        let SolveOptions { method, accuracy } = self.options;
        if method == MethodChoice::ClosedForm {
            return cases.par_iter().map(closed_form).collect();
        }
        let mut answers: Vec<Option<Answer>> = vec![None; cases.len()];
        if let Some(interpolation) = &mut self.interpolation {
            answers = interpolation.solve(&mut self.library, &mut self.spaces, cases, self.asker.is_none());
        }
        let left: Vec<usize> = (0..cases.len()).filter(|index| answers[*index].is_none()).collect();
        let cheapest = |index: &usize| (*index, JointPlan::cheapest(&cases[*index], method, accuracy));
        let plans: Vec<_> = left.par_iter().with_min_len(MANY).map(cheapest).collect();
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

    /// One attempt at each of some designs. A device has the bodies of up to two portions, and the joints of another, while the processor
    /// judges those of one more, or solves them.
    fn attempts(&mut self, cases: &[DesignCase], open: &[(usize, JointPlan)]) -> Vec<(Answer, Want)> {
        if self.library.device().is_none() || self.library.lost().is_some() {
            self.prepare(open);
            let attempt = self.begin_attempt(cases, open);
            return self.finish_attempt(cases, attempt);
        }
        self.library.keep_used(&requests(open));
        let portion = open.len().div_ceil(PORTIONS).max(FEWEST);
        let mut ahead = open.chunks(portion);
        ahead.by_ref().take(IN_FLIGHT).for_each(|portion| self.library.begin(&requests(portion)));
        let mut solved = Vec::with_capacity(open.len());
        let mut begun: Option<Attempt> = None;
        for portion in open.chunks(portion) {
            self.solve_bodies(portion, BodyLibrary::finish);
            let attempt = self.begin_attempt(cases, portion);
            ahead.next().into_iter().for_each(|portion| self.library.begin(&requests(portion)));
            let before = begun.replace(attempt);
            solved.extend(before.into_iter().flat_map(|attempt| self.finish_attempt(cases, attempt)));
        }
        solved.extend(begun.into_iter().flat_map(|attempt| self.finish_attempt(cases, attempt)));
        solved
    }

    /// Solves the bodies of plans and makes their spaces.
    pub fn prepare(&mut self, open: &[(usize, JointPlan)]) {
        self.solve_bodies(open, |library| library.solve(&requests(open)));
    }

    fn solve_bodies(&mut self, open: &[(usize, JointPlan)], solve: impl FnOnce(&mut BodyLibrary<'a>) + Send) {
        let Ladder { library, spaces, .. } = self;
        let make_spaces = || {
            let started = Stopwatch::start();
            spaces.make(open.iter().map(|(_, plan)| plan.space));
            started.elapsed()
        };
        let ((), time) = rayon::join(|| solve(library), make_spaces);
        self.times.spaces += time;
        let started = Stopwatch::start();
        let in_space = |(_, plan): &(usize, JointPlan)| {
            let solved = |request| (plan.space, &*library.solved(&request).compliance);
            plan.requests().map(solved).collect::<Vec<_>>()
        };
        let bodies: Vec<_> = open.par_iter().with_min_len(MANY).flat_map_iter(in_space).collect();
        spaces.prepare(bodies.into_iter());
        self.times.spaces += started.elapsed();
    }

    /// Finds which designs have a joint in common, by their numbers and plans, and gives a device those that it solves.
    fn begin_attempt<'b>(&mut self, cases: &[DesignCase], open: &'b [(usize, JointPlan)]) -> Attempt<'b> {
        let mut joints: HashMap<JointKey, Vec<usize>> = HashMap::default();
        let key = |(index, plan): &(usize, JointPlan)| joint_key(plan, &cases[*index]);
        let keys: Vec<JointKey> = open.par_iter().with_min_len(MANY).map(key).collect();
        for (place, key) in keys.into_iter().enumerate() {
            joints.entry(key).or_default().push(place);
        }
        let (few, many): (Vec<_>, Vec<_>) = joints.into_values().partition(|places| places.len() <= TOGETHER);
        let mut joints: Vec<Vec<usize>> = few;
        joints.extend(many.iter().flat_map(|places| places.chunks(TOGETHER).map(<[usize]>::to_vec)));
        if self.library.solves_joints() < SolvedJoints::All {
            return Attempt { open, joints, on_device: None };
        }
        let (library, spaces) = (&self.library, &self.spaces);
        let give = |places: &Vec<usize>, numbers: &mut Vec<f32>| {
            given(library, spaces, &open[places[0]].1, cases_of(cases, open, places), numbers)
        };
        let (batch, underway) = gathered(&joints, JOINTS_TOGETHER, give);
        self.library.begin_joints(&batch);
        Attempt { open, joints, on_device: Some(underway) }
    }

    /// The answers of an attempt, those first that a device has.
    fn finish_attempt(
        &mut self,
        cases: &[DesignCase],
        Attempt { open, joints, on_device }: Attempt,
    ) -> Vec<(Answer, Want)> {
        let found = on_device.and_then(|underway| Some((underway, self.library.finish_joints()?)));
        let (library, spaces, accuracy) = (&self.library, &self.spaces, self.options.accuracy);
        let judge = |places: &Vec<usize>, even: f64, found: &[f32]| {
            let (started, own) = (Stopwatch::start(), cases_of(cases, open, places));
            let found = (even, found);
            let judged = judged_designs(library, spaces, &open[places[0]].1, own, accuracy, found)?;
            Some((judged, started.elapsed()))
        };
        let judged = found.map_or(vec![None; joints.len()], |(underway, found)| {
            underway.judged(&joints, JOINTS_TOGETHER, &found, judge)
        });
        let solve = |(places, judged): (&Vec<usize>, Option<Timed>)| {
            let (solved, time) = judged.unwrap_or_else(|| {
                let (started, own) = (Stopwatch::start(), cases_of(cases, open, places));
                let solved = solve_designs(library, spaces, &open[places[0]].1, own, accuracy);
                (solved, started.elapsed())
            });
            let placed: Vec<Placed> = places.iter().copied().zip(solved).collect();
            (placed, time)
        };
        let solved: Vec<_> = joints.par_iter().with_min_len(4).zip(judged).map(solve).collect();
        self.times.contact += solved.iter().map(|(_, time)| *time).sum::<Duration>();
        let mut in_order: Vec<Option<(Answer, Want)>> = vec![None; open.len()];
        for (place, solved) in solved.into_iter().flat_map(|(solved, _)| solved) {
            in_order[place] = Some(solved);
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

/// The designs at some places.
fn cases_of<'a>(
    cases: &'a [DesignCase],
    open: &'a [(usize, JointPlan)],
    places: &'a [usize],
) -> impl Iterator<Item = &'a DesignCase> + Clone {
    places.iter().map(|place| &cases[open[*place].0])
}

/// The bodies of plans.
fn requests(open: &[(usize, JointPlan)]) -> Vec<BodyRequest> {
    open.iter().flat_map(|(_, plan)| plan.requests()).collect()
}
