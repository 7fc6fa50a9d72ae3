//! What the curves and maps of a report are over, and the tables of an export.

use crate::engine::outcome::Response;
use crate::study::columns::{INDENTATION, OFFSET};
use crate::study::design::{JointDesign, Load};

/// The way of the pin: in reports of tables that have it the offset, in exports of press fits, which have no first touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    Indentation,
    Offset,
}

impl Travel {
    /// From where the force begins: first touch, or where a press fit is at rest.
    pub fn of_force(joint: &JointDesign) -> Travel {
        if joint.is_press_fit() { Travel::Offset } else { Travel::Indentation }
    }

    pub fn name(self) -> &'static str {
        match self {
            Travel::Indentation => "indentation",
            Travel::Offset => "offset",
        }
    }

    /// Of an axis.
    pub fn label(self) -> String {
        format!("{}, mm", self.name())
    }

    pub fn column(self) -> &'static str {
        match self {
            Travel::Indentation => INDENTATION,
            Travel::Offset => OFFSET,
        }
    }

    pub fn load(self, way: f64) -> Load {
        match self {
            Travel::Indentation => Load::Indentation(way),
            Travel::Offset => Load::Offset(way),
        }
    }

    pub fn of(self, response: &Response) -> f64 {
        match self {
            Travel::Indentation => response.indentation,
            Travel::Offset => response.offset,
        }
    }

    /// From an indentation of a joint as tables have it, mm.
    pub fn of_indentation(self, indentation: f64, joint: &JointDesign) -> f64 {
        match self {
            Travel::Indentation => indentation,
            Travel::Offset => indentation + joint.radial_clearance,
        }
    }

    /// From this way to the indentation of a joint, mm.
    pub fn indentation(self, way: f64, joint: &JointDesign) -> f64 {
        match self {
            Travel::Indentation => way,
            Travel::Offset => way - joint.radial_clearance,
        }
    }
}
