//! Contact with a moving edge on a mesh as it is, without the exact near field: the compliance to the trial pressures is
//! found at each contact half angle itself, because between half angles a mesh's own has kinks.

use std::time::Instant;

use crate::engine::request::SpaceKey;
use crate::mechanics::compliance::arc::ContactArc;
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::ring_loads::{arc_loads, galerkin_compliance, load_rule};
use crate::mechanics::compliance::{NODE_COUNT, PressureCompliance};
use crate::mechanics::contact::arc_state::ArcState;
use crate::mechanics::contact::pressure::JointCompliance;
use crate::mechanics::contact::ring_joint::RingBody;
use crate::mechanics::real::LANES;
use crate::study::design::{DesignCase, JointDesign, Load};
use crate::tradeoff::choice::Solution;
use crate::tradeoff::joints::Terms;
use crate::tradeoff::moving_edge::whole;
use crate::tradeoff::ring_mesh::Division;
use crate::tradeoff::rings::Rings;
use crate::tradeoff::state::State;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectPath {
    pub division: Division,
    /// Meshes can bear few: each needs nodes of its own inside the contact.
    pub terms: usize,
}

/// Half angles that a design is looked at before its loads are searched for: from the first, rad, by a factor.
const FIRST: f64 = 2e-3;
const FACTOR: f64 = 1.25;

/// Evaluations of one search.
const MOST_EVALUATIONS: usize = 60;

/// Where a search ends: the logarithm of what is found over what is asked.
const TOLERANCE: f64 = 1e-10;

/// What half angles do not change.
struct Prepared {
    space: PressureSpace,
    rule: Vec<(f64, f64)>,
}

/// A design with its bodies.
struct Joint<'a> {
    prepared: &'a Prepared,
    bodies: [RingBody<'a>; 2],
}

impl DirectPath {
    pub fn solve(&self, cases: &[DesignCase]) -> Solution {
        let started = Instant::now();
        let prepared = [false, true].map(|half_ring| Prepared {
            space: PressureSpace::new(self.terms, SpaceKey { half_ring, terms: self.terms }.limit()),
            rule: load_rule(self.terms),
        });
        let of_spaces = started.elapsed();
        let rings = Rings::new(cases, &self.division);
        let states = cases.iter().enumerate().map(|(number, case)| {
            let half_ring = Terms::Fixed(self.terms).space(&case.joint).half_ring;
            let prepared = &prepared[usize::from(half_ring)];
            match rings.pair(number, &case.joint) {
                Some(bodies) => Joint { prepared, bodies }.states(case),
                None => vec![None; case.steps.len()],
            }
        });
        let states = states.collect();
        let shared = of_spaces + rings.shared;
        Solution { states, shared, own: started.elapsed() - shared }
    }
}

impl Joint<'_> {
    fn states(&self, case: &DesignCase) -> Vec<Option<State>> {
        let limit = self.prepared.space.limit;
        let angles = std::iter::successors(Some(FIRST), |angle| Some(angle * FACTOR));
        let angles = angles.take_while(|angle| *angle < limit).chain([limit]);
        let samples: Vec<ArcState> = angles.filter_map(|angle| self.at(angle)).collect();
        case.steps.iter().map(|load| self.state(&case.joint, *load, &samples)?.sound()).collect()
    }

    /// The joint at a half angle; `None` where the compliance is not positive definite.
    fn at(&self, half_angle: f64) -> Option<ArcState> {
        let Prepared { space, rule } = self.prepared;
        let arc = ContactArc::new(half_angle);
        let [pin, plate] = self.bodies.map(|RingBody { topology, compliance, youngs_modulus }| {
            let loads = arc_loads(&arc, space.terms, rule, topology.element, &topology.ring_angles);
            let own = galerkin_compliance(compliance, topology, &[loads], space.terms, 0.0);
            // The same at all nodes is the same between them.
            let values = own.values.repeat(NODE_COUNT);
            (PressureCompliance { values, ..own }, youngs_modulus)
        });
        let joined = JointCompliance::new(space, (&pin.0, pin.1), (&plate.0, plate.1));
        joined.at(&[half_angle; LANES])[0]
    }

    fn state(&self, joint: &JointDesign, load: Load, samples: &[ArcState]) -> Option<State> {
        let clearance = joint.radial_clearance / joint.hole_radius;
        // The offset of the centres over the hole's radius under this load, and the logarithm of how much the state's
        // load exceeds the one asked.
        let offset = |state: &ArcState| match load {
            Load::Indentation(delta) => clearance + delta / joint.hole_radius,
            Load::Force(force) => force / (joint.thickness * joint.hole_radius * state.force),
        };
        let excess = |state: &ArcState| match load {
            Load::Indentation(delta) => (state.indentation * offset(state) * joint.hole_radius / delta).ln(),
            // A neat fit has one half angle, whatever the load.
            Load::Force(_) if clearance == 0.0 => state.indentation.ln(),
            // At this force the clearance must be the joint's.
            Load::Force(_) => (clearance / (offset(state) * state.clearance().max(f64::MIN_POSITIVE))).ln(),
        };
        if matches!(load, Load::Indentation(0.0) | Load::Force(0.0)) {
            return None;
        }
        let above = samples.iter().position(|state| excess(state) >= 0.0)?;
        let mut high = samples[above];
        let mut low = samples[above.checked_sub(1)?];
        let (mut below, mut over) = (excess(&low), excess(&high));
        let mut best = high;
        for evaluation in 0..MOST_EVALUATIONS {
            // False position in ln(eps), bisection every third time.
            let (from, to) = (low.arc.half_angle.ln(), high.arc.half_angle.ln());
            let share = if evaluation % 3 == 2 { 0.5 } else { -below / (over - below) };
            let angle = (from + share.clamp(0.01, 0.99) * (to - from)).exp();
            best = self.at(angle)?;
            let excess = excess(&best);
            if excess.is_nan() {
                return None;
            }
            if excess.abs() < TOLERANCE || to - from < 1e-13 {
                break;
            }
            if excess < 0.0 {
                (low, below) = (best, excess);
            } else {
                (high, over) = (best, excess);
            }
        }
        Some(whole(&best, offset(&best), joint.hole_radius, joint.thickness))
    }
}
