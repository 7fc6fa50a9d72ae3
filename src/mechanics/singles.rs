//! Bodies side by side in single precision, twice as many as in double: as `Lanes` are.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use crate::mechanics::real::{Alone, Bodies, Lanes, Real};
use crate::mechanics::registers::ANY;
#[cfg(target_arch = "x86_64")]
use crate::mechanics::registers::{AVX2, AVX512};

/// One 512-bit register of `f32`.
pub const SINGLES: usize = 16;

/// One number of each of some bodies, in registers of a `WIDTH` of `registers`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Singles<const WIDTH: usize>(pub [f32; SINGLES]);

/// An operation on whole registers of a type, which hold so many numbers, one after the other.
#[cfg(target_arch = "x86_64")]
macro_rules! in_registers {
    ($register:ty, $numbers:expr, ($($operand:ident),*), $operation:expr) => {
        let mut result = [0.0_f32; SINGLES];
        let mut at = 0;
        while at < SINGLES {
            // SAFETY: `SINGLES` is a multiple of the numbers of a register, so that these lie within each array; and code of a `WIDTH`
            // runs where its instructions are, and those of AVX2 and FMA where those of AVX-512 are.
            unsafe {
                $(let $operand = $operand.0.as_ptr().add(at).cast::<$register>().read_unaligned();)*
                result.as_mut_ptr().add(at).cast::<$register>().write_unaligned($operation);
            }
            at += $numbers;
        }
        return Singles(result);
    };
}

macro_rules! operation {
    ($name:ident($($operand:ident),*), $sixteen:expr, $eight:expr, $one:expr) => {
        #[inline(always)]
        fn $name<const WIDTH: usize>($($operand: Singles<WIDTH>),*) -> Singles<WIDTH> {
            #[cfg(target_arch = "x86_64")]
            if WIDTH == AVX512 {
                in_registers!(__m512, 16, ($($operand),*), $sixteen);
            } else if WIDTH >= AVX2 {
                in_registers!(__m256, 8, ($($operand),*), $eight);
            }
            let mut result = [0.0_f32; SINGLES];
            for lane in 0..SINGLES {
                $(let $operand = $operand.0[lane];)*
                result[lane] = $one;
            }
            Singles(result)
        }
    };
}

operation!(add(a, b), _mm512_add_ps(a, b), _mm256_add_ps(a, b), a + b);
operation!(sub(a, b), _mm512_sub_ps(a, b), _mm256_sub_ps(a, b), a - b);
operation!(mul(a, b), _mm512_mul_ps(a, b), _mm256_mul_ps(a, b), a * b);
operation!(div(a, b), _mm512_div_ps(a, b), _mm256_div_ps(a, b), a / b);
operation!(neg(a), _mm512_sub_ps(_mm512_set1_ps(-0.0), a), _mm256_xor_ps(_mm256_set1_ps(-0.0), a), -a);
operation!(sqrt(a), _mm512_sqrt_ps(a), _mm256_sqrt_ps(a), a.sqrt());
operation!(size(a), _mm512_abs_ps(a), _mm256_andnot_ps(_mm256_set1_ps(-0.0), a), a.abs());
operation!(
    least(a, b),
    _mm512_mask_mov_ps(
        b,
        _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) | _mm512_cmp_ps_mask::<_CMP_UNORD_Q>(a, a),
        a
    ),
    _mm256_blendv_ps(
        b,
        a,
        _mm256_or_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b), _mm256_cmp_ps::<_CMP_UNORD_Q>(a, a))
    ),
    if a < b || a.is_nan() { a } else { b }
);
operation!(
    minus_product(a, b, c),
    _mm512_fnmadd_ps(b, c, a),
    _mm256_fnmadd_ps(b, c, a),
    if WIDTH == ANY { a - b * c } else { (-b).mul_add(c, a) }
);
operation!(
    if_less(a, b, x, y),
    _mm512_mask_mov_ps(y, _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b), x),
    _mm256_blendv_ps(y, x, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b)),
    if a < b { x } else { y }
);

macro_rules! lanewise {
    ($trait:ident, $method:ident) => {
        impl<const WIDTH: usize> $trait for Singles<WIDTH> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $method(self, other)
            }
        }
    };
}
lanewise!(Add, add);
lanewise!(Sub, sub);
lanewise!(Mul, mul);
lanewise!(Div, div);

impl<const WIDTH: usize> AddAssign for Singles<WIDTH> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const WIDTH: usize> SubAssign for Singles<WIDTH> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const WIDTH: usize> Neg for Singles<WIDTH> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        neg(self)
    }
}

impl<const WIDTH: usize> Real for Singles<WIDTH> {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        #[cfg(target_arch = "x86_64")]
        if WIDTH == AVX512 {
            let mut result = [0.0; SINGLES];
            // SAFETY: as of `in_registers`: the array is one register.
            unsafe { result.as_mut_ptr().cast::<__m512>().write_unaligned(_mm512_set1_ps(value as f32)) };
            return Singles(result);
        }
        Singles([value as f32; SINGLES])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        sqrt(self)
    }
    #[inline(always)]
    fn exp(mut self) -> Self {
        for lane in 0..SINGLES {
            self.0[lane] = self.0[lane].exp();
        }
        self
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        least(self, other)
    }
    #[inline(always)]
    fn is_positive(self) -> bool {
        self.0.iter().all(|value| *value > 0.0)
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        minus_product(self, a, b)
    }
}

impl<const WIDTH: usize> Bodies for Singles<WIDTH> {
    const COUNT: usize = SINGLES;

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        f64::from(self.0[lane])
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        self.0[lane] = value as f32;
    }
    #[inline(always)]
    fn size(self) -> Self {
        size(self)
    }
    #[inline(always)]
    fn if_less(self, other: Self, x: Self, y: Self) -> Self {
        if_less(self, other, x, y)
    }
}

