//! Contact with a moving edge: the state of a joint as a function of its contact half angle.
//!
//! With the pin's centre e = dR + delta off the hole's, the pressure on |phi| < eps closes the gap,
//!
//! ```text
//!   u_pin[p] + u_plate[p] = e cos(phi) - dR = delta - e (1 - cos phi),
//! ```
//!
//! in the weak sense: integral of p_j times both sides, for every trial pressure. The system is linear in e and delta,
//! so with a_1, a_v the solutions for the right-hand sides 1 and 1 - cos phi the pressure is delta a_1 - e a_v, and
//! the edge is free of singularity where delta sum(a_1) = e sum(a_v). Hence, without iteration, delta/e and F/e as
//! functions of eps. The stiffness is that of a punch that keeps its arc: dF/d delta = integral of (a_1 - a_v) cos phi,
//! because the pressure at a free edge does not change to first order as the edge moves (Barber, Contact Mechanics,
//! section 9.3; Mossakovskii 1963).

use std::f64::consts::FRAC_PI_2;

use crate::mechanics::compliance::pressure_space::{
    ContactArc, MAX_TERMS, PressureSpace, packed, packed_count,
};
use crate::mechanics::compliance::{NODE_COUNT, PressureCompliance};

/// Tension that truncation may leave at the edge, over the peak pressure.
const TENSION: f64 = 0.01;

/// The compliance of both bodies of a joint to the trial pressures of a space.
pub struct JointCompliance<'a> {
    space: &'a PressureSpace,
    terms: usize,
    amplitude: f64,
    /// `[node][packed lower triangle]`.
    values: Vec<f64>,
}

/// The joint at one contact half angle, whole joint (both halves), per unit thickness, hole radius 1, and per unit of
/// the centres' offset e; forces in the unit of the moduli.
#[derive(Clone, Copy, Debug)]
pub struct ArcState {
    pub arc: ContactArc,
    /// delta/e: 0 without load, 1 for a neat fit.
    pub indentation: f64,
    /// F/e.
    pub force: f64,
    /// dF/d delta.
    pub tangent_stiffness: f64,
    /// Strain energy of both bodies over e^2.
    pub energy: f64,
    terms: usize,
    /// Coefficients of the trial pressures over e.
    pressure: [f64; MAX_TERMS],
}

impl<'a> JointCompliance<'a> {
    /// Of a pin and a plate with their Young's moduli (one unit). Both compliances belong to `space`, whose terms they
    /// may exceed.
    pub fn new(
        space: &'a PressureSpace,
        (pin, pin_modulus): (&PressureCompliance, f64),
        (plate, plate_modulus): (&PressureCompliance, f64),
    ) -> JointCompliance<'a> {
        let terms = space.terms.min(pin.terms).min(plate.terms);
        let entries = packed_count(terms);
        let rows = |body: &PressureCompliance| packed_count(body.terms);
        let mut values = Vec::with_capacity(NODE_COUNT * entries);
        for node in 0..NODE_COUNT {
            let pin = &pin.values[node * rows(pin)..][..entries];
            let plate = &plate.values[node * rows(plate)..][..entries];
            values
                .extend(pin.iter().zip(plate).map(|(pin, plate)| pin / pin_modulus + plate / plate_modulus));
        }
        let amplitude = pin.amplitude / pin_modulus + plate.amplitude / plate_modulus;
        JointCompliance { space, terms, amplitude, values }
    }

    pub fn limit(&self) -> f64 {
        self.space.limit
    }

    /// At the half angles of the space's nodes, descending.
    pub fn at_node(&self, node: usize) -> Option<ArcState> {
        let entries = packed_count(self.terms);
        let mut matrix = [0.0; packed_count(MAX_TERMS)];
        matrix[..entries].copy_from_slice(&self.values[node * entries..][..entries]);
        self.solve(self.space.arcs[node], matrix)
    }

    /// At a contact half angle in (0, limit]. `None` where the compliance is not positive definite, which says that
    /// the discretisation has broken down.
    pub fn at(&self, half_angle: f64) -> Option<ArcState> {
        let entries = packed_count(self.terms);
        let mut matrix = [0.0; packed_count(MAX_TERMS)];
        for (weight, row) in
            self.space.interpolation(half_angle).iter().zip(self.values.chunks_exact(entries))
        {
            matrix[..entries].iter_mut().zip(row).for_each(|(entry, value)| *entry += weight * value);
        }
        self.solve(ContactArc::new(half_angle), matrix)
    }

    fn solve(&self, arc: ContactArc, mut matrix: [f64; packed_count(MAX_TERMS)]) -> Option<ArcState> {
        let terms = self.terms;
        matrix[0] -= FRAC_PI_2 * self.amplitude * arc.b.ln();
        // Right-hand sides 1 and 1 - cos phi, solved together by Cholesky in place.
        let mut one = [0.0; MAX_TERMS];
        let mut versine = [0.0; MAX_TERMS];
        for k in 0..terms {
            one[k] = ContactArc::resultant(k);
            versine[k] = arc.versine(k);
        }
        let (load_one, load_versine) = (one, versine);
        for row in 0..terms {
            for column in 0..=row {
                let dot: f64 = (0..column).map(|k| matrix[packed(row, k)] * matrix[packed(column, k)]).sum();
                let value = matrix[packed(row, column)] - dot;
                if column < row {
                    matrix[packed(row, column)] = value / matrix[packed(column, column)];
                } else if value > 0.0 {
                    matrix[packed(row, row)] = value.sqrt();
                } else {
                    return None;
                }
            }
            for right in [&mut one, &mut versine] {
                let known: f64 = (0..row).map(|k| matrix[packed(row, k)] * right[k]).sum();
                right[row] = (right[row] - known) / matrix[packed(row, row)];
            }
        }
        for row in (0..terms).rev() {
            for right in [&mut one, &mut versine] {
                let known: f64 = (row + 1..terms).map(|k| matrix[packed(k, row)] * right[k]).sum();
                right[row] = (right[row] - known) / matrix[packed(row, row)];
            }
        }
        let sum = |values: &[f64; MAX_TERMS]| values[..terms].iter().sum::<f64>();
        let indentation = sum(&versine) / sum(&one);
        let mut state = ArcState {
            arc,
            indentation,
            force: 0.0,
            tangent_stiffness: 0.0,
            energy: 0.0,
            terms,
            pressure: [0.0; MAX_TERMS],
        };
        for k in 0..terms {
            let pressure = indentation * one[k] - versine[k];
            let cosine = load_one[k] - load_versine[k];
            state.pressure[k] = pressure;
            state.force += 2.0 * pressure * cosine;
            state.tangent_stiffness += 2.0 * (one[k] - versine[k]) * cosine;
            state.energy += pressure * (indentation * load_one[k] - load_versine[k]);
        }
        Some(state)
    }
}

