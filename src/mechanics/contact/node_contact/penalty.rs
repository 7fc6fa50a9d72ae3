//! Contact by penalty, node by node: springs that push back in proportion to the penetration.
//!
//! ```text
//!   f_i = k_i max(0, -g_i),     g = g0 + C f
//! ```
//!
//! Where nodes touch this is (C_AA + K_A^-1) f_A = -g0_A, and they touch where that force is positive: the exact
//! conditions of `active_set`, with 1/k_i on the diagonal of C. So its semi-smooth Newton iteration with exact solves
//! serves (Alart & Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375), and the force is too soft by a part of
//! first order in 1/k. Equations (31), (32) of docs/theory.md.

use super::active_set::{ActiveSetOutcome, NodalContact, solve_nodal_contact_from};
use super::ring_joint::RingJoint;

/// Springs of the nodes of a joint as they add to the diagonal of its compliance, 1/k_i with
/// k_i = `factor` E*/h w_i: h the length of the sides at the node, w_i the length it stands for. The factor has no
/// dimension; 1 gives a spring about as stiff as the element behind it.
pub fn springs(joint: &RingJoint, factor: f64, effective_modulus: f64) -> Vec<f64> {
    let nodes = joint.lengths().into_iter().zip(joint.side_lengths());
    nodes.map(|(length, side)| side / (factor * effective_modulus * length)).collect()
}

/// Solves the penalised conditions for a normal `compliance` (row-major) and `springs` 1/k_i; gaps are the true ones,
/// negative where there is penetration.
pub fn solve_penalty(
    compliance: &[f64],
    initial_gaps: &[f64],
    springs: &[f64],
    iteration_limit: usize,
) -> NodalContact {
    let touching = initial_gaps.iter().map(|&gap| gap <= 0.0).collect();
    let softened = softened(compliance, springs);
    let mut contact = match springs_are_sound(springs) {
        true => solve_nodal_contact_from(touching, &softened, initial_gaps, iteration_limit),
        false => not_sound(initial_gaps),
    };
    for ((gap, spring), force) in contact.gaps.iter_mut().zip(springs).zip(&contact.forces) {
        if *force != 0.0 {
            *gap -= spring * force;
        }
    }
    contact
}

/// The most by which nodes overlap.
pub fn penetration(gaps: &[f64]) -> f64 {
    gaps.iter().fold(0.0, |most, gap| most.max(-gap))
}

/// C with `springs` on its diagonal.
pub(super) fn softened(compliance: &[f64], springs: &[f64]) -> Vec<f64> {
    let mut softened = compliance.to_vec();
    for (node, spring) in springs.iter().enumerate() {
        softened[node * springs.len() + node] += spring;
    }
    softened
}

/// A penalty of zero, a negative one, or none that is a number is no contact law.
pub(super) fn springs_are_sound(springs: &[f64]) -> bool {
    springs.iter().all(|spring| spring.is_finite() && *spring >= 0.0)
}

pub(super) fn not_sound(initial_gaps: &[f64]) -> NodalContact {
    NodalContact {
        outcome: ActiveSetOutcome::Singular,
        iterations: 0,
        active: vec![false; initial_gaps.len()],
        forces: vec![0.0; initial_gaps.len()],
        gaps: initial_gaps.to_vec(),
    }
}
