//! Designs solved by contact node by node: exact, by penalty, or by augmented Lagrangian.

use std::time::Instant;

use crate::lab::tradeoff::answer::State;
use crate::lab::tradeoff::choice::Solution;
use crate::lab::tradeoff::ring_mesh::Division;
use crate::lab::tradeoff::rings::{Rings, clearance_ratio};
use crate::mechanics::contact::node_contact::active_set::{
    ActiveSetOutcome, NodalContact, solve_nodal_contact,
};
use crate::mechanics::contact::node_contact::augmented_lagrangian::{
    AugmentedOutcome, AugmentedSettings, solve_augmented_lagrangian,
};
use crate::mechanics::contact::node_contact::penalty::{solve_penalty, springs};
use crate::mechanics::contact::node_contact::ring_joint::RingJoint;
use crate::mechanics::material::effective_modulus;
use crate::study::design::{DesignCase, JointDesign, Load};

/// How the unilateral conditions are met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formulation {
    /// By multipliers: no penetration.
    Exact,
    /// With springs of a factor of E*/h.
    Penalty { factor: f64 },
    /// With springs of a factor, until the gap left is this share of the indentation.
    Augmented { factor: f64, tolerance: f64 },
}

/// Newton iterations of an active set, and outer updates of an augmented Lagrangian.
const ITERATION_LIMIT: usize = 100;
const UPDATE_LIMIT: usize = 500;

/// Steps to the indentation of a force; each is one contact problem.
const FORCE_STEPS: usize = 60;

/// Of a force that is found, relative.
const FORCE_TOLERANCE: f64 = 1e-10;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodalPath {
    pub division: Division,
    pub formulation: Formulation,
}

impl NodalPath {
    pub fn solve(&self, cases: &[DesignCase]) -> Solution {
        let started = Instant::now();
        let rings = Rings::new(cases, &self.division);
        let states = cases.iter().enumerate().map(|(number, case)| {
            let pair = rings.pair(number, &case.joint);
            let joint =
                pair.and_then(|[pin, plate]| RingJoint::new(pin, plate, clearance_ratio(&case.joint)).ok());
            match joint {
                Some(joint) => self.states(&joint, case),
                None => vec![None; case.steps.len()],
            }
        });
        let states = states.collect();
        Solution { states, shared: rings.shared, own: started.elapsed() - rings.shared }
    }

    fn states(&self, joint: &RingJoint, case: &DesignCase) -> Vec<Option<State>> {
        let JointDesign { idealization, pin, plate, .. } = &case.joint;
        let modulus = effective_modulus(&pin.material, &plate.material, *idealization);
        let springs = match self.formulation {
            Formulation::Exact => vec![0.0; joint.angles.len()],
            Formulation::Penalty { factor } | Formulation::Augmented { factor, .. } => {
                springs(joint, factor, modulus)
            }
        };
        let pressed = |indentation: f64| self.pressed(joint, &springs, &case.joint, indentation);
        let state = |load: &Load| match case.joint.from_first_touch(*load) {
            Load::Indentation(0.0) | Load::Force(0.0) => None,
            Load::Indentation(indentation) | Load::Offset(indentation) => pressed(indentation),
            Load::Force(force) => found(&pressed, force, force / (modulus * case.joint.thickness)),
        };
        case.steps.iter().map(state).map(|state| state.and_then(State::sound)).collect()
    }

    /// The joint at an indentation (> 0).
    fn pressed(
        &self,
        joint: &RingJoint,
        springs: &[f64],
        design: &JointDesign,
        indentation: f64,
    ) -> Option<State> {
        let gaps = joint.initial_gaps(design.radial_clearance, indentation);
        let settled = |contact: NodalContact| {
            (contact.outcome == ActiveSetOutcome::Settled).then_some((contact.iterations, contact))
        };
        let (iterations, contact) = match self.formulation {
            Formulation::Exact => settled(solve_nodal_contact(&joint.compliance, &gaps, ITERATION_LIMIT))?,
            Formulation::Penalty { .. } => {
                settled(solve_penalty(&joint.compliance, &gaps, springs, ITERATION_LIMIT))?
            }
            Formulation::Augmented { tolerance, .. } => {
                let settings = AugmentedSettings {
                    tolerance: tolerance * indentation,
                    update_limit: UPDATE_LIMIT,
                    iteration_limit: ITERATION_LIMIT,
                };
                let contact = solve_augmented_lagrangian(&joint.compliance, &gaps, springs, &settings);
                if contact.outcome != AugmentedOutcome::Converged {
                    return None;
                }
                (contact.nodal.iterations, contact.nodal)
            }
        };
        // An augmented Lagrangian ends where the springs carry next to nothing: its stiffness is that without them.
        let springs = matches!(self.formulation, Formulation::Penalty { .. }).then_some(springs);
        Some(State {
            indentation,
            force: design.thickness * joint.force(&contact.forces),
            tangent_stiffness: design.thickness * joint.tangent_stiffness(&contact.active, springs)?,
            contact_half_angle: Some(joint.contact_half_angle(&contact.active)),
            peak_pressure: Some(joint.peak_pressure(&contact.active, &contact.forces)? / design.hole_radius),
            iterations: Some(iterations),
        })
    }
}

/// The state at a force, by Newton's iteration from any indentation > 0: the force is convex in the indentation, so the
/// iteration comes from above after its first step.
fn found(pressed: &dyn Fn(f64) -> Option<State>, force: f64, start: f64) -> Option<State> {
    let mut indentation = start;
    let mut iterations = 0;
    for _ in 0..FORCE_STEPS {
        let state = pressed(indentation)?;
        iterations += state.iterations.unwrap_or(0);
        if (state.force / force - 1.0).abs() < FORCE_TOLERANCE {
            return Some(State { iterations: Some(iterations), ..state });
        }
        let next = indentation + (force - state.force) / state.tangent_stiffness;
        // A kink where nodes switch can throw the first step beyond zero.
        indentation = if next > 0.0 { next } else { 0.5 * indentation };
    }
    None
}
