//! Johnson's law: the compression of two cylinders, centre to contact, under Hertz's pressure.
//!
//! Each body gives F/(pi E') [2 ln(4 R/a) - 1], a Hertz's half width; with R1 R2/a^2 = pi E* dR/(4 F) the sum is
//! delta = F/(pi E*) [ln(E* dR/F) + C], C = ln(4 pi) - 1, whatever the radii; F per thickness.
//! Its inverse is F = (4 pi E* dR/e) exp(W_-1(-e delta/(4 dR))).

use std::f64::consts::PI;

use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "johnson",
    citation: "K. L. Johnson, Contact Mechanics, Cambridge University Press (1985) sect. 5.6",
    range: "delta < (4/e^2) dR = 0.5413 dR, that is F/t < (4 pi/e^2) E* dR = 1.7007 E* dR, where the slope is \
            infinite; the narrow contact that it assumes ends far below",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    Curve::logarithmic(LAW.name, pair, 1.0, (4.0 * PI).ln() - 1.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::E;

    use super::super::HertzContact;
    use super::super::lambert::lambert_wm1;
    use super::*;

    #[test]
    fn is_the_sum_of_the_two_bodies() {
        // The text's form, with Hertz's half width from its own file; bodies of equal modulus E' = 2 E*.
        let pair = Pair::steel(10.0, 0.5, 1.0);
        let curve = LAW.curve(&pair).unwrap();
        for force in [1.0, 100.0, 10_000.0] {
            let half_width = HertzContact::from_force(&pair, force).unwrap().contact_half_width();
            let body = |radius: f64| force / (PI * 2e5) * (2.0 * (4.0 * radius / half_width).ln() - 1.0);
            let expected = body(9.5) + body(10.0);
            // 1e-13: round-off, a little of it amplified by the difference of logarithms.
            assert!((curve.indentation(force).unwrap() / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn ends_where_the_slope_is_infinite() {
        // E* dR = 5e4. 4/e^2 and 4 pi/e^2 to 6 digits, as in the range above: 1e-6.
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        assert!((curve.indentation_limit() / (0.5 * 0.541_341_1) - 1.0).abs() < 1e-6);
        assert!((curve.force_limit() / (5e4 * 1.700_673) - 1.0).abs() < 1e-6);
        // v = sqrt(2 (1 - q)) near the end: 1e-8 below it the tangent is pi E*/1.4e-4.
        let stiffness =
            curve.tangent_stiffness_per_thickness(curve.indentation_limit() * (1.0 - 1e-8)).unwrap();
        assert!((stiffness * 2e-8f64.sqrt() / (PI * 1e5) - 1.0).abs() < 1e-3, "{stiffness}");
    }

    #[test]
    fn is_the_exponential_of_lamberts_function() {
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        for indentation in [1e-9, 1e-4, 0.01, 0.2, 0.27] {
            let exponent = lambert_wm1(-E * indentation / (4.0 * 0.5)).unwrap();
            let expected = 4.0 * PI * 5e4 / E * exponent.exp();
            // 1e-13: exp turns the round-off of an exponent of about 25 into 25 round-offs.
            assert!((curve.force_per_thickness(indentation).unwrap() / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn has_no_curve_for_a_neat_fit() {
        let error = LAW.curve(&Pair::steel(10.0, 0.0, 1.0)).unwrap_err();
        assert!(matches!(error, LawError::OutOfRange { quantity: "radial clearance", .. }), "{error}");
    }
}
