//! Radzimovsky's law, delta = F/(pi E*) [2/3 + ln(4 R1/b) + ln(4 R2/b)], b = 2 a the whole width of Hertz's strip.
//!
//! With R1 R2/a^2 = pi E* dR/(4 F) the radii cancel: C = ln(pi) + 2/3 in delta = F/(pi E*) [ln(E* dR/F) + C].
//! (Handbooks give b = 1.60 sqrt(F K_D/E*) with the relative *diameter* K_D = 2 R; with R it is 2.26.)

use std::f64::consts::PI;

use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "radzimovsky",
    citation: "E. I. Radzimovsky, Stress distribution and strength condition of two rolling cylinders pressed \
               together, Univ. Illinois Eng. Exp. Station Bull. 408 (1953); in Roark's Formulas for Stress and Strain",
    range: "delta < (e^(-1/3)) dR = 0.7165 dR, that is F/t < 2.2510 E* dR, where the slope is infinite; the narrow \
            contact that it assumes ends far below",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    Curve::logarithmic(LAW.name, pair, 1.0, PI.ln() + 2.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::super::HertzContact;
    use super::*;

    #[test]
    fn is_the_printed_form_with_the_whole_width() {
        let pair = Pair::steel(10.0, 0.5, 1.0);
        let curve = LAW.curve(&pair).unwrap();
        for force in [1.0, 100.0, 10_000.0] {
            let width = 2.0 * HertzContact::from_force(&pair, force).unwrap().contact_half_width();
            let expected = force / (PI * 1e5) * (2.0 / 3.0 + (38.0 / width).ln() + (40.0 / width).ln());
            // 1e-13: round-off, a little of it amplified by the difference of logarithms.
            assert!((curve.indentation(force).unwrap() / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn ends_where_its_range_says() {
        // The numbers of `range`, written to 5 digits.
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        assert!((curve.indentation_limit() / 0.5 - 0.7165).abs() < 5e-5);
        assert!((curve.force_limit() / 5e4 - 2.2510).abs() < 5e-5);
    }
}
