//! A choice: one way to find the states of designs, with its family and its parameter.

use std::time::Duration;

use crate::engine::backend::gpu::context::GpuDevice;
use crate::lab::tradeoff::answer::States;
use crate::study::design::DesignCase;

/// What a choice has found, and in what time.
#[derive(Clone, Debug)]
pub struct Solution {
    pub states: States,
    /// On what a sweep shares, however many its designs: pressure spaces, near fields, meshes, kernels.
    pub shared: Duration,
    /// On the designs themselves.
    pub own: Duration,
}

/// From designs to their states.
pub type Solve<'a> = Box<dyn Fn(&[DesignCase]) -> Solution + Send + Sync + 'a>;

pub struct Choice<'a> {
    /// Of its `Family`.
    pub family: &'static str,
    /// Short: what a plot says of it.
    pub name: String,
    /// What is varied within the family, as a number.
    pub parameter: Option<f64>,
    pub solve: Solve<'a>,
}

/// What the choices may depend on besides the designs.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    pub gpu: Option<&'a GpuDevice>,
    /// Of the contact half angles, about; rad. Meshes for contact node by node are as fine everywhere as there.
    pub least_angle: f64,
}

/// Choices that differ in one parameter.
pub struct Family {
    pub name: &'static str,
    /// In a few words, for a legend.
    pub about: &'static str,
    /// What the parameter is; empty where there is none.
    pub parameter: &'static str,
}

impl Family {
    /// A choice of this family.
    pub fn choice<'a>(
        &self,
        name: String,
        parameter: Option<f64>,
        solve: impl Fn(&[DesignCase]) -> Solution + Send + Sync + 'a,
    ) -> Choice<'a> {
        Choice { family: self.name, name, parameter, solve: Box::new(solve) }
    }
}
