//! Text in SVG and HTML, and numbers as people write them.

/// With nothing in it that markup would take for its own. Characters that no XML may hold are left out.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' => out.push(character),
            control if control.is_control() || matches!(control, '\u{fffe}' | '\u{ffff}') => {}
            other => out.push(other),
        }
    }
    out
}

/// With `digits` significant digits; very large and very small ones by a power of ten.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if !(-4..7).contains(&exponent) {
        let mantissa = scientific.split_once('e').map_or("", |(mantissa, _)| mantissa);
        let mantissa = trimmed(mantissa);
        return match mantissa {
            "1" => format!("10{}", superscript(exponent)),
            _ => format!("{mantissa}\u{b7}10{}", superscript(exponent)),
        };
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    let rounded: f64 = scientific.parse().unwrap_or(value);
    trimmed(&format!("{rounded:.decimals$}")).to_string()
}

/// Without zeros behind the point.
fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// In small raised digits.
pub fn superscript(exponent: i32) -> String {
    let digit = |character: char| match character {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        other => char::from_u32('\u{2070}' as u32 + other.to_digit(10).unwrap_or(0)).unwrap_or(other),
    };
    exponent.to_string().chars().map(digit).collect()
}

/// A share as percent.
pub fn percent(share: f64, digits: usize) -> String {
    format!("{} %", number(100.0 * share, digits))
}

/// "1 design", "2 designs".
pub fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// What a line of text is wide at 13 px, px: near enough to keep labels apart.
pub fn width(text: &str) -> f64 {
    let of = |character: char| match character {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | 'I' | '(' | ')' | 't' | 'f' => 4.3,
        'm' | 'w' | 'M' | 'W' | '%' => 11.5,
        upper if upper.is_ascii_uppercase() => 9.2,
        ' ' => 3.9,
        _ => 7.3,
    };
    text.chars().map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_people_write_them() {
        let cases = [
            (0.0, "0"),
            (0.02, "0.02"),
            (38_319.76, "38320"),
            (1.0, "1"),
            (0.000_123_4, "0.0001234"),
            (99_996.0, "100000"),
            (2.5e-7, "2.5\u{b7}10\u{207b}\u{2077}"),
            (1e12, "10\u{b9}\u{b2}"),
            (-3.21e9, "-3.21\u{b7}10\u{2079}"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value, 4), expected);
        }
        assert_eq!(percent(0.001, 3), "0.1 %");
    }

    #[test]
    fn nothing_is_left_of_markup() {
        assert_eq!(escaped("a <b> & \"c\"\u{0}'"), "a &lt;b&gt; &amp; &quot;c&quot;&#39;");
    }
}
