//! A batch of designs on the processor: bodies first, each distinct one once, then the contact of every design.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::plan::InterpolationPlan;
use crate::engine::interpolation::rung::Interpolation;
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::{Compared, JointPlan, Want};
use crate::engine::refusal::Refusal;
use crate::engine::respond::{LoadState, Solving, Way, all_failed, closed_form, loads_in_contact};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::compliance::thin_wall::{THIN, thin_wall_error};
use crate::mechanics::contact::arc_state::ArcState;
use crate::mechanics::contact::loading::{DimensionlessLoad, JointCurve, NoState};
use crate::mechanics::contact::pressure::JointCompliance;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::DesignCase;

/// Solves batches; keeps the bodies it has met.
pub struct CpuBackend {
    options: SolveOptions,
    pub library: BodyLibrary,
    /// Time spent on contact, summed over threads.
    pub contact_time: Duration,
    pub interpolation: Option<Interpolation>,
}

impl CpuBackend {
    pub fn new(options: SolveOptions) -> CpuBackend {
        CpuBackend {
            options,
            library: BodyLibrary::default(),
            contact_time: Duration::ZERO,
            interpolation: None,
        }
    }

    /// With bodies interpolated as the plan has it.
    pub fn interpolating(options: SolveOptions, plan: InterpolationPlan) -> CpuBackend {
        CpuBackend { interpolation: Some(Interpolation::new(plan)), ..CpuBackend::new(options) }
    }

    /// Outcomes of `cases`, in their order. Designs whose error estimate is above the accuracy asked are solved again
    /// with more trial pressures or on finer meshes, as they want, until it is met or there is no more.
    pub fn solve(&mut self, cases: &[DesignCase]) -> Vec<DesignOutcome> {
        if self.options.method == MethodChoice::ClosedForm {
            return cases.par_iter().map(|case| closed_form(case.clone())).collect();
        }
        let mut outcomes: Vec<Option<DesignOutcome>> = vec![None; cases.len()];
        if let Some(interpolation) = &mut self.interpolation {
            outcomes = interpolation.solve(&mut self.library, cases);
        }
        let SolveOptions { method, accuracy } = self.options;
        let mut plans: Vec<(usize, Result<JointPlan, Refusal>)> = (0..cases.len())
            .filter(|index| outcomes[*index].is_none())
            .map(|index| (index, JointPlan::cheapest(&cases[index], method, accuracy)))
            .collect();
        while !plans.is_empty() {
            let requests: Vec<_> = plans
                .iter()
                .filter_map(|(_, plan)| plan.as_ref().ok())
                .flat_map(JointPlan::requests)
                .collect();
            self.library.solve(&requests);
            let library = &self.library;
            let solved: Vec<(DesignOutcome, Want, Duration)> = plans
                .par_iter()
                .with_min_len(16)
                .map(|(index, plan)| {
                    let started = Instant::now();
                    let case = &cases[*index];
                    let (outcome, want) = match plan {
                        Ok(plan) => solve_design(library, plan, case, accuracy),
                        Err(refusal) => {
                            let status = format!("failed: {refusal}");
                            (all_failed(case, BackendKind::Cpu, &status), Want::Nothing)
                        }
                    };
                    (outcome, want, started.elapsed())
                })
                .collect();
            let mut unsettled = Vec::new();
            for ((index, plan), (outcome, want, time)) in plans.into_iter().zip(solved) {
                self.contact_time += time;
                outcomes[index] = Some(outcome);
                let next = plan.ok().and_then(|plan| plan.next(want));
                unsettled.extend(next.map(|plan| (index, Ok(plan))));
            }
            plans = unsettled;
        }
        outcomes.into_iter().flatten().collect()
    }

    /// Where the time went, summed over threads, in the order the stages run.
    pub fn stages(&self) -> Vec<(&'static str, Duration)> {
        let times = self.library.times;
        vec![
            ("preparation", times.shared),
            ("series", times.series),
            ("condensation", times.condense),
            ("contact", self.contact_time),
            ("fits", self.interpolation.as_ref().map_or(Duration::ZERO, |rung| rung.fit_time)),
            ("interpolation", self.interpolation.as_ref().map_or(Duration::ZERO, |rung| rung.design_time)),
        ]
    }
}

