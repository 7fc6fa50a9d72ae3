//! Why a closed form gives no number, with the value at fault and what is allowed.

use std::ops::{Bound, RangeBounds};

/// Lower and upper bound of a quantity; each may belong to the range or not.
pub type Interval = (Bound<f64>, Bound<f64>);

pub(super) const POSITIVE: Interval = (Bound::Excluded(0.0), Bound::Unbounded);

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LawError {
    /// An input that is not a number, or a result too large for one.
    #[error("{law}: {quantity} = {value} is not a finite number")]
    NotFinite { law: &'static str, quantity: &'static str, value: f64 },

    #[error("{law}: {quantity} = {value} is outside {}", in_brackets(.allowed))]
    OutOfRange { law: &'static str, quantity: &'static str, value: f64, allowed: Interval },

    /// Dundurs' constants of the pair; the law needs both to be zero.
    #[error("{law}: the two materials must be elastically similar, but alpha = {alpha} and beta = {beta}")]
    DissimilarMaterials { law: &'static str, alpha: f64, beta: f64 },
}

/// The value itself when it is finite and allowed.
pub(super) fn check(
    law: &'static str,
    quantity: &'static str,
    value: f64,
    allowed: Interval,
) -> Result<f64, LawError> {
    if !value.is_finite() {
        return Err(LawError::NotFinite { law, quantity, value });
    }
    if !allowed.contains(&value) {
        return Err(LawError::OutOfRange { law, quantity, value, allowed });
    }
    Ok(value)
}

/// The value itself when it is finite: for results, which can overflow.
pub(super) fn finite(law: &'static str, quantity: &'static str, value: f64) -> Result<f64, LawError> {
    check(law, quantity, value, (Bound::Unbounded, Bound::Unbounded))
}

/// [a, b] with round brackets where an end does not belong to the range.
fn in_brackets(allowed: &Interval) -> String {
    let lower = match allowed.0 {
        Bound::Included(value) => format!("[{value}"),
        Bound::Excluded(value) => format!("({value}"),
        Bound::Unbounded => "(-inf".to_owned(),
    };
    let upper = match allowed.1 {
        Bound::Included(value) => format!("{value}]"),
        Bound::Excluded(value) => format!("{value})"),
        Bound::Unbounded => "inf)".to_owned(),
    };
    format!("{lower}, {upper}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_law_quantity_value_and_range() {
        let allowed = (Bound::Included(0.0), Bound::Excluded(0.5));
        let error = check("johnson", "indentation", 0.6, allowed).unwrap_err();
        assert_eq!(error.to_string(), "johnson: indentation = 0.6 is outside [0, 0.5)");
        let error = check("pair", "thickness", -1.0, POSITIVE).unwrap_err();
        assert_eq!(error.to_string(), "pair: thickness = -1 is outside (0, inf)");
    }

    #[test]
    fn the_ends_belong_to_the_range_as_stated() {
        let half_open = (Bound::Included(0.0), Bound::Excluded(0.5));
        assert_eq!(check("a", "b", 0.0, half_open), Ok(0.0));
        assert!(matches!(check("a", "b", 0.5, half_open), Err(LawError::OutOfRange { .. })));
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(finite("a", "b", value), Err(LawError::NotFinite { .. })));
        }
    }
}
