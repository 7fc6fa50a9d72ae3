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

/// The reverse, right for small and for large loads.
fn half_tangent_about(y: f64) -> f64 {
    let square = y / PI;
    (square / (1.0 + square / (NEAT_FIT * NEAT_FIT))).sqrt()
}

/// The reverse.
fn half_tangent(y: f64) -> f64 {
    let mut logarithm = half_tangent_about(y).ln();
    for _ in 0..60 {
        let [own, slope] = load(logarithm.exp());
        let next = (logarithm - (own / y).ln() * own / slope).min(0.5 * (logarithm + NEAT_FIT.ln()));
        let step = next - logarithm;
        logarithm = next;
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
