//! "12.7 mm", "210 GPa", "1 %": a number and its unit, converted once to mm, N, MPa.

use crate::error::suggest;

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// mm inside.
    Length,
    /// MPa inside.
    Stress,
    /// N inside.
    Force,
    /// N/mm inside.
    Stiffness,
    /// mJ inside.
    Energy,
    /// deg inside.
    Angle,
}

/// A unit's name, what it measures, and what one of it is in the unit of the tables.
type Unit = (&'static str, Dimension, f64);

/// One pound-force is 0.45359237 kg times 9.80665 m/s^2, and one inch is 25.4 mm, all exact by definition.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
const PSI: f64 = POUND_FORCE / (25.4 * 25.4);

#[rustfmt::skip]
const UNITS: [Unit; 38] = [
    ("nm", Dimension::Length, 1e-6),
    ("um", Dimension::Length, 1e-3),
    ("\u{b5}m", Dimension::Length, 1e-3),  // the micro sign
    ("\u{3bc}m", Dimension::Length, 1e-3), // the Greek letter, which looks the same
    ("mm", Dimension::Length, 1.0),
    ("cm", Dimension::Length, 10.0),
    ("m", Dimension::Length, 1e3),
    ("in", Dimension::Length, 25.4),
    ("Pa", Dimension::Stress, 1e-6),
    ("kPa", Dimension::Stress, 1e-3),
    ("MPa", Dimension::Stress, 1.0),
    ("GPa", Dimension::Stress, 1e3),
    ("psi", Dimension::Stress, PSI),
    ("ksi", Dimension::Stress, 1e3 * PSI),
    ("uN", Dimension::Force, 1e-6),
    ("\u{b5}N", Dimension::Force, 1e-6),
    ("\u{3bc}N", Dimension::Force, 1e-6),
    ("mN", Dimension::Force, 1e-3),
    ("N", Dimension::Force, 1.0),
    ("kN", Dimension::Force, 1e3),
    ("MN", Dimension::Force, 1e6),
    ("lbf", Dimension::Force, POUND_FORCE),
    ("N/m", Dimension::Stiffness, 1e-3),
    ("N/mm", Dimension::Stiffness, 1.0),
    ("N/um", Dimension::Stiffness, 1e3),
    ("N/\u{b5}m", Dimension::Stiffness, 1e3),
    ("N/\u{3bc}m", Dimension::Stiffness, 1e3),
    ("kN/m", Dimension::Stiffness, 1.0),
    ("kN/mm", Dimension::Stiffness, 1e3),
    ("MN/m", Dimension::Stiffness, 1e3),
    ("lbf/in", Dimension::Stiffness, POUND_FORCE / 25.4),
    ("uJ", Dimension::Energy, 1e-3),
    ("\u{b5}J", Dimension::Energy, 1e-3),
    ("\u{3bc}J", Dimension::Energy, 1e-3),
    ("mJ", Dimension::Energy, 1.0),
    ("J", Dimension::Energy, 1e3),
    ("deg", Dimension::Angle, 1.0),
    ("rad", Dimension::Angle, 180.0 / std::f64::consts::PI),
];

impl Dimension {
    pub const ALL: [Dimension; 6] = [
        Dimension::Length,
        Dimension::Stress,
        Dimension::Force,
        Dimension::Stiffness,
        Dimension::Energy,
        Dimension::Angle,
    ];

    /// Powers of N, mm and deg.
    pub fn powers(self) -> [i8; 3] {
        match self {
            Dimension::Length => [0, 1, 0],
            Dimension::Stress => [1, -2, 0],
            Dimension::Force => [1, 0, 0],
            Dimension::Stiffness => [1, -1, 0],
            Dimension::Energy => [1, 1, 0],
            Dimension::Angle => [0, 0, 1],
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Dimension::Length => "length",
            Dimension::Stress => "stress",
            Dimension::Force => "force",
            Dimension::Stiffness => "stiffness",
            Dimension::Energy => "energy",
            Dimension::Angle => "angle",
        }
    }

    /// The unit quantities of this dimension have inside the program and in its files.
    pub fn unit(self) -> &'static str {
        match self {
            Dimension::Length => "mm",
            Dimension::Stress => "MPa",
            Dimension::Force => "N",
            Dimension::Stiffness => "N/mm",
            Dimension::Energy => "mJ",
            Dimension::Angle => "deg",
        }
    }

    /// All units that may be written.
    pub fn unit_names(self) -> Vec<&'static str> {
        UNITS.iter().filter(|unit| unit.1 == self).map(|unit| unit.0).collect()
    }
}

/// What a unit measures, and what one of it is in the unit of the tables.
pub fn find(name: &str) -> Option<(Dimension, f64)> {
    UNITS.iter().find(|unit| unit.0 == name).map(|unit| (unit.1, unit.2))
}

