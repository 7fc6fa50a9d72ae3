//! What several integration tests need.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

pub mod meshes;
pub mod rings;

/// The greatest size of any value; NaN if there is one.
pub fn greatest(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |most: f64, value| if most.is_nan() || value.abs() <= most { most } else { value.abs() })
}
