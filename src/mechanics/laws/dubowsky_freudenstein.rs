//! Dubowsky and Freudenstein's law: delta = F/(pi E*) [ln(pi E* dR t^2/(F R1 R2)) + 1], F per thickness t.
//!
//! Printed as delta = F (s1 + s2)/L [ln(L^m dR/(F R1 R2 (s1 + s2))) + 1] with s = (1 - nu^2)/(pi E), L = t and F the
//! whole force. Only m = 3 makes the logarithm's argument a number. Goldsmith's law is the same with m = 1, a length
//! to the power -2 under the logarithm, so that its result depends on the unit of length: it is not offered.
//! The length under the logarithm has no mechanical reason in plane elasticity: a twice as long pin is not softer.

use std::f64::consts::PI;

use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "dubowsky-freudenstein",
    citation: "S. Dubowsky & F. Freudenstein, J. Eng. Industry 93 (1971) 305-309 and 310-316; as quoted in Pereira, \
               Ramalho & Ambrosio, Nonlinear Dynamics 63 (2011) 681-697",
    range: "delta < dR t^2/(R1 R2), that is F/t < pi E* dR t^2/(R1 R2), where the slope is infinite, and \
            delta < R1; depends on the thickness",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    let slenderness = (pair.thickness / pair.pin_radius).ln() + (pair.thickness / pair.hole_radius).ln();
    Curve::logarithmic(LAW.name, pair, 1.0, PI.ln() + 1.0 + slenderness)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_printed_form_with_m_equal_to_3() {
        let (length, compliance): (f64, f64) = (30.0, 2.0 / (PI * 2e5));
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, length)).unwrap();
        for force in [30.0, 3_000.0, 300_000.0] {
            let logarithm = (length.powi(3) * 0.5 / (force * 9.5 * 10.0 * compliance)).ln();
            let expected = force * compliance / length * (logarithm + 1.0);
            // 1e-14: round-off.
            assert!((curve.indentation(force / length).unwrap() / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_thin_plate_leaves_it_a_small_range() {
        // dR t^2/(R1 R2) with t = 1: 0.5/95; round-off.
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        assert!((curve.indentation_limit() / (0.5 / 95.0) - 1.0).abs() < 1e-14);
        assert!(matches!(curve.force_per_thickness(0.01), Err(LawError::OutOfRange { .. })));
    }
}
