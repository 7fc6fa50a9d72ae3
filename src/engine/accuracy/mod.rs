//! How good a force is: every source of its error, and the sum of them.

pub mod known_errors;
pub mod single_precision;
pub mod mesh_change;
pub mod fit_bound;
pub mod geometry_error;
pub mod body_errors;

use mesh_change::Trust;

use crate::mechanics::contact::state::ContactState;

/// How the error of meshes is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Estimate {
    /// Both bodies are exact.
    Exact,
    /// What the mesh level is known to be worth (`known_errors`).
    Known,
    /// From the change since the next coarser mesh.
    Change(Trust),
}

/// What the answer to a design still wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Want {
    Nothing,
    /// The meshes are good enough, but the curve between its nodes is not.
    MoreNodes,
    /// Or the pressure is not.
    MoreTerms,
    FinerMesh,
}

/// Relative error of a force by its sources, each a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceError {
    /// Of meshes, or of interpolation between bodies.
    pub bodies: f64,
    /// Of walls that are taken for beds, and of layers thinner than the waves of all modes: nothing lessens it.
    pub beds: f64,
    /// Of trial pressures.
    pub pressure: f64,
    /// Of the curve between its nodes, with quadrature and rounding.
    pub curve: f64,
    /// Of outlines: nothing lessens it.
    pub outlines: f64,
}

/// Quadrature and rounding.
pub const LEAST: f64 = 1e-8;

impl ForceError {
    pub fn new(state: &ContactState, curve: f64, [bodies, beds]: [f64; 2], outlines: f64) -> ForceError {
        ForceError { bodies, beds, pressure: state.truncation, curve: LEAST + curve, outlines }
    }

    pub fn total(&self) -> f64 {
        self.bodies + self.beds + self.pressure + self.curve + self.outlines
    }

    /// What brings it below an accuracy.
    pub fn want(&self, accuracy: f64, pressure_is_positive: bool) -> Want {
        // What nothing lessens takes its part of what is allowed, unless it is most of it.
        let fixed = self.beds + self.outlines;
        let accuracy = if fixed < 0.5 * accuracy { accuracy - fixed } else { accuracy };
        match pressure_is_positive {
            _ if LEAST + self.bodies > accuracy => Want::FinerMesh,
            true if self.bodies + self.pressure + self.curve <= accuracy => Want::Nothing,
            true if self.curve > self.pressure => Want::MoreNodes,
            _ => Want::MoreTerms,
        }
    }
}
