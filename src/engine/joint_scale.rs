//! The sizes of a joint: taken out of its loads before contact is solved, and put back into what is found. The one place for it.

use crate::engine::outcome::{Method, Response};
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::contact::state::ContactState;
use crate::study::design::{JointDesign, Load};

/// Lengths are over the hole's radius, forces over hole radius, thickness and MPa.
#[derive(Clone, Copy, Debug)]
pub struct JointScale<'a> {
    joint: &'a JointDesign,
    pub outlines: Outlines,
}

impl<'a> JointScale<'a> {
    pub fn of(joint: &'a JointDesign) -> JointScale<'a> {
        JointScale { joint, outlines: Outlines::new(joint.radial_clearance / joint.hole_radius) }
    }

    /// A load without sizes, `None` where there is no contact yet. A press fit always has contact.
    pub fn load(&self, load: Load) -> Option<DimensionlessLoad> {
        let JointDesign { hole_radius, thickness, .. } = *self.joint;
        match self.joint.from_first_touch(load) {
            Load::Offset(offset) => Some(DimensionlessLoad::Offset(offset / hole_radius)),
            Load::Force(force) if force != 0.0 || self.joint.is_press_fit() => {
                Some(DimensionlessLoad::Force(force / (thickness * hole_radius)))
            }
            Load::Indentation(delta) if delta != 0.0 => {
                Some(DimensionlessLoad::Indentation(delta / hole_radius))
            }
            // A neat fit has one state, which any load shows.
            _ => self.joint.is_neat().then_some(DimensionlessLoad::Indentation(1.0)),
        }
    }

    /// Those of the loads under which there is contact, in their order.
    pub fn loads_in_contact(self, steps: &[Load]) -> impl Iterator<Item = DimensionlessLoad> {
        steps.iter().filter_map(move |load| self.load(*load))
    }

    /// What a state under a load is per unit of, over R2: e, of press fits |dR|.
    pub fn unit(&self, load: Load, state: &ContactState) -> f64 {
        let JointDesign { hole_radius, thickness, .. } = *self.joint;
        let radial_clearance = self.outlines.radial_clearance;
        match self.joint.from_first_touch(load) {
            _ if self.joint.is_press_fit() => -radial_clearance,
            Load::Indentation(0.0) | Load::Force(0.0) => 0.0,
            Load::Indentation(length) | Load::Offset(length) => radial_clearance + length / hole_radius,
            Load::Force(force) => force / (thickness * hole_radius) / state.force,
        }
    }

    /// A state under a load with its sizes, and the estimated relative error of its force.
    pub fn response(&self, load: Load, state: &ContactState, force_error: f64, method: Method) -> Response {
        let unit = self.unit(load, state);
        let length = self.joint.hole_radius * unit;
        let scale = self.joint.thickness * length;
        let (indentation, force) = match self.joint.from_first_touch(load) {
            Load::Indentation(indentation) => (indentation, scale * state.force),
            Load::Offset(_) => (length * state.indentation, scale * state.force),
            Load::Force(force) => (length * state.indentation, force),
        };
        Response {
            indentation,
            offset: self.joint.offset(load, indentation),
            force,
            tangent_stiffness: self.joint.thickness * state.tangent_stiffness,
            contact_half_angle: Some(state.half_angle),
            peak_pressure: Some(unit * state.peak_pressure),
            peak_pressure_angle: Some(state.peak_angle),
            energy: Some(scale * length * state.energy),
            force_error,
            linearity_error: None,
            method,
        }
    }
}
