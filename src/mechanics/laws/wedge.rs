//! A wedge of springs under an elliptic pressure: F = (pi/2) E_w delta k, k = sin(eps/2), cos eps = dR/(dR + delta).

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, SQRT_2};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wedge {
    /// E_w.
    pub modulus: f64,
    pub radial_clearance: f64,
}

impl Wedge {
    pub fn force(&self, indentation: f64) -> f64 {
        FRAC_PI_2 * self.modulus * indentation * self.sine(indentation)
    }

    /// With g = 2 F/(pi E_w) and r = delta/g the law reads r^3 = 2 r + 2 dR/g. Newton's iteration from sqrt(2) +
    /// cbrt(2 dR/g), which lies above the one positive root, falls monotonically: the cubic is convex there.
    pub fn indentation(&self, force: f64) -> f64 {
        let scale = force / (FRAC_PI_2 * self.modulus);
        let constant = 2.0 * self.radial_clearance / scale;
        let mut root = SQRT_2 + constant.cbrt();
        // The start is at most twice the root, so about five steps do; the rest is for safety.
        for _ in 0..30 {
            let step = (root * (root * root - 2.0) - constant) / (3.0 * root * root - 2.0);
            if step.is_nan() || step <= f64::EPSILON * root {
                break;
            }
            root -= step;
        }
        root * scale
    }

    /// dF/d delta = (pi/2) E_w k [1 + dR/(2 (dR + delta))].
    pub fn tangent_stiffness(&self, indentation: f64) -> f64 {
        let offset = self.radial_clearance + indentation;
        let cosine = if offset > 0.0 { self.radial_clearance / offset } else { 0.0 };
        FRAC_PI_2 * self.modulus * self.sine(indentation) * (1.0 + 0.5 * cosine)
    }

    /// k = sin(eps/2) = sqrt(delta/(2 (dR + delta))). A neat fit has eps = 90 deg at every load, so also at none.
    pub fn sine(&self, indentation: f64) -> f64 {
        if self.radial_clearance == 0.0 {
            return FRAC_1_SQRT_2;
        }
        (0.5 * indentation / (self.radial_clearance + indentation)).sqrt()
    }
}
