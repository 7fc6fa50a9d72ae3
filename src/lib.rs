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
//! A whole sweep is a [`Sweep`], from the same configs as on the command line.
//!
//! Data runs one way:
//! `config -> design -> plan -> body -> mesh -> assembly -> solve -> compliance -> contact -> outcome -> table`.
//! The parts are in [`internals`], of which no promise is made.

pub mod internals;
use internals::{calibrate, engine, joint, mechanics, sensitivity, study, sweep};
#[cfg(feature = "files")]
use internals::{lab, output};

/// Errors for people: each variant carries the values that explain it.
pub mod error;

pub use engine::joint_stresses::{CircleStresses, PointStress};
pub use engine::material_shares::MaterialShare;
pub use engine::outcome::{DesignOutcome, Response, StepOutcome};
pub use engine::status::Status;
pub use error::Error;
pub use joint::{Curve, Dimensions, Joint, Options, material_shares, solve};
pub use mechanics::body::Side;
pub use mechanics::material::{Idealization, Material};
pub use study::config::MethodChoice;
pub use study::design::{DesignCase, Load, Part};
pub use study::layers::Layer;
pub use sweep::Sweep;
