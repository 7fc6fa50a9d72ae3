//! Lankarani and Nikravesh's law, F t = (4/3) E* sqrt(R) delta^1.5, 1/R = 1/R1 - 1/R2 = dR/(R1 R2).
//!
//! The law of two *spheres*, used for cylinders by habit: the whole force does not grow with the thickness t, so the
//! force per thickness falls with it. The factors of dissipation are in `damping`.

use super::law_curve::Form;
use super::law_error::{POSITIVE, check};
use super::power::Power;
use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "lankarani-nikravesh",
    citation: "H. M. Lankarani & P. E. Nikravesh, J. Mechanical Design 112 (1990) 369-376",
    range: "dR > 0 and delta < dR R1/R2, where the circle of contact, a^2 = R delta, is as wide as the pin; a law of \
            spheres: the whole force is the same for every thickness",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    check(LAW.name, "radial clearance", pair.radial_clearance, POSITIVE)?;
    let coefficient = 4.0 / 3.0 * pair.effective_modulus / pair.relative_curvature().sqrt() / pair.thickness;
    let limit = pair.radial_clearance * (pair.pin_radius / pair.hole_radius);
    Curve::new(LAW.name, pair, Form::Power(Power { coefficient, exponent: 1.5 }), limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_hertzs_law_of_spheres() {
        // Force by the sphere's radius of contact: F = 4 E* a^3/(3 R) with a^2 = R delta; R = 9 * 10/1.
        let whole = |thickness: f64, indentation: f64| {
            let curve = LAW.curve(&Pair::steel(10.0, 1.0, thickness)).unwrap();
            curve.force_per_thickness(indentation).unwrap() * thickness
        };
        for indentation in [1e-6f64, 0.01, 0.5] {
            let contact_radius = (90.0 * indentation).sqrt();
            let expected = 4.0 * 1e5 * contact_radius.powi(3) / (3.0 * 90.0);
            // 1e-14: round-off.
            assert!((whole(1.0, indentation) / expected - 1.0).abs() < 1e-14);
            assert!((whole(20.0, indentation) / expected - 1.0).abs() < 1e-14, "thickness must not matter");
        }
    }

    #[test]
    fn ends_where_the_circle_is_as_wide_as_the_pin() {
        let limit = LAW.curve(&Pair::steel(10.0, 1.0, 1.0)).unwrap().indentation_limit();
        assert!(((90.0 * limit).sqrt() / 9.0 - 1.0).abs() < 1e-14, "round-off only");
        assert!(LAW.curve(&Pair::steel(10.0, 0.0, 1.0)).is_err());
    }
}
