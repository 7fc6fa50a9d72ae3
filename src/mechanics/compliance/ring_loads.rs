//! Nodal loads of the trial pressures on a ring: f = integral of N n p_k d(phi), with the true normal n(phi), so that
//! a rigid translation does exactly the work of the pressure's resultant.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::arc::{ContactArc, cosines, packed_count};
use super::pressure_space::PressureSpace;
use super::{PressureCompliance, RingCompliance};
use crate::mechanics::element::quadrature::gauss_legendre;
use crate::mechanics::element::{ElementKind, side_functions};
use crate::mechanics::mesh::{RingTopology, SUPPORTED};

/// Loads of the trial pressures of one arc: `[ring node][component][k]`, for the nodes the arc reaches.
pub struct ArcLoads {
    pub node_count: usize,
    pub values: Vec<f64>,
}

/// Loads at every node of one pressure space on the rings met so far: bodies of many topologies have a ring in common.
#[derive(Default)]
pub struct RingLoads {
    made: Mutex<HashMap<(ElementKind, Vec<u64>), Made>>,
}

/// Made by who comes first; others wait for it.
type Made = Arc<OnceLock<Vec<ArcLoads>>>;

impl RingLoads {
    /// As `ring_loads`, always of the same `space`; `read` has them.
    pub fn with<T>(
        &self,
        space: &PressureSpace,
        element: ElementKind,
        ring_angles: &[f64],
        read: impl FnOnce(&[ArcLoads]) -> T,
    ) -> T {
        let ring = (element, ring_angles.iter().map(|angle| angle.to_bits()).collect());
        let made = self.made.lock().unwrap_or_else(PoisonError::into_inner).entry(ring).or_default().clone();
        read(made.get_or_init(|| ring_loads(space, element, ring_angles)))
    }
}

/// At every node of `space`, on a ring with nodes at `ring_angles` (mid-side nodes included).
pub fn ring_loads(space: &PressureSpace, element: ElementKind, ring_angles: &[f64]) -> Vec<ArcLoads> {
    let rule = load_rule(space.terms);
    space.arcs.iter().map(|arc| arc_loads(arc, space.terms, &rule, element, ring_angles)).collect()
}

/// Quadrature on each element: the integrand is smooth in tau, cos(2 k tau) asks for more points with more terms.
pub fn load_rule(terms: usize) -> Vec<(f64, f64)> {
    gauss_legendre(12 + terms)
}

/// On one arc, by `load_rule(terms)`.
pub fn arc_loads(
    arc: &ContactArc,
    terms: usize,
    rule: &[(f64, f64)],
    element: ElementKind,
    ring_angles: &[f64],
) -> ArcLoads {
    let side = element.side_node_count() - 1;
    let reached = ring_angles.iter().step_by(side).take_while(|angle| **angle < arc.half_angle).count();
    let elements = reached.min((ring_angles.len() - 1) / side);
    let node_count = elements * side + 1;
    let mut values = vec![0.0; node_count * 2 * terms];
    for element_index in 0..elements {
        let nodes = element_index * side;
        let (start, end) = (ring_angles[nodes], ring_angles[nodes + side]);
        let from = arc.tau(end.min(arc.half_angle));
        let to = if start == 0.0 { FRAC_PI_2 } else { arc.tau(start) };
        for &(x, weight) in rule {
            let tau = 0.5 * (from + to) + 0.5 * (to - from) * x;
            let weight = 0.5 * (to - from) * weight;
            let angle = arc.angle(tau);
            let (functions, count) = side_functions(element, (2.0 * angle - start - end) / (end - start));
            let normal = [angle.sin(), -angle.cos()];
            let trials = cosines((2.0 * tau).cos());
            for (node, function) in functions.iter().enumerate().take(count) {
                for (component, normal) in normal.iter().enumerate() {
                    let at = ((nodes + node) * 2 + component) * terms;
                    let scale = weight * function * normal;
                    values[at..at + terms].iter_mut().zip(&trials).for_each(|(f, t)| *f += scale * t);
                }
            }
        }
    }
    ArcLoads { node_count, values }
}

/// The compliance to the trial pressures, f^T C f at every arc, from that of a ring. The part -pi/2 c ln b of entry
/// (0, 0), which `PressureCompliance` leaves out, is still in; `amplitude` is c.
pub fn galerkin_compliance(
    ring: &RingCompliance,
    topology: &RingTopology,
    loads: &[ArcLoads],
    terms: usize,
    amplitude: f64,
) -> PressureCompliance {
    let mut values = Vec::with_capacity(loads.len() * packed_count(terms));
    for arc in loads {
        // Rows of the ring that the arc loads, with their loads.
        let mut rows: Vec<(usize, &[f64])> = Vec::with_capacity(2 * arc.node_count);
        for (place, load) in arc.values.chunks_exact(terms).enumerate() {
            let unknown = topology.unknowns[2 * topology.ring_nodes[place / 2] as usize + place % 2];
            if unknown != SUPPORTED {
                rows.push((unknown as usize - topology.ring_start, load));
            }
        }
        let mut matrix = vec![0.0; packed_count(terms)];
        let mut displacement = vec![0.0; terms];
        for &(row, load) in &rows {
            displacement.fill(0.0);
            for &(column, other) in &rows {
                let c = ring.values[row * ring.size + column];
                displacement.iter_mut().zip(other).for_each(|(u, f)| *u += c * f);
            }
            let mut entries = matrix.iter_mut();
            for (j, f) in load.iter().enumerate() {
                displacement[..=j].iter().zip(&mut entries).for_each(|(u, entry)| *entry += f * u);
            }
        }
        values.extend(matrix);
    }
    PressureCompliance { terms, amplitude, bed: 0.0, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rigid translation along y does the work of the vertical resultant, pi/2 delta_k0 - versine.
    #[test]
    fn translation_does_the_work_of_the_resultant() {
        let space = PressureSpace::new(6, 1.5);
        let angles: Vec<f64> = (0..=16).map(|i| i as f64 * 0.11).collect();
        for element in [ElementKind::Quad4, ElementKind::Quad8] {
            let all = ring_loads(&space, element, &angles);
            assert_eq!(all.len(), space.arcs.len());
            for (arc, loads) in space.arcs.iter().zip(all) {
                let versines: [f64; 6] = ContactArc::versines(arc.b);
                for (k, versine) in versines.iter().enumerate() {
                    let work: f64 =
                        (0..loads.node_count).map(|node| -loads.values[(node * 2 + 1) * 6 + k]).sum();
                    let resultant = ContactArc::resultant(k) - versine;
                    // Rounding of the sum.
                    assert!((work - resultant).abs() < 1e-13, "{element:?} k = {k}: {work} {resultant}");
                }
            }
        }
    }
}
