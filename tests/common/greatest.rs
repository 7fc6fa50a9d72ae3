//! The greatest of many errors. Nothing to compare is a failure, and so is a value that is no number.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

/// The greatest size of any value. Panics without values, and where one is NaN: `f64::max` would pass over it.
#[track_caller]
pub fn greatest(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut greatest = None;
    for (place, value) in values.into_iter().enumerate() {
        assert!(!value.is_nan(), "value {place} is NaN");
        greatest = Some(value.abs().max(greatest.unwrap_or(0.0)));
    }
    greatest.expect("there are values")
}

/// The greatest difference over the greatest value, of as many values on both sides.
#[track_caller]
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    greatest(found.iter().zip(expected).map(|(found, expected)| found - expected))
        / greatest(expected.iter().copied())
}
