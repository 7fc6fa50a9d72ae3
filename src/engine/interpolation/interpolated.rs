//! Designs with interpolated bodies: each is found in its fit, and their contact is that of any two bodies.

use std::sync::Arc;
use std::time::Duration;

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::Want;
use crate::engine::accuracy::body_errors::{JudgedBody, OwnError};
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::bodies::BodyLibrary;
use crate::engine::expected_contact::ExpectedContact;
use crate::engine::interpolation::family::{FamilyKey, Point, coordinates};
use crate::engine::interpolation::fit::FittedFamily;
use crate::engine::interpolation::fit_plan::{InterpolationPlan, Member, pair};
use crate::engine::joint_contact::solve_joint;
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind, Method};
use crate::engine::question::Asker;
use crate::engine::row::Solving;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::engine::stopwatch::Stopwatch;
use crate::mechanics::compliance::body_fit::{FitScratch, NEGLIGIBLE};
use crate::mechanics::compliance::row_sums::MANY;
use crate::mechanics::contact::curve::CurveRoom;
use crate::mechanics::contact::curve_space::CurveSpace;
use crate::mechanics::contact::outlines::Outlines;
use crate::study::design::DesignCase;

/// Designs that a thread takes at a time.
const TOGETHER: usize = 16;

/// The rung: fits of a plan, made when the first designs come.
pub struct Interpolation {
    pub(super) plan: Arc<InterpolationPlan>,
    fitted: Option<Arc<HashMap<FamilyKey, FittedFamily>>>,
    /// Time spent on fits, from start to end.
    pub fit_time: Duration,
    /// Time spent on designs, summed over threads.
    pub design_time: Duration,
}

impl Interpolation {
    pub fn new(plan: InterpolationPlan) -> Interpolation {
        Interpolation {
            plan: Arc::new(plan),
            fitted: None,
            fit_time: Duration::ZERO,
            design_time: Duration::ZERO,
        }
    }

    /// With the same fits, if they are made.
    pub fn twin(&self) -> Interpolation {
        let (plan, fitted) = (self.plan.clone(), self.fitted.clone());
        Interpolation { plan, fitted, fit_time: Duration::ZERO, design_time: Duration::ZERO }
    }

    /// Fits every family of the plan, whatever designs come first.
    pub(super) fn prepare(&mut self, library: &mut BodyLibrary, spaces: &mut Spaces) {
        if self.fitted.is_some() {
            return;
        }
        let started = Stopwatch::start();
        // A fit takes the rounding of its samples for what is left of it.
        let in_singles = std::mem::replace(&mut library.in_singles, false);
        let mut fitted = HashMap::default();
        for (number, (family, budget)) in self.plan.families.iter().enumerate() {
            if let Some(mut fit) = family.fit(self.plan.accuracy, *budget, library, spaces) {
                let coarsest = SpaceKey::of_fits_of_thick_walls(family.key.half_ring, self.plan.accuracy);
                let finer = |key: SpaceKey| [Some(key), key.with_more_terms(), key.with_more_nodes()];
                fit.number = number;
                fit.prepare(coarsest.flat_map(finer).flatten(), spaces);
                fitted.insert(family.key, fit);
            }
        }
        library.in_singles = in_singles;
        self.fitted = Some(Arc::new(fitted));
        self.fit_time += started.elapsed();
    }

    /// The fits, with the ranges they hold over.
    pub fn fits(&self) -> impl Iterator<Item = &FittedFamily> {
        self.fitted.iter().flat_map(|fitted| fitted.values())
    }

    /// By their numbers.
    pub(super) fn fits_in_order(&self) -> Vec<&FittedFamily> {
        let mut fits: Vec<&FittedFamily> = self.fits().collect();
        fits.sort_by_key(|fit| fit.number);
        fits
    }

    /// Has a device begin to count the rows of designs, where one solves joints; tells of each whether the device has it.
    pub fn begin_count(
        &mut self,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        cases: &[DesignCase],
        asker: &dyn Asker,
    ) -> Option<Vec<bool>> {
        if library.solves_joints() < SolvedJoints::Interpolated {
            return None;
        }
        self.prepare(library, spaces);
        Some(self.begin_counting(library, spaces, cases, asker))
    }

    /// The answers to the designs that are known well enough; `None` for those that are left to others.
    pub fn solve(
        &mut self,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        cases: &[DesignCase],
        may_be_on_device: bool,
    ) -> Vec<Option<Answer>> {
        self.prepare(library, spaces);
        let (this, spaces) = (&*self, &*spaces);
        let mut answers = if may_be_on_device && library.solves_joints() >= SolvedJoints::Interpolated {
            this.solve_on_device(library, spaces, cases)
        } else {
            vec![None; cases.len()]
        };
        let solve = |room: &mut Room, (cases, answers): (&[DesignCase], &mut [Option<Answer>])| {
            let started = Stopwatch::start();
            this.solve_some(spaces, cases, answers, room);
            started.elapsed()
        };
        let together = cases.par_chunks(TOGETHER).zip(answers.par_chunks_mut(TOGETHER));
        self.design_time += together.map_init(Default::default, solve).sum::<Duration>();
        answers
    }

