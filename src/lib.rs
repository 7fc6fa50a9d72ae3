//! Parametric sweeps of pin joints with clearance.
//!
//! ```
//! use jointsweep::engine::ladder::Ladder;
//! use jointsweep::mechanics::body::{annulus, cored_disc};
//! use jointsweep::mechanics::material::{Idealization, Material};
//! use jointsweep::study::config::{MethodChoice, SolveOptions};
//! use jointsweep::study::design::{DesignCase, JointDesign, Load, Part};
//!
//! let steel = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
//! let joint = JointDesign {
//!     idealization: Idealization::PlaneStress,
//!     hole_radius: 10.0,
//!     radial_clearance: 0.05,
//!     thickness: 8.0,
//!     pin: Part { shape: &cored_disc::SHAPE, parameters: [0.2, 0.0, 0.0], support: 0, material: steel },
//!     plate: Part { shape: &annulus::SHAPE, parameters: [3.0, 0.0, 0.0], support: 0, material: steel },
//! };
//! let case = DesignCase { index: 0, joint, steps: vec![Load::Indentation(0.01), Load::Force(2e4)] };
//! let mut backend = Ladder::new(SolveOptions { accuracy: 0.01, method: MethodChoice::Auto });
//! let outcome = &backend.solve(&[case])[0];
//! let response = outcome.steps[1].response.expect("the contact is free");
//! assert!(response.tangent_stiffness > outcome.steps[0].response.unwrap().tangent_stiffness);
//! assert!(response.force_error < 1e-5);
//! ```
//!
//! Data runs one way:
//! `config -> design -> plan -> body -> mesh -> assembly -> solve -> compliance -> contact -> outcome -> table`.
//! Five wings, each of which uses only the wings above it (`tests/layering.rs` checks this):

/// What is true: pure functions of numbers, dimensionless; no files, threads or printing.
pub mod mechanics;
/// What is asked: from a file to a numbered list of designs.
pub mod study;
/// How it is computed: the only wing with threads and devices.
pub mod engine;
/// What each choice costs and what it is worth: designs run through all of them, timed and compared.
pub mod tradeoff;
/// What is handed over: the only wing that writes files.
pub mod output;

/// Errors for people: each variant carries the values that explain it.
pub mod error;

pub use error::Error;
