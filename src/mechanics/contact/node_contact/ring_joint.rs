//! Pin and plate condensed to the nodes of their rings: what contact node by node starts from, and what is read from its
//! forces.
//!
//! Nodal forces are work-equivalent to a pressure, f_i = integral of N_i p, so a node stands for the length
//! w_i = integral of N_i along the ring, and the pressure that belongs to forces is that of M p = f with the boundary's
//! mass matrix M_ij = integral of N_i N_j. Equation (34) of docs/theory.md.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::mechanics::compliance::RingCompliance;
use crate::mechanics::element::ElementKind;
use crate::mechanics::mesh::{RingTopology, SUPPORTED};

/// Displacement of each ring node along n = (sin phi, -cos phi), away from the centre, per force along n on each;
/// row-major. Supported components do not move. `angles` are those of n, of as many nodes as are asked for.
pub fn normal_compliance(compliance: &RingCompliance, topology: &RingTopology, angles: &[f64]) -> Vec<f64> {
    let normals: Vec<Vec<(usize, f64)>> = topology
        .ring_nodes
        .iter()
        .zip(angles)
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

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("ring node {node} is at {pin} rad on the pin, which does not meet {plate} rad on the plate")]
pub struct RingsDiffer {
    pub node: usize,
    pub pin: f64,
    pub plate: f64,
}

/// The nodes at which a pin and a plate can touch, of the half that is modelled, per unit thickness. Lengths are in any
/// unit, forces in that unit times the unit of the moduli.
#[derive(Clone, Debug)]
pub struct RingJoint {
    pub element: ElementKind,
    /// dR/R2.
    clearance_ratio: f64,
    /// Angles of the nodes on the hole, from the load line, rad.
    pub angles: Vec<f64>,
    /// C = C_pin/E1 + C_plate/E2, along the hole's normals, row-major.
    pub compliance: Vec<f64>,
}

/// Over the clearance ratio, rad, on the coarsest sides.
const BEND: f64 = 0.1;

/// The angle of a hole that meets one of the pin, on its ray, at a clearance ratio: nothing is expanded.
pub fn angle_on_hole(of_pin: f64, clearance_ratio: f64) -> f64 {
    let pin_radius = 1.0 - clearance_ratio;
    (pin_radius * of_pin.sin()).atan2(clearance_ratio + pin_radius * of_pin.cos())
}

impl RingJoint {
    /// Of rings whose nodes meet at a clearance ratio dR/R2, as far as the shorter one goes.
    pub fn new(
        pin: RingBody<'_>,
        plate: RingBody<'_>,
        clearance_ratio: f64,
    ) -> Result<RingJoint, RingsDiffer> {
        let pairs = || pin.topology.ring_angles.iter().zip(&plate.topology.ring_angles);
        // Nodes amid a side meet but for the bend of the map.
        let apart = 1e-12 + BEND * clearance_ratio;
        let meet = |pin: f64, plate: f64| (angle_on_hole(pin, clearance_ratio) - plate).abs() <= apart;
        if let Some((node, (&pin, &plate))) =
            pairs().enumerate().find(|(_, (pin, plate))| !meet(**pin, **plate))
        {
            return Err(RingsDiffer { node, pin, plate });
        }
        let angles: Vec<f64> = pairs().map(|(_, &angle)| angle).collect();
        let count = angles.len();
        let pin_compliance = normal_compliance(pin.compliance, pin.topology, &angles);
        let plate_compliance = normal_compliance(plate.compliance, plate.topology, &angles);
        let mut compliance = Vec::with_capacity(count * count);
        for i in 0..count {
            for j in 0..count {
                compliance.push(
                    pin_compliance[i * count + j] / pin.youngs_modulus
                        + plate_compliance[i * count + j] / plate.youngs_modulus,
                );
            }
        }
        Ok(RingJoint { element: pin.topology.element, clearance_ratio, angles, compliance })
    }

    /// g0 = dR (1 - cos phi) + R1 (1 - cos alpha) - delta cos phi, R1 sin(alpha) = dR sin(phi), without the difference of nearly
    /// equal numbers.
    pub fn initial_gaps(&self, radial_clearance: f64, indentation: f64) -> Vec<f64> {
        let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
        // dR/R1.
        let ratio = self.clearance_ratio / (1.0 - self.clearance_ratio);
        let gap = |angle: &f64| {
            let tilt = (ratio * angle.sin()).asin();
            let bent = if ratio > 0.0 { versine(tilt) / ratio } else { 0.0 };
            radial_clearance * (versine(*angle) + bent) - indentation * angle.cos()
        };
        self.angles.iter().map(gap).collect()
    }

