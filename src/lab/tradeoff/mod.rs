//! What each choice costs and what it is worth: a set of designs run through every method, element, mesh, contact
//! formulation, solver and precision there is, timed, and compared with the best answer there is.
//!
//! A family of choices is one file in `families` and one line in its list. A choice takes designs and gives the states
//! of their load steps; it stands on `mechanics` and on what `engine` shares, not on what `engine` plans by itself.

pub mod answer;
pub mod errors;
pub mod front;
pub mod choice;
pub mod joints;
pub mod moving_edge;
pub mod ring_mesh;
pub mod rings;
pub mod meshed;
pub mod nodal;
pub mod families;
pub mod oracle;
pub mod measure;
pub mod plot;
pub mod manifest;
