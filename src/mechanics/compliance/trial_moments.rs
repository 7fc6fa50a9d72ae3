//! Integrals of trial pressures over functions of the angle.

use std::f64::consts::FRAC_PI_2;

use super::arc::{ArcMap, ContactArc};
use super::arc_lanes::{ArcLanes, ForEach, POINTS, numbers_of, points_from, subtract_products};
use super::lane_work::{TermWork, in_lanes_with_terms};
use super::ring_modes::RingModes;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Integrals of the trial pressures over functions of the angle, `[arc / LANES][function][k]`, an arc a lane.
#[derive(Clone, Default)]
pub struct Moments {
    pub values: Vec<[f64; LANES]>,
    pub count: usize,
}

impl Moments {
    /// Over cos(n phi), n = 0 to `count` - 1 at least, in whole blocks: a few modes more are no work. Of arcs of one map.
    pub fn of_modes(arcs: &[ContactArc], terms: usize, count: usize, for_each: ForEach) -> Moments {
        let of_arcs = |(arcs, moments): ArcLanes| {
            for (number, moments) in moments.chunks_exact_mut(BLOCK * terms).enumerate() {
                in_lanes_with_terms(terms, ModeMoments { arcs, first: number * BLOCK, moments });
            }
        };
        let count = count.next_multiple_of(BLOCK);
        Moments { values: numbers_of(arcs, count * terms, for_each, &of_arcs), count }
    }

    /// Over the functions of a ring. Of arcs of one map.
    pub fn of_ring_modes(arcs: &[ContactArc], terms: usize, modes: &RingModes, for_each: ForEach) -> Moments {
        let of_arcs = |(arcs, moments): ArcLanes| modes.add_moments(arcs, terms, moments);
        Moments { values: numbers_of(arcs, modes.count * terms, for_each, &of_arcs), count: modes.count }
    }
}

/// Functions whose moments share a quadrature rule: a moment does not depend on how many are asked for.
const BLOCK: usize = 32;

/// Adds integrals of the trial pressures over cos(n phi), an arc a lane, for a block of modes from `first` on.
struct ModeMoments<'a> {
    arcs: &'a [ContactArc; LANES],
    first: usize,
    /// `[mode][k]`.
    moments: &'a mut [[f64; LANES]],
}

impl TermWork for ModeMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize, const TERMS: usize>(self) {
        let ModeMoments { arcs, first, moments } = self;
        let number = Lanes::<WIDTH>::from_f64;
        let (moments, _) = moments.as_chunks_mut::<TERMS>();
        // The integrand is analytic and has period pi in tau, so the midpoint rule converges exponentially once it
        // resolves the fastest wave. A mode n has n eps/2 periods of phi in all, and where tan(phi/2) = b cos(tau) is steepest, at the edge
        // of the arc, as many as n b/2 in the place of that; and what is faster fades out.
        let fastest = (first + BLOCK) as f64;
        let mut widest: f64 = 0.0;
        let mut b = Lanes::<WIDTH>::zero();
        for (b, arc) in b.0.iter_mut().zip(arcs) {
            *b = arc.b;
            widest = widest.max(arc.half_angle.max(FADED * arc.b));
        }
        let points = (24 + TERMS + (0.5 * fastest * widest) as usize).next_multiple_of(POINTS);
        let weight = FRAC_PI_2 / points as f64;
        let mut waves = [[Lanes::<WIDTH>::zero(); POINTS]; BLOCK];
        for begin in (0..points).step_by(POINTS) {
            let (at, trials) = points_from::<TERMS>(begin, weight);
            for (point, cosine) in at.into_iter().enumerate() {
                let turn = Turn::at(arcs[0].map, b * number(cosine));
                // cos(n phi) of the first modes one by one, then of as many together, by
                // cos((n + m) x) = 2 cos(m x) cos(n x) - cos((n - m) x).
                let start = turn.times(first);
                let twice = number(2.0) * turn.cosine;
                waves[0][point] = start.cosine;
                waves[1][point] = start.and(turn).cosine;
                for mode in 2..2 * TOGETHER {
                    waves[mode][point] = twice * waves[mode - 1][point] - waves[mode - 2][point];
                }
                let twice = number(2.0) * turn.times(TOGETHER).cosine;
                for mode in 2 * TOGETHER..BLOCK {
                    waves[mode][point] =
                        twice * waves[mode - TOGETHER][point] - waves[mode - 2 * TOGETHER][point];
                }
            }
            for (waves, moments) in waves.iter().zip(moments.iter_mut()) {
                subtract_products(moments, waves, &trials);
            }
        }
    }
}

