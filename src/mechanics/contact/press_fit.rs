//! The states of a press fit, dR < 0: closed all around until the load opens the contact at the far side.
//!
//! Pin and hole are paired where they are concentric. The overlap |dR| + e cos(phi) is pressed away wherever they touch,
//!
//! ```text
//!   u_pin[p] + u_plate[p] = e cos(phi) - dR,
//! ```
//!
//! which is the equation of the clearance (`edge`) with 1 - cos(phi) for both versines: x = 1 + |dR|/e, from 1, the neat fit that
//! every press fit is under ever larger loads, to the x at which the contact closes on the far side. Where it is closed no edge
//! moves. Modes of concentric bodies do not couple, so that with S, Q and D of the whole ring and lambda_n the compliance of both bodies
//! to cos(n phi)
//!
//! ```text
//!   p = |dR|/lambda_0 + e cos(phi)/lambda_1,   F = 2 Q e,   U = (pi/2)^2 dR^2/S + Q e^2,   S = pi lambda_0/4,   Q = pi/(2 lambda_1),
//! ```
//!
//! up to e = |dR| lambda_1/lambda_0, where the pressure ends at phi = pi.
//!
//! The stiffness of the open contact is the slope of the force along the curve, dF/de = F/e - (x - 1) (F/e)'/x', because that of a punch
//! (`edge`) is off by more: ten trial pressures give the force to 1e-9 and where its arc ends, on which a punch depends, to 1e-5.

use std::f64::consts::{FRAC_PI_2, PI};

use super::curve::ContactCurve;
use super::load::{DimensionlessLoad, NoState};
use super::reduced::Reduced;
use super::state::ContactState;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Steps of a difference, and the weights of values there.
const DIFFERENCES: [(f64, f64); 4] = [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)];

/// Over cos(eps/2).
const STEP: f64 = 1.0 / 32.0;

/// cos(eps/2) below which hardly anything has opened: the stiffness there is that of the punch to 1e-6, and differences between states that
/// hardly differ are rounding.
const LEAST_GAP: f64 = 0.003;

impl ContactCurve<'_> {
    /// The states under loads (> 0 but for press fits), each with the widest node that is not wider: what is known node by node holds between it
    /// and the next. Press fits are of concentric bodies, in a space of their own.
    pub fn states_of_fit(
        &self,
        loads: impl Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        if self.outlines.radial_clearance < 0.0 { self.press_fit_states(loads) } else { self.states(loads) }
    }

    fn press_fit_states(
        &self,
        loads: impl Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        let loads: Vec<DimensionlessLoad> = loads.collect();
        if self.first != 0 {
            return vec![Err(NoState::BrokenCompliance); loads.len()];
        }
        let overlap = -self.outlines.radial_clearance;
        // e/|dR| of a load, where F/e is known.
        let offset = |load: &DimensionlessLoad, force_per_offset: f64| match *load {
            DimensionlessLoad::Indentation(delta) => delta / overlap - 1.0,
            DimensionlessLoad::Offset(offset) => offset / overlap,
            DimensionlessLoad::Force(force) => force / force_per_offset / overlap,
        };
        let (opening, stiffness) = (self.opening(), 2.0 * self.whole_ring().work);
        let closed = |load: &DimensionlessLoad| Some(offset(load, stiffness)).filter(|own| *own <= opening);
        let mut opened = self.states(loads.iter().copied().filter(|load| closed(load).is_none())).into_iter();
        let state = |load: &DimensionlessLoad| match closed(load) {
            Some(offset) => Ok((self.closed_state(offset), 0)),
            None => {
                let (state, node) = opened.next().unwrap_or(Err(NoState::BrokenCompliance))?;
                let tangent_stiffness = self.slope(&state);
                let per_overlap = per_overlap(state, offset(load, state.force));
                Ok((ContactState { tangent_stiffness, ..per_overlap }, node))
            }
        };
        loads.iter().map(state).collect()
    }

    /// The e/|dR| at which the contact opens at the far side.
    pub fn opening(&self) -> f64 {
        1.0 / (self.states.indentation(0) - 1.0)
    }

    /// What the equations come to on the whole ring, the first node.
    fn whole_ring(&self) -> Reduced<f64> {
        Reduced::of_functions(self.states.functions(0).map(|values| values[0]))
    }

    /// Of the contact that is closed all around, at an e/|dR|.
    fn closed_state(&self, offset: f64) -> ContactState {
        let ring = self.whole_ring();
        let uniform = FRAC_PI_2 / ring.singular;
        ContactState {
            half_angle: PI,
            indentation: 1.0 + offset,
            force: 2.0 * ring.work * offset,
            tangent_stiffness: 2.0 * ring.work,
            energy: FRAC_PI_2 * uniform + ring.work * offset * offset,
            peak_pressure: 0.5 * (uniform * ring.peak - offset * ring.peak_of_versine),
            peak_angle: 0.0,
            truncation: 0.0,
            pressure_is_positive: true,
        }
    }

    /// dF/de of an open state of the curve, told per e: by differences of the fourth order over cos(eps/2).
    fn slope(&self, state: &ContactState) -> f64 {
        let gap = (0.5 * state.half_angle).cos();
        if gap < LEAST_GAP {
            return state.tangent_stiffness;
        }
        let mut places = Lanes::<false>::from_f64(self.space.place_of_gap(gap));
        for (place, step) in places.0.iter_mut().zip(DIFFERENCES) {
            *place = self.space.place_of_gap(gap * (1.0 + STEP * step.0));
        }
        let at = self.at(places);
        let (indentation, force) = at.reduced.load(at.b);
        let difference = |values: [f64; LANES]| -> f64 {
            values.iter().zip(DIFFERENCES).map(|(value, step)| step.1 * value).sum()
        };
        state.force - (state.indentation - 1.0) * difference(force.0) / difference(indentation.0)
    }

    /// Coefficients of the trial pressures of a state that is closed all around.
    pub(super) fn closed_coefficients(&self, state: &ContactState) -> Vec<f64> {
        let offset = state.indentation - 1.0;
        let terms = self.space.pressures.terms;
        let mut coefficients: Vec<f64> =
            (0..terms).map(|k| offset * self.states.coefficient(terms, 0, k)).collect();
        coefficients[0] = FRAC_PI_2 / self.whole_ring().singular;
        coefficients
    }
}

/// From a state per e to the same per |dR|, from its e/|dR|.
fn per_overlap(state: ContactState, offset: f64) -> ContactState {
    ContactState {
        indentation: 1.0 + offset,
        force: offset * state.force,
        energy: offset * offset * state.energy,
        peak_pressure: offset * state.peak_pressure,
        ..state
    }
}
