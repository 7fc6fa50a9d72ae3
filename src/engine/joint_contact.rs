//! The contact of designs with one joint, its bodies being solved: their states, how good they are, and what they want.

use crate::engine::accuracy::known_errors::known_error;
use crate::engine::accuracy::{ForceError, Want};
use crate::engine::bodies::BodyLibrary;
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::{Estimate, JointPlan};
use crate::engine::request::{BodyRequest, Fidelity, RequestKey};
use crate::engine::row::Solving;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::compliance::thin_wall::bed_error;
use crate::mechanics::compliance::{BodyCompliance, Boundary};
use crate::mechanics::contact::curve::{ContactCurve, CurveSpace};
use crate::mechanics::contact::load::NoState;
use crate::study::design::DesignCase;

/// Joints with one of these have a curve in common: clearance, sizes and loads are left.
pub type JointKey = (RequestKey, RequestKey, [u64; 2], SpaceKey, Estimate);

/// Of a design with its plan.
pub fn joint_key(plan: &JointPlan, case: &DesignCase) -> JointKey {
    let moduli = [&case.joint.pin, &case.joint.plate].map(|part| part.material.youngs_modulus.to_bits());
    (plan.pin.key(), plan.plate.key(), moduli, plan.space, plan.estimate)
}

/// A body of a joint with 1/E, and its part of the joint's compliance.
struct Member<'a> {
    request: BodyRequest,
    body: &'a BodyCompliance,
    share: f64,
    part: JointCompliance<'static>,
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
    let parts = [(plan.pin, &first.joint.pin), (plan.plate, &first.joint.plate)];
    let members = parts.map(|(request, part)| {
        let solved = library.solved(&request);
        if solved.backend == BackendKind::Gpu {
            backend = BackendKind::Gpu;
        }
        let (body, share) = (&*solved.compliance, 1.0 / part.material.youngs_modulus);
        Member { request, body, share, part: space.pressures.joint(&[(body, share)]) }
    });
    let solving = Solving { backend, method: plan.method(), limit: space.limit, accuracy };
    let joined = JointCompliance::of_both(&members[0].part, &members[1].part);
    let Some(curve) = ContactCurve::new(space, &joined) else {
        let failed = |case| (solving.all_failed(case, NoState::BrokenCompliance), Want::FinerMesh);
        return cases.map(failed).collect();
    };
    let errors = BodyErrors::new(library, plan, space, &curve, &members);
    let answer = |case: &DesignCase| {
        let scale = JointScale::of(&case.joint);
        let states =
            curve.states(scale.clearance, scale.loads_in_contact(&case.steps)).into_iter().map(|state| {
                let (mut state, node) = state?;
                if plan.estimate != Estimate::Exact {
                    state.curve_error = curve.rough_error;
                }
                let [bodies, beds] = errors.at(plan, state.half_angle, node);
                Ok((state, ForceError::new(&state, bodies, beds)))
            });
        solving.respond(case, states)
    };
    cases.map(answer).collect()
}

/// What tells the errors of a joint's bodies, at each node of its curve.
#[derive(Default)]
struct BodyErrors {
    /// Relative change of the work since the next coarser meshes, summed over the bodies.
    change: Vec<f64>,
    /// Of each body on a mesh that is known, and each bed: its share of the work.
    shares: Vec<(BodyRequest, Vec<f64>)>,
}

impl BodyErrors {
    fn new(
        library: &BodyLibrary,
        plan: &JointPlan,
        CurveSpace { pressures, .. }: &CurveSpace,
        curve: &ContactCurve,
        members: &[Member; 2],
    ) -> BodyErrors {
        let mut errors = BodyErrors::default();
        for Member { request, body, share, part } in members {
            let is_bed = matches!(body.boundary, Boundary::Bed(_));
            let is_known = request.fidelity != Fidelity::Series && plan.estimate == Estimate::Known;
            if is_bed || is_known {
                // Both shares are one.
                let of_body = match errors.shares.first() {
                    Some((_, of_other)) => of_other.iter().map(|share| 1.0 - share).collect(),
                    None => curve.states.work_shares(pressures, part),
                };
                errors.shares.push((*request, of_body));
            }
            if let Some(coarser) = plan.coarser(request) {
                let coarser = &library.solved(&coarser).compliance;
                let change = pressures.joint(&[(body, *share), (coarser, -share)]);
                errors.change.resize(pressures.arcs.len(), 0.0);
                let changes = curve.states.work_shares(pressures, &change);
                errors.change.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change.abs());
            }
        }
        errors
    }

    /// The relative errors of the force by meshes and by beds.
    fn at(&self, plan: &JointPlan, half_angle: f64, node: usize) -> [f64; 2] {
        let mut of_meshes = match plan.estimate {
            Estimate::Change(trust) => trust.error(plan.level, ContactCurve::around(node, &self.change)),
            _ => 0.0,
        };
        let mut of_beds = 0.0;
        for (request, shares) in &self.shares {
            let share = ContactCurve::around(node, shares);
            if request.fidelity == Fidelity::Series {
                of_beds += share * bed_error(&request.body, half_angle);
            } else {
                of_meshes +=
                    share * known_error(&request.body, plan.level, half_angle).unwrap_or(f64::INFINITY);
            }
        }
        [of_meshes, of_beds]
    }
}
