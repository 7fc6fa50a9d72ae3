//! Trial pressures on arcs of every size: all that does not depend on the body, at nodes in eps.
//!
//! All quantities are functions of the half angle alone; they are interpolated between Chebyshev nodes in sqrt(eps).

use std::f64::consts::{FRAC_PI_2, PI};

use pulp::{Arch, Simd, WithSimd};

use super::arc::{ContactArc, MAX_TERMS, cosines, packed_count};
use super::kernels::{cubic_kernel, kinked_rule, logarithmic_kernel, logarithmic_rule, quadratic_kernel};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Nodes in eps between which compliances are interpolated.
pub const NODE_COUNT: usize = 32;

/// Trial pressures at the nodes in eps, with all that does not depend on the body.
pub struct PressureSpace {
    pub terms: usize,
    /// The largest contact half angle, rad.
    pub limit: f64,
    /// The arcs at the nodes.
    pub arcs: Vec<ContactArc>,
    /// Galerkin matrices of the kernels sum of (2/pi) cos(n phi) cos(n phi') f(n), packed, one row a node:
    /// f = 1/n over n >= 1 (less its -pi/2 ln b), ...
    pub logarithm: Vec<f64>,
    /// ... f = 1/(n (n^2 - 1)) over n >= 2, ...
    pub cubic: Vec<f64>,
    /// ... f = 1/(n^2 - 1) over n >= 2.
    pub quadratic: Vec<f64>,
    weights: Vec<f64>,
    abscissae: Vec<f64>,
}

impl PressureSpace {
    /// `terms` trial pressures on arcs up to `limit` (rad, below pi).
    pub fn new(terms: usize, limit: f64) -> PressureSpace {
        let count = NODE_COUNT as f64;
        let angle = |i: usize| PI * (i as f64 + 0.5) / count;
        let abscissae: Vec<f64> = (0..NODE_COUNT).map(|i| 0.5 * (1.0 + angle(i).cos())).collect();
        let weights =
            (0..NODE_COUNT).map(|i| if i % 2 == 0 { angle(i).sin() } else { -angle(i).sin() }).collect();
        let arcs: Vec<ContactArc> = abscissae.iter().map(|x| ContactArc::new(limit * x * x)).collect();
        let entries = packed_count(terms);
        let mut space = PressureSpace {
            terms,
            limit,
            logarithm: Vec::with_capacity(NODE_COUNT * entries),
            cubic: Vec::with_capacity(NODE_COUNT * entries),
            quadratic: Vec::with_capacity(NODE_COUNT * entries),
            arcs,
            weights,
            abscissae,
        };
        let logarithmic = logarithmic_rule(terms);
        let kinked = kinked_rule(terms);
        for arc in space.arcs.clone() {
            space.logarithm.extend(logarithmic_kernel(&arc, terms));
            space.cubic.extend(cubic_kernel(&arc, terms, &logarithmic));
            space.quadratic.extend(quadratic_kernel(&arc, terms, &kinked));
        }
        space
    }

    /// Abscissa and barycentric weight of each node; interpolation is in sqrt(eps/limit).
    pub fn nodes(&self) -> impl Iterator<Item = (f64, f64)> {
        self.abscissae.iter().copied().zip(self.weights.iter().copied())
    }

    /// Interpolation weights of the nodes at half angles side by side; those of each lane sum to one.
    #[inline(always)]
    pub fn interpolation<const FUSED: bool>(&self, half_angles: [f64; LANES]) -> [Lanes<FUSED>; NODE_COUNT] {
        let x = Lanes(half_angles.map(|half_angle| (half_angle / self.limit).sqrt()));
        let mut weights = [Lanes::zero(); NODE_COUNT];
        let mut sum = Lanes::zero();
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = Lanes::from_f64(self.weights[i]) / (x - Lanes::from_f64(self.abscissae[i]));
            sum += *weight;
        }
        for weight in &mut weights {
            *weight = *weight / sum;
        }
        for lane in (0..LANES).filter(|lane| sum.0[*lane].is_infinite()) {
            // On a node itself.
            for (weight, abscissa) in weights.iter_mut().zip(&self.abscissae) {
                weight.0[lane] = if *abscissa == x.0[lane] { 1.0 } else { 0.0 };
            }
        }
        weights
    }

    /// Moments m_kn = integral of p_k cos(n phi) at every node for n = 0 ... `highest`: `[n][k][node]`.
    pub fn moments(&self, highest: usize) -> Vec<[f64; NODE_COUNT]> {
        let mut moments = vec![[0.0; NODE_COUNT]; (highest + 1) * self.terms];
        for (node, arc) in self.arcs.iter().enumerate() {
            for (block, moments) in moments.chunks_mut(MODE_BLOCK * self.terms).enumerate() {
                let block = Moments { arc, terms: self.terms, first: block * MODE_BLOCK };
                let of_block = Arch::new().dispatch(block);
                for (mode, moments) in moments.chunks_exact_mut(self.terms).enumerate() {
                    moments.iter_mut().zip(&of_block).for_each(|(moment, modes)| moment[node] = modes[mode]);
                }
            }
        }
        moments
    }
}