impl<const WIDTH: usize> Singles<WIDTH> {
    /// Of bodies in two parts, rounded.
    #[inline(always)]
    pub fn rounded(one: Lanes<WIDTH>, other: Lanes<WIDTH>) -> Self {
        #[cfg(target_arch = "x86_64")]
        if WIDTH == AVX512 {
            let mut result = [0.0; SINGLES];
            // SAFETY: as of `in_registers`: each array is one register.
            unsafe {
                let half = |lanes: Lanes<WIDTH>| {
                    _mm512_cvtpd_ps(lanes.0.as_ptr().cast::<__m512d>().read_unaligned())
                };
                let [one, other] = [_mm256_castps_pd(half(one)), _mm256_castps_pd(half(other))];
                let both = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(one), other);
                result.as_mut_ptr().cast::<__m512>().write_unaligned(_mm512_castpd_ps(both));
            }
            return Singles(result);
        }
        let mut result = [0.0; SINGLES];
        for (to, from) in result.iter_mut().zip(one.0.iter().chain(&other.0)) {
            *to = *from as f32;
        }
        Singles(result)
    }
}

/// One number of one body, which comes to the same bits as in a lane.
pub type Single<const WIDTH: usize> = Alone<WIDTH, f32>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
    use crate::mechanics::registers::FUSED;

    /// Results of all operations, by name.
    type Results = Vec<(&'static str, Vec<f32>)>;

    #[inline(always)]
    fn all<const WIDTH: usize>(numbers: [[f32; SINGLES]; 3]) -> Results {
        let [a, b, c] = numbers.map(Singles::<WIDTH>);
        let lanes = |values: [f32; SINGLES], from: usize| {
            Lanes::<WIDTH>(std::array::from_fn(|lane| f64::from(values[from + lane]) / 3.0))
        };
        let results = [
            ("add", a + b),
            ("sub", a - b),
            ("mul", a * b),
            ("div", a / b),
            ("neg", -a),
            ("sqrt", a.sqrt()),
            ("size", a.size()),
            ("least", a.least(b)),
            ("minus_product", a.minus_product(b, c)),
            ("if_less", a.if_less(b, c, a)),
            ("from_f64", Singles::from_f64(f64::from(a.0[0]) / 3.0)),
            ("rounded", Singles::rounded(lanes(a.0, 0), lanes(a.0, SINGLES / 2))),
        ];
        results.map(|(name, result)| (name, result.0.to_vec())).to_vec()
    }

    /// The same number by number.
    fn alone<const WIDTH: usize>([a, b, c]: [f32; 3]) -> Vec<f32> {
        let rounded = Single::<WIDTH>::from_f64(f64::from(a) / 3.0);
        let [a, b, c] = [a, b, c].map(Alone::<WIDTH, f32>);
        let results = [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.sqrt(),
            a.size(),
            a.least(b),
            a.minus_product(b, c),
            a.if_less(b, c, a),
        ];
        results.into_iter().chain([rounded]).map(|result| result.0).collect()
    }

    struct All([[f32; SINGLES]; 3]);

    impl LaneWork for All {
        type Output = (usize, Results);

        #[inline(always)]
        fn run<const WIDTH: usize>(self) -> (usize, Results) {
            (WIDTH, all::<WIDTH>(self.0))
        }
    }

    /// On this processor's registers, and on those of half the width, as number by number, to the bit, also of what is no ordinary number; all
    /// NaN are alike.
    #[test]
    fn registers_do_what_single_numbers_do() {
        const NUMBERS: [f32; 14] = [
            0.0,
            -0.0,
            1.0,
            // The product of these is no number.
            1.000_000_1,
            1.000_000_2,
            -1.5,
            3.7e-5,
            1e30,
            f32::MIN_POSITIVE,
            1e-45,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            -7.1,
        ];
        let bits = |value: f32| if value.is_nan() { None } else { Some(value.to_bits()) };
        let mut compared = 0;
        for shift in 0..NUMBERS.len() * NUMBERS.len() {
            let (step, from) = (shift / NUMBERS.len(), shift % NUMBERS.len());
            let of = |factor: usize| {
                std::array::from_fn(|lane| NUMBERS[(from + factor * step + lane) % NUMBERS.len()])
            };
            let numbers: [[f32; SINGLES]; 3] = [of(0), of(1), of(2)];
            let (width, found) = in_lanes(All(numbers));
            let mut all_found = vec![found];
            // Registers of half the width are in every processor that has the whole.
            #[cfg(target_arch = "x86_64")]
            if width == AVX512 {
                all_found.push(all::<AVX2>(numbers));
            }
            for found in all_found {
                for lane in 0..SINGLES {
                    let own = numbers.map(|numbers| numbers[lane]);
                    let expected = if width == ANY { alone::<ANY>(own) } else { alone::<FUSED>(own) };
                    for ((name, found), expected) in found.iter().zip(&expected) {
                        let found = if *name == "from_f64" { continue } else { found[lane] };
                        assert_eq!(bits(found), bits(*expected), "{name} of {own:?} in registers of {width}");
                        compared += 1;
                    }
                    let (_, rounded) = &found[found.len() - 1];
                    assert_eq!(bits(rounded[lane]), bits(expected[expected.len() - 1]), "rounded {own:?}");
                    let (_, splat) = &found[found.len() - 2];
                    let first = (f64::from(numbers[0][0]) / 3.0) as f32;
                    assert_eq!(bits(splat[lane]), bits(first), "{first} everywhere");
                }
            }
        }
        assert!(compared >= 10 * SINGLES * NUMBERS.len() * NUMBERS.len(), "{compared}");
    }
}
