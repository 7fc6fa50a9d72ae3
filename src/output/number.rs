//! Decimal text of numbers: the same on every machine, no digits without meaning, never NaN or infinity.

use std::io::Write;
use std::ops::Range;

use crate::mechanics::digits::{plain, significant, without_zeros};

/// Decimal exponents written without an `e`.
const PLAIN: Range<i32> = -5..16;

/// Appends the shortest decimals that read back as exactly `value`.
pub fn push_exact(out: &mut Vec<u8>, value: f64) {
    assert!(value.is_finite(), "{value} has no place in a table");
    let mut buffer = ryu::Buffer::new();
    let text = buffer.format_finite(value).as_bytes();
    if value == 0.0 || text.contains(&b'e') {
        return push_decimal(out, text);
    }
    // What has no `e` stands there as it is to be written, but for the `.0` of whole numbers.
    out.extend_from_slice(text.strip_suffix(b".0").unwrap_or(text));
}

/// Appends `value` rounded to nine significant digits, without trailing zeros.
pub fn push_rounded(out: &mut Vec<u8>, value: f64) {
    assert!(value.is_finite(), "{value} has no place in a table");
    match significant::<9>(value.abs()) {
        Some((digits, exponent)) => push_digits(out, value < 0.0, &digits, exponent),
        None => push_decimal(out, format!("{value:.8e}").as_bytes()),
    }
}

/// `value` rounded to nine significant digits, as text.
pub fn rounded_cell(value: f64) -> String {
    let mut text = Vec::new();
    push_rounded(&mut text, value);
    String::from_utf8(text).unwrap_or_default()
}

/// Appends a number that is written in any way of `-12.5`, `0.00125` and `1.25e-7`.
fn push_decimal(out: &mut Vec<u8>, text: &[u8]) {
    let (mut digits, mut digit_count) = ([0; 20], 0);
    // Of the first digit that is not zero, and what follows an `e`.
    let (mut place, mut exponent) = (0, 0);
    let (mut after_point, mut in_exponent, mut negative_exponent) = (false, false, false);
    for &byte in text {
        match byte {
            b'e' => in_exponent = true,
            b'-' => negative_exponent = in_exponent,
            b'.' => after_point = true,
            _ if in_exponent => exponent = 10 * exponent + i32::from(byte - b'0'),
            b'0' if digit_count == 0 => place -= i32::from(after_point),
            _ => {
                let is_first = digit_count == 0;
                place += match after_point {
                    true => -i32::from(is_first),
                    false => i32::from(!is_first),
                };
                digits[digit_count] = byte;
                digit_count += 1;
            }
        }
    }
    let exponent = if negative_exponent { -exponent } else { exponent };
    push_digits(out, text[0] == b'-', &digits[..digit_count], place + exponent);
}

/// Appends the number d.ddd x 10^exponent, less its trailing zeros.
fn push_digits(out: &mut Vec<u8>, negative: bool, digits: &[u8], exponent: i32) {
    let digits = without_zeros(digits);
    if digits.is_empty() {
        return out.push(b'0');
    }
    if negative {
        out.push(b'-');
    }
    let is_plain = PLAIN.contains(&exponent);
    for piece in plain(digits, if is_plain { exponent } else { 0 }) {
        out.extend_from_slice(piece);
    }
    if !is_plain {
        write!(out, "e{exponent}").expect("a Vec takes every write");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(push: fn(&mut Vec<u8>, f64), value: f64) -> String {
        let mut out = Vec::new();
        push(&mut out, value);
        String::from_utf8(out).unwrap()
    }

    /// Doubles spread over signs, mantissas and decimal exponents -20 to 35.
    fn spread() -> impl Iterator<Item = f64> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        (0..200_000).map(move |index| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let mantissa = 1.0 + 9.0 * (state >> 11) as f64 / (1_u64 << 53) as f64;
            let sign = if state & 1 == 0 { 1.0 } else { -1.0 };
            sign * mantissa * 10_f64.powi(index % 56 - 20)
        })
    }

    #[test]
    fn numbers_look_as_a_person_writes_them() {
        let exact: [(f64, &str); 10] = [
            (0.0, "0"),
            (-0.0, "0"),
            (0.1, "0.1"),
            (200e3, "200000"),
            (-12.75, "-12.75"),
            (1e-5, "0.00001"),
            (1.5e-6, "1.5e-6"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1234567890123456.0, "1234567890123456"),
            (1e16, "1e16"),
        ];
        for (value, expected) in exact {
            assert_eq!(text(push_exact, value), expected);
        }
        let rounded: [(f64, &str); 9] = [
            (0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 3.0, "0.333333333"),
            (26919.812345678, "26919.8123"),
            (144_700.0, "144700"),
            (999_999_999.5, "1000000000"),
            (0.099_999_999_96, "0.1"),
            (-2.0e-7 / 3.0, "-6.66666667e-8"),
            (f64::MIN_POSITIVE, "2.22507386e-308"),
        ];
        for (value, expected) in rounded {
            assert_eq!(text(push_rounded, value), expected);
        }
    }

    #[test]
    fn inputs_read_back_as_they_were() {
        for value in spread() {
            let written = text(push_exact, value);
            assert_eq!(written.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{written}");
            // What is taken over from the formatter is written as what is not.
            let own_way =
                |out: &mut _, value| push_decimal(out, ryu::Buffer::new().format_finite(value).as_bytes());
            assert_eq!(text(own_way, value), written);
        }
    }

    /// Against the formatter of the standard library, which rounds every digit exactly.
    #[test]
    fn results_are_rounded_to_nine_digits() {
        for value in spread() {
            let written = text(push_rounded, value);
            let expected: f64 = format!("{value:.8e}").parse().unwrap();
            assert_eq!(written.parse::<f64>().unwrap(), expected, "{written} for {value:e}");
        }
    }

    #[test]
    fn powers_of_ten_keep_their_exponent() {
        for exponent in -20..35 {
            let value = 10_f64.powi(exponent);
            for neighbour in [value.next_down(), value, value.next_up()] {
                let parsed: f64 = text(push_rounded, neighbour).parse().unwrap();
                assert_eq!(parsed, format!("{neighbour:.8e}").parse::<f64>().unwrap(), "near 1e{exponent}");
            }
        }
    }
}
