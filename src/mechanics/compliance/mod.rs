//! What contact needs to know of a body: how its ring yields.

pub mod condense;
pub mod arc;
pub mod kernels;
pub mod pressure_space;
pub mod thin_wall;
pub mod series;
pub mod ring_loads;
pub mod lane_condensation;
pub mod near_field;
pub mod body_fit;

pub use pressure_space::NODE_COUNT;

/// Compliance of a ring: displacement of each of the ring's unknowns (the last ones of its `RingTopology`, in order)
/// per unit force on each, for Young's modulus 1, thickness 1 and ring radius 1. Symmetric, row-major.
#[derive(Clone, Debug)]
pub struct RingCompliance {
    pub size: usize,
    pub values: Vec<f64>,
}

/// Compliance of a body to the trial pressures of a `PressureSpace`: the matrix of integrals of p_j u(p_k) over the
/// half arc, u the normal displacement that p_k gives, for Young's modulus 1 and ring radius 1.
#[derive(Clone, Debug)]
pub struct PressureCompliance {
    pub terms: usize,
    /// c = 2/E': the part -pi/2 c ln b of entry (0, 0) is left out of `values`.
    pub amplitude: f64,
    /// lambda of the part that yields like a Winkler bed (`thin_wall`), which is left out of `values`, too: its closed form
    /// is not smooth enough to be interpolated between nodes.
    pub bed: f64,
    /// `[node][packed lower triangle]`.
    pub values: Vec<f64>,
}

impl PressureCompliance {
    /// The difference from another of the same space.
    pub fn minus(&self, other: &PressureCompliance) -> PressureCompliance {
        PressureCompliance {
            terms: self.terms,
            amplitude: self.amplitude - other.amplitude,
            bed: self.bed - other.bed,
            values: self.values.iter().zip(&other.values).map(|(own, other)| own - other).collect(),
        }
    }
}
