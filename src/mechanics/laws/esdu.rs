//! The law of ESDU 78035 for a cylinder in a hole: delta = F/(pi E*) [ln(4 pi E* dR/F) + 1], F per thickness.
//!
//! Johnson's law with + 1 for - 1: by its own arithmetic softer by 2 F/(pi E*).

use std::f64::consts::PI;

use super::{Curve, Law, LawError, Pair, Units};

pub static LAW: Law = Law {
    name: "esdu-78035",
    citation: "ESDU 78035, Contact phenomena I: stresses, deflections and contact dimensions for normally loaded \
               unlubricated elastic components (1978); as quoted in Pereira, Ramalho & Ambrosio, Nonlinear Dynamics \
               63 (2011) 681-697",
    range: "delta < 4 dR, that is F/t < 4 pi E* dR, where the slope is infinite; the narrow contact that it assumes \
            ends far below",
    units: Units::Consistent,
    build,
};

fn build(pair: &Pair) -> Result<Curve, LawError> {
    Curve::logarithmic(LAW.name, pair, 1.0, (4.0 * PI).ln() + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_printed_form() {
        // delta = F (s1 + s2)/L [ln(4 L dR/(F (s1 + s2))) + 1], s = (1 - nu^2)/(pi E) in plane strain, F the whole
        // force on the length L; plane stress has 1/(pi E). dR = 0.5, L = 3, E = 2e5.
        let (length, compliance) = (3.0, 2.0 / (PI * 2e5));
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, length)).unwrap();
        for force in [3.0, 300.0, 30_000.0] {
            let logarithm = (4.0 * length * 0.5 / (force * compliance)).ln();
            let expected = force * compliance / length * (logarithm + 1.0);
            // 1e-14: round-off.
            assert!((curve.indentation(force / length).unwrap() / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn ends_where_its_range_says() {
        // Exact numbers, so round-off; R1 > 4 dR, so the pin's radius does not end the curve.
        let curve = LAW.curve(&Pair::steel(10.0, 0.5, 3.0)).unwrap();
        assert!((curve.indentation_limit() / 2.0 - 1.0).abs() < 1e-14);
        assert!((curve.force_limit() / (4.0 * PI * 5e4) - 1.0).abs() < 1e-14);
        // A wide clearance: 4 dR = 12 would put the pin's centre outside the hole.
        assert_eq!(LAW.curve(&Pair::steel(10.0, 3.0, 3.0)).unwrap().indentation_limit(), 7.0);
    }
}
