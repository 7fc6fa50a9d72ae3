//! From the states of a joint under its loads to the rows of the table: sizes put back, the error estimated, and what a
//! reader must know said. The same for every backend.

use std::borrow::Cow;

use crate::engine::accuracy::{ForceError, Want};
use crate::engine::outcome::{BackendKind, DesignOutcome, Method, Response, StepOutcome};
use crate::mechanics::contact::load::{DimensionlessLoad, NoState};
use crate::mechanics::contact::state::ContactState;
use crate::mechanics::laws;
use crate::study::design::{DesignCase, JointDesign, Load};

/// How a design was solved.
#[derive(Clone, Copy, Debug)]
pub struct Solving {
    pub backend: BackendKind,
    pub method: Method,
    /// The largest contact half angle, rad.
    pub limit: f64,
    /// Asked: relative, of the force.
    pub accuracy: f64,
}

/// The geometry is linearised: from this (dR + delta)/R2 on, the force is off by a part in a thousand and more.
const LARGE_DISPLACEMENT: f64 = 0.05;

pub const NOT_A_PUSH: &str = "failed: the bodies do not push each other, the mesh is too coarse for them";

impl Solving {
    /// The outcome of a design from the states of its `loads_in_contact`, in their order, and what it wants.
    pub fn respond(
        &self,
        case: &DesignCase,
        states: impl IntoIterator<Item = Result<(ContactState, ForceError), NoState>>,
    ) -> (DesignOutcome, Want) {
        let joint = &case.joint;
        let clearance = joint.radial_clearance / joint.hole_radius;
        let mut states = states.into_iter();
        let mut want = Want::Nothing;
        let step = |load: &Load| {
            let Some(load_over) = dimensionless(joint, *load) else { return unloaded(self.method) };
            let (state, error) = match states.next().unwrap_or(Err(NoState::BrokenCompliance)) {
                // A mesh far too coarse for its body may answer with a pull.
                Ok((state, _)) if !state.is_a_push() => {
                    want = Want::FinerMesh;
                    return StepOutcome { response: None, status: NOT_A_PUSH.into() };
                }
                Ok(found) => found,
                Err(reason) => {
                    return StepOutcome { response: None, status: failure(reason, self.limit).into() };
                }
            };
            let offset = joint.hole_radius
                * match (*load, load_over) {
                    (Load::Indentation(0.0) | Load::Force(0.0), _) => 0.0,
                    (_, DimensionlessLoad::Indentation(delta)) => clearance + delta,
                    (_, DimensionlessLoad::Force(force)) => force / state.force,
                };
            want = want.max(error.want(self.accuracy, state.pressure_is_positive));
            let error = error.total();
            let accurate = error <= self.accuracy;
            StepOutcome {
                response: Some(response(joint, *load, &state, offset, error, self.method)),
                status: status(
                    offset > LARGE_DISPLACEMENT * joint.hole_radius,
                    state.pressure_is_positive,
                    accurate,
                ),
            }
        };
        let steps = case.steps.iter().map(step).collect();
        (DesignOutcome { case: case.clone(), backend: self.backend, steps }, want)
    }

    /// The outcome of a design without any state.
    pub fn all_failed(&self, case: &DesignCase, reason: NoState) -> DesignOutcome {
        all_failed(case, self.backend, &failure(reason, self.limit))
    }
}

pub fn all_failed(case: &DesignCase, backend: BackendKind, status: &str) -> DesignOutcome {
    let steps = case
        .steps
        .iter()
        .map(|_| StepOutcome { response: None, status: status.to_string().into() })
        .collect();
    DesignOutcome { case: case.clone(), backend, steps }
}

/// The loads of a design under which there is contact, over the joint's sizes.
pub fn loads_in_contact(case: &DesignCase) -> impl Iterator<Item = DimensionlessLoad> {
    case.steps.iter().filter_map(|load| dimensionless(&case.joint, *load))
}

