//! What a joint is loaded by, and how far a state of it is from that.

/// A load without dimensions: lengths over the hole's radius, forces over thickness, hole radius and the unit of the moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionlessLoad {
    Indentation(f64),
    /// Of press fits.
    Offset(f64),
    Force(f64),
}

impl DimensionlessLoad {
    /// How much of delta/e and of F/e sum to one at the state under it.
    pub fn target(self, radial_clearance: f64) -> [f64; 2] {
        let Target { of_indentation, of_force } = Target::new(radial_clearance, self);
        [of_indentation, of_force]
    }
}

/// Why a load has no state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoState {
    /// The contact would reach beyond the largest half angle the scene allows.
    ContactTooWide,
    /// The contact would be narrower than the curve goes, or so narrow that powers of its width are no numbers.
    ContactTooNarrow,
    /// The compliance is not positive definite, or not finite.
    BrokenCompliance,
    /// It is not because second order in the clearance does not bear such a clearance.
    ClearanceTooWide,
}

/// A load as what is searched for: the state at which this much of delta/e and this much of F/e sum to one. The sum grows with the
/// contact, to beyond a neat fit.
#[derive(Clone, Copy)]
pub(super) struct Target {
    pub(super) of_indentation: f64,
    pub(super) of_force: f64,
}

impl Target {
    pub(super) fn new(radial_clearance: f64, load: DimensionlessLoad) -> Target {
        match load {
            // delta/e is what it should be.
            DimensionlessLoad::Indentation(delta) => {
                Target { of_indentation: (radial_clearance + delta) / delta, of_force: 0.0 }
            }
            DimensionlessLoad::Offset(offset) => {
                Target { of_indentation: offset / (offset - radial_clearance), of_force: 0.0 }
            }
            // A neat fit has one half angle, whatever the load.
            DimensionlessLoad::Force(_) if radial_clearance == 0.0 => {
                Target { of_indentation: 1.0, of_force: 0.0 }
            }
            // F/e times dR/F is dR/e, which is 1 - delta/e.
            DimensionlessLoad::Force(force) => {
                Target { of_indentation: 1.0, of_force: radial_clearance / force }
            }
        }
    }
}
