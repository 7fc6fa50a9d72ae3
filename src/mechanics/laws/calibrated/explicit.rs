//! F = pi E* t delta/ln[a + b (e/delta)^(1/2) + c (e/delta)^n], e = dR + delta: four constants, no iteration.

use std::f64::consts::PI;

use super::least_squares::LeastSquares;
use super::logarithm::LogarithmSum;
use super::{Added, CalibratedLaw, Number, Sample, Samples};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "explicit",
    outside: "goes on by its formula: within 0.2 to 3 % up to ten times the range, its slope at no load is not the joint's",
    constants: &["a", "b", "c", "n"],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let [a, n] = [0, 3].map(|place| Number(constants[place]));
        let [b, c] = [1, 2].map(|place| Added(constants[place]));
        let (stiffness, clearance) = (Number(PI * sizes.stiffness), Number(sizes.radial_clearance));
        format!("F = {stiffness}*d/ln({a} {b}*((d + {clearance})/d)^0.5 {c}*((d + {clearance})/d)^{n})")
    },
};

/// Exponents that are tried, and how closely the best is found before a parabola tells the rest.
const EXPONENTS: (f64, f64) = (0.7, 2.0);
const CLOSE: f64 = 0.25;

fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    let sum = LogarithmSum::new(samples)?;
    let logarithms: Vec<f64> = samples.iter().map(|sample| -sample.share().ln()).collect();
    let mut rows: Vec<[f64; 3]> =
        samples.iter().map(|sample| [1.0, 1.0 / sample.share().sqrt(), 1.0]).collect();
    let mut room = LeastSquares::new();
    let exponent = least(EXPONENTS, |exponent| {
        raise(&mut rows, &logarithms, exponent);
        sum.least_misfit(&rows, &mut room).unwrap_or(f64::INFINITY)
    });
    raise(&mut rows, &logarithms, exponent);
    let [a, b, c] = sum.fit(&rows)?;
    let constants = vec![a, b, c, exponent];
    // Between the states, too, the argument of the logarithm must be above 1, and the force rise.
    let between = samples.windows(2).map(|pair| (pair[0].x * pair[1].x).sqrt());
    let is_sound = |x| value(&constants, x, f64::NAN)[1] > 0.0;
    between.into_iter().all(is_sound).then_some(constants)
}

/// Puts (e/delta)^n into the last column, from ln(e/delta).
fn raise(rows: &mut [[f64; 3]], logarithms: &[f64], exponent: f64) {
    rows.iter_mut().zip(logarithms).for_each(|(row, logarithm)| row[2] = (exponent * logarithm).exp());
}

/// The place of the least value, where there is one least: by the golden section, at the end by the parabola through the last places.
fn least((mut low, mut high): (f64, f64), mut value: impl FnMut(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let mut inner = [high - SHARE * (high - low), low + SHARE * (high - low)];
    let mut values = inner.map(&mut value);
    // The end beside the better one, with its value, where it was one of the inner places.
    let mut outer = None;
    while high - low > CLOSE {
        if values[0] <= values[1] {
            outer = Some((inner[1], values[1]));
            high = inner[1];
            inner = [high - SHARE * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            outer = Some((inner[0], values[0]));
            low = inner[0];
            inner = [inner[1], low + SHARE * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    let best = if values[0] <= values[1] { inner[0] } else { inner[1] };
    let Some((third, at_third)) = outer else { return best };
    // Where the slope of the parabola through the three is zero.
    let [a, b] = inner.map(|place| place - third);
    let [rise_a, rise_b] = values.map(|value| value - at_third);
    let below = 2.0 * (b * rise_a - a * rise_b);
    let vertex = third + (b * b * rise_a - a * a * rise_b) / below;
    if vertex > low && vertex < high { vertex } else { best }
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
