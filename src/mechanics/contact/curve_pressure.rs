//! The contact pressure of a state of a curve.

use super::arc_pressure::ArcPressure;
use super::curve::ContactCurve;
use super::state::ContactState;
use crate::mechanics::real::{Lanes, Real};
use crate::mechanics::registers::ANY;

/// Nodes around a state that its trial pressures are interpolated between.
const AROUND: usize = 6;

impl ContactCurve<'_> {
    /// Of a state of this curve, with the node at or above it.
    pub fn pressure(&self, state: &ContactState, above: usize) -> ArcPressure {
        let map = self.space.map();
        if state.on_whole_ring {
            // A state that was found has a pressure; a table would tell what is no number.
            return self.pressure_of_ring(state).unwrap_or(ArcPressure::of_whole_ring(vec![f64::NAN]));
        }
        let b = map.of_half(state.half_angle);
        let wanted = self.space.place(Lanes::<ANY>::from_f64(self.outlines.ratio() * b)).0[0];
        let count = self.space.arcs().len();
        let from = (above + 1).saturating_sub(AROUND / 2).max(self.first).min(count.saturating_sub(AROUND));
        let nodes = from..(from + AROUND).min(count);
        let weight = |node: usize| -> f64 {
            let place = |node: usize| self.space.weighted[node].0;
            let others = || nodes.clone().filter(|other| *other != node).map(place);
            let distances = |from: f64| others().map(|other| from - other).product::<f64>();
            distances(wanted) / distances(place(node))
        };
        let terms = self.space.pressures.terms;
        let mut coefficients = vec![0.0; terms];
        for node in nodes.clone() {
            let weight = weight(node);
            for (k, sum) in coefficients.iter_mut().enumerate() {
                *sum += weight * self.states.coefficient(terms, node, k);
            }
        }
        // What interpolation leaves is taken out at the load line, where the pressure is known.
        ArcPressure::with_peak(map, b, coefficients, state.peak_pressure)
    }

    /// A state with its greatest pressure, which a stiff layer on a soft one has beside the load line. What the whole ring tells has it.
    pub fn peaked(&self, state: ContactState, above: usize) -> ContactState {
        if state.on_whole_ring {
            return state;
        }
        let (peak_angle, peak_pressure) = self.pressure(&state, above).greatest();
        ContactState { peak_angle, peak_pressure, ..state }
    }
}
