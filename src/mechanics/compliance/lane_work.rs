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

/// With a count of trial pressures there is code for.
pub fn in_lanes_with_terms<W: TermWork>(terms: usize, work: W) -> W::Output {
    in_lanes(WithTerms { terms, work })
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

struct WithTerms<W> {
    terms: usize,
    work: W,
}

impl<W: TermWork> LaneWork for WithTerms<W> {
    type Output = W::Output;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> W::Output {
        match self.terms {
            3 => self.work.run::<WIDTH, 3>(),
            6 => self.work.run::<WIDTH, 6>(),
            10 => self.work.run::<WIDTH, 10>(),
            16 => self.work.run::<WIDTH, 16>(),
            MAX_TERMS => self.work.run::<WIDTH, MAX_TERMS>(),
            other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
        }
    }
}
