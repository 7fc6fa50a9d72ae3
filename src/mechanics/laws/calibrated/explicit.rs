//! F = pi E* t delta/ln[a + b (e/delta)^(1/2) + c (e/delta)^n], e = dR + delta: four constants, no iteration.

use std::f64::consts::PI;

use super::logarithm::LogarithmSum;
use super::{CalibratedLaw, Sample, Samples, number};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "explicit",
    outside: "goes on by its formula: within 0.2 to 3 % up to ten times the range, its slope at no load is not the joint's",
    constants: &["a", "b", "c", "n"],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let [a, b, c, n] = [0, 1, 2, 3].map(|place| number(constants[place]));
        let (stiffness, clearance) = (number(PI * sizes.stiffness), number(sizes.radial_clearance));
        format!("F = {stiffness}*d/ln({a} + {b}*((d + {clearance})/d)^0.5 + {c}*((d + {clearance})/d)^{n})")
    },
};

/// Exponents that are tried, and how closely the best is found.
const EXPONENTS: (f64, f64) = (0.6, 2.2);
const CLOSE: f64 = 0.02;

fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    let sum = LogarithmSum::new(samples)?;
    let roots: Vec<[f64; 2]> =
        samples.iter().map(|sample| sample.share()).map(|share| [1.0 / share.sqrt(), -share.ln()]).collect();
    let rows = |exponent: f64| -> Vec<[f64; 3]> {
        roots.iter().map(|[root, logarithm]| [1.0, *root, (exponent * logarithm).exp()]).collect()
    };
    let misfit = |exponent: f64| sum.least_misfit(&rows(exponent)).unwrap_or(f64::INFINITY);
    let exponent = golden_section(EXPONENTS, misfit);
    let [a, b, c] = sum.fit(&rows(exponent))?;
    let constants = vec![a, b, c, exponent];
    // Between the states, too, the argument of the logarithm must be above 1, and the force rise.
    let between = samples.windows(2).map(|pair| (pair[0].x * pair[1].x).sqrt());
    let is_sound = |x| value(&constants, x, f64::NAN)[1] > 0.0;
    between.into_iter().all(is_sound).then_some(constants)
}

/// The place of the least value, where there is one least.
fn golden_section((mut low, mut high): (f64, f64), value: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let mut inner = [high - SHARE * (high - low), low + SHARE * (high - low)];
    let mut values = inner.map(&value);
    while high - low > CLOSE {
        if values[0] <= values[1] {
            high = inner[1];
            inner = [high - SHARE * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + SHARE * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    0.5 * (low + high)
}

fn value(constants: &[f64], x: f64, _: f64) -> [f64; 2] {
    let [a, b, c, n] = [0, 1, 2, 3].map(|place| constants[place]);
    let ratio = (1.0 + x) / x;
    let (root, power) = (b * ratio.sqrt(), c * ratio.powf(n));
    let under = a + root + power;
    let logarithm = under.ln();
    let y = PI * x / logarithm;
    // d ratio/dx = -1/x^2.
    let slope = -(0.5 * root + n * power) / (ratio * x * x * under);
    // Below 1 the logarithm has no meaning here.
    if under <= 1.0 { [f64::NAN; 2] } else { [y, y / x - y / logarithm * slope] }
}
