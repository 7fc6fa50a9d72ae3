//! Work in `Lanes`, in code compiled for the widest vectors of the processor it runs on.

use pulp::{Arch, Simd, WithSimd};

use super::arc::{MAX_TERMS, TERM_CHOICES};
use crate::mechanics::registers::{ANY, AVX2, AVX512, FUSED};

/// Work that is written once for any vectors.
pub trait LaneWork {
    type Output;

    /// For registers of a `WIDTH` of `registers`. To be inlined always: only so it is compiled for the vectors.
    fn run<const WIDTH: usize>(self) -> Self::Output;
}

/// Work with so many trial pressures.
pub trait TermWork {
    type Output;

    /// To be inlined always.
    fn run<const WIDTH: usize, const TERMS: usize>(self) -> Self::Output;
}

pub fn in_lanes<W: LaneWork>(work: W) -> W::Output {
    Arch::new().dispatch(Vectorised(work))
}

/// With a count of trial pressures there is code for. A function for each: what they keep on the stack is not added up so.
pub fn in_lanes_with_terms<W: TermWork>(terms: usize, work: W) -> W::Output {
    match terms {
        3 => in_lanes(WithTerms::<W, 3>(work)),
        6 => in_lanes(WithTerms::<W, 6>(work)),
        10 => in_lanes(WithTerms::<W, 10>(work)),
        16 => in_lanes(WithTerms::<W, 16>(work)),
        MAX_TERMS => in_lanes(WithTerms::<W, MAX_TERMS>(work)),
        other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
    }
}

struct Vectorised<W>(W);

impl<W: LaneWork> WithSimd for Vectorised<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        // By what code is compiled for here.
        if S::IS_SCALAR {
            self.0.run::<ANY>()
        } else if cfg!(target_arch = "x86_64") && S::F64_LANES == AVX512 {
            self.0.run::<AVX512>()
        } else if cfg!(target_arch = "x86_64") && S::F64_LANES == AVX2 {
            self.0.run::<AVX2>()
        } else {
            self.0.run::<FUSED>()
        }
    }
}

struct WithTerms<W, const TERMS: usize>(W);

impl<W: TermWork, const TERMS: usize> LaneWork for WithTerms<W, TERMS> {
    type Output = W::Output;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> W::Output {
        self.0.run::<WIDTH, TERMS>()
    }
}
