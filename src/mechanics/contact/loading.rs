//! From a load to the contact half angle: one-dimensional roots on the joint's curve.

use super::pressure::{ArcState, JointCompliance};
use crate::mechanics::compliance::NODE_COUNT;

/// What a joint is loaded by, dimensionless: lengths over the hole's radius, forces over thickness, hole radius and
/// the unit of the moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionlessLoad {
    Indentation(f64),
    Force(f64),
}

/// Why a load has no state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoState {
    /// The contact would reach beyond the largest half angle the scene allows.
    ContactTooWide,
    /// The compliance is not positive definite, or not finite.
    BrokenCompliance,
}

/// The smallest contact half angle looked at, rad.
const SMALLEST: f64 = 1e-9;

/// A joint's curve, sampled at the nodes of its pressure space.
pub struct JointCurve<'a> {
    joint: JointCompliance<'a>,
    /// States at the nodes, by ascending half angle, up to the first that is not a free contact any more.
    samples: Vec<ArcState>,
}

impl<'a> JointCurve<'a> {
    pub fn new(joint: JointCompliance<'a>) -> Result<JointCurve<'a>, NoState> {
        let mut samples = Vec::with_capacity(NODE_COUNT);
        for node in (0..NODE_COUNT).rev() {
            let state = joint.at_node(node).ok_or(NoState::BrokenCompliance)?;
            if !(state.indentation.is_finite() && state.force.is_finite()) {
                return Err(NoState::BrokenCompliance);
            }
            let neat = state.indentation >= 1.0;
            samples.push(state);
            if neat {
                break;
            }
        }
        Ok(JointCurve { joint, samples })
    }

    pub fn joint(&self) -> &JointCompliance<'a> {
        &self.joint
    }

    /// The state under `load` (> 0) for a radial clearance over the hole's radius, >= 0.
    pub fn state(&self, clearance: f64, load: DimensionlessLoad) -> Result<ArcState, NoState> {
        // Each is negative below the root, positive above it, and of order one around it.
        let excess = |state: &ArcState| match load {
            DimensionlessLoad::Indentation(delta) => state.indentation / (delta / (clearance + delta)) - 1.0,
            DimensionlessLoad::Force(force) => state.force - state.clearance() * (force / clearance),
        };
        let excess = |state: &ArcState| match (load, clearance == 0.0) {
            (DimensionlessLoad::Force(_), true) => state.indentation - 1.0,
            _ => excess(state),
        };
        let above =
            self.samples.iter().position(|state| excess(state) >= 0.0).ok_or(NoState::ContactTooWide)?;
        let upper = &self.samples[above];
        let (mut b, mut fb) = (upper.arc.half_angle, excess(upper));
        let (mut a, mut fa) = match above.checked_sub(1) {
            Some(below) => (self.samples[below].arc.half_angle, excess(&self.samples[below])),
            None => {
                let state = self.joint.at(SMALLEST).ok_or(NoState::BrokenCompliance)?;
                (SMALLEST, excess(&state))
            }
        };
        let mut best = *upper;
        // Chandrupatla 1997: inverse quadratic interpolation where it is safe, bisection elsewhere.
        let (mut c, mut fc);
        let mut share = 0.5;
        for _ in 0..100 {
            if fb == 0.0 {
                break;
            }
            let next = a + share * (b - a);
            let state = self.joint.at(next).ok_or(NoState::BrokenCompliance)?;
            let value = excess(&state);
            if !value.is_finite() {
                return Err(NoState::BrokenCompliance);
            }
            best = state;
            if (value > 0.0) == (fa > 0.0) {
                (c, fc) = (a, fa);
            } else {
                (c, fc, b, fb) = (b, fb, a, fa);
            }
            (a, fa) = (next, value);
            // The force varies like eps^2 at least, so this leaves 1e-12 of it.
            let tolerance = 1e-13;
            let width = (b - a).abs() / a.abs().max(b.abs());
            if fa == 0.0 || width < tolerance || fa.abs() < tolerance {
                break;
            }
            let xi = (a - b) / (c - b);
            let phi = (fa - fb) / (fc - fb);
            let quadratic = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
            share = if quadratic {
                fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            } else {
                0.5
            };
            share = share.clamp(1e-6, 1.0 - 1e-6);
        }
        Ok(best)
    }

    /// Centre offset e = dR + delta over the hole's radius, at a state found for `load`.
    pub fn offset(&self, state: &ArcState, clearance: f64, load: DimensionlessLoad) -> f64 {
        match load {
            DimensionlessLoad::Indentation(delta) => clearance + delta,
            DimensionlessLoad::Force(force) => force / state.force,
        }
    }
}
