//! One point of a sweep: a joint and the load steps it is run through. mm, N, MPa.

use crate::mechanics::body::{Body, MAX_PARAMETERS, Shape};
use crate::mechanics::material::{Idealization, Material};

/// One half of a joint: its shape with ratios to the ring's radius, and its material (MPa).
#[derive(Clone, Copy, Debug)]
pub struct Part {
    pub shape: &'static Shape,
    /// Values of `shape.parameters`, in order; the rest is zero.
    pub parameters: [f64; MAX_PARAMETERS],
    /// Index into `shape.supports`; 0 when there is only one.
    pub support: usize,
    pub material: Material,
}

/// A pin in a hole with clearance.
#[derive(Clone, Copy, Debug)]
pub struct JointDesign {
    pub idealization: Idealization,
    /// R2, mm.
    pub hole_radius: f64,
    /// dR = R2 - R1, mm; 0 is a neat fit.
    pub radial_clearance: f64,
    /// mm.
    pub thickness: f64,
    pub pin: Part,
    pub plate: Part,
}

impl JointDesign {
    /// The dimensionless body of one half.
    pub fn body(&self, part: &Part) -> Body {
        Body {
            shape: part.shape,
            parameters: part.parameters,
            support: part.support,
            poissons_ratio: part.material.poissons_ratio,
            idealization: self.idealization,
        }
    }
}

/// The quantity a load step prescribes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Indentation of each step, mm, >= 0.
    Indentation(f64),
    /// Force of each step, N, >= 0.
    Force(f64),
}

/// A design with its load steps, in the order of the config.
#[derive(Clone, Debug)]
pub struct DesignCase {
    /// Position in the sweep, from 0.
    pub index: u64,
    pub joint: JointDesign,
    pub steps: Vec<Load>,
}
