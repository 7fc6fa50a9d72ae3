//! Integrals of trial pressures over functions of the angle.

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use super::arc::{ContactArc, MAX_TERMS, cosines};
use super::ring_modes::RingModes;
use crate::mechanics::real::LANES;

/// Integrals of the trial pressures over functions of the angle, `[arc / LANES][function][k]`, an arc a lane.
#[derive(Clone, Default)]
pub struct Moments {
    pub values: Vec<[f64; LANES]>,
    pub count: usize,
}

impl Moments {
    /// Over cos(n phi), n = 0 to `count` - 1 at least, in whole blocks: a few modes more are no work.
    pub fn of_modes(arcs: &[ContactArc], terms: usize, count: usize) -> Moments {
        Moments::new(arcs, terms, count.next_multiple_of(BLOCK), |moments, arc, first| {
            Arch::new().dispatch(ModeMoments { arc, terms, first, moments });
        })
    }

    /// Over the functions of a ring.
    pub fn of_ring_modes(arcs: &[ContactArc], terms: usize, modes: &RingModes) -> Moments {
        Moments::new(arcs, terms, modes.count, |moments, arc, first| {
            if first == 0 {
                modes.moments(arc, terms, moments);
            }
        })
    }

    /// For each arc and each block of functions, from `first` on, `fill` adds their integrals: `[function in block][k]`.
    fn new(
        arcs: &[ContactArc],
        terms: usize,
        count: usize,
        fill: impl Fn(&mut [f64], &ContactArc, usize),
    ) -> Moments {
        let mut values = vec![[0.0; LANES]; count * terms * arcs.len() / LANES];
        let mut block = Vec::new();
        for (place, arc) in arcs.iter().enumerate() {
            let own = &mut values[place / LANES * count * terms..][..count * terms];
            for (number, to) in own.chunks_mut(BLOCK * terms).enumerate() {
                block.clear();
                block.resize(BLOCK * terms, 0.0);
                fill(&mut block, arc, number * BLOCK);
                to.iter_mut().zip(&block).for_each(|(to, value)| to[place % LANES] = *value);
            }
        }
        Moments { values, count }
    }
}

/// Functions whose moments share a quadrature rule.
const BLOCK: usize = 64;

/// Integrals of the trial pressures of one arc over cos(n phi), for a block of modes from `first` on: `[mode][k]`. Blocks, so
/// that a moment does not depend on how many are asked for.
struct ModeMoments<'a> {
    arc: &'a ContactArc,
    terms: usize,
    first: usize,
    moments: &'a mut [f64],
}

impl WithSimd for ModeMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let ModeMoments { arc, terms, first, moments } = self;
        let mut sums = [[0.0; BLOCK]; MAX_TERMS];
        let mut waves = [0.0; BLOCK];
        // The integrand is analytic and has period pi in tau, so the midpoint rule converges exponentially once it
        // resolves the fastest wave. A mode n has n eps/2 periods of phi in all, and where tan(phi/2) = b cos(tau) is steepest, at the edge
        // of the arc, as many as n b/2 in the place of that; and what is faster fades out.
        let fastest = (first + BLOCK) as f64;
        let points = 24 + terms + (0.5 * fastest * arc.half_angle.max(FADED * arc.b)) as usize;
        let weight = FRAC_PI_2 / points as f64;
        for i in 0..points {
            let tau = (i as f64 + 0.5) * weight;
            let trials = cosines((2.0 * tau).cos(), terms);
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
            for group in (2 * TOGETHER..BLOCK).step_by(TOGETHER) {
                for mode in group..group + TOGETHER {
                    waves[mode] = turn * waves[mode - TOGETHER] - waves[mode - 2 * TOGETHER];
                }
            }
            for (sums, trial) in sums[..terms].iter_mut().zip(&trials) {
                let trial = simd.splat_f64s(weight * trial);
                let (sums, waves) = (S::as_mut_simd_f64s(sums).0, S::as_simd_f64s(&waves).0);
                for (sum, wave) in sums.iter_mut().zip(waves) {
                    *sum = simd.mul_add_e_f64s(trial, *wave, *sum);
                }
            }
        }
        for (mode, moments) in moments.chunks_exact_mut(terms).enumerate() {
            moments.iter_mut().zip(&sums).for_each(|(moment, sums)| *moment = sums[mode]);
        }
    }
}

/// Waves so much faster than the fastest have faded out.
const FADED: f64 = 1.1;

/// Modes whose waves follow from those as many before.
const TOGETHER: usize = 8;
