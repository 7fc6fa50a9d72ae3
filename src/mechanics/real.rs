//! The numbers a stage can be run in: `f64`, `f32`, or several bodies side by side in the lanes of one `Lanes`.
//!
//! Every finite-element stage is written once, over `Real`. With `Lanes` the same source handles `LANES` bodies of
//! one topology at a time, which is what fills the vector units: each body keeps to its own lane from its
//! coordinates to its compliance.

use std::mem::transmute;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::mechanics::registers::{self, ANY};

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
    fn exp(self) -> Self;
    /// The smaller of two; NaN if either is.
    fn least(self, other: Self) -> Self;
    /// Whether it is above zero, in every lane.
    fn is_positive(self) -> bool;
    /// `self - a * b`, fused where the processor can.
    fn minus_product(self, a: Self, b: Self) -> Self;

    /// The same of each of four numbers, with one b.
    #[inline(always)]
    fn four_minus_products(mut four: [Self; 4], a: [Self; 4], b: Self) -> [Self; 4] {
        for i in 0..4 {
            four[i] = four[i].minus_product(a[i], b);
        }
        four
    }

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
            fn exp(self) -> Self {
                <$scalar>::exp(self)
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

/// One number of each of some bodies, or loads, in registers of a `WIDTH` of `registers`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const WIDTH: usize, const COUNT: usize = LANES>(pub [f64; COUNT]);

/// Bodies side by side, or one alone.
pub trait Bodies: Real {
    /// How many.
    const COUNT: usize;

    fn lane(&self, lane: usize) -> f64;
    fn set_lane(&mut self, lane: usize, value: f64);
    /// Without signs.
    fn size(self) -> Self;
    /// Lane by lane x where it is less than `other`, else y.
    fn if_less(self, other: Self, x: Self, y: Self) -> Self;

    /// `of` each lane.
    #[inline(always)]
    fn of_lanes(mut of: impl FnMut(usize) -> f64) -> Self {
        let mut all = Self::zero();
        for lane in 0..Self::COUNT {
            all.set_lane(lane, of(lane));
        }
        all
    }

    /// But no more than `most`, which it also is in place of NaN.
    #[inline(always)]
    fn at_most(self, most: Self) -> Self {
        self.if_less(most, self, most)
    }

    /// Whether it is above zero in some lane.
    #[inline(always)]
    fn any_positive(&self) -> bool {
        (0..Self::COUNT).any(|lane| self.lane(lane) > 0.0)
    }
}

impl<const WIDTH: usize> Bodies for Lanes<WIDTH> {
    const COUNT: usize = LANES;

    #[inline(always)]
    fn size(self) -> Self {
        Lanes(registers::size::<WIDTH, LANES>(self.0))
    }
    #[inline(always)]
    fn if_less(self, other: Self, x: Self, y: Self) -> Self {
        Lanes(registers::if_less::<WIDTH, LANES>(self.0, other.0, x.0, y.0))
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[lane] = value;
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident) => {
        impl<const WIDTH: usize, const COUNT: usize> $trait for Lanes<WIDTH, COUNT> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes(registers::$method::<WIDTH, COUNT>(self.0, other.0))
            }
        }
    };
}
lanewise!(Add, add);
lanewise!(Sub, sub);
lanewise!(Mul, mul);
lanewise!(Div, div);

impl<const WIDTH: usize, const COUNT: usize> AddAssign for Lanes<WIDTH, COUNT> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const WIDTH: usize, const COUNT: usize> SubAssign for Lanes<WIDTH, COUNT> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const WIDTH: usize, const COUNT: usize> Neg for Lanes<WIDTH, COUNT> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(registers::neg::<WIDTH, COUNT>(self.0))
    }
}

