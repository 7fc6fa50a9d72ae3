//! Laws that are straight lines between logarithms.

use super::Sample;
use super::least_squares::even_fit;

/// ln y = ln k + n ln u - ln v for given u and v: k and n, with the least worst misfit.
pub fn fit_power(samples: &[Sample], terms: impl Fn(&Sample) -> [f64; 2]) -> Option<Vec<f64>> {
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for sample in samples {
        let [base, over] = terms(sample);
        rows.push([1.0, base.ln()]);
        values.push((sample.y / over).ln());
    }
    let ([logarithm, exponent], _) = even_fit(&rows, &values, &vec![1.0; samples.len()])?;
    (exponent > 0.0).then(|| vec![logarithm.exp(), exponent])
}
