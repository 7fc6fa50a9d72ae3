//! The rule by which kernels of two points with a logarithm or a kink where these meet are integrated.

use std::f64::consts::PI;

use crate::mechanics::compliance::arc::{MAX_TERMS, cosines};
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};

/// Weights for integrals over tau and tau' in (0, pi), at the midpoints of 2 `half` equal steps. Smooth functions take the midpoint rule.
/// ln|cos tau - cos tau'| f and sgn(tau' - tau) f are exact where f is a polynomial in cos tau and cos tau' of lower degree than there
/// are points: the first by R. Kress, Linear Integral Equations, sect. 12.3, the other by
///
/// ```text
///   integral of sgn(tau' - tau) cos(k tau) cos(l tau') over both = 4/(k^2 - l^2) for odd k + l, else 0.
/// ```
pub(super) struct ProductRule {
    /// Points over (0, pi/2). The others are their mirror images.
    pub half: usize,
    /// cos(tau) and the trial pressures at these.
    pub nodes: Vec<f64>,
    pub trials: Vec<[f64; MAX_TERMS]>,
    /// Of logarithm and sign over the step of tau, `[tau][tau'][tau' or pi - tau']`.
    pub weights: Vec<[[f64; 2]; 2]>,
}

impl ProductRule {
    pub fn new(half: usize, terms: usize) -> ProductRule {
        let count = 2 * half;
        let step = PI / count as f64;
        // Cosines of all multiples of half a step, and every so many of them, with one from `first` on.
        let table: Vec<f64> = (0..4 * count).map(|i| (0.5 * i as f64 * step).cos()).collect();
        let every = |distance: usize, first: usize| {
            std::iter::successors(Some(first), move |at| {
                let next = at + distance;
                Some(if next < 4 * count { next } else { next - 4 * count })
            })
            .map(|at| table[at])
        };
        // Sums of cos(k tau) cos(k tau')/k are half of those of cos(k (tau - tau'))/k and cos(k (tau + tau'))/k: one for each multiple of a step.
        let sum = |steps: usize| -> f64 {
            every(2 * steps, 2 * steps).zip(1..count).map(|(cosine, k)| cosine / k as f64).sum()
        };
        let sums: Vec<f64> = (0..=count).map(sum).collect();
        // cos(k tau) at the points for every other k, `[k][tau]`.
        let waves = |first: usize| -> Vec<f64> {
            let mut waves = Vec::with_capacity(half * half);
            (first..count).step_by(2).for_each(|k| waves.extend(every(2 * k, k).take(half)));
            waves
        };
        let (odd, even) = (waves(1), waves(0));
        let skew = in_lanes(Skew { half, odd: &odd, even: &even });
        let weight = |i: usize, j: usize| {
            let (own, reverse) = (skew[i * half + j], skew[j * half + i]);
            let logarithm = |one: usize, other: usize| -step * (2.0_f64.ln() + sums[one] + sums[other]);
            // Odd waves of tau' are the negative at pi - tau'.
            [
                [logarithm(i.abs_diff(j), i + j + 1), own - reverse],
                [logarithm(count - 1 - i - j, count - i.abs_diff(j)), own + reverse],
            ]
        };
        let weight = &weight;
        let nodes = odd[..half].to_vec();
        ProductRule {
            half,
            trials: nodes.iter().map(|s| cosines(2.0 * s * s - 1.0, terms)).collect(),
            weights: (0..half).flat_map(|i| (0..half).map(move |j| weight(i, j))).collect(),
            nodes,
        }
    }
}

/// Weights of the sign, `[tau][tau']`, of odd waves of tau and even ones of tau'. The reverse is the negative, transposed.
struct Skew<'a> {
    half: usize,
    /// `[k][tau]` each.
    odd: &'a [f64],
    even: &'a [f64],
}

impl LaneWork for Skew<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<f64> {
        let Skew { half, odd, even } = self;
        let mut all = vec![0.0; half * half];
        let mut factors = vec![0.0; half];
        for (place, odd) in odd.chunks_exact(half).enumerate() {
            let k = (2 * place + 1) as f64;
            factors.fill(0.0);
            for (place, even) in even.chunks_exact(half).enumerate() {
                let l = (2 * place) as f64;
                let factor = if place == 0 { 4.0 } else { 8.0 } / (PI * half as f64 * (k * k - l * l));
                for (sum, even) in factors.iter_mut().zip(even) {
                    *sum += factor * even;
                }
            }
            for (row, odd) in all.chunks_exact_mut(half).zip(odd) {
                for (sum, factor) in row.iter_mut().zip(&factors) {
                    *sum += odd * factor;
                }
            }
        }
        all
    }
}
