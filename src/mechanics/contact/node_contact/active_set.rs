//! Contact node by node: the plain, independent check of the moving-edge method.
//!
//! Find nodal forces f and gaps g at the ring's nodes with
//!
//! ```text
//!   g = g0 + C f >= 0,   f >= 0,   f_i g_i = 0,      g0 = dR - (dR + delta) cos phi,   C = C_pin/E1 + C_plate/E2
//! ```
//!
//! by the primal-dual active set method (Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865-888): close the
//! active gaps, release what pulls, close what penetrates, until nothing changes. Whole nodes open and close, so the
//! force is kinked in the indentation, and the edge of contact is known to a fraction of a node's spacing.

use super::ring_joint::solved_among;

/// Gaps above this share of the greatest initial one, below zero, are rounding.
const GAP_ROUNDING: f64 = 1e-13;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActiveSetOutcome {
    /// Every condition holds.
    Settled,
    /// A set of active nodes came back: the iteration would repeat for ever.
    Cycled,
    IterationLimit,
    /// The compliance of the active nodes is not positive definite, or not a number.
    Singular,
}

/// The last state of the iteration; a solution if `outcome` is `Settled`.
#[derive(Clone, Debug)]
pub struct NodalContact {
    pub outcome: ActiveSetOutcome,
    pub iterations: usize,
    pub active: Vec<bool>,
    /// Compression is positive.
    pub forces: Vec<f64>,
    /// Open is positive.
    pub gaps: Vec<f64>,
}

/// Solves the contact conditions for the normal `compliance` (row-major) of both bodies together.
pub fn solve_nodal_contact(compliance: &[f64], initial_gaps: &[f64], iteration_limit: usize) -> NodalContact {
    let touching = initial_gaps.iter().map(|&gap| gap <= 0.0).collect();
    solve_nodal_contact_from(touching, compliance, initial_gaps, iteration_limit)
}

/// The same from a guess of the active nodes.
pub fn solve_nodal_contact_from(
    active: Vec<bool>,
    compliance: &[f64],
    initial_gaps: &[f64],
    iteration_limit: usize,
) -> NodalContact {
    let count = initial_gaps.len();
    let closed = -GAP_ROUNDING * initial_gaps.iter().fold(0.0, |most: f64, gap| most.max(gap.abs()));
    let mut contact = NodalContact {
        outcome: ActiveSetOutcome::IterationLimit,
        iterations: 0,
        active,
        forces: vec![0.0; count],
        gaps: initial_gaps.to_vec(),
    };
    let mut seen = vec![contact.active.clone()];
    while contact.iterations < iteration_limit {
        contact.iterations += 1;
        let Some(forces) = closing_forces(compliance, initial_gaps, &contact.active) else {
            contact.outcome = ActiveSetOutcome::Singular;
            break;
        };
        contact.forces = forces;
        contact.gaps = gaps(compliance, initial_gaps, &contact.forces);
        let active: Vec<bool> = (0..count)
            .map(|i| if contact.active[i] { contact.forces[i] > 0.0 } else { contact.gaps[i] < closed })
            .collect();
        if active == contact.active {
            contact.outcome = ActiveSetOutcome::Settled;
            break;
        }
        if seen.contains(&active) {
            contact.outcome = ActiveSetOutcome::Cycled;
            break;
        }
        seen.push(active.clone());
        contact.active = active;
    }
    contact
}

/// Forces that close the gaps of the active nodes: C_AA f_A = -g0_A, f = 0 elsewhere.
fn closing_forces(compliance: &[f64], initial_gaps: &[f64], active: &[bool]) -> Option<Vec<f64>> {
    let count = initial_gaps.len();
    solved_among(active, |i, j| compliance[i * count + j], |i| -initial_gaps[i])
}

/// g = g0 + C f.
pub(super) fn gaps(compliance: &[f64], initial_gaps: &[f64], forces: &[f64]) -> Vec<f64> {
    let rows = compliance.chunks_exact(forces.len()).zip(initial_gaps);
    rows.map(|(row, gap)| gap + row.iter().zip(forces).map(|(c, f)| c * f).sum::<f64>()).collect()
}
