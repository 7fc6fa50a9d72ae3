//! Gauss-Legendre rules on [-1, 1].

use std::f64::consts::PI;

/// The two-point rule, for both elements: exact for the bilinear stiffness on parallelograms, and the reduced rule
/// that keeps Q8 free of volumetric locking.
pub const TWO_POINT: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

/// Points and weights of the rule of `count` points, by Newton's method on the Legendre polynomial.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let mut rule = Vec::with_capacity(count);
    for i in 0..count {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut p, mut previous) = (1.0, 0.0);
            for k in 0..count {
                let k = k as f64;
                (p, previous) = (((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0), p);
            }
            slope = n * (x * p - previous) / (x * x - 1.0);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        rule.push((x, 2.0 / ((1.0 - x * x) * slope * slope)));
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn integrates_polynomials_up_to_twice_the_count() {
        for count in 1..=20 {
            let integral = |degree: usize| -> f64 {
                gauss_legendre(count).iter().map(|(x, w)| w * x.powi(degree as i32)).sum()
            };
            for degree in 0..2 * count {
                let expected = if degree.is_multiple_of(2) { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                // Rounding of `count` terms of size one.
                let error = (integral(degree) - expected).abs();
                assert!(error < 1e-14 * count as f64, "{count} points, degree {degree}: {error:e}");
            }
        }
    }
}