/// All units that there are, those with a micro sign once.
pub fn all_names() -> Vec<&'static str> {
    UNITS.iter().map(|unit| unit.0).filter(|name| !name.contains('\u{3bc}')).collect()
}

/// `value` of a unit with this factor, in the unit of the tables.
pub fn in_table_units(value: f64, factor: f64) -> f64 {
    if factor == 1.0 { value } else { tidy(value * factor) }
}

/// The value of a number with its unit in mm, MPa or N; on failure, what is wrong with it.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    let (number, unit) = split(text);
    let wanted = dimension.name();
    if unit.is_empty() && !number.is_empty() && number.parse::<f64>().is_err() {
        return Err(format!("a {wanted} is one number and its unit, like \"12.5 {}\"", dimension.unit()));
    }
    if unit.is_empty() {
        let number = if number.parse::<f64>().is_ok() { number } else { "1" };
        let example = format!("\"{number} {}\"", dimension.unit());
        return Err(format!("the unit is missing; a {wanted} is written like {example}"));
    }
    let value = parse_number(number)?;
    let Some((found, factor)) = find(unit) else {
        return Err(format!(
            "`{unit}` is not a unit of {wanted}; {}",
            suggest(unit, &dimension.unit_names())
        ));
    };
    if found != dimension {
        let allowed = dimension.unit_names().join(", ");
        return Err(format!("`{unit}` is a unit of {}, a {wanted} is needed: {allowed}", found.name()));
    }
    finite(in_table_units(value, factor))
}

/// The value of "1 %" as a fraction, 0.01; on failure, what is wrong with it.
pub fn parse_percentage(text: &str) -> Result<f64, String> {
    match split(text) {
        (number, "%") => finite(tidy(parse_number(number)? / 100.0)),
        _ => Err("a fraction is written like \"1 %\" or as a plain number like 0.01".to_string()),
    }
}

/// `value` to 14 digits: takes away what binary arithmetic adds to decimals (0.3 in = 7.619999999999999 mm).
pub fn tidy(value: f64) -> f64 {
    format!("{value:.13e}").parse().unwrap_or(value)
}

/// The number and the trailing letters of a text.
fn split(text: &str) -> (&str, &str) {
    let text = text.trim();
    let number = text.trim_end_matches(|c: char| c.is_alphabetic() || "%/\u{b5}".contains(c));
    // `number` is a prefix of `text`, so its length is a character boundary.
    (number.trim_end(), &text[number.len()..])
}

fn parse_number(text: &str) -> Result<f64, String> {
    if text.is_empty() {
        return Err("the number before the unit is missing".to_string());
    }
    let parsed = text.parse::<f64>();
    parsed.map_err(|_| format!("`{text}` is not a number")).and_then(finite)
}

fn finite(value: f64) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err("the number is not finite".to_string()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_converts_exactly() {
        use Dimension::{Force, Length, Stress};
        // Right-hand sides are the decimals a reader expects; equality is exact, without a last-digit remainder.
        for (text, dimension, value) in [
            ("70.3 um", Length, 0.0703),
            ("70.3 \u{b5}m", Length, 0.0703),
            ("70.3\u{3bc}m", Length, 0.0703),
            ("250 nm", Length, 0.00025),
            ("0.3 in", Length, 7.62),
            (" -1.5e-3 m ", Length, -1.5),
            ("2 cm", Length, 20.0),
            ("210 GPa", Stress, 210e3),
            ("7e10 Pa", Stress, 70e3),
            ("5 kPa", Stress, 0.005),
            ("1 ksi", Stress, 6.8947572931684),
            ("1000 psi", Stress, 6.8947572931684),
            ("3 kN", Force, 3000.0),
            ("3 uN", Force, 3e-6),
            ("0.1 MN", Force, 1e5),
            ("1 lbf", Force, 4.4482216152605),
        ] {
            assert_eq!(parse_quantity(text, dimension), Ok(value), "{text}");
        }
        assert_eq!(parse_percentage("0.3%"), Ok(0.003));
    }

    #[test]
    fn complaints_say_what_is_wrong() {
        for (text, expected) in [
            ("12.7", "the unit is missing; a length is written like \"12.7 mm\""),
            ("", "the unit is missing"),
            ("1e3", "the unit is missing"),
            ("10 mm 3", "a length is one number and its unit, like \"12.5 mm\""),
            ("12 Mm", "did you mean `mm`?"),
            ("12 MPa", "`MPa` is a unit of stress, a length is needed: nm,"),
            ("12,7 mm", "`12,7` is not a number"),
            ("mm", "the number before the unit is missing"),
            ("1e400 mm", "the number is not finite"),
            ("1e308 m", "the number is not finite"),
        ] {
            let problem = parse_quantity(text, Dimension::Length).unwrap_err();
            assert!(problem.contains(expected), "{text:?}: {problem}");
        }
        assert!(parse_percentage("1").unwrap_err().contains("1 %"));
    }
}
