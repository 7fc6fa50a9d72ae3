//! Johnson's law with a calibrated offset, delta = F/(pi E* t) [ln(E* t dR/F) + C]; his own is C = ln(4 pi) - 1. For small loads only:
//! it turns back at F = E* t dR exp(C - 1).

use std::f64::consts::PI;

use super::offset::{at, fit_offset};
use super::{Added, CalibratedLaw, Number};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "johnson",
    outside: "right for loads below its range, has no value above the load where it turns back",
    constants: &["C"],
    range: |samples| {
        let (low, high) = samples.range();
        // As the smallest load has it, with some distance from where the law turns back.
        let turning = (samples.small_load_constant() - 1.0).exp();
        let reached = samples.between((low, high)).iter().take_while(|sample| sample.y < FAR * turning);
        (low, reached.last().map_or(low, |sample| sample.x))
    },
    fit: |samples| {
        let constant = fit_offset(samples, |sample| -sample.y.ln())?;
        Some(vec![constant])
    },
    value,
    formula: |constants, sizes| {
        let stiffness = Number(PI * sizes.stiffness);
        let scale = Number(sizes.stiffness * sizes.radial_clearance);
        format!("d = F/{stiffness}*(ln({scale}/F) {})", Added(constants[0]))
    },
};

/// Of the load where the law turns back.
const FAR: f64 = 0.1;

fn value(constants: &[f64], x: f64, guess: f64) -> [f64; 2] {
    let turning = constants[0] - 1.0;
    at(x, guess.ln(), (turning - 60.0, turning), |logarithm| {
        let y: f64 = logarithm.exp();
        let (under, slope) = (constants[0] - logarithm, turning - logarithm);
        [[y * under / PI, y * slope / PI], [y, y]]
    })
}
