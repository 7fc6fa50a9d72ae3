//! Parametric sweeps of pin joints with clearance.
//!
//! ```
//! use jointsweep::{Dimensions, Idealization, Joint, Load, Material, Options, Part};
//!
//! let steel = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
//! let joint = Joint::new(
//!     Dimensions { hole_radius: 10.0, radial_clearance: 0.05, thickness: 8.0 },
//!     Idealization::PlaneStress,
//!     Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, steel)?,
//!     Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, steel)?,
//! )?;
//! let curve = joint.curve(Options { accuracy: 1e-3, ..Options::default() })?;
//! let under_20_kn = curve.at(Load::Force(2e4))?;
//! assert!(under_20_kn.tangent_stiffness > curve.tangent_stiffness(0.01)?);
//! assert!(under_20_kn.force_error < 1e-3);
//! # Ok::<(), jointsweep::Error>(())
//! ```
//!
//! All that is not named on this page is for the program itself and its tests: it may change with any version.
//!
//! Data runs one way:
//! `config -> design -> plan -> body -> mesh -> assembly -> solve -> compliance -> contact -> outcome -> table`.
//! Wings, each of which uses only the wings above it (`tests/layering.rs` checks this):

/// What is true: pure functions of numbers, dimensionless; no files, threads or printing.
#[doc(hidden)]
pub mod mechanics;
/// What is asked: from a file to a numbered list of designs.
#[doc(hidden)]
pub mod study;
/// How it is computed: the only wing with threads and devices.
#[doc(hidden)]
pub mod engine;
/// One joint and its curve, for programs that use the library.
pub mod joint;
/// Joints fitted to measured points.
#[doc(hidden)]
pub mod calibrate;
/// What each choice costs and what it is worth: designs run through all of them, timed and compared.
#[doc(hidden)]
pub mod tradeoff;
/// What is handed over: the only wing that writes files.
#[doc(hidden)]
pub mod output;

/// Errors for people: each variant carries the values that explain it.
pub mod error;

pub use engine::outcome::{Response, StepOutcome};
pub use engine::status::Status;
pub use error::Error;
pub use joint::{Curve, Dimensions, Joint, Options, solve};
pub use mechanics::material::{Idealization, Material};
pub use study::config::{MethodChoice, Study as Sweep};
pub use study::design::{Load, Part};
