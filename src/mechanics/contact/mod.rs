//! Pin against plate: unilateral and frictionless. A load, the arcs it may reach, a free edge on each, and the curve through them.
//! `node_contact` is what this is checked against.

pub mod load;
pub mod outlines;
pub mod state;
pub mod reduced;
pub mod edge;
pub mod arc_pressure;
pub mod curve_space;
pub mod compliance_rows;
pub mod curve;
pub mod curve_error;
pub mod curve_pressure;
pub mod search;
pub mod whole_ring;
pub mod press_fit;
pub mod node_contact;
