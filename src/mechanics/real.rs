//! The numbers a stage can be run in: `f64`, `f32`, or several bodies side by side in the lanes of one `Lanes`.
//!
//! Every finite-element stage is written once, over `Real`. With `Lanes` the same source handles `LANES` bodies of
//! one topology at a time, which is what fills the vector units: each body keeps to its own lane from its
//! coordinates to its compliance.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A field with square roots.
pub trait Real:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    fn from_f64(value: f64) -> Self;
    fn sqrt(self) -> Self;
    /// The smaller of two; NaN if either is.
    fn least(self, other: Self) -> Self;
    /// Whether it is above zero, in every lane.
    fn is_positive(self) -> bool;
    /// `self - a * b`, fused where the processor can.
    fn minus_product(self, a: Self, b: Self) -> Self;

    fn zero() -> Self {
        Self::from_f64(0.0)
    }
}

macro_rules! real_for_scalar {
    ($scalar:ty) => {
        impl Real for $scalar {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $scalar
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$scalar>::sqrt(self)
            }
            #[inline(always)]
            fn least(self, other: Self) -> Self {
                if self < other || self.is_nan() { self } else { other }
            }
            #[inline(always)]
            fn is_positive(self) -> bool {
                self > 0.0
            }
            #[inline(always)]
            fn minus_product(self, a: Self, b: Self) -> Self {
                self - a * b
            }
        }
    };
}
real_for_scalar!(f64);
real_for_scalar!(f32);

/// Bodies solved side by side: one 512-bit register of `f64`.
pub const LANES: usize = 8;

/// One number of each of `LANES` bodies; `FUSED` where the processor fuses multiply and add.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const FUSED: bool>(pub [f64; LANES]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const FUSED: bool> $trait for Lanes<FUSED> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for lane in 0..LANES {
                    self.0[lane] $op other.0[lane];
                }
                self
            }
        }
    };
}
lanewise!(Add, add, +=);
lanewise!(Sub, sub, -=);
lanewise!(Mul, mul, *=);
lanewise!(Div, div, /=);

impl<const FUSED: bool> AddAssign for Lanes<FUSED> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const FUSED: bool> SubAssign for Lanes<FUSED> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const FUSED: bool> Neg for Lanes<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(self.0.map(|value| -value))
    }
}

impl<const FUSED: bool> Real for Lanes<FUSED> {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Lanes([value; LANES])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn least(mut self, other: Self) -> Self {
        for lane in 0..LANES {
            self.0[lane] = self.0[lane].least(other.0[lane]);
        }
        self
    }
    #[inline(always)]
    fn is_positive(self) -> bool {
        self.0.iter().all(|value| *value > 0.0)
    }
    #[inline(always)]
    fn minus_product(mut self, a: Self, b: Self) -> Self {
        for lane in 0..LANES {
            self.0[lane] = if FUSED {
                (-a.0[lane]).mul_add(b.0[lane], self.0[lane])
            } else {
                self.0[lane] - a.0[lane] * b.0[lane]
            };
        }
        self
    }
}
