//! From the states of a joint under its loads to the rows of the table, each with what a reader must know of it. The same for
//! every backend.

use crate::engine::accuracy::geometry_error::{LARGE_DISPLACEMENT, WIDEST_CLEARANCE, linearity_error};
use crate::engine::accuracy::{ForceError, Want};
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{Answer, BackendKind, Method, Response, StepOutcome};
use crate::engine::refusal::Refusal;
use crate::engine::rest_stresses;
use crate::engine::status::{Failure, Remark, Remarks, Status};
use crate::mechanics::contact::load::NoState;
use crate::mechanics::contact::state::ContactState;
use crate::mechanics::laws;
use crate::study::config::MethodChoice;
use crate::study::design::{DesignCase, JointDesign, Load};

/// How a design was solved.
#[derive(Clone, Copy, Debug)]
pub struct Solving {
    pub backend: BackendKind,
    pub method: Method,
    /// The largest contact half angle, of the pin, rad.
    pub limit_of_pin: f64,
    /// Asked: relative, of the force.
    pub accuracy: f64,
}

impl Solving {
    /// The answer to a design from the states of its `loads_in_contact`, in their order, and what it wants. Takes no more states than these.
    pub fn respond(
        &self,
        case: &DesignCase,
        states: impl IntoIterator<Item = Result<(ContactState, ForceError), NoState>>,
    ) -> (Answer, Want) {
        let scale = JointScale::of(&case.joint);
        let mut states = states.into_iter();
        let mut want = Want::Nothing;
        let yields_at_rest = rest_stresses::yields_at_rest(&case.joint);
        let step = |load: &Load| {
            if scale.load(*load).is_none() {
                return unloaded(&case.joint, *load, self.method);
            }
            let (state, error) = match states.next().unwrap_or(Err(NoState::BrokenCompliance)) {
                // A mesh far too coarse for its body may answer with a pull.
                Ok((state, _)) if !state.is_a_push() => {
                    want = Want::FinerMesh;
                    return StepOutcome::failed(Failure::NotAPush);
                }
                Ok(found) => found,
                Err(reason) => return StepOutcome::failed(self.no_state(reason, &scale)),
            };
            want = want.max(error.want(self.accuracy, state.pressure_is_positive));
            let error = error.total();
            let accurate = error <= self.accuracy;
            let mut response = scale.response(*load, &state, error, self.method);
            let of_linearity = linearity_error(&case.joint, &response);
            response.linearity_error = Some(of_linearity);
            let remarks = [
                (scale.outlines.radial_clearance >= WIDEST_CLEARANCE, Remark::ClearanceBeyondModel),
                (of_linearity > self.accuracy.max(LARGE_DISPLACEMENT), Remark::LargeDisplacement),
                (!state.pressure_is_positive, Remark::PressureNotPositive),
                (!accurate, Remark::AccuracyNotMet),
                (yields_at_rest, Remark::YieldsAtRest),
            ];
            StepOutcome { response: Some(response), status: Status::Answered(Remarks::of(&remarks)) }
        };
        let steps = case.steps.iter().map(step).collect();
        (Answer { backend: self.backend, steps }, want)
    }

    /// The answer to a design without any state.
    pub fn all_failed(&self, case: &DesignCase, reason: NoState) -> Answer {
        all_failed(case, self.backend, self.no_state(reason, &JointScale::of(&case.joint)))
    }

    fn no_state(&self, reason: NoState, scale: &JointScale) -> Failure {
        Failure::NoState(reason, scale.outlines.of_hole(self.limit_of_pin))
    }
}

/// The answer to a design that is not solved.
pub fn refused(case: &DesignCase, refusal: Refusal) -> Answer {
    all_failed(case, BackendKind::Cpu, Failure::Refused(refusal))
}

fn all_failed(case: &DesignCase, backend: BackendKind, failure: Failure) -> Answer {
    Answer { backend, steps: vec![StepOutcome::failed(failure); case.steps.len()] }
}

/// Of a joint with clearance before its bodies press each other.
fn unloaded(joint: &JointDesign, load: Load, method: Method) -> StepOutcome {
    let response = Response {
        indentation: 0.0,
        offset: joint.offset(load, 0.0),
        force: 0.0,
        tangent_stiffness: 0.0,
        contact_half_angle: Some(0.0),
        peak_pressure: Some(0.0),
        peak_pressure_angle: Some(0.0),
        energy: Some(0.0),
        force_error: 0.0,
        linearity_error: Some(0.0),
        method,
    };
    let remarks = Remarks::of(&[(true, Remark::NoContact)]);
    StepOutcome { response: Some(response), status: Status::Answered(remarks) }
}

/// Johnson's law. It knows nothing of the plate's extent, so it is right to a factor of two at best.
pub fn closed_form(case: &DesignCase) -> Answer {
    let joint = &case.joint;
    if let Some(refusal) = Refusal::of_joint(case, MethodChoice::ClosedForm) {
        return refused(case, refusal);
    }
    let curve = joint.pair().and_then(|pair| laws::johnson::LAW.curve(&pair));
    let step = |load: &Load| -> Result<StepOutcome, laws::LawError> {
        let curve = curve?;
        let indentation = match joint.from_first_touch(*load) {
            Load::Indentation(length) | Load::Offset(length) => length,
            Load::Force(force) => curve.indentation(force / joint.thickness)?,
        };
        let response = Response {
            indentation,
            offset: joint.offset(*load, indentation),
            force: joint.thickness * curve.force_per_thickness(indentation)?,
            tangent_stiffness: joint.thickness * curve.tangent_stiffness_per_thickness(indentation)?,
            contact_half_angle: None,
            peak_pressure: None,
            peak_pressure_angle: None,
            energy: None,
            force_error: 1.0,
            linearity_error: None,
            method: Method::ClosedForm,
        };
        let is_open = response.force == 0.0 && joint.radial_clearance > 0.0;
        let remarks = Remarks::of(&[(true, Remark::PlateNotModelled), (is_open, Remark::NoContact)]);
        Ok(StepOutcome { response: Some(response), status: Status::Answered(remarks) })
    };
    let failed = |error| StepOutcome::failed(Failure::Law(error));
    let steps = case.steps.iter().map(|load| step(load).unwrap_or_else(failed)).collect();
    Answer { backend: BackendKind::Cpu, steps }
}
