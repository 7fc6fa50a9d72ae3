//! Work in `Lanes`, in code compiled for the widest vectors of the processor it runs on.

use pulp::{Arch, Simd, WithSimd};

use super::arc::{MAX_TERMS, TERM_CHOICES};
use crate::mechanics::real::LANES;

/// Work that is written once for any vectors.
pub trait LaneWork {
    type Output;

    /// `FUSED` where the processor fuses multiply and add. To be inlined always: only so it is compiled for the vectors.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Work with so many trial pressures.
pub trait TermWork {
    type Output;

    /// To be inlined always.
    fn run<const FUSED: bool, const TERMS: usize>(self) -> Self::Output;
}

pub fn in_lanes<W: LaneWork>(work: W) -> W::Output {
    Arch::new().dispatch(Vectorised(work))
}

/// With a count of trial pressures there is code for.
pub fn in_lanes_with_terms<W: TermWork>(terms: usize, work: W) -> W::Output {
    in_lanes(WithTerms { terms, work })
}

/// Whether a register of the processor holds all lanes, not half of them or fewer.
pub fn lanes_fit_a_register() -> bool {
    Arch::new().dispatch(RegisterWidth) >= LANES
}

struct RegisterWidth;

impl WithSimd for RegisterWidth {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

struct Vectorised<W>(W);

impl<W: LaneWork> WithSimd for Vectorised<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        if S::IS_SCALAR { self.0.run::<false>() } else { self.0.run::<true>() }
    }
}

struct WithTerms<W> {
    terms: usize,
    work: W,
}

impl<W: TermWork> LaneWork for WithTerms<W> {
    type Output = W::Output;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> W::Output {
        match self.terms {
            3 => self.work.run::<FUSED, 3>(),
            6 => self.work.run::<FUSED, 6>(),
            10 => self.work.run::<FUSED, 10>(),
            16 => self.work.run::<FUSED, 16>(),
            MAX_TERMS => self.work.run::<FUSED, MAX_TERMS>(),
            other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
        }
    }
}
