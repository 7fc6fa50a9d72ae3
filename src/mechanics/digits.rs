//! Decimal digits of numbers.

/// Powers of ten that f64 holds exactly, so that one multiplication or division by them is correctly rounded.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// The digits of 00 to 99.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[b'0'; 2]; 100];
    let mut number = 0;
    while number < 100 {
        pairs[number] = [b'0' + number as u8 / 10, b'0' + number as u8 % 10];
        number += 1;
    }
    pairs
};

/// `value` rounded to so many digits, at most nine, and the decimal exponent of the first; `None` where only the general (and slower)
/// route is sure of every digit.
pub fn significant<const COUNT: usize>(value: f64) -> Option<([u8; COUNT], i32)> {
    const { assert!(COUNT > 0 && COUNT < 10) };
    if !(1e-13..1e22).contains(&value) {
        return None;
    }
    let places = COUNT as i32 - 1;
    let binary_exponent = (value.to_bits() >> 52) as i32 - 1023;
    // floor(binary_exponent log10(2)): the decimal exponent or one less.
    let mut exponent = (binary_exponent * 78913) >> 18;
    let mut scaled = shifted(value, places - exponent);
    if scaled >= POWERS[COUNT] - 0.5 {
        exponent += 1;
        scaled = shifted(value, places - exponent);
    }
    // Beyond 2^52 there are no fractions, so the sum is rounded, ties to even, and its last bits are the integer.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let mut integer = (scaled + WHOLE).to_bits() as u32;
    // Two digits at a time: half as many divisions that wait for each other.
    let mut digits = [0; 10];
    for pair in digits.chunks_exact_mut(2).rev() {
        pair.copy_from_slice(&PAIRS[(integer % 100) as usize]);
        integer /= 100;
    }
    digits.last_chunk().map(|digits| (*digits, exponent))
}

/// value 10^power, correctly rounded.
fn shifted(value: f64, power: i32) -> f64 {
    let factor = POWERS[power.unsigned_abs() as usize];
    if power < 0 { value / factor } else { value * factor }
}

/// Digits less the zeros at their end.
pub fn without_zeros(digits: &[u8]) -> &[u8] {
    let end = digits.iter().rposition(|digit| *digit != b'0').map_or(0, |last| last + 1);
    &digits[..end]
}

/// What the number d.ddd x 10^exponent is put together of where it is written without an `e`; exponents from -9 to 20.
pub fn plain(digits: &[u8], exponent: i32) -> [&[u8]; 3] {
    let Ok(before) = usize::try_from(exponent) else {
        return [&b"0.00000000"[..(1 - exponent) as usize], digits, b""];
    };
    match digits.split_at_checked(before + 1) {
        Some((whole, part)) if !part.is_empty() => [whole, b".", part],
        _ => [digits, &b"00000000000000000000"[..before + 1 - digits.len()], b""],
    }
}
