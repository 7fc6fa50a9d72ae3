//! Contact by augmented Lagrangian, by the gap it leaves, on the mesh on which `node_contact` is exact.

use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::families::penalty::FINENESS;
use crate::lab::tradeoff::nodal::{Formulation, NodalPath};
use crate::lab::tradeoff::ring_mesh::Division;
use crate::mechanics::element::ElementKind;

pub static FAMILY: Family = Family {
    name: "augmented-lagrangian",
    about: "node contact, augmented Lagrangian, Q8, q = 4",
    parameter: "gap left, of the indentation",
};

/// Of E*/h: springs as stiff as the elements behind them, which is what general programs begin with.
const FACTOR: f64 = 1.0;

pub fn choices<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    let least_angle = scope.least_angle;
    let choice = |decade: i32| {
        let tolerance = 10f64.powi(-decade);
        let division = Division::Contact { element: ElementKind::Quad8, fineness: FINENESS, least_angle };
        let path = NodalPath { division, formulation: Formulation::Augmented { factor: FACTOR, tolerance } };
        family.choice(format!("gap {tolerance:.0e}"), Some(tolerance), move |cases| path.solve(cases))
    };
    (1..=6).map(choice).collect()
}
