//! What contact needs to know of a body: how its ring yields.

pub mod condense;

/// Compliance of a ring: displacement of each of the ring's unknowns (the last ones of its `RingTopology`, in order)
/// per unit force on each, for Young's modulus 1, thickness 1 and ring radius 1. Symmetric, row-major.
#[derive(Clone, Debug)]
pub struct RingCompliance {
    pub size: usize,
    pub values: Vec<f64>,
}
