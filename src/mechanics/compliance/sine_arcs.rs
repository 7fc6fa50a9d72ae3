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
use super::infinite_body::InfiniteKernels;
use super::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// The sums over modes end here, which leaves 1/(8 tan(eps/2) HIGHEST^2) = 1e-7 of the matrices of a punch, and far less where an edge is free:
/// the time goes with the square of it.
const HIGHEST: usize = 1024;

/// For arcs of sines, as many as a multiple of `LANES`; nothing tilts there.
pub fn infinite_kernels(arcs: &[ContactArc], terms: usize) -> InfiniteKernels {
    let count = arcs.len();
    let mut kernels: [Vec<f64>; 2] = std::array::from_fn(|_| vec![0.0; packed_count(terms) * count]);
    for (chunk, of_chunk) in arcs.chunks_exact(LANES).enumerate() {
        let own = in_lanes(Sums { squares: std::array::from_fn(|lane| of_chunk[lane].b.powi(2)), terms });
        for (kernel, own) in kernels.iter_mut().zip(own) {
            for (entry, values) in own.iter().enumerate() {
                kernel[entry * count + chunk * LANES..][..LANES].copy_from_slice(values);
            }
        }
    }
    for k in 1..terms {
        let of_logarithm = PI / (8.0 * k as f64);
        kernels[0][packed(k, k) * count..][..count].iter_mut().for_each(|value| *value += of_logarithm);
    }
    let [even, odd] = kernels;
    InfiniteKernels { even, odd, ..InfiniteKernels::default() }
}

/// 2/pi times the sums over n >= 2 of M_nj M_nk/(n (n^2 - 1)) and of M_nj M_nk/(n^2 - 1), `[packed entry]`, an arc a lane.
struct Sums {
    /// b^2.
    squares: [f64; LANES],
    terms: usize,
}

impl LaneWork for Sums {
    type Output = [Vec<[f64; LANES]>; 2];

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Self::Output {
        let Sums { squares, terms } = self;
        let square = Lanes::<WIDTH>(squares);
        let twice = Lanes::from_f64(2.0) * (Lanes::from_f64(1.0) - square);
        let mut sums: [Vec<Lanes<WIDTH>>; 2] =
            std::array::from_fn(|_| vec![Lanes::zero(); packed_count(terms)]);
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
                let (of_even, of_odd) = (even * current[j], odd * current[j]);
                for k in 0..=j {
                    let entry = packed(j, k);
                    sums[0][entry] = sums[0][entry].minus_product(of_even, current[k]);
                    sums[1][entry] = sums[1][entry].minus_product(of_odd, current[k]);
                }
            }
        }
        sums.map(|sums| sums.into_iter().map(|lanes| lanes.0).collect())
    }
}
