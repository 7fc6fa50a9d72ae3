//! The "Hertz" compression law as Liu, Zhang & Yang print it: delta = 2 F/(pi E*) [ln(pi E* dR/F) - 1].
//!
//! Offered for comparison with that study only. It does not follow from its own two terms, F/(pi E') [2 ln(4 R/a) - 1]
//! for each body, which give Johnson's law: the factor 2 before it belongs to one body's modulus (2 F/(pi E'),
//! E' = 2 E* for equal bodies), and a ln 4 is lost. A half-plane's displacement grows as -2 F/(pi E') ln r, so any law
//! must have dF/d ln F -> -1/(pi E*): this one has twice that, and is up to twice too soft at small loads.

use std::f64::consts::PI;

use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "hertz-liu-as-printed",
    citation: "C.-S. Liu, K. Zhang & R. Yang, Mechanism and Machine Theory 42 (2007) 183-197, as printed",
    range: "delta < (2/e^2) dR = 0.2707 dR, that is F/t < (pi/e^2) E* dR = 0.4252 E* dR, where the slope is infinite; \
            not a consistent theory: to reproduce the study, not to design with",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    Curve::logarithmic(LAW.name, pair, 2.0, PI.ln() - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_printed_form() {
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        for force in [1.0, 100.0, 10_000.0] {
            let expected = 2.0 * force / (PI * 1e5) * ((PI * 1e5 * 0.5 / force).ln() - 1.0);
            // 1e-14: round-off.
            assert!((curve.indentation(force).unwrap() / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn ends_where_its_range_says() {
        // The numbers of `range`, written to 4 digits.
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 1.0)).unwrap();
        assert!((curve.indentation_limit() / 0.5 - 0.2707).abs() < 5e-5);
        assert!((curve.force_limit() / 5e4 - 0.4252).abs() < 5e-5);
    }
}