/// Waves so much faster than the fastest have faded out.
const FADED: f64 = 1.1;

/// Modes whose waves follow from those as many before.
const TOGETHER: usize = 8;

/// A turn by an angle.
#[derive(Clone, Copy)]
struct Turn<const WIDTH: usize> {
    cosine: Lanes<WIDTH>,
    sine: Lanes<WIDTH>,
}

impl<const WIDTH: usize> Turn<WIDTH> {
    /// By the angle phi whose half has such a tangent, or sine.
    #[inline(always)]
    fn at(map: ArcMap, of_half: Lanes<WIDTH>) -> Turn<WIDTH> {
        let (one, square) = (Lanes::from_f64(1.0), of_half * of_half);
        match map {
            ArcMap::Tangent => {
                let slope = one / (one + square);
                Turn { cosine: (one - square) * slope, sine: (of_half + of_half) * slope }
            }
            ArcMap::Sine => {
                let other = (one - square).sqrt();
                Turn { cosine: one - (square + square), sine: (of_half + of_half) * other }
            }
        }
    }

    /// And another one.
    #[inline(always)]
    fn and(self, other: Turn<WIDTH>) -> Turn<WIDTH> {
        Turn {
            cosine: (self.cosine * other.cosine).minus_product(self.sine, other.sine),
            sine: self.sine * other.cosine + self.cosine * other.sine,
        }
    }

    /// So many times.
    #[inline(always)]
    fn times(self, mut count: usize) -> Turn<WIDTH> {
        let mut all = Turn { cosine: Lanes::from_f64(1.0), sine: Lanes::zero() };
        let mut power = self;
        while count > 0 {
            if count % 2 == 1 {
                all = all.and(power);
            }
            power = power.and(power);
            count /= 2;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::arc_lanes::one_by_one;
    use crate::mechanics::compliance::ring_modes::LARGEST_HELD;

    /// Against sums over many more points, with each cosine by itself.
    #[test]
    fn moments_equal_their_integrals() {
        let tangents =
            |widest: f64| (1..=LANES).map(move |i| ContactArc::new(widest * i as f64 / LANES as f64));
        let sines = (0..LANES).map(|i| ContactArc::leaving(0.1 * i as f64));
        let arcs: Vec<ContactArc> = [0.02, 0.9, LARGEST_HELD, 2.4].into_iter().flat_map(tangents).collect();
        let mut worst: f64 = 0.0;
        for (arcs, terms) in [(arcs.clone(), 6), (arcs, 24), (sines.collect(), 16)] {
            let Moments { values, count } = Moments::of_modes(&arcs, terms, 3 * BLOCK - 1, &one_by_one);
            assert_eq!(count, 3 * BLOCK);
            let points = 1000;
            let weight = FRAC_PI_2 / points as f64;
            for (place, arc) in arcs.iter().enumerate() {
                for mode in [0, 1, 2, 15, 16, 31, 32, 33, 64, 95] {
                    for k in [0, 1, terms - 1] {
                        let of_point = |point: usize| {
                            let tau = (point as f64 + 0.5) * weight;
                            weight * (2.0 * k as f64 * tau).cos() * (mode as f64 * arc.angle(tau)).cos()
                        };
                        let integral: f64 = (0..points).map(of_point).sum();
                        let found = values[(place / LANES * count + mode) * terms + k][place % LANES];
                        worst = worst.max((found - integral).abs());
                    }
                }
            }
        }
        println!("worst: {worst:e}");
        assert!(worst < 1e-11, "{worst:e}");
    }
}
