//! Designs whose rows a device counts for who asks nothing but what all rows come to: begun on it, and what it leaves.

use std::ops::Range;
use std::time::Duration;

use rayon::prelude::*;

use super::Ladder;
use crate::engine::backend::joints::SolvedJoints;
use crate::engine::body_portions::MANY;
use crate::engine::interpolation::drawn_on_device::Drawing;
use crate::engine::plan::JointPlan;
use crate::engine::question::Asker;
use crate::engine::question::counted::{Counted, Verdict};
use crate::engine::whole_joints::WholeJoints;
use crate::error::Error;
use crate::study::config::{MethodChoice, SolveOptions, Study};
use crate::study::design::DesignCase;

/// Designs whose rows a device counts.
pub enum Counting {
    /// With, of each, whether the device has it, and in how many batches.
    Given { cases: Vec<DesignCase>, are_there: Vec<bool>, batches: usize },
    /// By their numbers.
    Drawn(Range<u64>),
}

/// What is counted, and designs that something is left to do of.
pub type Finished = (Counted, Vec<(DesignCase, Verdict)>);

/// Designs of a study by their numbers, which ascend: those that no device draws, or has left.
pub fn drawn_here(study: &Study, numbers: &[u64]) -> Result<Vec<DesignCase>, Error> {
    let draw = |numbers: &[u64]| study.cases_at(numbers.iter().copied())?.collect::<Result<Vec<_>, _>>();
    let drawn: Vec<_> = numbers.par_chunks(MANY).map(draw).collect::<Result<_, Error>>()?;
    Ok(drawn.into_iter().flatten().collect())
}

impl Ladder<'_> {
    /// Has a device begin to count the rows of `cases` for who asks; nothing where nobody does, or no device counts.
    pub fn begin_count(&mut self, cases: Vec<DesignCase>) -> Result<Counting, Vec<DesignCase>> {
        let Some(asker) = self.asker else { return Err(cases) };
        let begun = match &mut self.interpolation {
            Some(interpolation) => interpolation
                .begin_count(&mut self.library, &mut self.spaces, &cases, asker)
                .map(|are_there| (are_there, 1)),
            None => self.begin_count_whole(&cases, asker),
        };
        match begun {
            Some((are_there, batches)) => Ok(Counting::Given { cases, are_there, batches }),
            None => Err(cases),
        }
    }

    /// The same of designs whose bodies a device condenses for it: tells of each whether the device has it, and in how many batches they come.
    fn begin_count_whole(&mut self, cases: &[DesignCase], asker: &dyn Asker) -> Option<(Vec<bool>, usize)> {
        let Ladder { library, spaces, options: SolveOptions { method, accuracy }, .. } = self;
        if library.solves_joints() < SolvedJoints::All || *method == MethodChoice::ClosedForm {
            return None;
        }
        let cheapest = |case| JointPlan::cheapest(case, *method, *accuracy).ok();
        let plans = cases.par_iter().with_min_len(MANY).map(cheapest);
        let plans: Vec<Option<JointPlan>> = plans.collect();
        let mut whole = WholeJoints { library, spaces, accuracy: *accuracy, contact: Duration::ZERO };
        let (are_there, batches) = whole.begin_count(cases, &plans, asker);
        (batches > 0).then_some((are_there, batches))
    }

    /// Has a device draw the designs of these numbers and count their rows; nothing where none can.
    pub fn begin_drawn(&mut self, drawing: &Drawing, numbers: Range<u64>) -> Option<Counting> {
        let Ladder { interpolation, library, spaces, asker, .. } = self;
        let (interpolation, asker) = (interpolation.as_mut()?, (*asker)?);
        let designs = u32::try_from(numbers.start).ok()?..u32::try_from(numbers.end).ok()?;
        let is_begun = interpolation.begin_drawn(library, spaces, drawing, asker, designs);
        is_begun.then_some(Counting::Drawn(numbers))
    }

    /// What is counted of the designs of a study that were begun before all others, and those of them that something is left to do of: all
    /// where the device is lost.
    pub fn finish_count(&mut self, study: &Study, counting: Counting) -> Option<Result<Finished, Error>> {
        let question = self.asker?.question();
        let batches = match &counting {
            Counting::Given { batches, .. } => *batches,
            Counting::Drawn(_) => 1,
        };
        let (mut counted, mut verdicts) = (Counted::none(question), Vec::new());
        for told in (0..batches).flat_map(|_| self.library.finish_answers()).flatten() {
            let (more, own) = question.read(&told);
            counted.merge(&more);
            verdicts.extend(own);
        }
        let mut verdicts = verdicts.into_iter();
        let mut verdict =
            |is_there: bool| is_there.then(|| verdicts.next()).flatten().unwrap_or(Verdict::Open);
        let left = match counting {
            Counting::Given { cases, are_there, .. } => {
                let verdicts: Vec<Verdict> = are_there.into_iter().map(verdict).collect();
                let all = cases.into_par_iter().zip(verdicts).with_min_len(MANY);
                Ok(all.filter(|(_, verdict)| *verdict != Verdict::Counted).collect())
            }
            Counting::Drawn(numbers) => {
                let all = numbers.map(|number| (number, verdict(true)));
                let left = all.filter(|(_, verdict)| *verdict != Verdict::Counted);
                let (numbers, verdicts): (Vec<u64>, Vec<Verdict>) = left.unzip();
                drawn_here(study, &numbers).map(|cases| cases.into_iter().zip(verdicts).collect())
            }
        };
        Some(left.map(|left| (counted, left)))
    }
}
