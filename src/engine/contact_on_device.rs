//! The contact of bodies on meshes on a device: the processor makes the numbers of joints and judges their states. What the device has no
//! kernel for, and what is not good enough, is left to the processor.

use crate::engine::accuracy::{Estimate, Want};
use crate::engine::backend::joints::{Amplitudes, BodyTables, DeviceBody, DeviceJoint, JointTables, states};
use crate::engine::bodies::BodyLibrary;
use crate::engine::device_joints::{Given, errors_of_bodies};
use crate::engine::joint_contact::{SolvedPlan, judged, own_error};
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind};
use crate::engine::row::Solving;
use crate::engine::spaces::Spaces;
use crate::mechanics::contact::compliance_rows::ModeMembers;
use crate::study::design::DesignCase;

/// The joint of some designs of one `JointKey`, whose bodies and space were prepared, with `even` of its compliance; nothing where a device
/// has no kernel for it. Layers, press fits, and meshes that are told by coarser ones are the processor's.
pub fn given<'a, 'b>(
    library: &BodyLibrary,
    spaces: &'a Spaces,
    SolvedPlan { plan, bodies }: SolvedPlan,
    cases: impl Iterator<Item = &'b DesignCase> + Clone,
    numbers: &mut Vec<f32>,
) -> Option<Given<'a, f64>> {
    let joint = &cases.clone().next()?.joint;
    let outlines = JointScale::of(joint).outlines;
    let parts = [(&plan.pin, &joint.pin), (&plan.plate, &joint.plate)];
    if plan.estimate != Estimate::Known || parts.iter().any(|(request, _)| !request.body.lining.is_empty()) {
        return None;
    }
    let solved = bodies.own.map(|handle| &library.body(handle).compliance);
    let members = |side: usize| ModeMembers::of(parts[side].0.body.shape.side, solved[side]);
    let members = [members(0)?, members(1)?];
    let space = (plan.space, spaces.get(plan.space));
    let tables = JointTables { bodies: members.map(BodyTables::Modes), space };
    if !tables.are_for_devices(&outlines) {
        return None;
    }
    let body = |side: usize| DeviceBody {
        infinite: [solved[side].even, solved[side].odd],
        share: 1.0 / parts[side].1.contact_material().youngs_modulus,
        amplitudes: Amplitudes::Modes(members[side], solved[side]),
    };
    let joint = DeviceJoint { bodies: [body(0), body(1)], outlines };
    let loads = cases.flat_map(|case| JointScale::of(&case.joint).loads_in_contact(&case.steps));
    let load_count = joint.numbers(loads, numbers)?;
    Some(Given { tables, load_count, kept: joint.even() })
}

/// The answers to the designs of a joint that was given, from what a device has found, if all of them are good enough.
pub fn judged_designs<'a>(
    library: &BodyLibrary,
    spaces: &Spaces,
    SolvedPlan { plan, bodies }: SolvedPlan,
    cases: impl Iterator<Item = &'a DesignCase> + Clone,
    accuracy: f64,
    (even, found): (f64, &[f32]),
) -> Option<Vec<(Answer, Want)>> {
    let outlines = JointScale::of(&cases.clone().next()?.joint).outlines;
    let (of_curve, mut states) = states(found, even, &outlines)?;
    let errors = [0, 1].map(|side| {
        let request = [&plan.pin, &plan.plate][side];
        own_error(request, library.body(bodies.own[side]), true)
    });
    let limit = outlines.of_hole(spaces.get(plan.space).limit);
    let solving = Solving { backend: BackendKind::Gpu, method: plan.method(), limit, accuracy };
    let answer = |case: &DesignCase| {
        let count = JointScale::of(&case.joint).loads_in_contact(&case.steps).count();
        let own = states.by_ref().take(count);
        let own = own.map(|found| Ok((found.state, errors_of_bodies(&errors, &found))));
        let (answer, want) = judged(case, &outlines, solving, of_curve, own);
        (want == Want::Nothing).then_some((answer, want))
    };
    cases.map(answer).collect()
}