/// One design on one rung, and what it wants of the next.
fn solve_design(
    library: &BodyLibrary,
    plan: &JointPlan,
    case: &DesignCase,
    accuracy: f64,
) -> (DesignOutcome, Want) {
    let joint = &case.joint;
    let space = library.space(plan.pin.space);
    let (pin, plate) = (library.compliance(&plan.pin.key()), library.compliance(&plan.plate.key()));
    let moduli = [joint.pin.material.youngs_modulus, joint.plate.material.youngs_modulus];
    let joined = JointCompliance::new(space, (pin, moduli[0]), (plate, moduli[1]));
    let solving =
        Solving { backend: BackendKind::Cpu, way: Way::Planned(*plan), limit: space.limit, accuracy };
    // Change from what each body on a mesh is compared with, and the body's modulus.
    let changes: Vec<(Arc<PressureCompliance>, f64)> =
        [(plan.pin, pin, moduli[0]), (plan.plate, plate, moduli[1])]
            .into_iter()
            .filter_map(|(request, fine, modulus)| {
                let change = match plan.compared(&request) {
                    Compared::Not => return None,
                    Compared::WithNothing => Arc::clone(fine),
                    Compared::With(coarser) => Arc::new(fine.minus(library.compliance(&coarser.key()))),
                };
                Some((change, modulus))
            })
            .collect();
    let curve = match JointCurve::new(joined) {
        Ok(curve) => curve,
        Err(reason) => return (solving.all_failed(case, reason), Want::FinerMesh),
    };
    let clearance = joint.radial_clearance / joint.hole_radius;
    let loads: Vec<DimensionlessLoad> = loads_in_contact(case).collect();
    let states = curve.states(clearance, &loads);
    let thin: Vec<ThinBody> = [(plan.pin, pin, moduli[0]), (plan.plate, plate, moduli[1])]
        .into_iter()
        .filter(|(request, ..)| request.body.depth_range().0 < THIN)
        .map(|(request, compliance, modulus)| ThinBody { body: request.body, compliance, modulus })
        .collect();
    solving.respond(case, load_states(&curve, &states, &changes, &thin))
}

/// A body whose thin walls leave an error of their own.
struct ThinBody<'a> {
    body: Body,
    compliance: &'a PressureCompliance,
    modulus: f64,
}

/// What the table needs of each state, with the relative change of its work by what its meshes are compared with.
fn load_states(
    curve: &JointCurve,
    states: &[Result<ArcState, NoState>],
    changes: &[(Arc<PressureCompliance>, f64)],
    thin: &[ThinBody],
) -> Vec<Result<LoadState, NoState>> {
    let sound: Vec<ArcState> = states.iter().filter_map(|state| state.as_ref().ok().copied()).collect();
    let mut relative = vec![0.0; sound.len()];
    for (change, modulus) in changes {
        for (sum, change) in relative.iter_mut().zip(curve.joint().relative_changes(&sound, change)) {
            *sum += (change / modulus).abs();
        }
    }
    let mut thin_walls = vec![0.0; sound.len()];
    for ThinBody { body, compliance, modulus } in thin {
        let shares = curve.joint().relative_changes(&sound, compliance);
        for ((sum, share), state) in thin_walls.iter_mut().zip(shares).zip(&sound) {
            *sum += share / modulus * thin_wall_error(body, state.arc.half_angle);
        }
    }
    let mut errors = relative.into_iter().zip(thin_walls);
    states
        .iter()
        .map(|state| {
            let state = state.as_ref().map_err(|reason| *reason)?;
            let (change, thin_walls) = errors.next().unwrap_or((f64::NAN, f64::NAN));
            Ok(LoadState::new(state, change, thin_walls))
        })
        .collect()
}
