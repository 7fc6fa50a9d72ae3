//! Arithmetic on arrays of `f64` as whole registers of the processor.
//!
//! A loop over the numbers of an array is unrolled, and put together to registers again only as far as the compiler sees through what
//! is around it: in large functions it gathers numbers of several arrays, or stores halves that are read as a whole. So where the width of a
//! register is known, each operation is an instruction of that width.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// The width, in numbers, for code that may run anywhere: multiply and add are not fused.
pub const ANY: usize = 1;
/// For processors that fuse them, with registers of a width not known here.
pub const FUSED: usize = 2;
/// For those with AVX2 and FMA. Such code must run on no other.
pub const AVX2: usize = 4;
/// For those with AVX-512, likewise.
pub const AVX512: usize = 8;

/// An operation on whole registers of a type, which hold so many numbers, one after the other.
#[cfg(target_arch = "x86_64")]
macro_rules! in_registers {
    ($register:ty, $numbers:expr, $result:ident, ($($operand:ident),*), $operation:expr) => {
        let mut at = 0;
        while at < COUNT {
            // SAFETY: `COUNT` is a multiple of the numbers of a register, so that these lie within each array; and code of a `WIDTH`
            // runs where its instructions are, and those of AVX2 and FMA where those of AVX-512 are.
            unsafe {
                $(let $operand = $operand.as_ptr().add(at).cast::<$register>().read_unaligned();)*
                $result.as_mut_ptr().add(at).cast::<$register>().write_unaligned($operation);
            }
            at += $numbers;
        }
        return $result;
    };
}

/// An operation, number by number: by instructions on registers of eight and of four where `WIDTH` has them, else by a formula.
macro_rules! operation {
    ($(#[$about:meta])* $name:ident($($operand:ident),*), $eight:expr, $four:expr, $one:expr) => {
        $(#[$about])*
        #[inline(always)]
        pub fn $name<const WIDTH: usize, const COUNT: usize>($($operand: [f64; COUNT]),*) -> [f64; COUNT] {
            let mut result = [0.0; COUNT];
            #[cfg(target_arch = "x86_64")]
            if WIDTH == AVX512 && COUNT.is_multiple_of(AVX512) {
                in_registers!(__m512d, AVX512, result, ($($operand),*), $eight);
            } else if WIDTH >= AVX2 && COUNT.is_multiple_of(AVX2) {
                in_registers!(__m256d, AVX2, result, ($($operand),*), $four);
            }
            for lane in 0..COUNT {
                $(let $operand = $operand[lane];)*
                result[lane] = $one;
            }
            result
        }
    };
}

operation!(add(a, b), _mm512_add_pd(a, b), _mm256_add_pd(a, b), a + b);
operation!(sub(a, b), _mm512_sub_pd(a, b), _mm256_sub_pd(a, b), a - b);
operation!(mul(a, b), _mm512_mul_pd(a, b), _mm256_mul_pd(a, b), a * b);
operation!(div(a, b), _mm512_div_pd(a, b), _mm256_div_pd(a, b), a / b);
operation!(neg(a), _mm512_sub_pd(_mm512_set1_pd(-0.0), a), _mm256_xor_pd(_mm256_set1_pd(-0.0), a), -a);
operation!(sqrt(a), _mm512_sqrt_pd(a), _mm256_sqrt_pd(a), a.sqrt());
operation!(size(a), _mm512_abs_pd(a), _mm256_andnot_pd(_mm256_set1_pd(-0.0), a), a.abs());
operation!(
    /// The smaller of two; NaN if either is.
    least(a, b),
    _mm512_mask_mov_pd(b, _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b) | _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(a, a), a),
    _mm256_blendv_pd(b, a, _mm256_or_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b), _mm256_cmp_pd::<_CMP_UNORD_Q>(a, a))),
    if a < b || a.is_nan() { a } else { b }
);
operation!(
    /// a - b c, fused but for `ANY`.
    minus_product(a, b, c),
    _mm512_fnmadd_pd(b, c, a),
    _mm256_fnmadd_pd(b, c, a),
    if WIDTH == ANY { a - b * c } else { (-b).mul_add(c, a) }
);
operation!(
    /// x where a < b, else y: where either is NaN, too.
    if_less(a, b, x, y),
    _mm512_mask_mov_pd(y, _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b), x),
    _mm256_blendv_pd(y, x, _mm256_cmp_pd::<_CMP_LT_OQ>(a, b)),
    if a < b { x } else { y }
);
operation!(
    /// x where a <= b, else y: where either is NaN, too.
    if_at_most(a, b, x, y),
    _mm512_mask_mov_pd(y, _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b), x),
    _mm256_blendv_pd(y, x, _mm256_cmp_pd::<_CMP_LE_OQ>(a, b)),
    if a <= b { x } else { y }
);

