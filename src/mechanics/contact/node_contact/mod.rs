//! Contact node by node on the rings of two meshes: the plain check (`active_set`), and what others do in its place.

pub mod ring_joint;
pub mod active_set;
pub mod penalty;
pub mod augmented_lagrangian;
