//! The outlines of pin and hole where they first touch: which points meet, and along what they push each other.
//!
//! Pin and hole meet on rays from the hole's centre. The ray at phi meets the pin at its own angle theta, seen from its own
//! centre, R1 sin(theta - phi) = dR sin(phi), and closes a gap that is dR - sqrt(R1^2 - dR^2 sin^2 phi) + R1 - dR cos(phi) wide.
//! The pressure acts along the ray on both bodies, so on the pin it is tilted by theta - phi against its normal. To first order
//! in the clearance, with m = R2/R1,
//!
//! ```text
//!   tan(theta/2) = m tan(phi/2),    gap = dR (1 - cos phi'), tan(phi'/2) = sqrt(m) tan(phi/2),    theta - phi = mu sin(theta),
//! ```
//!
//! mu = (m - 1/m)/2. The first maps arcs to arcs and trial pressures to trial pressures with the same coefficients, so that
//! bodies are condensed once for every clearance. To second order, eta = dR/R2,
//!
//! ```text
//!   theta:  + eta^2 sin(theta) [1 - cos(theta)]/2,     gap:  + dR eta^2 sin^2(theta) [1 - cos(theta)]/4,
//!   theta - phi:  + eta^2 [sin(theta) - sin(2 theta)]/2,
//! ```
//!
//! of which the first and the third are part of the pin's compliance (`compliance::second_order`). What is left is of the
//! order of the clearance ratio cubed (docs/theory.md, section 10).

use crate::mechanics::compliance::pressure_space::Tilt;

/// Of one clearance. The outlines of a press fit overlap all around: pin and hole meet normal to normal where they are concentric,
/// at equal angles, and there is nothing to correct.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlines {
    /// dR/R2, < 1; of press fits negative.
    pub radial_clearance: f64,
    /// m.
    ratio: f64,
}

impl Outlines {
    /// Of a neat fit.
    pub const ALIKE: Outlines = Outlines { radial_clearance: 0.0, ratio: 1.0 };

    /// For dR/R2.
    pub fn new(radial_clearance: f64) -> Outlines {
        Outlines { radial_clearance, ratio: 1.0 / (1.0 - radial_clearance.max(0.0)) }
    }

    /// m: of the tangents of half angles, the pin's over the hole's where they meet.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Of the pressure on the pin against its normal; mu to first order.
    pub fn tilt(&self) -> Tilt {
        Tilt { first: 0.5 * (self.ratio - 1.0 / self.ratio), second: self.square() }
    }

    /// The clearance ratio squared; nothing of press fits.
    pub fn square(&self) -> f64 {
        self.radial_clearance * self.radial_clearance.max(0.0)
    }

    /// Of the gap over dR: its part to second order, over sin^2(theta) (1 - cos theta).
    pub fn bend(&self) -> f64 {
        0.25 * self.square()
    }

    /// The angle of the hole, rad, that meets one of the pin.
    pub fn of_hole(&self, of_pin: f64) -> f64 {
        2.0 * ((0.5 * of_pin).tan() / self.ratio).atan()
    }

    /// The reverse of `of_hole`.
    pub fn of_pin(&self, of_hole: f64) -> f64 {
        2.0 * ((0.5 * of_hole).tan() * self.ratio).atan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The maps against the outlines themselves, and with what is to second order: what they leave falls with the square of the
    /// clearance, or its cube.
    #[test]
    fn second_order_is_what_is_left_out_of() {
        let mut left = [[0.0_f64; 5]; 2];
        for (left, eta) in left.iter_mut().zip([0.02, 0.01]) {
            let (outlines, pin_radius) = (Outlines::new(eta), 1.0 - eta);
            let Tilt { first, second } = outlines.tilt();
            for step in 1..=30 {
                let phi = 0.05 * f64::from(step);
                let theta = phi + (eta * phi.sin() / pin_radius).asin();
                let gap = 1.0 - eta * phi.cos() - (pin_radius.powi(2) - (eta * phi.sin()).powi(2)).sqrt();
                let at = 2.0 * (outlines.ratio().sqrt() * (0.5 * phi).tan()).atan();
                let found = outlines.of_pin(phi);
                let (place, tilt) = (found - theta, first * found.sin() - (theta - phi));
                let (sine, versine) = (theta.sin(), 1.0 - theta.cos());
                let errors = [
                    place,
                    tilt,
                    place + second * 0.5 * sine * versine,
                    tilt + second * 0.5 * (sine - (2.0 * theta).sin()),
                    gap / eta - (1.0 - at.cos()) - outlines.bend() * sine * sine * versine,
                ];
                left.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error.abs()));
                assert!((outlines.of_hole(outlines.of_pin(phi)) - phi).abs() < 1e-14);
            }
        }
        for ((of_double, of_single), expected) in
            left[0].into_iter().zip(left[1]).zip([2.0, 2.0, 3.0, 3.0, 3.0])
        {
            let order = (of_double / of_single).log2();
            assert!((order - expected).abs() < 0.2, "{left:?}");
        }
        assert_eq!(Outlines::new(0.0), Outlines::ALIKE);
    }
}
