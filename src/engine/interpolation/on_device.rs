//! Designs with interpolated bodies on a device that solves their contact: the processor finds their fits before, and judges the
//! states after. What the device has no kernel for, and what is not good enough, is left to the processor.

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::Want;
use crate::engine::backend::joints::{
    InterpolatedJoint, JointGroup, JointStates, JointTablesKey, MOST_LOADS, has_room,
};
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::fit::NARROW;
use crate::engine::interpolation::interpolated::{Interpolation, MetJoint, whole};
use crate::engine::joint_contact::judged;
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind};
use crate::engine::spaces::Spaces;
use crate::mechanics::compliance::row_sums::Rows;
use crate::study::design::DesignCase;

/// Designs that a thread takes at a time.
const TOGETHER: usize = 64;

/// Joints with these in common go together: tables, and how many loads have contact.
type GroupKey = (JointTablesKey, usize);

/// A design as the device is given it.
struct Given<'a> {
    key: GroupKey,
    met: MetJoint<'a>,
    rows: [&'a Rows; 2],
    joint: InterpolatedJoint,
}

impl Interpolation {
    /// The answers that the device has; `None` for the other designs.
    pub(super) fn solve_on_device(
        &self,
        library: &mut BodyLibrary,
        spaces: &Spaces,
        cases: &[DesignCase],
    ) -> Vec<Option<Answer>> {
        let given: Vec<Option<Given>> =
            cases.par_iter().with_min_len(TOGETHER).map(|case| self.given(case)).collect();
        let mut groups: HashMap<GroupKey, JointGroup> = HashMap::default();
        let mut met: Vec<Option<(GroupKey, MetJoint)>> = Vec::with_capacity(cases.len());
        for given in given {
            met.push(given.map(|Given { key, met, rows: [of_pin, of_plate], joint }| {
                let (tables, load_count) = key;
                let group = || JointGroup {
                    key: tables,
                    fits: [(&met.fits[0].fit, of_pin), (&met.fits[1].fit, of_plate)],
                    space: spaces.get(met.key),
                    load_count,
                    joints: Vec::new(),
                };
                groups.entry(key).or_insert_with(group).joints.push(joint);
                (key, met)
            }));
        }
        let (keys, groups): (Vec<GroupKey>, Vec<JointGroup>) = groups.into_iter().unzip();
        let Some(states) = library.solve_joints(&groups) else { return vec![None; cases.len()] };
        let mut states: HashMap<GroupKey, _> =
            keys.into_iter().zip(states.into_iter().map(Vec::into_iter)).collect();
        // In the order of the designs, as the groups have them.
        let found: Vec<Option<(MetJoint, JointStates)>> = met
            .into_iter()
            .map(|met| {
                let (key, met) = met?;
                Some((met, states.get_mut(&key)?.next()??))
            })
            .collect();
        let answer = |(case, found): (&DesignCase, Option<(MetJoint, JointStates)>)| {
            let (met, states) = found?;
            self.judge(spaces, case, &met, &states)
        };
        cases.par_iter().with_min_len(TOGETHER).zip(found).map(answer).collect()
    }

    /// A design as the device is given it; `None` where it has no kernel for it.
    fn given(&self, case: &DesignCase) -> Option<Given<'_>> {
        let met = self.meet(case)?;
        let MetJoint { members, fits, points, outlines, key } = &met;
        let [of_pin, of_plate] = [fits[0].rows(*key)?, fits[1].rows(*key)?];
        if outlines.radial_clearance > NARROW
            || !has_room(*key, [(&fits[0].fit, of_pin), (&fits[1].fit, of_plate)])
        {
            return None;
        }
        let body =
            |side: usize| fits[side].on_device((&members[side].body, &points[side], members[side].share));
        let loads: Vec<_> = JointScale::of(&case.joint).loads_in_contact(&case.steps).collect();
        let key = ((fits[0].number, fits[1].number, *key), loads.len());
        let joint = InterpolatedJoint { bodies: [body(0)?, body(1)?], outlines: *outlines, loads };
        let has_loads = (1..=MOST_LOADS).contains(&joint.loads.len());
        has_loads.then_some(Given { key, met, rows: [of_pin, of_plate], joint })
    }

    /// The answer from what a device has found, if that is good enough.
    fn judge(
        &self,
        spaces: &Spaces,
        case: &DesignCase,
        met: &MetJoint,
        found: &JointStates,
    ) -> Option<Answer> {
        let MetJoint { members, fits, points, outlines, key } = met;
        let bound = |side: usize| fits[side].error(&members[side].body, &points[side]);
        let bounds = [bound(0), bound(1)];
        let states = found.states.iter().map(|found| {
            let [above, below] = found.of_pin;
            let shares = [above.max(below), 1.0 - above.min(below)];
            let of_bodies = bounds.iter().zip(shares);
            let of_bodies = of_bodies.map(|(bound, share)| share * bound.at(found.state.half_angle)).sum();
            Ok((found.state, [of_bodies, 0.0]))
        });
        let solving = self.solving(BackendKind::Gpu, outlines, spaces.get(*key));
        let (answer, want) = judged(case, outlines, solving, found.of_curve, states);
        (want == Want::Nothing).then(|| whole(answer)).flatten()
    }
}
