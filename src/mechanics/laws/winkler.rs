//! Liu, Zhang & Yang's law: the hole as a bed of springs. F = (pi/2) E_w delta sqrt(delta/(2 (dR + delta))),
//! cos eps = dR/(dR + delta), p0 = E_w delta/(2 R2); F per thickness.
//!
//! E_w is Young's modulus for equal bodies in plane stress, 2 E* in general (the paper prints E* for it).
//! The springs give p0 and eps; the force is that of an *elliptic* pressure over the half width 2 R2 sin(eps/2), not
//! the springs' own resultant E_w (dR + delta) (eps - sin eps cos eps)/2, which is 15 % to 29 % less.

use super::law_curve::Form;
use super::law_error::{LawError, finite};
use super::wedge::Wedge;
use super::{Curve, Law, Pair, Units};

pub static LAW: Law = Law {
    name: "winkler",
    citation: "C.-S. Liu, K. Zhang & R. Yang, Mechanism and Machine Theory 42 (2007) 183-197",
    range: "any clearance, also 0; delta < R1. Its authors compare it with finite elements at sin(eps/2) >= 0.2; how \
            good it is depends on the plate, which it ignores",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    Curve::new(LAW.name, pair, Form::Wedge(wedge(pair)), pair.pin_radius)
}

fn wedge(pair: &Pair) -> Wedge {
    Wedge { modulus: 2.0 * pair.effective_modulus, radial_clearance: pair.radial_clearance }
}

/// eps in rad, for an indentation within the law's range; 90 deg for a neat fit.
pub fn contact_half_angle(pair: &Pair, indentation: f64) -> Result<f64, LawError> {
    build(pair)?.force_per_thickness(indentation)?;
    Ok(2.0 * wedge(pair).sine(indentation).asin())
}

/// p0, for an indentation within the law's range.
pub fn peak_pressure(pair: &Pair, indentation: f64) -> Result<f64, LawError> {
    build(pair)?.force_per_thickness(indentation)?;
    finite(LAW.name, "peak pressure", pair.effective_modulus * indentation / pair.hole_radius)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn is_an_elliptic_pressure_over_the_springs_arc() {
        let pair = Pair::steel(10.0, 0.5, 1.0);
        let curve = LAW.curve(&pair).unwrap();
        for indentation in [1e-6f64, 0.01, 0.5, 5.0] {
            let angle = (0.5 / (0.5 + indentation)).acos();
            let half_width = 20.0 * (angle / 2.0).sin();
            let force = PI / 2.0 * peak_pressure(&pair, indentation).unwrap() * half_width;
            // acos near 1 keeps half the digits at delta = 1e-6: 1e-16/4e-6; elsewhere round-off.
            assert!((contact_half_angle(&pair, indentation).unwrap() / angle - 1.0).abs() < 1e-10);
            assert!((curve.force_per_thickness(indentation).unwrap() / force - 1.0).abs() < 1e-10);
            // p0 = E delta/(2 R2) for equal bodies in plane stress, E = 2e5; round-off.
            assert!((peak_pressure(&pair, indentation).unwrap() / (1e4 * indentation) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_worked_case_of_the_study() {
        // R2 = 100, dR = delta = 0.1: F = (pi/2) 2e5 0.1 sqrt(1/4) = 5000 pi, eps = 60 deg, p0 = 100.
        let pair = Pair::steel(100.0, 0.1, 1.0);
        let curve = LAW.curve(&pair).unwrap();
        assert!((curve.force_per_thickness(0.1).unwrap() / (5000.0 * PI) - 1.0).abs() < 1e-14);
        assert!((contact_half_angle(&pair, 0.1).unwrap() / (PI / 3.0) - 1.0).abs() < 1e-14);
        assert!((peak_pressure(&pair, 0.1).unwrap() / 100.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_neat_fit_is_linear() {
        let pair = Pair::steel(100.0, 0.0, 1.0);
        let curve = LAW.curve(&pair).unwrap();
        let stiffness = PI / 2.0 * 2e5 / 2f64.sqrt();
        for indentation in [0.0, 1e-9, 0.1] {
            let tangent = curve.tangent_stiffness_per_thickness(indentation).unwrap();
            let force = curve.force_per_thickness(indentation).unwrap();
            // 1e-14: round-off.
            assert!((tangent / stiffness - 1.0).abs() < 1e-14);
            assert!((force - stiffness * indentation).abs() <= 1e-14 * force);
            assert!((curve.indentation(force).unwrap() - indentation).abs() <= 1e-14 * indentation);
            assert!((contact_half_angle(&pair, indentation).unwrap() / (PI / 2.0) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn refuses_a_pin_that_leaves_the_hole() {
        let pair = Pair::steel(100.0, 0.5, 1.0);
        for indentation in [99.5, -1e-9, f64::NAN, f64::INFINITY] {
            assert!(contact_half_angle(&pair, indentation).is_err(), "{indentation}");
            assert!(peak_pressure(&pair, indentation).is_err(), "{indentation}");
        }
    }
}
