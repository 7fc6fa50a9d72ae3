//! What is told of arcs, an arc a lane: integrals of their trial pressures, in shares that need not wait for each other.

use super::arc::{ContactArc, cosines};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Arcs side by side, an arc a lane, with the place of what is told of them: `[number][lane]`.
pub type ArcLanes<'a> = (&'a [ContactArc; LANES], &'a mut [[f64; LANES]]);

/// Does the same with each of some, which need not wait for each other.
pub type ForEach<'a> = &'a dyn Fn(Vec<ArcLanes>, &(dyn Fn(ArcLanes) + Sync));

/// One after the other.
pub fn one_by_one(all: Vec<ArcLanes>, each: &(dyn Fn(ArcLanes) + Sync)) {
    all.into_iter().for_each(each);
}

/// `count` numbers of each of some arcs, which are as many as a multiple of `LANES`: `[chunk of arcs][number][lane]`. From zero on `add` adds to them.
pub fn numbers_of(
    arcs: &[ContactArc],
    count: usize,
    for_each: ForEach,
    add: &(dyn Fn(ArcLanes) + Sync),
) -> Vec<[f64; LANES]> {
    let mut numbers = vec![[0.0; LANES]; count * arcs.len() / LANES];
    let places = numbers.chunks_exact_mut(count.max(1));
    for_each(arcs.as_chunks().0.iter().zip(places).collect(), &|(arcs, places)| {
        // New pages of memory that are read before they are written are mapped twice, and the second time all threads wait.
        places.fill([0.0; LANES]);
        add((arcs, places));
    });
    numbers
}

/// Points of an integral that are summed together.
pub const POINTS: usize = 4;

/// cos(tau) at some points of a midpoint rule and the trial pressures there, times minus the weight: `[point][k]`.
#[inline(always)]
pub fn points_from<const TERMS: usize>(begin: usize, weight: f64) -> ([f64; POINTS], [[f64; TERMS]; POINTS]) {
    let (mut at, mut trials) = ([0.0; POINTS], [[0.0; TERMS]; POINTS]);
    for point in 0..POINTS {
        at[point] = (((begin + point) as f64 + 0.5) * weight).cos();
        let twice = 2.0 * at[point] * at[point] - 1.0;
        for (trial, cosine) in trials[point].iter_mut().zip(cosines(twice, TERMS)) {
            *trial = -weight * cosine;
        }
    }
    (at, trials)
}

/// From each k the sum over some points of a function there times those: an arc a lane.
#[inline(always)]
pub fn subtract_products<const WIDTH: usize, const TERMS: usize>(
    sums: &mut [[f64; LANES]; TERMS],
    values: &[Lanes<WIDTH>; POINTS],
    factors: &[[f64; TERMS]; POINTS],
) {
    for (k, sum) in sums.iter_mut().enumerate() {
        let mut own = Lanes::<WIDTH>(*sum);
        for point in 0..POINTS {
            own = own.minus_product(values[point], Lanes::from_f64(factors[point][k]));
        }
        *sum = own.0;
    }
}
