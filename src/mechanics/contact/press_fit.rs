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
//! moves, and everything is linear in |dR| and e. With S, V, Q and y of the whole ring and a = pi/2 - V,
//!
//! ```text
//!   p_0 = W,    p' = -W y - e w_v,    W = (pi/2 |dR| + a e)/S,
//!   F = 2 [pi/2 a/S |dR| + (a^2/S + Q) e],     U = (pi/2)^2/S dR^2 + pi a/S |dR| e + (a^2/S + Q) e^2.
//! ```
//!
//! A body that is not concentric is pushed aside by the overlap alone: F is zero at a certain e, where the joint is at rest. The
//! offset of a press fit is counted from there. Modes of concentric bodies do not couple: a is zero, at rest they are concentric, and
//! with the compliance lambda_n of both bodies to cos(n phi) it is S = pi lambda_0/4, Q = pi/(2 lambda_1),
//!
//! ```text
//!   p = |dR|/lambda_0 + e cos(phi)/lambda_1,     up to e = |dR| lambda_1/lambda_0,
//! ```
//!
//! where the pressure ends at phi = pi. Of other bodies it may end elsewhere first. Then the contact is two arcs until it is one again: there
//! is no state between.
//!
//! The stiffness of the open contact is the slope of the force along the curve, dF/de = F/e - (x - 1) (F/e)'/x', because that of a punch
//! (`edge`) is off by more: ten trial pressures give the force to 1e-9 and where its arc ends, on which a punch depends, to 1e-5.

use std::f64::consts::{FRAC_PI_2, PI};

use super::arc_pressure::ArcPressure;
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
    /// and the next. Press fits have a space of their own.
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
        let overlap = -self.outlines.radial_clearance;
        let ring = WholeRing::of(self);
        let (opening, rest) = (self.opening(), ring.rest());
        // e/|dR| from where the joint is at rest.
        let offset = |load: &DimensionlessLoad| match *load {
            DimensionlessLoad::Indentation(delta) => delta / overlap - 1.0,
            DimensionlessLoad::Offset(offset) => offset / overlap,
            DimensionlessLoad::Force(force) => force / ring.stiffness() / overlap,
        };
        let closed = |load: &DimensionlessLoad| Some(offset(load)).filter(|own| *own <= opening);
        // From where pin and hole are concentric.
        let from_concentric = |load: &DimensionlessLoad| match *load {
            DimensionlessLoad::Indentation(delta) => DimensionlessLoad::Indentation(delta + rest * overlap),
            DimensionlessLoad::Offset(offset) => DimensionlessLoad::Offset(offset + rest * overlap),
            DimensionlessLoad::Force(force) => DimensionlessLoad::Force(force),
        };
        let open = loads.iter().filter(|load| closed(load).is_none()).map(from_concentric);
        let mut opened = self.states(open).into_iter();
        let state = |load: &DimensionlessLoad| match closed(load) {
            Some(offset) => Ok((self.closed_state(&ring, offset), 0)),
            None => {
                let (state, node) = match opened.next() {
                    // Wider than one arc that grows with the load.
                    Some(Err(NoState::ContactTooWide)) => Err(NoState::OpensAside),
                    found => found.unwrap_or(Err(NoState::BrokenCompliance)),
                }?;
                let tangent_stiffness = self.slope(&state);
                let offset = match *load {
                    DimensionlessLoad::Force(force) => force / state.force / overlap - rest,
                    _ => offset(load),
                };
                Ok((ContactState { tangent_stiffness, ..per_overlap(state, offset, rest) }, node))
            }
        };
        loads.iter().map(state).collect()
    }

    /// The e/|dR| up to which the contact is closed all around, from where the joint is at rest; below zero where it is open there.
    pub fn opening(&self) -> f64 {
        let ring = WholeRing::of(self);
        let at_far_side = 1.0 / (self.states.indentation(0) - 1.0) - ring.rest();
        if self.is_uncoupled() {
            return at_far_side;
        }
        // Closed, the pressure is linear in the offset: where it ends first.
        let [at_rest, beyond] = [0.0, 1.0].map(|offset| self.closed_pressure(&ring, offset));
        let ends = |angle: f64| {
            let (pressure, slope) = (at_rest.at(angle), beyond.at(angle) - at_rest.at(angle));
            match slope < 0.0 {
                _ if pressure < 0.0 => f64::NEG_INFINITY,
                true => -pressure / slope,
                false => f64::INFINITY,
            }
        };
        let first = at_rest.places().map(ends).fold(f64::INFINITY, f64::min);
        // Not apart from the curve by rounding.
        if self.first == 0 && first >= at_far_side * (1.0 - ROUNDING) { at_far_side } else { first }
    }

    /// The pressure of the contact that is closed all around.
    fn closed_pressure(&self, ring: &WholeRing, offset: f64) -> ArcPressure {
        ArcPressure::of_whole_ring(self.closed_coefficients(ring, ring.rest() + offset))
    }

    /// Of the contact that is closed all around, at an e/|dR| from where the joint is at rest.
    fn closed_state(&self, ring: &WholeRing, offset: f64) -> ContactState {
        let from_concentric = ring.rest() + offset;
        let first = ring.first(from_concentric);
        ContactState {
            half_angle: PI,
            indentation: 1.0 + offset,
            force: ring.stiffness() * offset,
            tangent_stiffness: ring.stiffness(),
            energy: ring.energy(from_concentric),
            peak_pressure: 0.5 * (first * ring.reduced.peak - from_concentric * ring.reduced.peak_of_versine),
            peak_angle: 0.0,
            truncation: self.states.truncation(0),
            pressure_is_positive: true,
        }
    }

    /// Whether a uniform pressure and cos(phi) are all there is while the contact is closed, as of concentric bodies.
    pub(super) fn is_uncoupled(&self) -> bool {
        self.states.coupling().iter().all(|coupling| coupling.abs() < UNCOUPLED)
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

    /// The pressure of a state that is closed all around.
    pub(super) fn pressure_of_closed(&self, state: &ContactState) -> ArcPressure {
        self.closed_pressure(&WholeRing::of(self), state.indentation - 1.0)
    }

    /// Coefficients of its trial pressures, at an offset from where pin and hole are concentric.
    fn closed_coefficients(&self, ring: &WholeRing, offset: f64) -> Vec<f64> {
        let terms = self.space.pressures.terms;
        let first = ring.first(offset);
        // The state that is about to open has -W y - w_v, with a W of its own.
        let of_opening = |k: usize| self.states.coefficient(terms, 0, k);
        let more = first - offset * of_opening(0);
        let mut coefficients: Vec<f64> = self.states.coupling().iter().map(|y| -more * y).collect();
        coefficients.iter_mut().enumerate().for_each(|(k, value)| *value += offset * of_opening(k));
        coefficients[0] = first;
        coefficients
    }
}

