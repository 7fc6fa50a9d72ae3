//! What is told of arcs, an arc a lane: integrals of their trial pressures, in shares that need not wait for each other.

use super::arc::ContactArc;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Arcs side by side, an arc a lane, with the place of what is told of them: `[number][lane]`.
pub type ArcLanes<'a> = (&'a [ContactArc; LANES], &'a mut [[f64; LANES]]);

/// Does the same with each of some, which need not wait for each other.
pub type ForEach<'a> = &'a dyn Fn(Vec<ArcLanes>, &(dyn Fn(ArcLanes) + Sync));

/// One after the other.
pub fn one_by_one(all: Vec<ArcLanes>, each: &(dyn Fn(ArcLanes) + Sync)) {
    all.into_iter().for_each(each);
}

/// Arcs, as many as a multiple of `LANES`, each eight with an equal share of the places.
pub fn in_arc_lanes<'a>(arcs: &'a [ContactArc], places: &'a mut [[f64; LANES]]) -> Vec<ArcLanes<'a>> {
    let (arcs, _) = arcs.as_chunks();
    let share = (places.len() / arcs.len().max(1)).max(1);
    arcs.iter().zip(places.chunks_exact_mut(share)).collect()
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
        let (mut value, mut previous) = (-weight, -weight * twice);
        for trial in &mut trials[point] {
            *trial = value;
            (value, previous) = (2.0 * twice * value - previous, value);
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
