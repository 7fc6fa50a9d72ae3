//! The contact of designs with one joint, its bodies being solved: their states, how good they are, and what they want.

use crate::engine::accuracy::body_errors::{BodyErrors, ErrorSource, JudgedBody};
use crate::engine::accuracy::{Estimate, ForceError, Want};
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_request::{Fidelity, RequestKey};
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::JointPlan;
use crate::engine::row::Solving;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::compliance::Boundary;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::contact::curve::ContactCurve;
use crate::mechanics::contact::load::NoState;
use crate::study::design::DesignCase;

/// Joints with one of these have a curve in common: clearance, sizes and loads are left.
pub type JointKey = (RequestKey, RequestKey, [u64; 2], SpaceKey, Estimate);

/// Of a design with its plan.
pub fn joint_key(plan: &JointPlan, case: &DesignCase) -> JointKey {
    let moduli = [&case.joint.pin, &case.joint.plate].map(|part| part.material.youngs_modulus.to_bits());
    (plan.pin.key(), plan.plate.key(), moduli, plan.space, plan.estimate)
}

/// The answers to designs of one `JointKey`, on one rung, and what each wants of the next. Bodies and space of the plan were
/// prepared.
pub fn solve_designs<'a>(
    library: &BodyLibrary,
    spaces: &Spaces,
    plan: &JointPlan,
    cases: impl Iterator<Item = &'a DesignCase> + Clone,
    accuracy: f64,
) -> Vec<(DesignOutcome, Want)> {
    let Some(first) = cases.clone().next() else { return Vec::new() };
    let space = spaces.get(plan.space);
    let mut backend = BackendKind::Cpu;
    let members = [(plan.pin, &first.joint.pin), (plan.plate, &first.joint.plate)].map(|(request, part)| {
        let solved = library.solved(&request);
        if solved.backend == BackendKind::Gpu {
            backend = BackendKind::Gpu;
        }
        let (body, share) = (&*solved.compliance, 1.0 / part.material.youngs_modulus);
        (request, body, share, space.pressures.joint(&[(body, share)]))
    });
    let judged = members.each_ref().map(|(request, body, share, part)| {
        let source = match (request.fidelity, plan.coarser(request)) {
            (Fidelity::Series, _) if matches!(body.boundary, Boundary::Bed(_)) => ErrorSource::Bed,
            (Fidelity::Series, _) => ErrorSource::Exact,
            (Fidelity::Mesh { .. }, Some(coarser)) => {
                let coarse = &*library.solved(&coarser).compliance;
                ErrorSource::MeshBeside { fine: body, coarse, share: *share }
            }
            (Fidelity::Mesh { level }, None) => ErrorSource::Mesh(level),
        };
        JudgedBody { body: &request.body, source, part }
    });
    let solving = Solving { backend, method: plan.method(), limit: space.limit, accuracy };
    let joined = JointCompliance::of_both(&members[0].3, &members[1].3);
    let Some(curve) = ContactCurve::new(space, &joined) else {
        let failed = |case| (solving.all_failed(case, NoState::BrokenCompliance), Want::FinerMesh);
        return cases.map(failed).collect();
    };
    let trust = match plan.estimate {
        Estimate::Change(trust) => Some((trust, plan.level)),
        Estimate::Exact | Estimate::Known => None,
    };
    let errors = BodyErrors::new(&curve, &judged, trust);
    let answer = |case: &DesignCase| {
        let scale = JointScale::of(&case.joint);
        let states = curve
            .states(scale.radial_clearance, scale.loads_in_contact(&case.steps))
            .into_iter()
            .map(|state| {
                let (mut state, node) = state?;
                if plan.estimate != Estimate::Exact {
                    state.curve_error = curve.rough_error;
                }
                let [bodies, beds] = errors.at(state.half_angle, node);
                Ok((state, ForceError::new(&state, bodies, beds)))
            });
        solving.respond(case, states)
    };
    cases.map(answer).collect()
}
