//! Galerkin matrices of the infinitely extended bodies on arcs of sines (`arc::ArcMap::Sine`), up to the whole ring.
//!
//! With sin(phi/2) = b cos(tau) the logarithm is diagonal, sum over n >= 1 of cos(n phi) cos(n phi')/n = -ln b + sum over
//! j >= 1 of cos(2 j tau) cos(2 j tau')/j, and what is left of the kernels falls like n^-2 at least. The integrals of the
//! trial pressures over cos(n phi) follow from cos(phi) = 1 - b^2 - b^2 cos(2 tau),
//!
//! ```text
//!   M_(n+1)k = 2 (1 - b^2) M_nk - b^2 [M_n(k+1) + M_n(k-1)] - M_(n-1)k,     M_0k = pi/2 for k = 0, else 0,     M_n(-1) = M_n1,
//! ```
//!
//! zero for k > n; on the whole ring, b = 1, only k = n is left.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

use super::arc::{ContactArc, packed, packed_count};
use super::arc_lanes::{ArcLanes, ForEach, numbers_of};
use super::infinite_body::{InfiniteKernels, by_entries};
use super::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// The sums over modes end here, which leaves 1/(8 tan(eps/2) HIGHEST^2) = 1e-7 of the matrices of a punch, and far less where an edge is free:
/// the time goes with the square of it.
const HIGHEST: usize = 1024;

/// For arcs of sines, as many as a multiple of `LANES`; nothing tilts there.
pub fn infinite_kernels(arcs: &[ContactArc], terms: usize, for_each: ForEach) -> InfiniteKernels {
    let of_arcs = |(arcs, matrices): ArcLanes| {
        in_lanes(AddSums { squares: arcs.map(|arc| arc.b.powi(2)), terms, matrices });
        for k in 1..terms {
            let of_logarithm = PI / (8.0 * k as f64);
            matrices[packed(k, k)].iter_mut().for_each(|value| *value += of_logarithm);
        }
    };
    let entries = packed_count(terms);
    let matrices = numbers_of(arcs, 2 * entries, for_each, &of_arcs);
    let [even, odd] = by_entries(&matrices, entries);
    InfiniteKernels { even, odd, ..InfiniteKernels::default() }
}

/// Adds 2/pi times the sums over n >= 2 of M_nj M_nk/(n (n^2 - 1)) and of M_nj M_nk/(n^2 - 1), an arc a lane.
struct AddSums<'a> {
    /// b^2.
    squares: [f64; LANES],
    terms: usize,
    /// `[kernel][packed entry]`.
    matrices: &'a mut [[f64; LANES]],
}

impl LaneWork for AddSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        let AddSums { squares, terms, matrices } = self;
        let square = Lanes::<WIDTH>(squares);
        let twice = Lanes::from_f64(2.0) * (Lanes::from_f64(1.0) - square);
        let (of_even, of_odd) = matrices.split_at_mut(packed_count(terms));
        // M of the mode before, which the next one takes the place of, and of this mode: [k], with zeros behind k = n.
        let mut before = vec![Lanes::<WIDTH>::zero(); HIGHEST + 3];
        let mut current = before.clone();
        before[0] = Lanes::from_f64(FRAC_PI_2);
        current[0] = Lanes::from_f64(0.5 * FRAC_PI_2) * twice;
        current[1] = Lanes::from_f64(-0.5 * FRAC_PI_2) * square;
        for n in 2..=HIGHEST {
            // What later modes need of this one.
            let needed = n.min(HIGHEST - n + terms);
            let first = twice * current[0] - Lanes::from_f64(2.0) * square * current[1];
            before[0] = first - before[0];
            for k in 1..=needed {
                let beside = current[k + 1] + current[k - 1];
                before[k] = (twice * current[k]).minus_product(square, beside) - before[k];
            }
            std::mem::swap(&mut before, &mut current);
            let m = n as f64;
            let odd = FRAC_2_PI / (m * m - 1.0);
            let (odd, even) = (Lanes::from_f64(-odd), Lanes::from_f64(-odd / m));
            for j in 0..terms {
                let (even, odd) = (even * current[j], odd * current[j]);
                for k in 0..=j {
                    let entry = packed(j, k);
                    of_even[entry] = Lanes::<WIDTH>(of_even[entry]).minus_product(even, current[k]).0;
                    of_odd[entry] = Lanes::<WIDTH>(of_odd[entry]).minus_product(odd, current[k]).0;
                }
            }
        }
    }
}
