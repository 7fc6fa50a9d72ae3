//! The contact of bodies on meshes on a device: the processor makes the numbers of joints and judges their states. What the device has no
//! kernel for, and what is not good enough, is left to the processor.

use crate::engine::accuracy::body_errors::OwnError;
use crate::engine::accuracy::{Estimate, Want};
use crate::engine::backend::joints::{
    self, Amplitudes, BodyTables, CondensedBody, DeviceBody, DeviceJoint, JointTables, states,
};
use crate::engine::body_request::BodyRequest;
use crate::engine::device_joints::{Given, errors_of_bodies};
use crate::engine::joint_contact::judged;
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind};
use crate::engine::plan::JointPlan;
use crate::engine::row::Solving;
use crate::engine::spaces::Spaces;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::near_field::NearField;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::series::NEGLIGIBLE_SECOND;
use crate::mechanics::compliance::{BodyCompliance, concentric_pin, infinite};
use crate::mechanics::contact::compliance_rows::ModeMembers;
use crate::study::design::DesignCase;

/// A body of a joint that a device is given.
#[derive(Clone, Copy)]
pub enum GivenBody<'a> {
    Solved(&'a BodyCompliance),
    OnDevice(BodyOnDevice<'a>),
}

/// One that the device condenses for the joint, with what the processor knows of it.
#[derive(Clone, Copy)]
pub struct BodyOnDevice<'a> {
    pub modes: RingModes,
    /// The near fields between which (0 to 1) its own lies.
    pub around: [&'a NearField; 2],
    pub between: f64,
    pub place: CondensedBody,
}

impl BodyOnDevice<'_> {
    /// How many bands of second order a body has at most.
    pub fn band_count(body: &Body) -> usize {
        concentric_pin(body).map_or(0, |body| body.second_order_count(NEGLIGIBLE_SECOND))
    }
}

/// Whether a device may solve the joints of a plan, as far as the plan tells. Layers, press fits, and meshes that are told by coarser ones
/// are the processor's.
pub fn is_for_devices(plan: &JointPlan) -> bool {
    plan.estimate == Estimate::Known
        && joints::is_for_devices(plan.space)
        && [&plan.pin, &plan.plate].into_iter().all(|request| request.body.lining.is_empty())
}

/// The joint of some designs of one `JointKey`, whose bodies and space were prepared, with `even` of its compliance; nothing where a device
/// has no kernel for it.
pub fn given<'a, 'b>(
    spaces: &'a Spaces,
    plan: &JointPlan,
    bodies: [GivenBody; 2],
    cases: impl Iterator<Item = &'b DesignCase> + Clone,
    numbers: &mut Vec<f32>,
) -> Option<Given<'a, f64>> {
    let joint = &cases.clone().next()?.joint;
    let outlines = JointScale::of(joint).outlines;
    if !is_for_devices(plan) {
        return None;
    }
    let parts = [(&plan.pin, &joint.pin), (&plan.plate, &joint.plate)];
    let second = [0, 1].map(|side| match bodies[side] {
        GivenBody::OnDevice(_) => {
            concentric_pin(&parts[side].0.body).map(|body| body.second_order_felt(outlines.square()))
        }
        GivenBody::Solved(_) => None,
    });
    let second = second.each_ref().map(|second| second.as_deref().unwrap_or_default());
    let members = |side: usize| {
        let own = parts[side].0.body.shape.side;
        match bodies[side] {
            GivenBody::Solved(compliance) => ModeMembers::of(own, compliance),
            GivenBody::OnDevice(body) => Some(ModeMembers::of_mesh(own, second[side].len(), body.modes)),
        }
    };
    let members = [members(0)?, members(1)?];
    let space = (plan.space, spaces.get(plan.space));
    let tables = JointTables { bodies: members.map(BodyTables::Modes), space };
    if !tables.are_for_devices(&outlines) {
        return None;
    }
    let body = |side: usize| {
        let (request, part) = parts[side];
        let (infinite, amplitudes) = match bodies[side] {
            GivenBody::Solved(solved) => {
                ([solved.even, solved.odd], Amplitudes::Modes(members[side], solved))
            }
            GivenBody::OnDevice(BodyOnDevice { around, between, .. }) => {
                let weights = NearField::weights(around, between, &request.body);
                (infinite(&request.body), Amplitudes::OnDevice(members[side], second[side], weights))
            }
        };
        DeviceBody { infinite, share: 1.0 / part.contact_material().youngs_modulus, amplitudes }
    };
    let joint = DeviceJoint { bodies: [body(0), body(1)], outlines };
    let loads = cases.flat_map(|case| JointScale::of(&case.joint).loads_in_contact(&case.steps));
    let [load_count, amplitude_count] = joint.numbers(loads, numbers)?;
    let condensed = bodies.map(|body| match body {
        GivenBody::Solved(_) => None,
        GivenBody::OnDevice(body) => Some(body.place),
    });
    Some(Given { tables, load_count, amplitude_count, condensed, kept: joint.even() })
}

/// The answers to the designs of a joint that was given, from what a device has found, and what each wants; nothing where one has no state. `own` is
/// what is known of a body.
pub fn judged_designs<'a, 'b>(
    spaces: &Spaces,
    plan: &'b JointPlan,
    own: impl Fn(usize, &'b BodyRequest) -> OwnError<'b>,
    cases: impl Iterator<Item = &'a DesignCase> + Clone,
    accuracy: f64,
    (even, found): (f64, &[f32]),
) -> Option<Vec<(Answer, Want)>> {
    let outlines = JointScale::of(&cases.clone().next()?.joint).outlines;
    let (of_curve, mut states) = states(found, even, &outlines)?;
    let errors = [own(0, &plan.pin), own(1, &plan.plate)];
    let limit_of_pin = spaces.get(plan.space).limit;
    let solving = Solving { backend: BackendKind::Gpu, method: plan.method(), limit_of_pin, accuracy };
    let answer = |case: &DesignCase| {
        // As many as the design has loads in contact.
        let own = states.by_ref().map(|found| Ok((found.state, errors_of_bodies(&errors, &found))));
        let (answer, want) = judged(case, &outlines, solving, of_curve, own);
        answer.steps.iter().all(|step| step.response.is_some()).then_some((answer, want))
    };
    cases.map(answer).collect()
}
