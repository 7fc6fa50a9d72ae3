//! The family of logarithmic laws, delta = m F/(pi E*) [ln(E* dR/F) + C], F per thickness.
//!
//! The indentation has a maximum, dR m e^(C-1)/pi at F = E* dR e^(C-1); only the branch below it is a law.
//! The inverse is F = E* dR e^C exp(W_-1(-q/e)) with q = delta over that maximum, and with v = -1 - W_-1(-q/e)
//! F = pi E* delta/(m (1 + v)), dF/d delta = pi E*/(m v).

use std::f64::consts::PI;

use super::lambert::below_branch_point;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Logarithmic {
    /// m; the half-plane's logarithm has m = 1.
    multiple: f64,
    effective_modulus: f64,
    /// Where the law ends.
    largest_indentation: f64,
    largest_force: f64,
}

impl Logarithmic {
    pub fn new(effective_modulus: f64, radial_clearance: f64, multiple: f64, constant: f64) -> Self {
        let scale = radial_clearance * (constant - 1.0).exp();
        let largest_indentation = multiple * scale / PI;
        Logarithmic {
            multiple,
            effective_modulus,
            largest_indentation,
            largest_force: effective_modulus * scale,
        }
    }

    pub fn largest_indentation(&self) -> f64 {
        self.largest_indentation
    }

    pub fn force(&self, indentation: f64) -> f64 {
        PI * self.effective_modulus * indentation / (self.multiple * (1.0 + self.depth(indentation)))
    }

    pub fn indentation(&self, force: f64) -> f64 {
        // ln(E* dR/F) + C = 1 - ln(F/F_max).
        self.multiple * force / (PI * self.effective_modulus) * (1.0 - (force / self.largest_force).ln())
    }

    pub fn tangent_stiffness(&self, indentation: f64) -> f64 {
        PI * self.effective_modulus / (self.multiple * self.depth(indentation))
    }

    /// v of the module's header.
    fn depth(&self, indentation: f64) -> f64 {
        below_branch_point(indentation / self.largest_indentation)
    }
}
