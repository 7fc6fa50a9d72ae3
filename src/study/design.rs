//! One point of a sweep: a joint and the load steps it is run through. mm, N, MPa.

use crate::mechanics::body::{Body, MAX_PARAMETERS, Shape, ShapeParameter};
use crate::mechanics::material::{Idealization, Material};

/// The values a quantity may take: from `low`, itself allowed or not, to below `high`.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub low: f64,
    pub low_allowed: bool,
    pub high: f64,
}

impl Limits {
    /// Radii, thickness, moduli.
    pub const POSITIVE: Limits = Limits::between(0.0, f64::INFINITY);
    /// Clearance, indentation, force.
    pub const NOT_NEGATIVE: Limits = Limits { low: 0.0, low_allowed: true, high: f64::INFINITY };
    /// Where plane strain has a positive energy; 0.5 itself is incompressible.
    pub const POISSONS_RATIO: Limits = Limits::between(-1.0, 0.5);

    const fn between(low: f64, high: f64) -> Limits {
        Limits { low, low_allowed: false, high }
    }

    /// The exclusive bounds of a shape's ratio.
    pub fn of_parameter(parameter: &ShapeParameter) -> Limits {
        Limits::between(parameter.above, parameter.below)
    }

    /// What is allowed, if `value` is not.
    pub fn refuse(&self, value: f64) -> Result<(), String> {
        // False for NaN, too.
        let inside = if self.low_allowed { value >= self.low } else { value > self.low } && value < self.high;
        match (inside, self.low_allowed, self.high.is_finite()) {
            (true, ..) => Ok(()),
            (_, true, false) => Err(format!("must be {} or more", self.low)),
            (_, false, false) => Err(format!("must be above {}", self.low)),
            (_, true, true) => Err(format!("must be at least {} and below {}", self.low, self.high)),
            (_, false, true) => Err(format!("must be above {} and below {}", self.low, self.high)),
        }
    }
}

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

impl Part {
    /// The value of one of the shape's ratios; `None` when the shape has no such ratio.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let position = self.shape.parameters.iter().position(|parameter| parameter.name == name)?;
        self.parameters.get(position).copied()
    }

    /// The name of the way it is held; `None` when there is only one.
    pub fn support_name(&self) -> Option<&'static str> {
        self.shape.supports.get(self.support).copied()
    }
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
