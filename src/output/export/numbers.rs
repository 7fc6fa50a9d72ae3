//! Numbers as other programs read them: plain decimals, without an exponent, that fit where they stand.

/// Rounded to some significant digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// With twelve digits at most, and a point: `-0.00125`, `3.0`.
pub fn plain(value: f64) -> String {
    format!("{:?}", Plain(rounded(value, 12)))
}

struct Plain(f64);

impl std::fmt::Debug for Plain {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        // Never an exponent, unlike `{:?}` of a number.
        let text = format!("{}", self.0);
        out.write_str(&text)?;
        if text.contains('.') { Ok(()) } else { out.write_str(".0") }
    }
}

/// In a field of some columns, at least nine: with as many digits as there is room for, and with an exponent where
/// that has more.
pub fn fitted(value: f64, columns: usize) -> String {
    let fits = |text: &String| text.len() <= columns;
    let candidates = (1..=12).rev().find_map(|digits| {
        let value = rounded(value, digits);
        let decimal = format!("{:?}", Plain(value));
        let text = format!("{value:E}");
        let exponent = if text.contains('.') { text } else { text.replacen('E', ".0E", 1) };
        [decimal, exponent].into_iter().find(fits)
    });
    candidates.unwrap_or_else(|| "0.0".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_plain_and_fit() {
        assert_eq!(
            [0.0, 3.0, -1.25e-7, 1.0 / 3.0].map(plain),
            ["0.0", "3.0", "-0.000000125", "0.333333333333"]
        );
        assert_eq!(fitted(1.0 / 3.0, 10), "0.33333333");
        assert_eq!(fitted(1.234_567_89e-9, 12), "1.2345679E-9");
        assert_eq!(fitted(-12345.678, 9), "-12345.68");
        for value in [1e-300, 7.0, 123_456_789_012.3, -5.4321e-8] {
            for columns in [9, 16, 20] {
                let text = fitted(value, columns);
                let back: f64 = text.parse().unwrap();
                assert!(
                    text.len() <= columns && text.contains('.') && (back / value - 1.0).abs() < 2e-3,
                    "{text}"
                );
            }
        }
    }
}
