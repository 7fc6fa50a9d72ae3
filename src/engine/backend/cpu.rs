//! A batch of designs on the processor: bodies first, each distinct one once, then the contact of every design.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::bodies::{BodyLibrary, Fidelity};
use crate::engine::outcome::{DesignOutcome, Method, Response, StepOutcome};
use crate::engine::plan::{JointPlan, coarser, first_level, mesh_error};
use crate::mechanics::contact::arc_state::ArcState;
use crate::mechanics::contact::loading::{DimensionlessLoad, JointCurve, NoState};
use crate::mechanics::contact::pressure::JointCompliance;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::mechanics::laws;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::{DesignCase, JointDesign, Load};

/// Solves batches; keeps the bodies it has met.
pub struct CpuBackend {
    options: SolveOptions,
    pub library: BodyLibrary,
    /// Time spent on contact, summed over threads.
    pub contact_time: Duration,
}

/// The geometry is linearised: from this (dR + delta)/R2 on, the force is off by a part in a thousand and more.
const LARGE_DISPLACEMENT: f64 = 0.05;

/// Error of an exact compliance: quadrature, interpolation between half angles and rounding.
const SERIES_ERROR: f64 = 1e-8;

impl CpuBackend {
    pub fn new(options: SolveOptions) -> CpuBackend {
        CpuBackend { options, library: BodyLibrary::default(), contact_time: Duration::ZERO }
    }

    /// Outcomes of `cases`, in their order. Designs whose error estimate is above the accuracy asked are solved again
    /// on finer meshes until it is met or the meshes end.
    pub fn solve(&mut self, cases: Vec<DesignCase>) -> Vec<DesignOutcome> {
        if self.options.method == MethodChoice::ClosedForm {
            return cases.into_par_iter().map(closed_form).collect();
        }
        let mut outcomes: Vec<Option<DesignOutcome>> = vec![None; cases.len()];
        let mut open: Vec<usize> = (0..cases.len()).collect();
        for level in first_level(self.options.accuracy)..LEVEL_COUNT {
            let plans: Vec<(usize, Option<JointPlan>)> = open
                .iter()
                .map(|&index| (index, JointPlan::new(&cases[index].joint, self.options.method, level)))
                .collect();
            let requests: Vec<_> =
                plans.iter().filter_map(|(_, plan)| plan.as_ref()).flat_map(JointPlan::requests).collect();
            self.library.solve(&requests);
            let (library, accuracy) = (&self.library, self.options.accuracy);
            let solved: Vec<(DesignOutcome, bool, Duration)> = plans
                .par_iter()
                .with_min_len(16)
                .map(|(index, plan)| {
                    let started = Instant::now();
                    let case = &cases[*index];
                    let (outcome, settled) = match plan {
                        Some(plan) => solve_design(library, plan, case, accuracy),
                        None => (all_failed(case, NOT_CONCENTRIC.into()), true),
                    };
                    (outcome, settled, started.elapsed())
                })
                .collect();
            let mut unsettled = Vec::new();
            for ((index, _), (outcome, settled, time)) in plans.iter().zip(solved) {
                self.contact_time += time;
                outcomes[*index] = Some(outcome);
                if !settled {
                    unsettled.push(*index);
                }
            }
            open = unsettled;
            if open.is_empty() {
                break;
            }
        }
        outcomes.into_iter().flatten().collect()
    }
}

const NOT_CONCENTRIC: &str = "failed: series needs a rigid-core pin in an annulus";

fn all_failed(case: &DesignCase, status: String) -> DesignOutcome {
    let steps = case.steps.iter().map(|_| StepOutcome { response: None, status: status.clone() }).collect();
    DesignOutcome { case: case.clone(), steps }
}

