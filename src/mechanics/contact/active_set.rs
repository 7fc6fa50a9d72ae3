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

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::mechanics::compliance::RingCompliance;
use crate::mechanics::mesh::{RingTopology, SUPPORTED};

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
    let count = initial_gaps.len();
    let closed = -GAP_ROUNDING * initial_gaps.iter().fold(0.0, |most: f64, gap| most.max(gap.abs()));
    let mut contact = NodalContact {
        outcome: ActiveSetOutcome::IterationLimit,
        iterations: 0,
        active: initial_gaps.iter().map(|&gap| gap <= 0.0).collect(),
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
    let nodes: Vec<usize> = (0..count).filter(|&i| active[i]).collect();
    let mut forces = vec![0.0; count];
    if nodes.is_empty() {
        return Some(forces);
    }
    let matrix = Mat::from_fn(nodes.len(), nodes.len(), |i, j| compliance[nodes[i] * count + nodes[j]]);
    let gaps = Mat::from_fn(nodes.len(), 1, |i, _| -initial_gaps[nodes[i]]);
    let solution = matrix.llt(Side::Lower).ok()?.solve(&gaps);
    for (i, &node) in nodes.iter().enumerate() {
        forces[node] = solution[(i, 0)];
    }
    forces.iter().all(|force| force.is_finite()).then_some(forces)
}

/// g = g0 + C f.
fn gaps(compliance: &[f64], initial_gaps: &[f64], forces: &[f64]) -> Vec<f64> {
    let rows = compliance.chunks_exact(forces.len()).zip(initial_gaps);
    rows.map(|(row, gap)| gap + row.iter().zip(forces).map(|(c, f)| c * f).sum::<f64>()).collect()
}

/// Displacement of each ring node along n = (sin phi, -cos phi), away from the centre, per force along n on each;
/// row-major. Supported components do not move.
pub fn normal_compliance(compliance: &RingCompliance, topology: &RingTopology) -> Vec<f64> {
    let normals: Vec<Vec<(usize, f64)>> = topology
        .ring_nodes
        .iter()
        .zip(&topology.ring_angles)
        .map(|(&node, angle)| {
            let components = [(0, angle.sin()), (1, -angle.cos())];
            let place = |(component, share)| match topology.unknowns[2 * node as usize + component] {
                SUPPORTED => None,
                unknown => Some((unknown as usize - topology.ring_start, share)),
            };
            components.into_iter().filter_map(place).collect()
        })
        .collect();
    let mut normal = Vec::with_capacity(normals.len() * normals.len());
    for row in &normals {
        for column in &normals {
            let mut sum = 0.0;
            for &(i, a) in row {
                for &(j, b) in column {
                    sum += a * b * compliance.values[i * compliance.size + j];
                }
            }
            normal.push(sum);
        }
    }
    normal
}

/// One half of a joint: its condensed ring for Young's modulus 1, and its Young's modulus.
#[derive(Clone, Copy, Debug)]
pub struct RingBody<'a> {
    pub topology: &'a RingTopology,
    pub compliance: &'a RingCompliance,
    pub youngs_modulus: f64,
}

/// Contact of a joint per unit thickness. Lengths are in the unit of clearance and indentation, forces in that of
/// length times Young's modulus.
#[derive(Clone, Debug)]
pub struct RingContact {
    /// Angles of the nodes that can touch, from the load line, rad.
    pub angles: Vec<f64>,
    /// Of the half that is modelled: the node at the load line carries half of what it does in the whole joint.
    pub nodal: NodalContact,
    /// F = 2 sum f_i cos phi_i, of both halves.
    pub force: f64,
    /// Angle of the last node that touches, rad; 0 without contact. Measured against fine meshes it is free of bias,
    /// a quarter of a node's spacing off (rms); the point half-way to the next node would be half a spacing beyond.
    pub contact_half_angle: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("ring node {node} is at {pin} rad on the pin, {plate} rad on the plate")]
pub struct RingsDiffer {
    pub node: usize,
    pub pin: f64,
    pub plate: f64,
}

/// Presses `pin` into `plate` by `indentation` after first touch. Their rings share their nodes' angles, as far as
/// the shorter one goes.
pub fn ring_contact(
    pin: RingBody<'_>,
    plate: RingBody<'_>,
    radial_clearance: f64,
    indentation: f64,
    iteration_limit: usize,
) -> Result<RingContact, RingsDiffer> {
    let pairs = || pin.topology.ring_angles.iter().zip(&plate.topology.ring_angles);
    if let Some((node, (&pin, &plate))) = pairs().enumerate().find(|(_, (a, b))| (*a - *b).abs() > 1e-12) {
        return Err(RingsDiffer { node, pin, plate });
    }
    let angles: Vec<f64> = pairs().map(|(&angle, _)| angle).collect();
    let (pin_count, plate_count) = (pin.topology.ring_nodes.len(), plate.topology.ring_nodes.len());
    let pin_compliance = normal_compliance(pin.compliance, pin.topology);
    let plate_compliance = normal_compliance(plate.compliance, plate.topology);
    let mut compliance = Vec::with_capacity(angles.len() * angles.len());
    for i in 0..angles.len() {
        for j in 0..angles.len() {
            compliance.push(
                pin_compliance[i * pin_count + j] / pin.youngs_modulus
                    + plate_compliance[i * plate_count + j] / plate.youngs_modulus,
            );
        }
    }
    // dR - (dR + delta) cos phi without the difference of nearly equal numbers.
    let initial_gap =
        |angle: &f64| 2.0 * radial_clearance * (0.5 * angle).sin().powi(2) - indentation * angle.cos();
    let initial_gaps: Vec<f64> = angles.iter().map(initial_gap).collect();
    let nodal = solve_nodal_contact(&compliance, &initial_gaps, iteration_limit);
    let force = 2.0 * nodal.forces.iter().zip(&angles).map(|(force, angle)| force * angle.cos()).sum::<f64>();
    let contact_half_angle = nodal.active.iter().rposition(|&active| active).map_or(0.0, |last| angles[last]);
    Ok(RingContact { angles, nodal, force, contact_half_angle })
}