impl<const WIDTH: usize, const COUNT: usize> Real for Lanes<WIDTH, COUNT> {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Lanes(registers::splat::<WIDTH, COUNT>(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes(registers::sqrt::<WIDTH, COUNT>(self.0))
    }
    #[inline(always)]
    fn exp(mut self) -> Self {
        for lane in 0..COUNT {
            self.0[lane] = self.0[lane].exp();
        }
        self
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Lanes(registers::least::<WIDTH, COUNT>(self.0, other.0))
    }
    #[inline(always)]
    fn is_positive(self) -> bool {
        self.0.iter().all(|value| *value > 0.0)
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Lanes(registers::minus_product::<WIDTH, COUNT>(self.0, a.0, b.0))
    }
}

/// A number of the language.
pub trait Scalar: Real + PartialOrd + Into<f64> {
    /// `self - a * b` with one rounding.
    fn minus_fused_product(self, a: Self, b: Self) -> Self;
    /// Without its sign.
    fn magnitude(self) -> Self;
    /// `Real::four_minus_products` of one body.
    #[inline(always)]
    fn four_minus_products_alone<const WIDTH: usize>(
        mut four: [Alone<WIDTH, Self>; 4],
        a: [Alone<WIDTH, Self>; 4],
        b: Alone<WIDTH, Self>,
    ) -> [Alone<WIDTH, Self>; 4] {
        for i in 0..4 {
            four[i] = four[i].minus_product(a[i], b);
        }
        four
    }
}

macro_rules! scalar {
    ($scalar:ty $(, $own:item)?) => {
        impl Scalar for $scalar {
            #[inline(always)]
            fn minus_fused_product(self, a: Self, b: Self) -> Self {
                (-a).mul_add(b, self)
            }
            #[inline(always)]
            fn magnitude(self) -> Self {
                self.abs()
            }
            $($own)?
        }
    };
}
scalar!(f32);
scalar!(
    f64,
    #[inline(always)]
    fn four_minus_products_alone<const WIDTH: usize>(
        four: [Alone<WIDTH>; 4],
        a: [Alone<WIDTH>; 4],
        b: Alone<WIDTH>,
    ) -> [Alone<WIDTH>; 4] {
        // SAFETY: `Alone` is the number in it. Numbers that are taken out one by one do not stay in one register.
        unsafe {
            let four: [f64; 4] = transmute(four);
            let a: [f64; 4] = transmute(a);
            transmute(registers::minus_product::<WIDTH, 4>(four, a, [b.0; 4]))
        }
    }
);

/// One number of one body, which comes to the same bits as in a lane of `Lanes`, in single precision of `Singles`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Alone<const WIDTH: usize, S = f64>(pub S);

macro_rules! alone {
    ($trait:ident, $method:ident) => {
        impl<const WIDTH: usize, S: Scalar> $trait for Alone<WIDTH, S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Alone(self.0.$method(other.0))
            }
        }
    };
}
alone!(Add, add);
alone!(Sub, sub);
alone!(Mul, mul);
alone!(Div, div);

impl<const WIDTH: usize, S: Scalar> AddAssign for Alone<WIDTH, S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl<const WIDTH: usize, S: Scalar> SubAssign for Alone<WIDTH, S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}

impl<const WIDTH: usize, S: Scalar> Neg for Alone<WIDTH, S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Alone(-self.0)
    }
}

impl<const WIDTH: usize, S: Scalar> Real for Alone<WIDTH, S> {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Alone(S::from_f64(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Alone(self.0.sqrt())
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Alone(self.0.exp())
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Alone(self.0.least(other.0))
    }
    #[inline(always)]
    fn is_positive(self) -> bool {
        self.0.is_positive()
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Alone(if WIDTH == ANY { self.0 - a.0 * b.0 } else { self.0.minus_fused_product(a.0, b.0) })
    }
    #[inline(always)]
    fn four_minus_products(four: [Self; 4], a: [Self; 4], b: Self) -> [Self; 4] {
        S::four_minus_products_alone(four, a, b)
    }
}

impl<const WIDTH: usize, S: Scalar> Bodies for Alone<WIDTH, S> {
    const COUNT: usize = 1;

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        self.0.into()
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: f64) {
        self.0 = S::from_f64(value);
    }
    #[inline(always)]
    fn size(self) -> Self {
        Alone(self.0.magnitude())
    }
    #[inline(always)]
    fn if_less(self, other: Self, x: Self, y: Self) -> Self {
        if self.0 < other.0 { x } else { y }
    }
}

