//! The lower real branch of Lambert's W, written so that it stays accurate at the branch point.
//!
//! W_-1(x), -1/e <= x < 0, is the root w <= -1 of w e^w = x. With w = -1 - v and x = -q/e the equation reads
//! v - ln(1 + v) = -ln q, v >= 0, 0 < q <= 1: nothing cancels for q -> 1, where w itself is a square root.

use std::f64::consts::E;
use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, check};

/// E + E_REST is Euler's number to twice the precision.
const E_REST: f64 = 1.445_646_891_729_250_2e-16;

/// W_-1(x) for -1/e <= x < 0.
pub fn lambert_wm1(x: f64) -> Result<f64, LawError> {
    check("lambert-wm1", "x", x, (Included(-1.0 / E), Excluded(0.0)))?;
    // 1 - q = 1 + e x without cancellation; below zero only by the rounding of -1/e.
    let product = x * E;
    let distance = (product + 1.0 + (rounding(x, E, product) + x * E_REST)).max(0.0);
    // Far from the branch point the logarithm of x itself loses nothing, and e x could underflow.
    let minus_ln_q = if distance < 0.5 { -(-distance).ln_1p() } else { -1.0 - (-x).ln() };
    Ok(-1.0 - root(minus_ln_q))
}

/// What a product of two numbers lost when it was rounded, by halves of their digits (T. J. Dekker 1971). A fused multiplication would tell, too,
/// but not every processor has one.
fn rounding(a: f64, b: f64, product: f64) -> f64 {
    let halves = |x: f64| {
        let shifted = 134_217_729.0 * x;
        let high = shifted - (shifted - x);
        [high, x - high]
    };
    let ([a, rest_of_a], [b, rest_of_b]) = (halves(a), halves(b));
    a * b - product + a * rest_of_b + rest_of_a * b + rest_of_a * rest_of_b
}

/// v = -1 - W_-1(-q/e) for 0 <= q <= 1: 0 at the branch point, infinite for q = 0.
pub(super) fn below_branch_point(q: f64) -> f64 {
    root(-q.ln())
}

/// The root v >= 0 of v - ln(1 + v) = s, s >= 0, by Halley's iteration from the two asymptotic series.
fn root(s: f64) -> f64 {
    if s == f64::INFINITY {
        return s;
    }
    // v in powers of p = sqrt(2 s): the series behind Stirling's.
    let p = (2.0 * s).sqrt();
    let near = p
        * (1.0 + p * (1.0 / 3.0 + p * (1.0 / 36.0 + p * (-1.0 / 270.0 + p * (1.0 / 4320.0 + p / 17010.0)))));
    // The next term is 3e-5 p^7, below round-off here, while v - ln(1 + v) already cancels.
    if p < 0.01 {
        return near;
    }
    let mut v = if s < 2.0 { near } else { s + (1.0 + s + (1.0 + s).ln()).ln() };
    // Cubic convergence from a start within 2 %: two steps reach round-off, the others are spare.
    for _ in 0..6 {
        let residual = v - v.ln_1p() - s;
        let newton = residual * (1.0 + v) / v;
        let step = newton / (1.0 - newton / (2.0 * v * (1.0 + v)));
        v -= step;
        if step.abs() <= 2.0 * f64::EPSILON * v {
            break;
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (x, W_-1(x)) to 30 digits by mpmath, rounded to f64; x as the f64 nearest to what is written.
    const REFERENCE: [(f64, f64); 8] = [
        (-0.36787944117144, -1.0000001122836022),
        (-0.3678794, -1.0004731826130855),
        (-0.36, -1.2227701339785062),
        (-0.3, -1.7813370234216277),
        (-0.1, -3.577152063957297),
        (-0.001, -9.11800647040274),
        (-1e-100, -235.72115887568532),
        (-1e-300, -697.3227762954601),
    ];

    #[test]
    fn agrees_with_thirty_digit_values() {
        for (x, expected) in REFERENCE {
            let w = lambert_wm1(x).unwrap();
            // Four units in the last place: one rounding each in ln, ln_1p, sqrt and the last sum.
            assert!((w / expected - 1.0).abs() <= 4.0 * f64::EPSILON, "x = {x}: {w} for {expected}");
        }
    }

    #[test]
    fn the_distance_to_the_branch_point_keeps_its_relative_accuracy() {
        // q = 1 - 2^-40 is exact in f64; v = p + p^2/3 + ... with p^2 = -2 ln q, by hand. 1e-15: round-off.
        let tiny = 2f64.powi(-40);
        let p = (2.0 * (tiny + tiny * tiny / 2.0)).sqrt();
        let expected = p + p * p / 3.0 + p * p * p / 36.0;
        let v = below_branch_point(1.0 - tiny);
        assert!((v / expected - 1.0).abs() < 1e-15, "{v} for {expected}");
        assert_eq!(below_branch_point(1.0), 0.0);
        assert_eq!(below_branch_point(0.0), f64::INFINITY);
    }

    #[test]
    fn solves_its_equation_over_the_whole_range() {
        // Residual of v - ln(1 + v) = s against its own round-off, for s from 1e-6 to 1e6.
        for step in 0..=600 {
            let s = 10f64.powf(-6.0 + 0.02 * f64::from(step));
            let v = root(s);
            assert!((v - v.ln_1p() - s).abs() <= 4.0 * f64::EPSILON * v.max(s), "s = {s}, v = {v}");
        }
    }

    #[test]
    fn refuses_what_has_no_real_value() {
        for x in [f64::NAN, f64::NEG_INFINITY, f64::INFINITY, -0.4, 0.0, 0.1] {
            assert!(lambert_wm1(x).is_err(), "{x}");
        }
        assert_eq!(lambert_wm1(-1.0 / E), Ok(-1.0));
    }
}
