//! Pin against plate: unilateral and frictionless. `pressure` and `loading` are the method; `active_set` is the plain
//! check, node by node.

pub mod arc_state;
pub mod pressure;
pub mod loading;
pub mod smooth_curve;
pub mod active_set;