/// y of bodies that do not couple, at most.
const UNCOUPLED: f64 = 1e-9;

/// Offsets that are equal, relative.
const ROUNDING: f64 = 1e-6;

/// What the equations come to on the whole ring, the first node. Lengths are over |dR|, offsets from where pin and hole are concentric.
struct WholeRing {
    reduced: Reduced<f64>,
    /// a.
    arm: f64,
}

impl WholeRing {
    fn of(curve: &ContactCurve) -> WholeRing {
        let reduced = Reduced::of_functions(curve.states.functions(0).map(|values| values[0]));
        WholeRing { arm: FRAC_PI_2 - reduced.versine, reduced }
    }

    /// dF/de.
    fn stiffness(&self) -> f64 {
        2.0 * (self.arm * self.arm / self.reduced.singular + self.reduced.work)
    }

    /// The force of the overlap alone.
    fn force_of_overlap(&self) -> f64 {
        PI * self.arm / self.reduced.singular
    }

    /// Where there is no force.
    fn rest(&self) -> f64 {
        -self.force_of_overlap() / self.stiffness()
    }

    /// W.
    fn first(&self, offset: f64) -> f64 {
        (FRAC_PI_2 + self.arm * offset) / self.reduced.singular
    }

    /// U.
    fn energy(&self, offset: f64) -> f64 {
        let of_overlap = FRAC_PI_2 * FRAC_PI_2 / self.reduced.singular;
        of_overlap + offset * (self.force_of_overlap() + 0.5 * self.stiffness() * offset)
    }
}

/// From a state per e to the same per |dR|, from its e/|dR| from where the joint is at rest, and where that is.
fn per_overlap(state: ContactState, offset: f64, rest: f64) -> ContactState {
    let from_concentric = rest + offset;
    ContactState {
        indentation: 1.0 + offset,
        force: from_concentric * state.force,
        energy: from_concentric * from_concentric * state.energy,
        peak_pressure: from_concentric * state.peak_pressure,
        ..state
    }
}