/// One body alone, in code for any processor.
impl Bodies for f64 {
    const COUNT: usize = 1;

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        *self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn if_less(self, other: Self, x: Self, y: Self) -> Self {
        if self < other { x } else { y }
    }
}

/// 1/(2 n + 1), n = 0 to 10: atanh(s)/s as a polynomial of s^2. What follows is below 1e-17 where s^2 < 0.0295.
const OF_ATANH: [f64; 11] = {
    let mut shares = [0.0; 11];
    let mut n = 0;
    while n < shares.len() {
        shares[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    shares
};

impl<const WIDTH: usize, const COUNT: usize> Lanes<WIDTH, COUNT> {
    /// The first numbers of a slice.
    #[inline(always)]
    pub fn from_slice(values: &[f64]) -> Self {
        let mut lanes = [0.0; COUNT];
        lanes.copy_from_slice(&values[..COUNT]);
        Lanes(lanes)
    }

    /// Without signs.
    #[inline(always)]
    pub fn size(self) -> Self {
        Lanes(registers::size::<WIDTH, COUNT>(self.0))
    }

    /// Whether all of it is.
    #[inline(always)]
    pub fn is_zero(self) -> bool {
        self.0.iter().all(|value| *value == 0.0)
    }

    /// Lane by lane x where it is less than `other`, else y.
    #[inline(always)]
    pub fn if_less(self, other: Self, x: Self, y: Self) -> Self {
        Lanes(registers::if_less::<WIDTH, COUNT>(self.0, other.0, x.0, y.0))
    }

    /// Lane by lane x where it is at most `other`, else y.
    #[inline(always)]
    pub fn if_at_most(self, other: Self, x: Self, y: Self) -> Self {
        Lanes(registers::if_at_most::<WIDTH, COUNT>(self.0, other.0, x.0, y.0))
    }

    /// Natural logarithm of positive numbers that are not subnormal, to a few units in the last place: of x = 2^k m with m around 1
    /// it is k ln 2 + 2 atanh((m - 1)/(m + 1)).
    #[inline(always)]
    pub fn ln(self) -> Self {
        const FRACTION: u64 = (1 << 52) - 1;
        const LEAST: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
        let above = self.0.map(|value| value.to_bits().wrapping_sub(LEAST));
        let exponent = Lanes(above.map(|bits| (bits as i64 >> 52) as f64));
        let mantissa = Lanes(above.map(|bits| f64::from_bits((bits & FRACTION) + LEAST)));
        let one = Lanes::from_f64(1.0);
        let s = (mantissa - one) / (mantissa + one);
        let minus_square = -s * s;
        let mut sum = Lanes::zero();
        for share in OF_ATANH.iter().rev() {
            sum = Lanes::from_f64(*share).minus_product(minus_square, sum);
        }
        (s * sum + s * sum).minus_product(exponent, Lanes::from_f64(-std::f64::consts::LN_2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::registers::FUSED;

    #[test]
    fn logarithms_are_those_of_the_library() {
        let mut compared = 0;
        for step in -3000..3000 {
            let value = (0.1 * f64::from(step)).exp() * (1.0 + 1e-3 * f64::from(step));
            if !value.is_normal() || value < 0.0 {
                continue;
            }
            let near_one = 1.0 + 1e-5 * f64::from(step);
            let values = [value, 1.0 / value, near_one, 1.0, 0.75, 1.5, f64::MIN_POSITIVE, f64::MAX];
            for (found, value) in [Lanes::<ANY>(values).ln().0, Lanes::<FUSED>(values).ln().0]
                .as_flattened()
                .iter()
                .zip(values.into_iter().cycle())
            {
                let expected = value.ln();
                assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{value}: {found}");
                compared += 1;
            }
        }
        assert!(compared > 16 * 3000);
    }
}
