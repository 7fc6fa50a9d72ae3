//! Laws with constants calibrated to the curve of one joint, for simulators that take a formula.
//!
//! All of them relate x = delta/dR to y = F/(E* t dR), dR > 0: one file a law, each with a static `CalibratedLaw` that is listed in
//! `CALIBRATED_LAWS`. What fits which joint is measured in docs/laws.md.

mod least_squares;
pub mod samples;
mod logarithm;
pub mod explicit;
pub mod inverse_three;
pub mod inverse_four;
mod power_of;
pub mod power;
pub mod working_power;
pub mod winkler_two;
mod offset;
pub mod johnson_offset;
pub mod persson_offset;
pub mod spline;
pub mod fitted;

use std::fmt::{self, Display, Formatter};

use crate::mechanics::digits::{plain, significant, without_zeros};

pub use fitted::{FittedLaw, fitted_laws, recommended};
pub use samples::{Sample, Samples};

/// A law with constants to calibrate.
#[derive(Debug)]
pub struct CalibratedLaw {
    /// The name in tables and on the command line.
    pub name: &'static str,
    /// What it does outside the range that it was fitted over.
    pub outside: &'static str,
    /// The names of the constants, all of them dimensionless; none of a law that has a list of points.
    pub constants: &'static [&'static str],
    /// The samples it is to be fitted to: all, or those of the load's working decade.
    pub range: fn(&Samples) -> (f64, f64),
    /// The constants; `None` where it does not fit.
    pub fit: fn(&[Sample]) -> Option<Vec<f64>>,
    /// y and dy/dx at x > 0; not finite where the law has no value. Where y is searched, from a guess at it, or from NaN.
    pub value: fn(&[f64], f64, f64) -> [f64; 2],
    /// As a person pastes it: F in N, d = delta in mm.
    pub formula: fn(&[f64], &Sizes) -> String,
}

/// What brings x and y to mm and N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// dR, mm, > 0.
    pub radial_clearance: f64,
    /// E* t, N/mm.
    pub stiffness: f64,
}

/// Every law, the one to prefer first.
pub static CALIBRATED_LAWS: [&CalibratedLaw; 9] = [
    &explicit::LAW,
    &inverse_four::LAW,
    &inverse_three::LAW,
    &spline::LAW,
    &winkler_two::LAW,
    &power::LAW,
    &working_power::LAW,
    &persson_offset::LAW,
    &johnson_offset::LAW,
];

/// Seven digits: a misfit in the sixth is below all others. Without an exponent from 1e-4 to below 1e9.
struct Number(f64);

impl Display for Number {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Number(value) = *self;
        match significant::<7>(value.abs()) {
            Some((digits, exponent)) if (-4..9).contains(&exponent) => {
                f.write_str(if value < 0.0 { "-" } else { "" })?;
                let mut pieces = plain(without_zeros(&digits), exponent).into_iter();
                pieces.try_for_each(|piece| f.write_str(str::from_utf8(piece).map_err(|_| fmt::Error)?))
            }
            _ => write!(f, "{value:.6e}"),
        }
    }
}

/// A number that is added: with its sign before it.
struct Added(f64);

impl Display for Added {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Added(value) = *self;
        let sign = if value.is_sign_negative() { '-' } else { '+' };
        write!(f, "{sign} {}", Number(value.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_rust_writes_them() {
        let written = |value: f64| {
            let text = format!("{value:.6e}");
            let rounded: f64 = text.parse().unwrap();
            if (1e-4..1e9).contains(&rounded.abs()) { format!("{rounded}") } else { text }
        };
        let number = |value: f64| Number(value).to_string();
        let mut value = 7.3e-7_f64;
        while value < 3e11 {
            for own in [value, -value, 1.0 / value, value.round(), 10.0_f64.powf(value.log10().round())] {
                assert_eq!(number(own), written(own));
            }
            value *= 1.00173;
        }
        let odd =
            [0.0, -0.0, 1e-4, 0.999_999_96e-4, 0.000_123, 999_999_999.9, 1e9, 12.5, 100.0, 0.5, f64::MAX];
        odd.into_iter().for_each(|own| assert_eq!(number(own), written(own)));
        assert_eq!([f64::NAN, f64::INFINITY].map(number), ["NaN", "inf"]);
        assert_eq!(
            [0.000_123, -1_234_567.0, 1_234_567_800.0].map(number),
            ["0.000123", "-1234567", "1.234568e9"]
        );
        assert_eq!(
            [2.5, -0.25, -3e-9].map(|value| Added(value).to_string()),
            ["+ 2.5", "- 0.25", "- 3.000000e-9"]
        );
    }
}
