//! The parts of the program, for its command line, tests and benchmarks: no promise is made of them, they may change with any
//! version. What other programs need stands at the root.
//!
//! Wings, each of which uses only the wings above it (`tests/layering.rs` checks this):

/// What is true: pure functions of numbers, dimensionless; no files, threads or printing.
#[path = "mechanics/mod.rs"]
pub mod mechanics;
/// What is asked: from a file to a numbered list of designs.
#[path = "study/mod.rs"]
pub mod study;
/// How it is computed: the only wing with threads and devices.
#[path = "engine/mod.rs"]
pub mod engine;
/// One joint and its curve, for programs that use the library.
#[path = "joint.rs"]
pub mod joint;
/// A sweep, for programs that use the library.
#[path = "sweep.rs"]
pub mod sweep;
/// Joints fitted to measured points.
#[path = "calibrate/mod.rs"]
pub mod calibrate;
/// Which inputs the scatter of a result comes from.
#[path = "sensitivity/mod.rs"]
pub mod sensitivity;
/// What is handed over: the wing that writes files.
#[cfg(feature = "files")]
#[path = "output/mod.rs"]
pub mod output;
/// What is measured about the program itself: benchmarks, and what each choice costs and is worth.
#[cfg(feature = "files")]
#[path = "lab/mod.rs"]
pub mod lab;
