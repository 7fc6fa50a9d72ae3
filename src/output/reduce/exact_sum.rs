//! Sums of numbers, and of their squares, without any rounding: the order in which they are added is of no account.

use serde::{Deserialize, Serialize};

/// A sum as digits of 32 bits; digit i counts 2^(32 i + LOWEST). Digits are signed and carry now and then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Digits", try_from = "Digits")]
pub struct ExactSum {
    digits: Box<[i64; DIGITS]>,
    /// Numbers added since the digits last carried.
    pending: u32,
}

/// The squares of the smallest and the largest number fit, (2^-1074)^2 and (2^1024)^2, and 2^64 of them.
const LOWEST: i32 = -2176;
const DIGITS: usize = (2176 + 2048 + 96) / 32;

/// Each number adds less than 2^33 to a digit.
const MOST_PENDING: u32 = 1 << 29;

/// A sum as data: one way to write each.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Digits {
    negative: bool,
    /// The place of the first digit that is not 0; lower ones come first.
    first: usize,
    digits: Vec<u32>,
}

impl Default for ExactSum {
    fn default() -> ExactSum {
        ExactSum { digits: Box::new([0; DIGITS]), pending: 0 }
    }
}

impl ExactSum {
    /// `value` must be finite.
    pub fn add(&mut self, value: f64) {
        let (negative, mantissa, exponent) = integer(value);
        self.add_integer(negative, mantissa, exponent);
        self.count_one();
    }

    /// `value` must be finite; its square need not be.
    pub fn add_square(&mut self, value: f64) {
        let (_, mantissa, exponent) = integer(value);
        let square = u128::from(mantissa) * u128::from(mantissa);
        self.add_integer(false, square as u64, 2 * exponent);
        self.add_integer(false, (square >> 64) as u64, 2 * exponent + 64);
        self.count_one();
    }

    /// Adds a whole number of 2^exponent, which is that of a number or of its square.
    pub fn add_whole(&mut self, negative: bool, whole: u128, exponent: i32) {
        self.add_integer(negative, whole as u64, exponent);
        self.add_integer(negative, (whole >> 64) as u64, exponent + 64);
        self.count_one();
    }

    pub fn merge(&mut self, other: &ExactSum) {
        let mut other = other.clone();
        other.carry();
        self.carry();
        self.digits.iter_mut().zip(other.digits.iter()).for_each(|(own, theirs)| *own += theirs);
        self.carry();
    }

    /// Adds mantissa 2^exponent.
    fn add_integer(&mut self, negative: bool, mantissa: u64, exponent: i32) {
        let place = (exponent - LOWEST) as usize;
        let (first, shift) = (place / 32, place % 32);
        let shifted = u128::from(mantissa) << shift;
        // Without branches: -digit is !digit + 1.
        let sign = -i64::from(negative);
        for (part, own) in self.digits[first..first + 3].iter_mut().enumerate() {
            let digit = i64::from((shifted >> (32 * part)) as u32);
            *own += (digit ^ sign) - sign;
        }
    }

    fn count_one(&mut self) {
        self.pending += 1;
        if self.pending == MOST_PENDING {
            self.carry();
        }
    }

    /// All digits but the last are in [0, 2^32) afterwards.
    fn carry(&mut self) {
        carry(&mut self.digits);
        self.pending = 0;
    }

    /// Whether it is negative, and its digits without sign.
    fn magnitude(&self) -> (bool, Vec<u32>) {
        let mut digits = self.digits.clone();
        carry(&mut digits);
        let negative = digits[DIGITS - 1] < 0;
        if negative {
            digits.iter_mut().for_each(|digit| *digit = -*digit);
            carry(&mut digits);
        }
        (negative, digits.iter().map(|digit| *digit as u32).collect())
    }

    /// The sum over `count`, rounded to the nearest number but for ties.
    pub fn mean(&self, count: u64) -> f64 {
        let (negative, digits) = self.magnitude();
        let (leading, exponent) = leading(&digits);
        let mean = scaled((leading / u128::from(count)) as f64, exponent + LOWEST);
        if negative { -mean } else { mean }
    }
}

