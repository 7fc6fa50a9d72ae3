//! Persson's load with a calibrated offset of the displacement: y = 2 pi b^2 (1 + b^2)/[2 - ln(1 + b^2) - 2 b^4],
//! pi x/y = C - 2 ln b, b = tan(eps/2). For small loads it is Johnson's law, for large ones it is linear.

use std::f64::consts::PI;

use super::offset::{at, fit_offset};
use super::{CalibratedLaw, Number, Samples};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "persson",
    outside: "goes on by its formula, with the right limit for small loads",
    constants: &["C"],
    range: Samples::range,
    fit: |samples| {
        let constant = fit_offset(samples, |sample| -2.0 * half_tangent(sample.y).ln())?;
        Some(vec![constant])
    },
    value,
    formula: |constants, sizes| {
        let stiffness = Number(PI * sizes.stiffness);
        let scale = Number(2.0 * PI * sizes.stiffness * sizes.radial_clearance);
        format!(
            "d = F/{stiffness}*({} - 2*ln(b)), F = {scale}*b^2*(1 + b^2)/(2 - ln(1 + b^2) - 2*b^4)",
            Number(constants[0])
        )
    },
};

/// b of a neat fit, where the load has no bound: 2 - ln(1 + b^2) = 2 b^4.
const NEAT_FIT: f64 = 0.913_573;

/// y and dy/d ln b.
fn load(b: f64) -> [f64; 2] {
    let square = b * b;
    let left = 2.0 - square.ln_1p() - 2.0 * square * square;
    let y = 2.0 * PI * square * (1.0 + square) / left;
    let slope =
        2.0 + 2.0 * square / (1.0 + square) - (-2.0 * square / (1.0 + square) - 8.0 * square * square) / left;
    [y, y * slope]
}

/// The reverse within 1e-5, right for small and for large loads; between them by a polynomial fitted to `load`.
fn half_tangent_about(y: f64) -> f64 {
    const NEAT: f64 = NEAT_FIT * NEAT_FIT;
    const BETWEEN: [f64; 5] = [-0.106_691, 0.311_690, -0.393_603, 0.306_390, -0.250_715];
    let square = y / PI;
    let part = square / (NEAT + square);
    let between = BETWEEN.iter().fold(0.0, |sum, factor| sum * part + factor);
    (NEAT * part * (1.0 + part * (1.0 - part) * between)).sqrt()
}

/// The reverse.
fn half_tangent(y: f64) -> f64 {
    let mut logarithm = half_tangent_about(y).ln();
    for _ in 0..60 {
        let [own, slope] = load(logarithm.exp());
        let next = (logarithm - (own / y).ln() * own / slope).min(0.5 * (logarithm + NEAT_FIT.ln()));
        let step = next - logarithm;
        logarithm = next;
        // Newton's next step would be about the square of this one.
        if step.abs() < 1e-3 {
            break;
        }
    }
    logarithm.exp()
}

fn value(constants: &[f64], x: f64, guess: f64) -> [f64; 2] {
    at(x, half_tangent_about(guess).ln(), (-30.0, NEAT_FIT.ln()), |logarithm| {
        let [y, slope] = load(logarithm.exp());
        let under = constants[0] - 2.0 * logarithm;
        [[y * under / PI, (slope * under - 2.0 * y) / PI], [y, slope]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_tangents_are_the_reverse_of_loads() {
        // Up to fifty times E* t dR.
        let mut b = 1e-4_f64;
        while load(b)[0] < 50.0 {
            let y = load(b)[0];
            assert!((half_tangent_about(y) / b - 1.0).abs() < 1e-5, "{b}");
            assert!((half_tangent(y) / b - 1.0).abs() < 2e-9, "{b}");
            b += 0.001 * b.min(NEAT_FIT - b);
        }
        assert!(b > 0.88, "{b}");
    }
}
