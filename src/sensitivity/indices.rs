//! Sobol' indices of one output: which share of its variance each factor makes, by itself and with others.
//!
//! Of rows A, B, C_i (A with factor i of B), E being the mean over rows, m and V the mean and variance of all A and B:
//!
//! ```text
//! first order   S_i  = E[(B - m) (C_i - A)] / V     Saltelli et al., Computer Physics Communications 181 (2010), table 2 (b)
//! total         ST_i = E[(C_i - A)^2] / (2 V)       Jansen, Computer Physics Communications 117 (1999)
//! ```
//!
//! A factor that does nothing has both indices exactly 0, which Jansen's and Janon's estimators of the first order do not
//! give; `tests/analysis/sensitivity.rs` compares their errors.

pub use crate::sensitivity::moments::Moments;
use crate::sensitivity::moments::Sums;
use crate::study::sampling::mix;

/// Share of studies whose interval holds the true index, at least.
pub const CONFIDENCE: f64 = 0.95;

/// Draws of the bootstrap: the ends of an interval then move by some 5 % of its width from seed to seed.
pub const RESAMPLES: usize = 1000;

/// Of the bootstrap, always: the same values have the same intervals.
const SEED: u64 = 0x5eed;

/// A standard deviation below this, relative to the mean, is rounding: the output does not change.
const LEAST_DEVIATION: f64 = 1e-12;

/// A value with its interval, both ends as the bootstrap has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactorIndices {
    /// Share of the variance that is gone, on average, when this factor is known.
    pub first_order: Estimate,
    /// Share of the variance that is left, on average, when all other factors are known.
    pub total: Estimate,
}

/// The indices of one output.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// In the order of the factors.
    pub factors: Vec<FactorIndices>,
    /// 1 where factors only add up; what is missing from 1 is what they do together.
    pub sum_of_first_orders: Estimate,
}

/// Mean and standard deviation over all A and B; `None` without rows.
pub fn spread(moments: &Moments) -> Option<(f64, f64)> {
    let all = total(moments.factors(), moments.groups());
    let (mean, variance) = mean_and_variance(&all);
    (all.rows > 0.0).then(|| (moments.origin() + mean, variance.sqrt()))
}

/// `None` where the output does not change.
pub fn indices(moments: &Moments) -> Option<Indices> {
    let (mean, deviation) = spread(moments)?;
    if !deviation.is_finite() || deviation <= LEAST_DEVIATION * mean.abs() {
        return None;
    }
    let factors = moments.factors();
    let groups: Vec<&Sums> = moments.groups().collect();
    let values = shares(&total(factors, groups.iter().copied()));
    // Beyond what numbers hold.
    if !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let mut draws: Vec<Vec<f64>> = vec![Vec::with_capacity(RESAMPLES); values.len()];
    for resample in 0..RESAMPLES {
        let drawn = (0..groups.len()).map(|k| {
            let random = mix(SEED ^ mix((resample * groups.len() + k) as u64));
            groups[((u128::from(random) * groups.len() as u128) >> 64) as usize]
        });
        for (draws, share) in draws.iter_mut().zip(shares(&total(factors, drawn))) {
            // Groups that are all alike have no variance to share.
            if share.is_finite() {
                draws.push(share);
            }
        }
    }
    let estimates: Vec<Estimate> =
        values.into_iter().zip(draws).map(|(value, draws)| estimate(value, draws)).collect();
    let of_factor = |i: usize| FactorIndices { first_order: estimates[i], total: estimates[factors + i] };
    Some(Indices {
        factors: (0..factors).map(of_factor).collect(),
        sum_of_first_orders: estimates[2 * factors],
    })
}

fn total<'a>(factors: usize, groups: impl Iterator<Item = &'a Sums>) -> Sums {
    let mut all = Sums::new(factors);
    groups.for_each(|group| all.add(group));
    all
}

/// Relative to the origin of the sums.
fn mean_and_variance(sums: &Sums) -> (f64, f64) {
    let mean = sums.values / (2.0 * sums.rows);
    (mean, (sums.squares / (2.0 * sums.rows) - mean * mean).max(0.0))
}

/// First orders, totals, and the sum of the first orders.
fn shares(sums: &Sums) -> Vec<f64> {
    let (mean, variance) = mean_and_variance(sums);
    let first = sums.change_with_b.iter().zip(&sums.change);
    let mut shares: Vec<f64> =
        first.map(|(with_b, change)| (with_b - mean * change) / (sums.rows * variance)).collect();
    let sum = shares.iter().sum();
    shares.extend(sums.change_squared.iter().map(|squared| squared / (2.0 * sums.rows * variance)));
    shares.push(sum);
    shares
}

/// With the interval between equal tails of what was drawn.
fn estimate(value: f64, mut draws: Vec<f64>) -> Estimate {
    draws.sort_unstable_by(f64::total_cmp);
    let end = |share: f64| {
        let place = share * draws.len().saturating_sub(1) as f64;
        let at = |place: f64| draws.get(place as usize).copied().unwrap_or(value);
        at(place.floor()) + place.fract() * (at(place.ceil()) - at(place.floor()))
    };
    let tail = 0.5 * (1.0 - CONFIDENCE);
    Estimate { value, low: end(tail), high: end(1.0 - tail) }
}