impl JointCompliance<'_> {
    /// Share by which a change of one body's compliance (`values` as in `PressureCompliance`, of `terms` terms, over the
    /// body's modulus) changes the work of the state's pressure: to first order the relative change of the force, since
    /// the work is stationary in the pressure.
    pub fn relative_change(&self, state: &ArcState, terms: usize, values: &[f64]) -> f64 {
        let entries = packed_count(terms);
        let weights = self.space.interpolation(state.arc.half_angle);
        let mut matrix = [0.0; packed_count(MAX_TERMS)];
        for (weight, row) in weights.iter().zip(values.chunks_exact(entries)) {
            matrix[..entries].iter_mut().zip(row).for_each(|(entry, value)| *entry += weight * value);
        }
        let mut work = 0.0;
        for j in 0..terms.min(self.terms) {
            let below: f64 = (0..j).map(|k| matrix[packed(j, k)] * state.pressure[k]).sum();
            work += state.pressure[j] * (2.0 * below + matrix[packed(j, j)] * state.pressure[j]);
        }
        work / state.energy
    }
}

impl ArcState {
    /// The last two trial pressures over the largest, squared: of that order is what leaving out further ones costs in
    /// the force.
    pub fn truncation(&self) -> f64 {
        let tail = self.pressure[self.terms - 2..self.terms].iter().map(|c| c.abs()).sum::<f64>();
        let most = self.pressure[..self.terms].iter().fold(f64::MIN_POSITIVE, |most, c| most.max(c.abs()));
        (tail / most).powi(2)
    }

    /// dR/e; negative beyond the angle of a neat fit, where no clearance reaches.
    pub fn clearance(&self) -> f64 {
        1.0 - self.indentation
    }

    /// Contact pressure over e at the load line.
    pub fn peak_pressure(&self) -> f64 {
        let alternating =
            |sum: f64, (k, value): (usize, &f64)| if k % 2 == 0 { sum + value } else { sum - value };
        self.pressure[..self.terms].iter().enumerate().fold(0.0, alternating) / (2.0 * self.arc.b)
    }

    /// Whether there is no tension: looked at between the zeros of the highest trial pressure.
    pub fn pressure_is_positive(&self) -> bool {
        let count = 2 * self.terms;
        let least = -TENSION * self.peak_pressure().abs();
        (1..=count).all(|i| self.pressure_at(FRAC_PI_2 * i as f64 / count as f64) >= least)
    }

    /// Contact pressure over e at tau, 0 < tau <= pi/2; phi = `arc.angle(tau)`.
    pub fn pressure_at(&self, tau: f64) -> f64 {
        let series: f64 = self.pressure[..self.terms]
            .iter()
            .enumerate()
            .map(|(k, c)| c * (2.0 * k as f64 * tau).cos())
            .sum();
        let s = self.arc.b * tau.cos();
        series * (1.0 + s * s) / (2.0 * self.arc.b * tau.sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::series::ConcentricBody;
    use crate::mechanics::material::Idealization;

    /// Persson's table (Ciavarella & Decuzzi 2001): similar materials, the plate of ratio 1e4, a core of 1e-3.
    #[test]
    fn persson() {
        let space = PressureSpace::new(10, 1.9);
        let highest = 40;
        let moments = space.moments(highest);
        let body = |fixed_radius| ConcentricBody {
            fixed_radius,
            poissons_ratio: 0.3,
            idealization: Idealization::PlaneStress,
        };
        let plate = body(1e4).compliance(&space, &moments, highest);
        let pin = body(1e-3).compliance(&space, &moments, highest);
        let joint = JointCompliance::new(&space, (&pin, 1.0), (&plate, 1.0));
        let table = [
            (5.0, 166.503, 7.30208),
            (10.0, 41.1103, 3.66156),
            (20.0, 9.76763, 1.85239),
            (30.0, 3.97177, 1.26029),
            (45.0, 1.41156, 0.882111),
            (60.0, 0.533601, 0.711721),
            (80.0, 0.0630728, 0.611608),
        ];
        for (degrees, clearance, peak) in table {
            let state = joint.at(f64::to_radians(degrees)).unwrap();
            let inverse_force = 0.5 * state.clearance() / state.force;
            let peak_pressure = state.peak_pressure() / state.force;
            println!("{degrees}: {} {}", inverse_force / clearance - 1.0, peak_pressure / peak - 1.0);
        }
    }
}
