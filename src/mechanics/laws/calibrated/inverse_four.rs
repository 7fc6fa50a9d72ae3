//! s = (f/pi) ln(A + B f^(-1/3) + C f^(-2/3) + D/f), s = delta/e, f = F/(E* t e): four constants; f^(-1/3) is the range of thin layers.

use super::logarithm::{LogarithmSum, inverse};
use super::{Added, CalibratedLaw, Number, Sample, Samples};
use std::f64::consts::PI;

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "inverse-four",
    outside: "goes on by its formula, with the right limits for small and large loads",
    constants: &["A", "B", "C", "D"],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let a = Number(constants[0]);
        let [b, c, d] = [1, 2, 3].map(|place| Added(constants[place]));
        let (stiffness, clearance) = (Number(sizes.stiffness), Number(sizes.radial_clearance));
        format!(
            "d = F/{}*ln({a} {b}*f^(-1/3) {c}*f^(-2/3) {d}/f), f = F/({stiffness}*(d + {clearance}))",
            Number(PI * sizes.stiffness)
        )
    },
};

fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    let functions = |sample: &Sample| {
        let root = 1.0 / sample.force().cbrt();
        [1.0, root, root * root, root * root * root]
    };
    let rows: Vec<_> = samples.iter().map(functions).collect();
    Some(LogarithmSum::new(samples)?.fit(&rows)?.to_vec())
}

fn value(constants: &[f64], x: f64, guess: f64) -> [f64; 2] {
    let [a, b, c, d] = [0, 1, 2, 3].map(|place| constants[place]);
    inverse(x, guess, |logarithm| {
        let root = (-logarithm / 3.0).exp();
        let slope = -root * (b + root * (2.0 * c + root * 3.0 * d)) / 3.0;
        [a + root * (b + root * (c + root * d)), slope]
    })
}
