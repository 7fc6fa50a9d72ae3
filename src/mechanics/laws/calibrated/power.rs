//! F = k delta^n over the whole range: what most contact dialogues take, and not good there.

use super::power_of::fit_power;
use super::{CalibratedLaw, Number, Sample, Samples, Sizes};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "power",
    outside: "goes on as a power: too soft for small loads, too stiff for large ones",
    constants: &["k", "n"],
    range: Samples::range,
    fit,
    value,
    formula,
};

pub(super) fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    fit_power(samples, |sample| [sample.x, 1.0])
}

pub(super) fn value(constants: &[f64], x: f64, _: f64) -> [f64; 2] {
    let y = constants[0] * x.powf(constants[1]);
    [y, constants[1] * y / x]
}

/// k in N/mm^n.
pub(super) fn formula(constants: &[f64], sizes: &Sizes) -> String {
    let [factor, exponent] = [constants[0], constants[1]];
    let factor = factor * sizes.stiffness * sizes.radial_clearance.powf(1.0 - exponent);
    format!("F = {}*d^{}", Number(factor), Number(exponent))
}