/// Modes whose moments share a quadrature rule; they go through it side by side.
const MODE_BLOCK: usize = 64;

/// The moments of a block of modes of one arc, from `first` on. Blocks, so that a moment does not depend on how many are
/// asked for.
struct Moments<'a> {
    arc: &'a ContactArc,
    terms: usize,
    first: usize,
}

impl WithSimd for Moments<'_> {
    /// `[k][mode]`.
    type Output = [[f64; MODE_BLOCK]; MAX_TERMS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Moments { arc, terms, first } = self;
        let mut moments = [[0.0; MODE_BLOCK]; MAX_TERMS];
        let mut waves = [0.0; MODE_BLOCK];
        // The integrand is analytic and has period pi in tau, so the midpoint rule converges exponentially once it
        // resolves the fastest wave, which has n eps/2 periods.
        let fastest = (first + MODE_BLOCK) as f64;
        let points = 24 + terms + (0.5 * fastest * arc.half_angle) as usize;
        let weight = FRAC_PI_2 / points as f64;
        for i in 0..points {
            let tau = (i as f64 + 0.5) * weight;
            let trials = cosines((2.0 * tau).cos());
            let angle = arc.angle(tau);
            // cos(n phi) of the first modes one by one, then of as many together, by
            // cos((n + m) x) = 2 cos(m x) cos(n x) - cos((n - m) x).
            let turn = 2.0 * angle.cos();
            waves[0] = (first as f64 * angle).cos();
            waves[1] = ((first as f64 + 1.0) * angle).cos();
            for mode in 2..2 * TOGETHER {
                waves[mode] = turn * waves[mode - 1] - waves[mode - 2];
            }
            let turn = 2.0 * (TOGETHER as f64 * angle).cos();
            for group in (2 * TOGETHER..MODE_BLOCK).step_by(TOGETHER) {
                for mode in group..group + TOGETHER {
                    waves[mode] = turn * waves[mode - TOGETHER] - waves[mode - 2 * TOGETHER];
                }
            }
            for (moments, trial) in moments[..terms].iter_mut().zip(&trials) {
                let trial = simd.splat_f64s(weight * trial);
                let (sums, waves) = (S::as_mut_simd_f64s(moments).0, S::as_simd_f64s(&waves).0);
                for (sum, wave) in sums.iter_mut().zip(waves) {
                    *sum = simd.mul_add_e_f64s(trial, *wave, *sum);
                }
            }
        }
        moments
    }
}

/// Modes whose waves follow from those as many before.
const TOGETHER: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;

    /// Each node has its own value, and a function of sqrt(eps) is found between them, to rounding.
    #[test]
    fn interpolation_goes_through_the_nodes() {
        let space = PressureSpace::new(4, 2.0);
        for first in (0..NODE_COUNT).step_by(LANES) {
            let weights =
                space.interpolation::<false>(std::array::from_fn(|i| space.arcs[first + i].half_angle));
            for (node, weight) in weights.iter().enumerate() {
                assert_eq!(weight.0, std::array::from_fn(|i| if node == first + i { 1.0 } else { 0.0 }));
            }
        }
        let half_angles = std::array::from_fn(|i| 0.01 * 1.9_f64.powi(i as i32));
        let weights = space.interpolation::<false>(half_angles);
        for (lane, half_angle) in half_angles.into_iter().enumerate() {
            let function = |half_angle: f64| (half_angle.sqrt() - 0.3).cos();
            let found: f64 = weights
                .iter()
                .zip(&space.arcs)
                .map(|(weight, arc)| weight.0[lane] * function(arc.half_angle))
                .sum();
            assert!((found - function(half_angle)).abs() < 1e-14, "{half_angle}");
        }
    }
}
