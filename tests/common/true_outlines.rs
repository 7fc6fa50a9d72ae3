//! Contact of two concentric bodies on their true outlines, nothing expanded: rays from the hole's centre meet the pin where they
//! meet it, the gap is what is between, the pressure acts along the ray on both bodies. Modes are those of `stepped_ring`.
//!
//! Pressures that vanish at the edge, tried against ones that are singular there: one equation more than pressures, for the
//! indentation. Lengths over the hole's radius; whole joint, per unit thickness.

use std::f64::consts::{FRAC_PI_2, PI};

use faer::Mat;
use faer::linalg::solvers::Solve;
use pulp::{Arch, Simd, WithSimd};

use super::stepped_ring::Ring;

/// A state of contact at a contact half angle of the hole.
#[derive(Clone, Copy, Debug)]
pub struct TrueState {
    pub indentation: f64,
    pub force: f64,
    pub peak_pressure: f64,
}

/// Pressures that are tried.
const TERMS: usize = 14;

/// Highest mode times the contact half angle.
const RESOLVED: f64 = 1500.0;

/// Integrals over a mode: of pressures that test, then of those that are tried, and what fills the registers.
const BOTH: usize = 2 * TERMS + 1;
const PADDED: usize = BOTH.next_multiple_of(8);

/// Modes whose integrals stay in the fastest memory.
const TOGETHER: usize = 32;

/// A point of the quadrature.
struct Point {
    phi: f64,
    theta: f64,
    tilt: f64,
    pressures: [f64; PADDED],
}

/// The integrals over modes from `first` on: of each side, hole and pin along and across its normal.
struct Integrals<'a> {
    points: &'a [Point],
    first: usize,
}

impl WithSimd for Integrals<'_> {
    type Output = [[[f64; PADDED]; 3]; TOGETHER];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut sums = [[[0.0; PADDED]; 3]; TOGETHER];
        for Point { phi, theta, tilt, pressures } in self.points {
            let (pressures, _) = S::as_simd_f64s(pressures);
            let begin = |angle: f64| {
                let (sine, cosine) = (self.first as f64 * angle).sin_cos();
                (cosine, sine)
            };
            let (mut hole, mut along) = (begin(*phi), begin(*theta));
            let turns = [phi.sin_cos(), theta.sin_cos()];
            let (across, normal) = tilt.sin_cos();
            for of_mode in &mut sums {
                let waves = [hole.0, along.0 * normal, along.1 * across];
                for (sums, wave) in of_mode.iter_mut().zip(waves) {
                    let wave = simd.splat_f64s(wave);
                    for (sum, pressure) in S::as_mut_simd_f64s(sums).0.iter_mut().zip(pressures) {
                        *sum = simd.mul_add_e_f64s(wave, *pressure, *sum);
                    }
                }
                hole = turned(hole, turns[0]);
                along = turned(along, turns[1]);
            }
        }
        sums
    }
}

/// The state of a joint with a radial clearance whose contact is as wide as that, rad.
pub fn true_state([pin, plate]: [Ring; 2], clearance: f64, half_angle: f64) -> TrueState {
    let b = (0.5 * half_angle).tan();
    let highest = (RESOLVED / half_angle.min(1.0)) as usize;
    let count = 64 + (highest as f64 * half_angle * (1.0 + 2.0 * clearance)) as usize;
    let weight = FRAC_PI_2 / count as f64;
    let pin_radius = 1.0 - clearance;
    let (mut closes, mut gaps) = ([0.0; BOTH], [0.0; BOTH]);
    let point = |i: usize| {
        let tau = (i as f64 + 0.5) * weight;
        let phi = 2.0 * (b * tau.cos()).atan();
        let pressure = |k: usize| {
            if k <= TERMS {
                (2.0 * k as f64 * tau).cos()
            } else if k < BOTH {
                ((2 * (k - TERMS) - 1) as f64 * tau).sin() * tau.sin()
            } else {
                0.0
            }
        };
        let pressures: [f64; PADDED] = std::array::from_fn(|k| weight * pressure(k));
        let tilt = (clearance * phi.sin() / pin_radius).asin();
        let gap = 1.0 - clearance * phi.cos() - pin_radius * tilt.cos();
        for (k, pressure) in pressures[..BOTH].iter().enumerate() {
            closes[k] += pressure * phi.cos();
            gaps[k] += pressure * gap;
        }
        Point { phi, theta: phi + tilt, tilt, pressures }
    };
    let points: Vec<Point> = (0..count).map(point).collect();
    let mut matrix = Mat::<f64>::zeros(TERMS + 1, TERMS + 1);
    for first in (0..=highest).step_by(TOGETHER) {
        let sums = Arch::new().dispatch(Integrals { points: &points, first });
        for (n, [hole, along, across]) in (first..=highest).zip(&sums) {
            let share = if n == 0 { 1.0 } else { 2.0 } / PI;
            let (of_plate, of_pin) = (plate.mode(n), pin.compliance(n));
            for j in 0..=TERMS {
                for column in 0..TERMS {
                    let k = TERMS + 1 + column;
                    let inward = of_pin[0][0] * along[k] - of_pin[0][1] * across[k];
                    let around = of_pin[1][1] * across[k] - of_pin[1][0] * along[k];
                    matrix[(j, column)] +=
                        share * (hole[j] * of_plate * hole[k] + along[j] * inward + across[j] * around);
                }
            }
        }
    }
    for j in 0..=TERMS {
        matrix[(j, TERMS)] = -closes[j];
    }
    let right = Mat::from_fn(TERMS + 1, 1, |j, _| -gaps[j]);
    let solution = matrix.partial_piv_lu().solve(right);
    let pressure = |of: &dyn Fn(usize) -> f64| (0..TERMS).map(|k| solution[(k, 0)] * of(k)).sum::<f64>();
    TrueState {
        indentation: solution[(TERMS, 0)],
        force: 2.0 * pressure(&|k| closes[TERMS + 1 + k]),
        peak_pressure: pressure(&|k| if k % 2 == 0 { 1.0 } else { -1.0 }) / (2.0 * b),
    }
}

/// cos and sin of an angle, turned by one of which sin and cos are given.
fn turned((cosine, sine): (f64, f64), (by_sine, by_cosine): (f64, f64)) -> (f64, f64) {
    (cosine * by_cosine - sine * by_sine, sine * by_cosine + cosine * by_sine)
}
