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
//! moves, and the rest is `whole_ring`.
//!
//! The stiffness of the open contact is the slope of the force along the curve, dF/de = F/e - (x - 1) (F/e)'/x', because that of a punch
//! (`edge`) is off by more: ten trial pressures give the force to 1e-9 and where its arc ends, on which a punch depends, to 1e-5.

use super::arc_pressure::ArcPressure;
use super::curve::ContactCurve;
use super::load::{DimensionlessLoad, NoState};
use super::state::ContactState;
use super::whole_ring::{RingState, WholeRing};
use crate::mechanics::compliance::arc::packed;
use crate::mechanics::real::{LANES, Lanes, Real};
use crate::mechanics::registers::ANY;

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
        loads: &mut dyn Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        if self.outlines.radial_clearance < 0.0 { self.press_fit_states(loads) } else { self.states(loads) }
    }

    fn press_fit_states(
        &self,
        loads: &mut dyn Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        let loads: Vec<DimensionlessLoad> = loads.collect();
        let Some(ring) = WholeRing::of(self) else {
            return vec![Err(NoState::BrokenCompliance); loads.len()];
        };
        let overlap = -self.outlines.radial_clearance;
        let (opening, rest) = (self.opening_of(&ring), ring.rest);
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
        let open: Vec<_> = loads.iter().filter(|load| closed(load).is_none()).map(from_concentric).collect();
        let seam = if open.is_empty() { None } else { self.seam(&ring) };
        let mut opened = self.states(&mut open.into_iter()).into_iter();
        let state = |load: &DimensionlessLoad| {
            if let Some(offset) = closed(load) {
                return Ok((
                    self.state_of_ring(&ring, &ring.closed(rest + offset), self.states.truncation(0)),
                    0,
                ));
            }
            let (one_arc, left) = seam.ok_or(NoState::BrokenCompliance)?;
            match opened.next().unwrap_or(Err(NoState::BrokenCompliance)) {
                Ok((state, node)) if node >= one_arc => {
                    let tangent_stiffness = self.slope(&state);
                    let offset = match *load {
                        DimensionlessLoad::Force(force) => force / state.force / overlap - rest,
                        _ => offset(load),
                    };
                    Ok((ContactState { tangent_stiffness, ..per_overlap(state, offset, rest) }, node))
                }
                Ok(_) | Err(NoState::ContactTooWide | NoState::ContactTooNarrow) => {
                    let found = match *load {
                        DimensionlessLoad::Force(force) => {
                            ring.under_force(force / overlap, rest + opening.max(0.0))
                        }
                        _ => ring.open(rest + offset(load)),
                    };
                    let found = found.ok_or(NoState::BrokenCompliance)?;
                    Ok((self.state_of_ring(&ring, &found, left), 0))
                }
                Err(reason) => Err(reason),
            }
        };
        loads.iter().map(state).collect()
    }

    /// The e/|dR| up to which the contact is closed all around, from where the joint is at rest; below zero where it is open there. `None`
    /// where the compliance is not positive definite.
    pub fn opening(&self) -> Option<f64> {
        Some(self.opening_of(&WholeRing::of(self)?))
    }

    fn opening_of(&self, ring: &WholeRing) -> f64 {
        let at_far_side = 1.0 / (self.states.indentation(0) - 1.0) - ring.rest;
        if !self.is_coupled() {
            return at_far_side;
        }
        // Not apart from the curve by rounding.
        let first = ring.opening();
        if self.first == 0 && first >= at_far_side * (1.0 - ROUNDING) { at_far_side } else { first }
    }

    /// Whether a uniform pressure is not answered by one, as it is of concentric bodies.
    pub(super) fn is_coupled(&self) -> bool {
        let ring = self.states.whole_ring();
        (1..self.space.pressures.terms).any(|k| ring[packed(k, 0)].abs() > UNCOUPLED * ring[0])
    }

    /// The widest node at which contact is one arc, and what the force of the whole ring differs from that of the curve there, relative. On wider
    /// arcs the bodies would overlap at the far side, on narrower ones the whole ring leaves more: it is where they differ least. Of concentric
    /// bodies that is the whole ring itself.
    fn seam(&self, ring: &WholeRing) -> Option<(usize, f64)> {
        if !self.is_coupled() {
            return (self.first == 0).then_some((0, 0.0));
        }
        let left = |node: usize| {
            let offset = 1.0 / (self.states.indentation(node) - 1.0);
            let found = ring.with_gaps_at(offset)?;
            Some((node, (found.force / (offset * self.states.force(node)) - 1.0).abs()))
        };
        let nodes = self.first..self.states.count().min(self.first + SEAM_NODES);
        nodes.filter_map(left).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// As a state of the curve, with what is left out of its pressure.
    fn state_of_ring(&self, ring: &WholeRing, state: &RingState, truncation: f64) -> ContactState {
        // Concentric bodies press most at the load line, or alike all around.
        let at_load_line = || (0.0, state.pressure.at(0.0));
        let (peak_angle, peak_pressure) =
            if self.is_coupled() { state.pressure.greatest() } else { at_load_line() };
        ContactState {
            half_angle: state.half_angle,
            indentation: 1.0 + (state.offset - ring.rest),
            force: state.force,
            tangent_stiffness: state.stiffness,
            energy: state.energy,
            peak_pressure,
            peak_angle,
            truncation,
            pressure_is_positive: true,
            on_whole_ring: true,
        }
    }

    /// The pressure of a state that presses all around, or in more than one arc; none where the compliance is not positive definite.
    pub(super) fn pressure_of_ring(&self, state: &ContactState) -> Option<ArcPressure> {
        let ring = WholeRing::of(self)?;
        let offset = state.indentation - 1.0;
        let found = match offset <= self.opening_of(&ring) {
            true => ring.closed(ring.rest + offset),
            false => ring.with_gaps_at(ring.rest + offset)?,
        };
        Some(found.pressure)
    }

    /// dF/de of an open state of the curve, told per e: by differences of the fourth order over cos(eps/2).
    fn slope(&self, state: &ContactState) -> f64 {
        let gap = (0.5 * state.half_angle).cos();
        if gap < LEAST_GAP {
            return state.tangent_stiffness;
        }
        let mut places = Lanes::<ANY>::from_f64(self.space.place_of_gap(gap));
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
}

/// Nodes that the seam of the whole ring and the curve is looked for at.
const SEAM_NODES: usize = 10;

/// Compliances of concentric bodies between different modes, over that to a uniform pressure.
const UNCOUPLED: f64 = 1e-9;

/// Offsets that are equal, relative.
const ROUNDING: f64 = 1e-6;

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
