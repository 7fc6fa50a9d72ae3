//! Contact with a moving edge on meshes graded to the contact, without the exact near field: beside `node_contact` on the
//! same meshes, all that differs is contact.

use crate::mechanics::compliance::arc::FEW_TERMS;
use crate::mechanics::element::ElementKind;
use crate::tradeoff::choice::{Choice, Family, Scope};
use crate::tradeoff::direct_edge::DirectPath;
use crate::tradeoff::ring_mesh::Division;

pub static FAMILY: Family = Family {
    name: "moving-edge-contact-mesh",
    about: "moving edge, Q8 graded to the contact",
    parameter: "elements per contact angle",
    choices,
};

/// Elements over the least contact angle.
pub const FINENESS: [f64; 3] = [2.0, 4.0, 8.0];

fn choices<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    let least_angle = scope.least_angle;
    let choice = |fineness: f64| {
        let division = Division::Contact { element: ElementKind::Quad8, fineness, least_angle };
        let path = DirectPath { division, terms: FEW_TERMS[0] };
        family.choice(format!("q = {fineness}"), Some(fineness), move |cases| path.solve(cases))
    };
    FINENESS.into_iter().map(choice).collect()
}
