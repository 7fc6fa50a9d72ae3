//! Contact by augmented Lagrangian, node by node: a penalty whose springs start from the force found before, until they
//! need no penetration any more.
//!
//! ```text
//!   f_i = max(0, lambda_i - k_i g_i),     g = g0 + C f,     then lambda = f, and again
//! ```
//!
//! Uzawa's outer updates (Simo & Laursen, Computers & Structures 42 (1992) 97-116) around the semi-smooth Newton
//! iteration of Alart & Curnier (Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375). An inner problem is the penalised
//! one with initial gaps g0_i - lambda_i/k_i. The outer error falls by (C + 1/k)^-1 1/k in each update, for every k > 0:
//! quickly in smooth pressures and slowly in those that swing from node to node.
//! Equation (33) of docs/theory.md.

use super::active_set::{ActiveSetOutcome, NodalContact, gaps, solve_nodal_contact_from};
use super::penalty::{not_sound, softened, springs_are_sound};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedSettings {
    /// The gap, open or closed, that a node with a force may be left with; in the unit of the gaps.
    pub tolerance: f64,
    /// Outer updates after the first, which is a plain penalty.
    pub update_limit: usize,
    /// Of each inner iteration.
    pub iteration_limit: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AugmentedOutcome {
    /// No node with a force has a gap above the tolerance.
    Converged,
    UpdateLimit,
    /// How the inner iteration ended, where it did not settle.
    Inner(ActiveSetOutcome),
}

/// The last state of the iteration; within the tolerance a solution if `outcome` is `Converged`.
#[derive(Clone, Debug)]
pub struct AugmentedContact {
    pub outcome: AugmentedOutcome,
    /// Outer updates done.
    pub updates: usize,
    /// The gap left at nodes with a force, open or closed.
    pub violation: f64,
    /// Its iterations are those of all inner problems, its gaps the true ones.
    pub nodal: NodalContact,
}

/// Solves the exact conditions of `active_set` to a tolerance, with `springs` 1/k_i as in `penalty`.
pub fn solve_augmented_lagrangian(
    compliance: &[f64],
    initial_gaps: &[f64],
    springs: &[f64],
    settings: &AugmentedSettings,
) -> AugmentedContact {
    let softened = softened(compliance, springs);
    let mut multipliers = vec![0.0; initial_gaps.len()];
    let mut active: Vec<bool> = initial_gaps.iter().map(|&gap| gap <= 0.0).collect();
    let mut iterations = 0;
    for updates in 0.. {
        let mut nodal = if springs_are_sound(springs) {
            let shifted: Vec<f64> = initial_gaps
                .iter()
                .zip(springs)
                .zip(&multipliers)
                .map(|((gap, spring), multiplier)| gap - spring * multiplier)
                .collect();
            solve_nodal_contact_from(active, &softened, &shifted, settings.iteration_limit)
        } else {
            not_sound(initial_gaps)
        };
        iterations += nodal.iterations;
        nodal.iterations = iterations;
        nodal.gaps = gaps(compliance, initial_gaps, &nodal.forces);
        let touching = nodal.gaps.iter().zip(&nodal.forces).filter(|(_, force)| **force > 0.0);
        let open_or_closed = touching.fold(0.0, |most: f64, (gap, _)| most.max(gap.abs()));
        // Nodes without a force must not overlap either.
        let violation = nodal.gaps.iter().fold(open_or_closed, |most, gap| most.max(-gap));
        let outcome = if nodal.outcome != ActiveSetOutcome::Settled {
            AugmentedOutcome::Inner(nodal.outcome)
        } else if violation <= settings.tolerance {
            AugmentedOutcome::Converged
        } else if updates == settings.update_limit {
            AugmentedOutcome::UpdateLimit
        } else {
            multipliers.clone_from(&nodal.forces);
            active = nodal.active;
            continue;
        };
        return AugmentedContact { outcome, updates, violation, nodal };
    }
    unreachable!("the last update ends the iteration")
}
