//! The contact pressure along the arc of a state.

use super::curve::ContactCurve;
use super::state::ContactState;
use crate::mechanics::real::{Lanes, Real};

/// Nodes around a state that its trial pressures are interpolated between.
const AROUND: usize = 6;

/// The pressure of one state.
pub struct ArcPressure {
    /// tan(eps/2) of the hole.
    b: f64,
    /// Coefficients of the trial pressures; their sum is zero.
    coefficients: Vec<f64>,
}

impl ContactCurve<'_> {
    /// Of a state of this curve, with the node at or above it.
    pub fn pressure(&self, state: &ContactState, above: usize) -> ArcPressure {
        let b = (0.5 * state.half_angle).tan();
        let place_of = |b: f64| self.space.place(Lanes::<false>::from_f64(b)).0[0];
        let wanted = place_of(self.outlines.ratio() * b);
        let count = self.space.arcs().len();
        let from = (above + 1).saturating_sub(AROUND / 2).max(self.first).min(count.saturating_sub(AROUND));
        let nodes = from..(from + AROUND).min(count);
        let place = |node: usize| place_of(self.space.arcs()[node].b);
        let weight = |node: usize| -> f64 {
            let others = nodes.clone().filter(|other| *other != node);
            others.map(|other| (wanted - place(other)) / (place(node) - place(other))).product()
        };
        let terms = self.space.pressures.terms;
        let mut coefficients = vec![0.0; terms];
        for node in nodes.clone() {
            let weight = weight(node);
            for (k, sum) in coefficients.iter_mut().enumerate() {
                *sum += weight * self.states.coefficient(terms, node, k);
            }
        }
        let mut pressure = ArcPressure { b, coefficients };
        // What interpolation leaves is taken out at the load line, where the pressure is known.
        let scale = state.peak_pressure / pressure.at(0.0);
        pressure.coefficients.iter_mut().for_each(|value| *value *= scale);
        pressure
    }
}

impl ArcPressure {
    /// Over e, in the unit of the moduli, per area of the hole, at an angle of the hole from the load line, rad; zero beyond
    /// the arc.
    ///
    /// p d(phi) = sum of c_k cos(2 k tau) d(tau) with cos(tau) = tan(phi/2)/b. The c_k sum to zero, so that
    /// sum of c_k cos(2 k tau) = -2 sum of c_k sin(k tau)^2, which is free of the singularity at the edge.
    pub fn at(&self, angle: f64) -> f64 {
        let cosine = (0.5 * angle).tan().abs() / self.b;
        if cosine >= 1.0 {
            return 0.0;
        }
        let tau = cosine.acos();
        let sine = tau.sin();
        let term = |(k, value): (usize, &f64)| value * (k as f64 * tau).sin().powi(2);
        let sum: f64 = self.coefficients.iter().enumerate().map(term).sum();
        -sum / sine * (1.0 + (self.b * cosine).powi(2)) / self.b
    }
}
