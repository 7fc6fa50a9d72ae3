//! Contact node by node, exact, on meshes graded to the contact.

use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::nodal::{Formulation, NodalPath};
use crate::lab::tradeoff::ring_mesh::Division;
use crate::mechanics::element::ElementKind;

/// Elements over the least contact angle.
pub const FINENESS: [f64; 3] = [2.0, 4.0, 8.0];

pub static QUAD8: Family = Family {
    name: "node-contact-q8",
    about: "node contact, exact, Q8",
    parameter: "elements per contact angle",
};

pub static QUAD4: Family = Family {
    name: "node-contact-q4",
    about: "node contact, exact, Q4",
    parameter: "elements per contact angle",
};

pub fn on_quad8<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, scope, ElementKind::Quad8, FINENESS)
}

pub fn on_quad4<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, scope, ElementKind::Quad4, FINENESS.map(|fineness| 2.0 * fineness))
}

fn choices<'a>(
    family: &Family,
    scope: &Scope<'a>,
    element: ElementKind,
    fineness: [f64; 3],
) -> Vec<Choice<'a>> {
    let choice = |fineness: f64| {
        let division = Division::Contact { element, fineness, least_angle: scope.least_angle };
        let path = NodalPath { division, formulation: Formulation::Exact };
        family.choice(format!("q = {fineness}"), Some(fineness), move |cases| path.solve(cases))
    };
    fineness.into_iter().map(choice).collect()
}
