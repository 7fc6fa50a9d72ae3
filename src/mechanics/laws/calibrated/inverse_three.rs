//! s = (f/pi) ln(A + B f^(-1/2) + C/f), s = delta/e, f = F/(E* t e): both limits exact, three constants.

use super::logarithm::{LogarithmSum, inverse};
use super::{Added, CalibratedLaw, Number, Sample, Samples};
use std::f64::consts::PI;

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "inverse-three",
    outside: "goes on by its formula, with the right limits for small and large loads",
    constants: &["A", "B", "C"],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let a = Number(constants[0]);
        let [b, c] = [1, 2].map(|place| Added(constants[place]));
        let (stiffness, clearance) = (Number(sizes.stiffness), Number(sizes.radial_clearance));
        format!(
            "d = F/{}*ln({a} {b}*f^-0.5 {c}/f), f = F/({stiffness}*(d + {clearance}))",
            Number(PI * sizes.stiffness)
        )
    },
};

fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    let functions = |sample: &Sample| [1.0, 1.0 / sample.force().sqrt(), 1.0 / sample.force()];
    let rows: Vec<_> = samples.iter().map(functions).collect();
    Some(LogarithmSum::new(samples)?.fit(&rows)?.to_vec())
}

fn value(constants: &[f64], x: f64, guess: f64) -> [f64; 2] {
    let [a, b, c] = [0, 1, 2].map(|place| constants[place]);
    inverse(x, guess, |logarithm| {
        let root = (-0.5 * logarithm).exp();
        [a + root * (b + root * c), -root * (0.5 * b + root * c)]
    })
}