/// One number in every place.
#[inline(always)]
pub fn splat<const WIDTH: usize, const COUNT: usize>(value: f64) -> [f64; COUNT] {
    #[cfg(target_arch = "x86_64")]
    if WIDTH == AVX512 && COUNT == AVX512 {
        let mut result = [0.0; COUNT];
        // SAFETY: as of `in_registers`: the array is one register.
        unsafe { result.as_mut_ptr().cast::<__m512d>().write_unaligned(_mm512_set1_pd(value)) };
        return result;
    }
    [value; COUNT]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};

    /// Results of all operations, by name.
    type Results = Vec<(&'static str, [f64; 8])>;

    struct All([[f64; 8]; 3]);

    impl LaneWork for All {
        type Output = (usize, Results);

        #[inline(always)]
        fn run<const WIDTH: usize>(self) -> (usize, Results) {
            (WIDTH, all::<WIDTH, 8>(self.0))
        }
    }

    #[inline(always)]
    fn all<const WIDTH: usize, const COUNT: usize>(
        [a, b, c]: [[f64; COUNT]; 3],
    ) -> Vec<(&'static str, [f64; COUNT])> {
        vec![
            ("add", add::<WIDTH, COUNT>(a, b)),
            ("sub", sub::<WIDTH, COUNT>(a, b)),
            ("mul", mul::<WIDTH, COUNT>(a, b)),
            ("div", div::<WIDTH, COUNT>(a, b)),
            ("neg", neg::<WIDTH, COUNT>(a)),
            ("sqrt", sqrt::<WIDTH, COUNT>(a)),
            ("size", size::<WIDTH, COUNT>(a)),
            ("least", least::<WIDTH, COUNT>(a, b)),
            ("minus_product", minus_product::<WIDTH, COUNT>(a, b, c)),
            ("if_less", if_less::<WIDTH, COUNT>(a, b, c, a)),
            ("if_at_most", if_at_most::<WIDTH, COUNT>(a, b, c, a)),
            ("splat", splat::<WIDTH, COUNT>(a[0])),
        ]
    }

    /// Of four numbers.
    struct Half([[f64; 4]; 3]);

    impl LaneWork for Half {
        type Output = Vec<(&'static str, [f64; 4])>;

        #[inline(always)]
        fn run<const WIDTH: usize>(self) -> Self::Output {
            all::<WIDTH, 4>(self.0)
        }
    }

    /// On this processor's registers as number by number, to the bit, also of what is no ordinary number; all NaN are alike.
    #[test]
    fn registers_do_what_loops_do() {
        const NUMBERS: [f64; 12] = [
            0.0,
            -0.0,
            1.0,
            -1.5,
            3.7e-5,
            1e300,
            f64::MIN_POSITIVE,
            5e-324,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            -7.1,
        ];
        let bits = |value: f64| if value.is_nan() { None } else { Some(value.to_bits()) };
        let mut compared = 0;
        for shift in 0..NUMBERS.len() * NUMBERS.len() {
            let (step, from) = (shift / NUMBERS.len(), shift % NUMBERS.len());
            let of = |factor: usize| {
                std::array::from_fn(|lane| NUMBERS[(from + factor * step + lane) % NUMBERS.len()])
            };
            let numbers: [[f64; 8]; 3] = [of(0), of(1), of(2)];
            let (width, found) = in_lanes(All(numbers));
            let expected = if width == ANY { all::<ANY, 8>(numbers) } else { all::<FUSED, 8>(numbers) };
            assert_eq!(found.len(), expected.len());
            let halves = numbers.map(|numbers| std::array::from_fn(|lane| numbers[lane]));
            let of_halves = in_lanes(Half(halves));
            // Registers of half the width are in every processor that has the whole.
            #[cfg(target_arch = "x86_64")]
            if width == AVX512 {
                for ((name, found), (_, expected)) in all::<AVX2, 8>(numbers).iter().zip(&expected) {
                    assert_eq!(
                        found.map(bits),
                        expected.map(bits),
                        "{name} of {numbers:?} in registers of four"
                    );
                }
            }
            for (((name, found), (_, expected)), (_, half)) in found.iter().zip(&expected).zip(&of_halves) {
                assert_eq!(
                    found.map(bits),
                    expected.map(bits),
                    "{name} of {numbers:?} in registers of {width}"
                );
                assert_eq!(half.map(bits)[..], expected.map(bits)[..4], "{name} of {halves:?}");
                compared += 1;
            }
        }
        assert_eq!(compared, 12 * NUMBERS.len() * NUMBERS.len());
        #[cfg(target_arch = "x86_64")]
        assert_eq!(in_lanes(All([[1.0; 8]; 3])).0 == AVX512, is_x86_feature_detected!("avx512f"));
    }
}
