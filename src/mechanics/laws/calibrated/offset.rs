//! Laws that a plate's extent adds a constant to: pi x/y = C + L, L a function of the load that falls.

use super::Sample;
use super::least_squares::even_fit;

/// C whose worst relative misfit of the indentation is least.
pub fn fit_offset(samples: &[Sample], logarithm: impl Fn(&Sample) -> f64) -> Option<f64> {
    let (mut rows, mut values, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for sample in samples {
        let whole = std::f64::consts::PI * sample.x / sample.y;
        rows.push([1.0]);
        values.push(whole - logarithm(sample));
        weights.push(1.0 / whole);
    }
    even_fit(&rows, &values, &weights).map(|([constant], _)| constant)
}

/// Where x and y are given by a parameter u and rise with it: y and dy/dx at an x, by Newton's method between bounds of u, from a
/// guess at it. `state` gives x, y and their slopes in u.
pub fn at(
    x: f64,
    guess: f64,
    (mut low, mut high): (f64, f64),
    state: impl Fn(f64) -> [[f64; 2]; 2],
) -> [f64; 2] {
    const STEPS: usize = 100;
    let mut u = if guess > low && guess < high { guess } else { 0.5 * (low + high) };
    for _ in 0..STEPS {
        let [[own, slope], [y, y_slope]] = state(u);
        // Compared in logarithms: x is nearly a power of the load.
        let excess = (own / x).ln();
        // Newton's step from here leaves nothing.
        if excess.abs() < 1e-7 {
            return [y - excess * own / slope * y_slope, y_slope / slope];
        }
        if excess.is_nan() {
            return [f64::NAN; 2];
        }
        if excess > 0.0 {
            high = u
        } else {
            low = u
        }
        let next = u - excess * own / slope;
        u = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    [f64::NAN; 2]
}
