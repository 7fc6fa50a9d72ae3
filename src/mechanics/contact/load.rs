//! What a joint is loaded by, and how far a state of it is from that.

/// A load without dimensions: lengths over the hole's radius, forces over thickness, hole radius and the unit of the moduli.
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
    /// It is not because second order in the clearance does not bear such a clearance.
    ClearanceTooWide,
}

/// A load as what is searched for.
#[derive(Clone, Copy)]
pub(super) enum Target {
    /// delta/e.
    Indentation(f64),
    /// F over the clearance.
    Force(f64),
}

impl Target {
    pub(super) fn new(radial_clearance: f64, load: DimensionlessLoad) -> Target {
        match load {
            DimensionlessLoad::Indentation(delta) => Target::Indentation(delta / (radial_clearance + delta)),
            // A neat fit has one half angle, whatever the load.
            DimensionlessLoad::Force(_) if radial_clearance == 0.0 => Target::Indentation(1.0),
            DimensionlessLoad::Force(force) => Target::Force(force / radial_clearance),
        }
    }

    /// `excess` >= 0, without a logarithm.
    #[inline(always)]
    pub(super) fn is_reached(self, indentation: f64, force: f64) -> bool {
        match self {
            Target::Indentation(target) => indentation >= target,
            Target::Force(target) => force >= target * (1.0 - indentation),
        }
    }

    /// How much a state's load, delta/e and F/e, exceeds the one asked: the logarithm of their ratio, a power law of eps for
    /// small angles. A force grows without bound towards a neat fit, where dR/e ends; so there it is the difference of
    /// dR/e and what it should be, which goes on beyond. The root is searched of this, negative below and positive above.
    #[inline(always)]
    pub(super) fn excess(self, indentation: f64, force: f64) -> f64 {
        match self {
            Target::Indentation(target) => (indentation / target).ln(),
            Target::Force(target) => {
                let (wanted, radial_clearance) = (force / target, 1.0 - indentation);
                if radial_clearance > 0.5 {
                    (wanted / radial_clearance).ln()
                } else {
                    wanted - radial_clearance
                }
            }
        }
    }
}