/// The standard deviation of `count` numbers (two or more) from their sum and the sum of their squares: the root of
/// (count squares - sum^2) / (count (count - 1)), whose difference is exact.
pub fn standard_deviation(sum: &ExactSum, squares: &ExactSum, count: u64) -> f64 {
    let (_, sum) = sum.magnitude();
    let (_, squares) = squares.magnitude();
    let counts = [count as u32, (count >> 32) as u32];
    // sum^2 counts in 2^(2 LOWEST), the squares in 2^LOWEST.
    let aligned: Vec<u32> = std::iter::repeat_n(0, (-LOWEST / 32) as usize).chain(squares).collect();
    let (leading, exponent) = leading(&difference(product(&aligned, &counts), &product(&sum, &sum)));
    let variance = leading as f64 / (count as f64 * (count - 1) as f64);
    let exponent = exponent + 2 * LOWEST;
    let odd = exponent.rem_euclid(2);
    scaled((variance * f64::from(1 + odd)).sqrt(), (exponent - odd) / 2)
}

/// |value| = mantissa 2^exponent, the mantissa below 2^53, and whether it is negative.
fn integer(value: f64) -> (bool, u64, i32) {
    let bits = value.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    match exponent {
        0 => (value < 0.0, fraction, -1074),
        _ => (value < 0.0, fraction | 1 << 52, exponent - 1075),
    }
}

fn carry(digits: &mut [i64; DIGITS]) {
    for place in 0..DIGITS - 1 {
        let over = digits[place] >> 32;
        digits[place] -= over << 32;
        digits[place + 1] += over;
    }
}

/// The leading 97 bits or more of an integer, and the exponent of 2 that they have.
fn leading(digits: &[u32]) -> (u128, i32) {
    let Some(last) = digits.iter().rposition(|digit| *digit != 0) else { return (0, 0) };
    let first = last.saturating_sub(3);
    let top = digits[first..=last].iter().rev().fold(0_u128, |top, digit| top << 32 | u128::from(*digit));
    (top, 32 * first as i32)
}

/// value 2^exponent.
fn scaled(value: f64, exponent: i32) -> f64 {
    let mut rest = exponent;
    let mut value = value;
    while rest != 0 {
        let step = rest.clamp(-1000, 1000);
        value *= f64::from_bits(((1023 + step) as u64) << 52);
        rest -= step;
    }
    value
}

fn product(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut out = vec![0_u32; a.len() + b.len()];
    for (i, &left) in a.iter().enumerate().filter(|(_, digit)| **digit != 0) {
        let mut over = 0_u64;
        for (j, &right) in b.iter().enumerate() {
            let sum = u64::from(left) * u64::from(right) + u64::from(out[i + j]) + over;
            out[i + j] = sum as u32;
            over = sum >> 32;
        }
        out[i + b.len()] = over as u32;
    }
    out
}

/// a - b, where b is not larger.
fn difference(mut a: Vec<u32>, b: &[u32]) -> Vec<u32> {
    a.resize(a.len().max(b.len()), 0);
    let mut borrow = 0_i64;
    for (place, own) in a.iter_mut().enumerate() {
        let rest = i64::from(*own) - i64::from(b.get(place).copied().unwrap_or(0)) + borrow;
        *own = rest as u32;
        borrow = rest >> 32;
    }
    a
}

impl From<ExactSum> for Digits {
    fn from(sum: ExactSum) -> Digits {
        let (negative, digits) = sum.magnitude();
        let first = digits.iter().position(|digit| *digit != 0).unwrap_or(0);
        let end = digits.iter().rposition(|digit| *digit != 0).map_or(0, |last| last + 1);
        Digits { negative, first, digits: digits[first.min(end)..end].to_vec() }
    }
}

impl TryFrom<Digits> for ExactSum {
    type Error = &'static str;

    fn try_from(data: Digits) -> Result<ExactSum, &'static str> {
        let mut sum = ExactSum::default();
        let end = data.first.saturating_add(data.digits.len());
        let places = sum.digits.get_mut(data.first..end).ok_or("a sum has more digits than there are")?;
        for (place, digit) in places.iter_mut().zip(data.digits) {
            *place = if data.negative { -i64::from(digit) } else { i64::from(digit) };
        }
        sum.carry();
        Ok(sum)
    }
}
