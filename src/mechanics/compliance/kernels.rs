//! Galerkin matrices of the infinitely extended bodies: the kernels sum of (2/pi) cos(n phi) cos(n phi') f(n) in the
//! trial pressures of one arc, in closed form.
//!
//! Half the range suffices: pressures are even, so that for tau in (0, pi/2) the other point goes over (0, pi).

use std::f64::consts::{FRAC_PI_2, PI};

use super::arc::{ContactArc, MAX_TERMS, cosines, packed, packed_count};
use crate::mechanics::element::quadrature::gauss_legendre;

/// Points, beyond one for each trial pressure, of the rules for the two kernels: with more of them nothing changes
/// by more than 1e-12.
const SMOOTH_RULE: usize = 22;
const KINK_RULE: usize = 22;

/// Galerkin matrix, packed, of f(n) = 1/n over n >= 1, less its -pi/2 ln b in (0, 0).
///
/// From ln|2 cos phi - 2 cos phi'| = ln|s^2 - s'^2| + 2 ln b + ln 4 - ln(1 + b^2 s^2) - ln(1 + b^2 s'^2), of which the
/// first is diagonal in T_2k and the last two have the Fourier series of ln(1 + 2 q cos(2 tau) + q^2), q = t^2.
pub fn logarithmic_kernel(arc: &ContactArc, terms: usize) -> Vec<f64> {
    let q = arc.t * arc.t;
    let fourier = |k: usize| match k {
        0 => -PI * (1.0 - q).ln(),
        _ => -FRAC_PI_2 * (-q).powi(k as i32) / k as f64,
    };
    let mut matrix = vec![0.0; packed_count(terms)];
    for k in 1..terms {
        matrix[packed(k, k)] = PI / (8.0 * k as f64);
        matrix[packed(k, 0)] = 0.5 * fourier(k);
    }
    // -[pi pi/2 ln(1/2) + (pi/2)^2 ln 4 - 2 (pi/2) fourier(0)]/pi: the logarithms of 2 cancel.
    matrix[0] = fourier(0);
    matrix
}

/// The rule of `cubic_kernel`: weights for integrals of ln|cos tau - cos tau'| f(tau') over tau' in (0, pi) by the values
/// of f at the midpoints of `count` equal steps, exact for f = cos(k tau'), k < count (R. Kress, Linear Integral Equations, sect. 12.3):
/// `[node of tau][node of tau']`.
pub fn logarithmic_rule(terms: usize) -> Vec<f64> {
    let count = 2 * (SMOOTH_RULE + terms);
    let step = PI / count as f64;
    let cosine = |i: usize, k: usize| ((i as f64 + 0.5) * step * k as f64).cos();
    let table: Vec<f64> = (0..count * count).map(|i| cosine(i / count, i % count)).collect();
    let wave = |node: usize| &table[node * count..(node + 1) * count];
    let weight = |i: usize, j: usize| {
        let sum: f64 = (1..count).map(|k| wave(i)[k] * wave(j)[k] / k as f64).sum();
        -step * (2.0_f64.ln() + 2.0 * sum)
    };
    (0..count * count).map(|i| weight(i / count, i % count)).collect()
}

/// Galerkin matrix, packed, of the sum over n >= 2 of cos(n theta)/(n (n^2 - 1))
/// = (1 - cos theta) ln(2 sin(theta/2)) - 1/2 + 3/4 cos theta.
///
/// With x = tan(phi/2) = b s and g = 1/(1 + x^2): 1 - cos theta = 2 b^2 (s - s')^2 g g', and
/// ln(2 sin(theta/2)) = ln|s - s'| + ln(2 b) + ln(g)/2 + ln(g')/2, so all but ln|s - s'| is smooth.
pub fn cubic_kernel(arc: &ContactArc, terms: usize, rule: &[f64]) -> Vec<f64> {
    let count = rule.len().isqrt();
    let step = PI / count as f64;
    let nodes: Vec<(f64, f64, f64)> = (0..count)
        .map(|i| {
            let s = ((i as f64 + 0.5) * step).cos();
            let g = 1.0 / (1.0 + arc.b * arc.b * s * s);
            (s, g, 0.5 * g.ln())
        })
        .collect();
    let trials: Vec<[f64; MAX_TERMS]> = nodes.iter().map(|(s, ..)| cosines(2.0 * s * s - 1.0)).collect();
    let mut matrix = vec![0.0; packed_count(terms)];
    let double = (2.0 * arc.b).ln();
    for (i, (s, g, ln_g)) in nodes.iter().enumerate() {
        let mut potential = [0.0; MAX_TERMS];
        for (j, (other, other_g, other_ln_g)) in nodes.iter().enumerate() {
            let versine = 2.0 * (arc.b * (s - other)).powi(2) * g * other_g;
            let smooth = versine * (double + ln_g + other_ln_g) + 0.25 - 0.75 * versine;
            let weight = versine * rule[i * count + j] + smooth * step;
            potential.iter_mut().zip(&trials[j]).for_each(|(sum, trial)| *sum += weight * trial);
        }
        for row in 0..terms {
            for column in 0..=row {
                // Half of the integral over tau in (0, pi).
                matrix[packed(row, column)] += 0.5 * step / PI * trials[i][row] * potential[column];
            }
        }
    }
    matrix
}

