//! The arithmetic peak of one core, measured.

use std::time::Instant;

use divan::black_box;
use pulp::{Arch, Simd, WithSimd};

/// Multiply-adds that do not wait for each other: as many as hide their latency and stay, with both constants, in the 16 registers of AVX2.
const CHAINS: usize = 12;
const LINKS: usize = 100_000;

struct Peak;

impl WithSimd for Peak {
    /// Operations done.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let (factor, term) = black_box((simd.splat_f64s(0.5), simd.splat_f64s(1.0)));
        let mut sums = [simd.splat_f64s(0.0); CHAINS];
        for _ in 0..LINKS {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(factor, *sum, term);
            }
        }
        black_box(sums);
        2 * CHAINS * LINKS * S::F64_LANES
    }
}

/// Multiplications and additions of doubles a second, in the widest registers that `pulp` finds.
pub fn peak() -> f64 {
    let operations = Arch::new().dispatch(Peak) as f64;
    operations / median(101, || _ = Arch::new().dispatch(Peak))
}

/// Median seconds of `work`.
pub fn median(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..runs)
        .map(|_| {
            let started = Instant::now();
            work();
            started.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[runs / 2]
}
