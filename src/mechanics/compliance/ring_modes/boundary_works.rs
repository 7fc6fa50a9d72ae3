//! The works of the modes of a ring that the boundary of concentric bodies adds to those of an infinite one.

use std::f64::consts::PI;

use super::{Ring, RingModes};
use crate::mechanics::body::Side;
use crate::mechanics::compliance::arc::{packed, packed_count};
use crate::mechanics::compliance::arc_lanes::POINTS;
use crate::mechanics::compliance::lane_work::LaneWork;
use crate::mechanics::real::LANES;

/// Those of `works_of_modes`, `[body][work]`.
pub(super) struct WorksOfModes<'a> {
    pub modes: &'a RingModes,
    pub side: Side,
    pub bodies: &'a [[Vec<f64>; 2]],
}

impl LaneWork for WorksOfModes<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<Vec<f64>> {
        let WorksOfModes { modes, side, bodies } = self;
        let RingModes { count, ring } = *modes;
        let highest = bodies.iter().map(|[normal, _]| normal.len()).max().unwrap_or(0);
        let stretch = if let Ring::Whole(quarters) = ring { 0.25 * f64::from(quarters) } else { 1.0 };
        // The integrand has period 2 pi in u and is smooth: the midpoint rule converges once it resolves the fastest wave.
        let points = 64 + 2 * count + (highest as f64 * stretch) as usize;
        let points = points.next_multiple_of(POINTS);
        let weight = modes.end() / points as f64;
        // Integrals of psi_m cos(n phi): `[n][m]`.
        let mut integrals = vec![0.0; highest * count];
        let mut psi = vec![0.0; POINTS * count];
        for first in (0..points).step_by(POINTS) {
            let stretched: [f64; POINTS] = std::array::from_fn(|i| ((first + i) as f64 + 0.5) * weight);
            for (psi, stretched) in psi.chunks_exact_mut(count).zip(stretched) {
                modes.values(stretched, psi);
            }
            let turns = stretched.map(|stretched| 2.0 * modes.angle(stretched).cos());
            let (mut waves, mut previous) = ([1.0; POINTS], turns.map(|turn| 0.5 * turn));
            for integrals in integrals.chunks_exact_mut(count) {
                let scales = waves.map(|wave| weight * wave);
                for (m, sum) in integrals.iter_mut().enumerate() {
                    let at = |i: usize| scales[i] * psi[i * count + m];
                    *sum += (at(0) + at(1)) + (at(2) + at(3));
                }
                let next = std::array::from_fn(|i| turns[i] * waves[i] - previous[i]);
                (waves, previous) = (next, waves);
            }
        }
        let works = Products { side, integrals: &integrals, count };
        let mut all = Vec::with_capacity(bodies.len());
        for bodies in bodies.chunks(LANES) {
            if bodies.len() <= FEW {
                bodies.chunks(1).for_each(|body| all.extend(works.of::<1>(body)));
            } else {
                all.extend(works.of::<LANES>(bodies));
            }
        }
        all
    }
}

/// So many bodies at most take no longer one after the other than in lanes.
const FEW: usize = 2;

/// Works of modes of the boundary, from their integrals with the modes of the ring.
struct Products<'a> {
    side: Side,
    /// `[n][m]`
    integrals: &'a [f64],
    /// Modes of the ring.
    count: usize,
}

impl Products<'_> {
    /// Of so many bodies abreast at most, to the same bits in any company.
    #[inline(always)]
    fn of<const ABREAST: usize>(&self, bodies: &[[Vec<f64>; 2]]) -> Vec<Vec<f64>> {
        let Products { side, integrals, count } = *self;
        let of_mode = |n: usize| &integrals[n * count..][..count];
        // Lanes without a body have none of any mode, nor has a body of those beyond its own.
        let scales = |scale: &dyn Fn(&[Vec<f64>; 2]) -> f64| -> [f64; ABREAST] {
            std::array::from_fn(|lane| 2.0 / PI * bodies.get(lane).map_or(0.0, scale))
        };
        let highest = bodies.iter().map(|[normal, _]| normal.len()).max().unwrap_or(0);
        let of = |modes: &[f64], n: usize| modes.get(n).copied().unwrap_or(0.0);
        let mut works = vec![[0.0; ABREAST]; packed_count(count)];
        for n in 0..highest {
            let scales = scales(&|[normal, _]| of(normal, n));
            add_product(&scales, of_mode(n), of_mode(n), &mut works);
        }
        if side == Side::Pin {
            let mut tilt = vec![[0.0; ABREAST]; packed_count(count)];
            for n in 1..highest {
                // Half of it in either order.
                let halves = scales(&|[_, along]| match along.get(n - 1..=n) {
                    Some([before, value]) => 0.5 * (value - before),
                    _ => 0.0,
                });
                add_product(&halves, of_mode(n), of_mode(n - 1), &mut tilt);
                add_product(&halves, of_mode(n - 1), of_mode(n), &mut tilt);
            }
            works.extend(tilt);
        }
        (0..bodies.len()).map(|lane| works.iter().map(|of_lanes| of_lanes[lane]).collect()).collect()
    }
}

/// works[m n] += scale a_m b_n, packed, of each body with its scale.
#[inline(always)]
fn add_product<const ABREAST: usize>(
    scales: &[f64; ABREAST],
    a: &[f64],
    b: &[f64],
    works: &mut [[f64; ABREAST]],
) {
    for m in 0..a.len() {
        let of_a = scales.map(|scale| scale * a[m]);
        for (works, b) in works[packed(m, 0)..=packed(m, m)].iter_mut().zip(b) {
            for lane in 0..ABREAST {
                works[lane] += of_a[lane] * b;
            }
        }
    }
}