/// One design on one rung, and whether there is nothing to gain from the next.
fn solve_design(
    library: &BodyLibrary,
    plan: &JointPlan,
    case: &DesignCase,
    accuracy: f64,
) -> (DesignOutcome, bool) {
    let joint = &case.joint;
    let space = library.space(plan.pin.space);
    let (pin, plate) = (library.compliance(&plan.pin.key()), library.compliance(&plan.plate.key()));
    let moduli = [joint.pin.material.youngs_modulus, joint.plate.material.youngs_modulus];
    let joined = JointCompliance::new(space, (pin, moduli[0]), (plate, moduli[1]));
    let exact = [plan.pin, plan.plate].iter().all(|request| request.fidelity == Fidelity::Series);
    let method = if exact { Method::Series } else { Method::Fe };
    // Change from the next coarser mesh, for each body that has one, and the body's modulus.
    let changes: Vec<(Vec<f64>, f64)> = [(plan.pin, pin, moduli[0]), (plan.plate, plate, moduli[1])]
        .into_iter()
        .filter_map(|(request, fine, modulus)| {
            let coarse = library.compliance(&coarser(&request)?.key());
            let change = fine.values.iter().zip(&coarse.values).map(|(fine, coarse)| fine - coarse);
            Some((change.collect(), modulus))
        })
        .collect();
    let curve = match JointCurve::new(joined) {
        Ok(curve) => curve,
        Err(reason) => return (all_failed(case, failure(reason, space.limit)), exact),
    };
    let clearance = joint.radial_clearance / joint.hole_radius;
    let loads: Vec<DimensionlessLoad> =
        case.steps.iter().filter_map(|load| dimensionless(joint, *load)).collect();
    let states = curve.states(clearance, &loads);
    let errors = force_errors(&curve, &states, &changes, plan.level);
    let mut settled = true;
    let mut solved = states.into_iter().zip(errors).zip(loads);
    let steps = case
        .steps
        .iter()
        .map(|load| match dimensionless(joint, *load).and_then(|_| solved.next()) {
            None => unloaded(method),
            Some(((Err(reason), _), _)) => {
                StepOutcome { response: None, status: failure(reason, space.limit) }
            }
            Some(((Ok(state), error), load_over)) => {
                let offset = match *load {
                    Load::Indentation(0.0) | Load::Force(0.0) => 0.0,
                    _ => curve.offset(&state, clearance, load_over) * joint.hole_radius,
                };
                let (accurate, positive) = (error <= accuracy, state.pressure_is_positive());
                settled &= accurate && positive;
                StepOutcome {
                    response: Some(response(joint, *load, &state, offset, error, method)),
                    status: status(offset > LARGE_DISPLACEMENT * joint.hole_radius, positive, accurate),
                }
            }
        })
        .collect();
    (DesignOutcome { case: case.clone(), steps }, settled || exact)
}

/// The estimated relative error of the force of each state: what is left of exact compliances, and for every mesh the
/// change from the next coarser one.
fn force_errors(
    curve: &JointCurve,
    states: &[Result<ArcState, NoState>],
    changes: &[(Vec<f64>, f64)],
    level: usize,
) -> Vec<f64> {
    let sound: Vec<ArcState> = states.iter().filter_map(|state| state.as_ref().ok().copied()).collect();
    let mut errors: Vec<f64> = sound.iter().map(|state| SERIES_ERROR + state.truncation()).collect();
    let mut relative = vec![0.0; sound.len()];
    for (values, modulus) in changes {
        for (sum, change) in relative.iter_mut().zip(curve.joint().relative_changes(&sound, values)) {
            *sum += (change / modulus).abs();
        }
    }
    if !changes.is_empty() {
        errors.iter_mut().zip(relative).for_each(|(error, change)| *error += mesh_error(level, change));
    }
    let mut errors = errors.into_iter();
    states
        .iter()
        .map(|state| if state.is_ok() { errors.next().unwrap_or(f64::NAN) } else { f64::NAN })
        .collect()
}

/// A load over the joint's sizes, `None` where there is no contact yet.
fn dimensionless(joint: &JointDesign, load: Load) -> Option<DimensionlessLoad> {
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
    state: &ArcState,
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
        contact_half_angle: Some(state.arc.half_angle),
        peak_pressure: Some(offset / joint.hole_radius * state.peak_pressure()),
        energy: Some(scale * offset * state.energy),
        force_error: error,
        method,
    }
}

/// What a reader of a row must know.
fn status(large_displacement: bool, positive: bool, accurate: bool) -> String {
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
    if remarks.is_empty() { "ok".into() } else { remarks.join("; ") }
}

/// Johnson's law. It knows nothing of the plate's extent, so it is right to a factor of two at best.
fn closed_form(case: DesignCase) -> DesignOutcome {
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
            step(load)
                .unwrap_or_else(|error| StepOutcome { response: None, status: format!("failed: {error}") })
        })
        .collect();
    DesignOutcome { case, steps }
}