/// The rule of `quadratic_kernel`: points and weights on [-1, 1].
pub fn kinked_rule(terms: usize) -> Vec<(f64, f64)> {
    gauss_legendre(KINK_RULE + terms)
}

/// Galerkin matrix, packed, of the sum over n >= 2 of cos(n theta)/(n^2 - 1)
/// = 1/2 + 1/4 cos theta - (pi - theta)/2 sin theta, 0 <= theta <= 2 pi, which has a kink on the diagonal.
///
/// For each tau the integral over tau' in (0, pi) is taken on both sides of the kink. sin(theta/2) = |x - x'|/h,
/// cos(theta/2) = (1 + x x')/h, h^2 = (1 + x^2)(1 + x'^2).
pub fn quadratic_kernel(arc: &ContactArc, terms: usize, rule: &[(f64, f64)]) -> Vec<f64> {
    let mut matrix = vec![0.0; packed_count(terms)];
    for &(point, outer_weight) in rule {
        let tau = 0.5 * FRAC_PI_2 * (1.0 + point);
        let x = arc.b * tau.cos();
        let mut potential = [0.0; MAX_TERMS];
        for (start, end) in [(0.0, tau), (tau, PI)] {
            for &(point, weight) in rule {
                let other = (0.5 * (start + end) + 0.5 * (end - start) * point).cos();
                let y = arc.b * other;
                let scale = 1.0 / ((1.0 + x * x) * (1.0 + y * y)).sqrt();
                let (sine, cosine) = ((x - y).abs() * scale, (1.0 + x * y) * scale);
                let theta = 2.0 * sine.atan2(cosine);
                let kernel = 0.75 - 0.5 * sine * sine - (PI - theta) * sine * cosine;
                let weight = 0.5 * (end - start) * weight * kernel;
                let trials = cosines(2.0 * other * other - 1.0);
                potential.iter_mut().zip(&trials).for_each(|(sum, trial)| *sum += weight * trial);
            }
        }
        let trials = cosines((2.0 * tau).cos());
        for row in 0..terms {
            for column in 0..=row {
                // Symmetric but for the quadrature: take the mean.
                let product = trials[row] * potential[column] + trials[column] * potential[row];
                matrix[packed(row, column)] += 0.25 * FRAC_PI_2 / PI * outer_weight * product;
            }
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::pressure_space::PressureSpace;
    use super::*;

    /// The kernels against their own series, summed to where the remainder is below the tolerance.
    #[test]
    fn kernels_equal_their_series() {
        let space = PressureSpace::new(4, 2.0);
        let highest = 2000;
        let moments = space.moments(highest);
        let entries = packed_count(4);
        for node in [0, 9, 15] {
            for row in 0..4 {
                for column in 0..=row {
                    let term = |n: usize, k: usize| moments[n * 4 + k][node];
                    let sum = |weight: &dyn Fn(f64) -> f64, first: usize| -> f64 {
                        (first..=highest)
                            .map(|n| 2.0 / PI * weight(n as f64) * term(n, row) * term(n, column))
                            .sum()
                    };
                    let at = node * entries + packed(row, column);
                    let cubic = sum(&|n| 1.0 / (n * (n * n - 1.0)), 2);
                    let quadratic = sum(&|n| 1.0 / (n * n - 1.0), 2);
                    // What the series leave out beyond the highest mode: their terms fall like n^-4, n^-3.
                    assert!(
                        (space.cubic[at] - cubic).abs() < 1e-8,
                        "cubic {row},{column}: {} {cubic}",
                        space.cubic[at]
                    );
                    assert!(
                        (space.quadratic[at] - quadratic).abs() < 1e-6,
                        "quadratic {row},{column}: {} {quadratic}",
                        space.quadratic[at]
                    );
                    let arc = space.arcs[node];
                    let log = space.logarithm[at] - if row == 0 { FRAC_PI_2 * arc.b.ln() } else { 0.0 };
                    let series = sum(&|n| 1.0 / n, 1);
                    // These fall like n^-2: 2/(pi eps highest) is left.
                    assert!(
                        (log - series).abs() < 1e-3,
                        "log {row},{column} at {}: {log} {series}",
                        arc.half_angle
                    );
                }
            }
        }
    }
}