    /// w_i, over the ring's radius: what a node stands for. They add up to the ring's length.
    pub fn lengths(&self) -> Vec<f64> {
        let mut lengths = vec![0.0; self.angles.len()];
        let shares: &[f64] = match self.element {
            ElementKind::Quad4 => &[1.0 / 2.0, 1.0 / 2.0],
            ElementKind::Quad8 => &[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
        };
        for (first, length) in self.sides() {
            for (node, share) in shares.iter().enumerate() {
                lengths[first + node] += share * length;
            }
        }
        lengths
    }

    /// Length of the sides that meet at each node, in the mean, over the ring's radius: h of a penalty in E*/h.
    pub fn side_lengths(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.angles.len()];
        for (first, length) in self.sides() {
            for (sum, count) in &mut sums[first..first + self.element.side_node_count()] {
                *sum += length;
                *count += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| sum / count).collect()
    }

    /// F = 2 sum f_i cos phi_i, of both halves.
    pub fn force(&self, forces: &[f64]) -> f64 {
        2.0 * forces.iter().zip(&self.angles).map(|(force, angle)| force * angle.cos()).sum::<f64>()
    }

    /// Angle of the last node that touches, rad; 0 without contact. Measured against fine meshes it is free of bias,
    /// a quarter of a node's spacing off (rms); the point half-way to the next node would be half a spacing beyond.
    pub fn contact_half_angle(&self, active: &[bool]) -> f64 {
        active.iter().rposition(|&active| active).map_or(0.0, |last| self.angles[last])
    }

    /// dF/d delta of both halves while the `active` nodes stay: 2 c.(C_AA + S_A)^-1 c with c = cos phi, since
    /// dg0/d delta = -c. `springs` are what a penalty adds to the diagonal of C; `None` where C_AA + S_A is not positive
    /// definite.
    pub fn tangent_stiffness(&self, active: &[bool], springs: Option<&[f64]>) -> Option<f64> {
        let count = self.angles.len();
        let spring = |node: usize| springs.map_or(0.0, |springs| springs[node]);
        let matrix =
            |i: usize, j: usize| self.compliance[i * count + j] + if i == j { spring(i) } else { 0.0 };
        Some(self.force(&solved_among(active, matrix, |i| self.angles[i].cos())?))
    }

    /// Contact pressure at the load line times the ring's radius: that of M_AA p_A = f_A over the `active` nodes, which
    /// is zero at all others. `None` where there is no contact there.
    pub fn peak_pressure(&self, active: &[bool], forces: &[f64]) -> Option<f64> {
        let (mass, count) = (self.mass(), self.angles.len());
        let pressures = solved_among(active, |i, j| mass[i * count + j], |i| forces[i])?;
        active.first()?.then_some(pressures[0])
    }

    /// M over the ring's radius, row-major.
    fn mass(&self) -> Vec<f64> {
        let count = self.angles.len();
        let mut mass = vec![0.0; count * count];
        // Integrals of N_i N_j over a side of length 1.
        let (size, shares): (usize, &[f64]) = match self.element {
            ElementKind::Quad4 => (2, &[2.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 2.0 / 6.0]),
            ElementKind::Quad8 => {
                const A: f64 = 1.0 / 30.0;
                (3, &[4.0 * A, 2.0 * A, -A, 2.0 * A, 16.0 * A, 2.0 * A, -A, 2.0 * A, 4.0 * A])
            }
        };
        for (first, length) in self.sides() {
            for i in 0..size {
                for j in 0..size {
                    mass[(first + i) * count + first + j] += length * shares[i * size + j];
                }
            }
        }
        mass
    }

    /// First node and length of each side of an element on the ring.
    fn sides(&self) -> impl Iterator<Item = (usize, f64)> {
        let step = self.element.side_node_count() - 1;
        let firsts = (0..self.angles.len().saturating_sub(step)).step_by(step);
        firsts.map(move |first| (first, self.angles[first + step] - self.angles[first]))
    }
}

/// x of A x = b over the active nodes alone, 0 at the others; `None` where A is not positive definite among them, or x no number.
pub(super) fn solved_among(
    active: &[bool],
    matrix: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
) -> Option<Vec<f64>> {
    let nodes: Vec<usize> = (0..active.len()).filter(|&node| active[node]).collect();
    let mut solution = vec![0.0; active.len()];
    if !nodes.is_empty() {
        let matrix = Mat::from_fn(nodes.len(), nodes.len(), |i, j| matrix(nodes[i], nodes[j]));
        let among = matrix.llt(Side::Lower).ok()?.solve(Mat::from_fn(nodes.len(), 1, |i, _| right(nodes[i])));
        nodes.iter().enumerate().for_each(|(i, &node)| solution[node] = among[(i, 0)]);
    }
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}
