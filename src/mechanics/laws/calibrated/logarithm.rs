//! What laws with a logarithm have in common: exp(pi delta E* t/F) is a sum of functions times constants, so that constants follow
//! from linear equations.

use super::Sample;
use super::least_squares::{LeastSquares, even_fit};

/// G = exp(pi s/f) of samples, as a sum of functions with constants. Weighted so that misfits are those of the force:
/// dF/F = -dG/(G ln G).
pub struct LogarithmSum {
    values: Vec<f64>,
    weights: Vec<f64>,
}

impl LogarithmSum {
    /// `None` where there are too few samples for four constants.
    pub fn new(samples: &[Sample]) -> Option<LogarithmSum> {
        let values: Vec<f64> = samples.iter().map(Sample::under_logarithm).collect();
        let weights = values.iter().map(|value| 1.0 / (value * value.ln())).collect();
        (samples.len() > 4).then_some(LogarithmSum { values, weights })
    }

    /// The constants with about the least worst misfit, for functions at the samples.
    pub fn fit<const TERMS: usize>(&self, functions: &[[f64; TERMS]]) -> Option<[f64; TERMS]> {
        even_fit(functions, &self.values, &self.weights).map(|(constants, _)| constants)
    }

    /// The least sum of squares of misfits.
    pub fn least_misfit<const TERMS: usize>(
        &self,
        functions: &[[f64; TERMS]],
        room: &mut LeastSquares<TERMS>,
    ) -> Option<f64> {
        room.solve(functions, &self.values, &self.weights).map(|(_, left)| left)
    }
}

/// y and dy/dx of an inverse law, s = (f/pi) ln g(ln f), `g` giving g and dg/d ln f: by Newton's method for ln f.
pub fn inverse(x: f64, guess: f64, g: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    const STEPS: usize = 60;
    let target = std::f64::consts::PI * x / (1.0 + x);
    let of_target = target.ln();
    // ln of f ln g, to be ln of the target, and its slope.
    let value = |logarithm: f64| {
        let [own, slope] = g(logarithm);
        let under = own.ln();
        [logarithm + under.ln() - of_target, 1.0 + slope / (own * under)]
    };
    // pi s/f is some 1 to 10.
    let guess = guess / (1.0 + x);
    let mut logarithm = if guess > 0.0 { guess } else { target / 3.0 }.ln();
    for _ in 0..STEPS {
        let [excess, slope] = value(logarithm);
        let step = excess / slope;
        if !step.is_finite() || slope <= 0.0 {
            return [f64::NAN; 2];
        }
        logarithm -= step.clamp(-1.0, 1.0);
        // Newton's next step would be the square of this one; the slope is that of the place before.
        if step.abs() < 1e-6 {
            let (force, share) = (logarithm.exp(), x / (1.0 + x));
            // y = f (1 + x), d ln f = d ln s/slope, ds/dx = 1/(1 + x)^2.
            return [force * (1.0 + x), force + force / (slope * share * (1.0 + x))];
        }
    }
    [f64::NAN; 2]
}