/// A load over the joint's sizes, `None` where there is no contact yet.
pub fn dimensionless(joint: &JointDesign, load: Load) -> Option<DimensionlessLoad> {
    match load {
        // A neat fit has one state, which any load shows.
        Load::Indentation(0.0) | Load::Force(0.0) if joint.radial_clearance == 0.0 => {
            Some(DimensionlessLoad::Indentation(1.0))
        }
        Load::Indentation(0.0) | Load::Force(0.0) => None,
        Load::Indentation(delta) => Some(DimensionlessLoad::Indentation(delta / joint.hole_radius)),
        Load::Force(force) => Some(DimensionlessLoad::Force(force / (joint.thickness * joint.hole_radius))),
    }
}

fn unloaded(method: Method) -> StepOutcome {
    let response = Response {
        indentation: 0.0,
        force: 0.0,
        tangent_stiffness: 0.0,
        contact_half_angle: Some(0.0),
        peak_pressure: Some(0.0),
        energy: Some(0.0),
        force_error: 0.0,
        method,
    };
    StepOutcome { response: Some(response), status: "ok".into() }
}

fn failure(reason: NoState, limit: f64) -> String {
    match reason {
        NoState::ContactTooWide => format!("failed: contact wider than {:.0} deg", limit.to_degrees()),
        NoState::BrokenCompliance => "failed: compliance not positive definite".into(),
    }
}

fn response(
    joint: &JointDesign,
    load: Load,
    state: &ContactState,
    offset: f64,
    error: f64,
    method: Method,
) -> Response {
    let scale = joint.thickness * offset;
    let (indentation, force) = match load {
        Load::Indentation(indentation) => (indentation, scale * state.force),
        Load::Force(force) => (offset * state.indentation, force),
    };
    Response {
        indentation,
        force,
        tangent_stiffness: joint.thickness * state.tangent_stiffness,
        contact_half_angle: Some(state.half_angle),
        peak_pressure: Some(offset / joint.hole_radius * state.peak_pressure),
        energy: Some(scale * offset * state.energy),
        force_error: error,
        method,
    }
}

/// What a reader of a row must know.
fn status(large_displacement: bool, positive: bool, accurate: bool) -> Cow<'static, str> {
    let mut remarks = Vec::new();
    if large_displacement {
        remarks.push("large displacement");
    }
    if !positive {
        remarks.push("pressure not positive everywhere");
    }
    if !accurate {
        remarks.push("accuracy not met");
    }
    if remarks.is_empty() { "ok".into() } else { remarks.join("; ").into() }
}

/// Johnson's law. It knows nothing of the plate's extent, so it is right to a factor of two at best.
pub fn closed_form(case: DesignCase) -> DesignOutcome {
    let joint = &case.joint;
    let pair = laws::Pair::new(
        joint.hole_radius,
        joint.radial_clearance,
        joint.thickness,
        &joint.pin.material,
        &joint.plate.material,
        joint.idealization,
    );
    let curve = pair.and_then(|pair| laws::johnson::LAW.curve(&pair));
    let step = |load: &Load| -> Result<StepOutcome, laws::LawError> {
        let curve = curve?;
        let indentation = match *load {
            Load::Indentation(delta) => delta,
            Load::Force(force) => curve.indentation(force / joint.thickness)?,
        };
        let response = Response {
            indentation,
            force: joint.thickness * curve.force_per_thickness(indentation)?,
            tangent_stiffness: joint.thickness * curve.tangent_stiffness_per_thickness(indentation)?,
            contact_half_angle: None,
            peak_pressure: None,
            energy: None,
            force_error: 1.0,
            method: Method::ClosedForm,
        };
        Ok(StepOutcome { response: Some(response), status: "plate extent not modelled".into() })
    };
    let steps = case
        .steps
        .iter()
        .map(|load| {
            step(load).unwrap_or_else(|error| StepOutcome {
                response: None,
                status: format!("failed: {error}").into(),
            })
        })
        .collect();
    DesignOutcome { case, backend: BackendKind::Cpu, steps }
}