    /// A design as its fits have it; `None` where it has none.
    pub(super) fn meet(&self, case: &DesignCase) -> Option<MetJoint<'_>> {
        let InterpolationPlan { accuracy, pairs, .. } = &*self.plan;
        let members = pair(&case.joint)?;
        let [pin, plate] = &members;
        let families = pairs.contains(&(pin.key, plate.key)).then_some(self.fitted.as_ref()?)?;
        let fits = [families.get(&pin.key)?, families.get(&plate.key)?];
        let points = [coordinates(&pin.body), coordinates(&plate.body)];
        let expected = ExpectedContact::of(case).half_angle;
        let key = SpaceKey::of_fits(&pin.body, &plate.body, *accuracy, expected);
        Some(MetJoint { members, fits, points, outlines: JointScale::of(&case.joint).outlines, key })
    }

    /// With what has computed it.
    pub(super) fn solving(&self, backend: BackendKind, space: &CurveSpace) -> Solving {
        let (method, accuracy) = (Method::Interpolated, self.plan.accuracy);
        Solving { backend, method, limit_of_pin: space.limit, accuracy }
    }

    /// The answers to those of some designs that have none yet and are known well enough.
    fn solve_some(
        &self,
        spaces: &Spaces,
        cases: &[DesignCase],
        answers: &mut [Option<Answer>],
        Room { bodies, curve }: &mut Room,
    ) {
        let without = cases.iter().zip(&*answers).enumerate().filter(|(_, (_, answer))| answer.is_none());
        let met = without.filter_map(|(place, (case, _))| Some((place, self.meet(case)?)));
        let mut open: Vec<(usize, MetJoint)> = met.filter(|(_, met)| met.is_in_boxes()).collect();
        while let Some(first) = open.pop() {
            let mut alike = vec![first];
            for place in (0..open.len()).rev() {
                if alike.len() < MANY && open[place].1.has_rows_of(&alike[0].1) {
                    alike.push(open.swap_remove(place));
                }
            }
            if sum_rows(&alike, bodies).is_none() {
                continue;
            }
            for ((place, mut met), scratch) in alike.into_iter().zip(&mut *bodies) {
                let Some((answer, want)) = self.solve_summed(spaces, &cases[place], &met, scratch, curve)
                else {
                    continue;
                };
                let next = match want {
                    Want::Nothing => {
                        answers[place] = whole(answer);
                        None
                    }
                    Want::MoreTerms => met.key.with_more_terms(),
                    Want::MoreNodes => met.key.with_more_nodes(),
                    Want::FinerMesh => None,
                };
                if let Some(key) = next {
                    met.key = key;
                    open.push((place, met));
                }
            }
        }
    }

    /// The answer to a design whose bodies' rows are summed, and what it wants.
    fn solve_summed(
        &self,
        spaces: &Spaces,
        case: &DesignCase,
        MetJoint { members, fits, points, outlines, key }: &MetJoint,
        [of_pin, of_plate]: &mut [FitScratch; 2],
        room: &mut CurveRoom,
    ) -> Option<(Answer, Want)> {
        let space = spaces.get(*key);
        let judged = |side: usize, scratch| {
            let Member { body, share, .. } = &members[side];
            let own = OwnError::Fit(fits[side].error(body, &points[side]));
            let part = fits[side].part((body, *share), outlines, space, scratch);
            JudgedBody { body, own, change: None, part }
        };
        let judged = [judged(0, of_pin), judged(1, of_plate)];
        let solving = self.solving(BackendKind::Cpu, space);
        solve_joint(space, &judged, *outlines, None, solving, [case].into_iter(), room).pop()
    }
}

/// Sums the rows of the bodies of joints that have them in common, each joint's in its own scratch; `None` where they were not made.
fn sum_rows(alike: &[(usize, MetJoint)], bodies: &mut [[FitScratch; 2]; MANY]) -> Option<()> {
    let MetJoint { fits, key, .. } = alike.first()?.1;
    let rows = [fits[0].rows(key)?, fits[1].rows(key)?];
    for (side, (fit, rows)) in fits.into_iter().zip(rows).enumerate() {
        let joints = || alike.iter().map(|(_, met)| (met, &met.members[side]));
        let begin = |((met, member), scratch): ((&MetJoint, &Member), _)| {
            fit.begin((&member.body, &met.points[side]), scratch)
        };
        let mut begun: Vec<_> =
            joints().zip(bodies.iter_mut().map(|own| &mut own[side])).map(begin).collect();
        fit.fit.coefficients().sums(0.0, &mut begun);
        let weigh = |((met, member), scratch): ((&MetJoint, &Member), _)| {
            fit.weigh((&member.body, member.share), &met.outlines, scratch)
        };
        let mut weighed: Vec<_> =
            joints().zip(bodies.iter_mut().map(|own| &mut own[side])).map(weigh).collect();
        rows.sums(NEGLIGIBLE, &mut weighed);
    }
    Some(())
}

/// What a thread works with.
#[derive(Default)]
struct Room {
    /// Of the bodies of joints whose rows are summed abreast.
    bodies: [[FitScratch; 2]; MANY],
    curve: CurveRoom,
}

/// A design as its fits have it.
pub(super) struct MetJoint<'a> {
    pub members: [Member; 2],
    pub fits: [&'a FittedFamily; 2],
    pub points: [Point; 2],
    pub outlines: Outlines,
    pub key: SpaceKey,
}

impl MetJoint<'_> {
    /// Whether both bodies are in the boxes of their fits.
    fn is_in_boxes(&self) -> bool {
        let is_in = |side: usize| self.fits[side].contains(&self.members[side].body, &self.points[side]);
        is_in(0) && is_in(1)
    }

    /// Whether both bodies are sums of the same rows as those of another joint.
    fn has_rows_of(&self, other: &MetJoint) -> bool {
        let numbers = |met: &MetJoint| met.fits.map(|fit| fit.number);
        self.key == other.key && numbers(self) == numbers(other)
    }
}

/// An answer with a state for every load.
pub(super) fn whole(answer: Answer) -> Option<Answer> {
    let is_whole = answer.steps.iter().all(|step| step.response.is_some());
    is_whole.then_some(answer)
}
