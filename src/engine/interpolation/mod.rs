//! Interpolation across bodies: a rung of the ladder below the meshes. Where a sweep has many distinct bodies, a few of
//! them are solved, and the others are found between them, to an error that is checked on bodies that were held out.
//!
//! What is fitted, over which ranges, is decided from the whole study before the first design is solved (`fit_plan`), so that
//! a design has the same answer in whatever batch, order or thread it is solved. A design that is outside of what was
//! fitted, or whose error is not known to be small enough, goes on to the meshes.

pub mod family;
pub mod basis;
mod points;
mod samples;
mod held_out;
pub mod fit;
pub mod fit_plan;
pub mod interpolated;
mod on_device;
pub mod drawn_on_device;
