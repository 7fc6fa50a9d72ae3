//! Parametric sweeps of pin joints with clearance.
//!
//! Data runs one way:
//! `config -> design -> plan -> body -> mesh -> assembly -> solve -> compliance -> contact -> outcome -> table`.
//! Four wings, each of which uses only the wings above it (`tests/layering.rs` checks this):

/// What is true: pure functions of numbers, dimensionless; no files, threads or printing.
pub mod mechanics;
/// What is asked: from a file to a numbered list of designs.
pub mod study;
/// How it is computed: the only wing with threads and devices.
pub mod engine;
/// What is handed over: the only wing that writes files.
pub mod output;

/// Errors for people: each variant carries the values that explain it.
pub mod error;

pub use error::Error;
