//! Pin against plate: unilateral and frictionless. `pressure` and `loading` are the method; `active_set` is the plain
//! check, node by node, and `penalty` and `augmented_lagrangian` are what others do in its place, to be measured against it.

pub mod arc_state;
pub mod pressure;
pub mod loading;
pub mod smooth_curve;
pub mod ring_joint;
pub mod active_set;
pub mod penalty;
pub mod augmented_lagrangian;
