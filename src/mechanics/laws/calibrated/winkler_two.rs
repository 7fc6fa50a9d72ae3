//! Winkler's bed with calibrated modulus and exponent, F = (pi/2) m E* t delta [delta/(2 e)]^n: Liu, Zhang & Yang's law has m = 2,
//! n = 1/2.

use std::f64::consts::FRAC_PI_2;

use super::power_of::fit_power;
use super::{CalibratedLaw, Number, Sample, Samples};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "winkler",
    outside: "goes on by its formula: too soft for small loads",
    constants: &["m", "n"],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let (clearance, exponent) = (Number(sizes.radial_clearance), Number(constants[1]));
        let factor = Number(FRAC_PI_2 * constants[0] * sizes.stiffness);
        format!("F = {factor}*d*(d/(2*(d + {clearance})))^{exponent}")
    },
};

fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    fit_power(samples, |sample| [0.5 * sample.share(), FRAC_PI_2 * sample.x])
}

fn value(constants: &[f64], x: f64, _: f64) -> [f64; 2] {
    let y = FRAC_PI_2 * constants[0] * x * (0.5 * x / (1.0 + x)).powf(constants[1]);
    [y, y / x * (1.0 + constants[1] / (1.0 + x))]
}
