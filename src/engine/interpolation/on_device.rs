//! Designs with interpolated bodies on a device that solves their contact: the processor finds their fits before, and judges the
//! states after. What the device has no kernel for, and what is not good enough, is left to the processor.

use crate::engine::accuracy::Want;
use crate::engine::accuracy::body_errors::OwnError;
use crate::engine::accuracy::single_precision::OF_CONTACT_IN_SINGLES;
use crate::engine::backend::joints::{AskedOfJoints, BodyTables, DeviceJoint, JointTables, states};
use crate::engine::bodies::BodyLibrary;
use crate::engine::device_joints::{Given, errors_of_bodies, gathered};
use crate::engine::interpolation::interpolated::{Interpolation, MetJoint, whole};
use crate::engine::joint_contact::judged;
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind};
use crate::engine::question::Asker;
use crate::engine::question::tables::{BoundPlaces, Standing};
use crate::engine::spaces::Spaces;
use crate::study::design::DesignCase;

/// Designs that a thread takes at a time.
const TOGETHER: usize = 64;

/// What is kept of a design that the device has: where it lies in its fits, and `even` of its compliance.
type Kept<'a> = (MetJoint<'a>, f64);

impl Interpolation {
    /// The answers that the device has; `None` for the other designs.
    pub(super) fn solve_on_device(
        &self,
        library: &mut BodyLibrary,
        spaces: &Spaces,
        cases: &[DesignCase],
    ) -> Vec<Option<Answer>> {
        let give = |case: &DesignCase, numbers: &mut Vec<f32>| self.given(spaces, case, numbers);
        let (batch, underway) = gathered(cases, TOGETHER, give);
        library.begin_joints(&batch);
        let Some(found) = library.finish_joints() else { return vec![None; cases.len()] };
        let judge = |case: &DesignCase, kept: Kept, found: &[f32]| self.judge(spaces, case, &kept, found);
        underway.judged(cases, TOGETHER, &found, judge)
    }

    /// Has the device count the rows of designs that it can solve; tells of each whether it has it.
    pub(super) fn begin_counting(
        &self,
        library: &mut BodyLibrary,
        spaces: &Spaces,
        cases: &[DesignCase],
        asker: &dyn Asker,
    ) -> Vec<bool> {
        let question = asker.question();
        let standing = Standing::new(question, asker.limits());
        let mut tables = standing.tables();
        let mut bounds_at = vec![0; self.plan.families.len()];
        for fit in self.fits_in_order() {
            bounds_at[fit.number] = tables.len();
            tables.extend(fit.bound.table().map(|number| number as f32));
        }
        let give = |case: &DesignCase, numbers: &mut Vec<f32>| {
            let given = self.given(spaces, case, numbers)?;
            let (MetJoint { members, fits, points, .. }, even) = &given.kept;
            let bound = |side: usize| {
                let (kind, of_mesh) = fits[side].error(&members[side].body, &points[side]).places()?;
                Some(BoundPlaces { of_fit: bounds_at[fits[side].number], kind, of_mesh })
            };
            let bounds = [bound(0)?, bound(1)?];
            let is_for_device = standing.push_design(case, *even, bounds, numbers);
            // No state comes back that would have to be judged.
            is_for_device.then(|| given.keeping(()))
        };
        let (mut batch, underway) = gathered(cases, TOGETHER, give);
        batch.asked = Some(AskedOfJoints { question, tables, ranges: standing.ranges() });
        library.begin_joints(&batch);
        underway.are_there().collect()
    }

    /// A design as the device is given it; `None` where it has no kernel for it.
    fn given<'a>(
        &'a self,
        spaces: &'a Spaces,
        case: &DesignCase,
        numbers: &mut Vec<f32>,
    ) -> Option<Given<'a, Kept<'a>>> {
        let met = self.meet(case)?;
        let MetJoint { members, fits, points, outlines, key } = &met;
        let of_fit =
            |side: usize| Some(BodyTables::Fit(fits[side].number, &fits[side].fit, fits[side].rows(*key)?));
        let tables = JointTables { bodies: [of_fit(0)?, of_fit(1)?], space: (*key, spaces.get(*key)) };
        if !tables.are_for_devices(outlines) {
            return None;
        }
        let body =
            |side: usize| fits[side].on_device((&members[side].body, &points[side], members[side].share));
        let joint = DeviceJoint { bodies: [body(0)?, body(1)?], outlines: *outlines };
        let loads = JointScale::of(&case.joint).loads_in_contact(&case.steps);
        let [load_count, amplitude_count] = joint.numbers(loads, numbers)?;
        let even = joint.even();
        Some(Given { tables, load_count, amplitude_count, condensed: [None; 2], kept: (met, even) })
    }

    /// The answer from what a device has found, if that is good enough.
    fn judge(&self, spaces: &Spaces, case: &DesignCase, (met, even): &Kept, found: &[f32]) -> Option<Answer> {
        let MetJoint { members, fits, points, outlines, key } = met;
        let error = |side: usize| OwnError::Fit(fits[side].error(&members[side].body, &points[side]));
        let errors = [error(0), error(1)];
        let (of_curve, states) = states(found, *even, outlines)?;
        let states = states.map(|found| Ok((found.state, errors_of_bodies(&errors, &found))));
        let solving = self.solving(BackendKind::Gpu, spaces.get(*key));
        let (answer, want) = judged(case, outlines, solving, of_curve + OF_CONTACT_IN_SINGLES, states);
        (want == Want::Nothing).then(|| whole(answer)).flatten()
    }
}
