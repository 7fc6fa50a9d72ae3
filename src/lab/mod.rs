//! What is measured about the program itself. Nothing else in the library uses it; the commands `bench`, `bench-gpu` and
//! `tradeoff` do.

pub mod benchmark;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod tradeoff;
