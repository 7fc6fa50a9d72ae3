//! The sizes of a joint: taken out of its loads before contact is solved, and put back into what is found. The one place for it.

use crate::engine::outcome::{Method, Response};
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::contact::state::ContactState;
use crate::study::design::{JointDesign, Load};

/// Lengths are over the hole's radius, forces over hole radius, thickness and MPa.
#[derive(Clone, Copy, Debug)]
pub struct JointScale {
    pub outlines: Outlines,
    /// mm.
    hole_radius: f64,
    thickness: f64,
}

impl JointScale {
    pub fn of(joint: &JointDesign) -> JointScale {
        let JointDesign { hole_radius, radial_clearance, thickness, .. } = *joint;
        JointScale { outlines: Outlines::new(radial_clearance / hole_radius), hole_radius, thickness }
    }

    /// A load without sizes, `None` where there is no contact yet.
    pub fn load(&self, load: Load) -> Option<DimensionlessLoad> {
        match load {
            // A neat fit has one state, which any load shows.
            Load::Indentation(0.0) | Load::Force(0.0) if self.outlines.radial_clearance == 0.0 => {
                Some(DimensionlessLoad::Indentation(1.0))
            }
            Load::Indentation(0.0) | Load::Force(0.0) => None,
            Load::Indentation(delta) => Some(DimensionlessLoad::Indentation(delta / self.hole_radius)),
            Load::Force(force) => Some(DimensionlessLoad::Force(force / (self.thickness * self.hole_radius))),
        }
    }

    /// Those of the loads under which there is contact, in their order.
    pub fn loads_in_contact(&self, steps: &[Load]) -> impl Iterator<Item = DimensionlessLoad> {
        steps.iter().filter_map(|load| self.load(*load))
    }

    /// e/R2 of a state under a load.
    pub fn offset(&self, load: Load, state: &ContactState) -> f64 {
        match load {
            Load::Indentation(0.0) | Load::Force(0.0) => 0.0,
            Load::Indentation(delta) => self.outlines.radial_clearance + delta / self.hole_radius,
            Load::Force(force) => force / (self.thickness * self.hole_radius) / state.force,
        }
    }

    /// A state under a load with its sizes, and the estimated relative error of its force.
    pub fn response(&self, load: Load, state: &ContactState, force_error: f64, method: Method) -> Response {
        let offset = self.offset(load, state);
        let length = self.hole_radius * offset;
        let scale = self.thickness * length;
        let (indentation, force) = match load {
            Load::Indentation(indentation) => (indentation, scale * state.force),
            Load::Force(force) => (length * state.indentation, force),
        };
        Response {
            indentation,
            force,
            tangent_stiffness: self.thickness * state.tangent_stiffness,
            contact_half_angle: Some(state.half_angle),
            peak_pressure: Some(offset * state.peak_pressure),
            peak_pressure_angle: Some(state.peak_angle),
            energy: Some(scale * length * state.energy),
            force_error,
            linearity_error: None,
            method,
        }
    }
}
