//! Contact by penalty, by its factor, on the mesh on which `node_contact` is exact.

use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::nodal::{Formulation, NodalPath};
use crate::lab::tradeoff::ring_mesh::Division;
use crate::mechanics::element::ElementKind;

pub static FAMILY: Family =
    Family { name: "penalty", about: "node contact, penalty, Q8, q = 4", parameter: "factor of E*/h" };

/// Of the mesh that formulations are compared on.
pub const FINENESS: f64 = 4.0;

pub fn choices<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    let least_angle = scope.least_angle;
    let choice = |decade: i32| {
        let factor = 10f64.powi(decade);
        let division = Division::Contact { element: ElementKind::Quad8, fineness: FINENESS, least_angle };
        let path = NodalPath { division, formulation: Formulation::Penalty { factor } };
        family.choice(format!("factor {factor:.0e}"), Some(factor), move |cases| path.solve(cases))
    };
    (0..=6).map(choice).collect()
}
