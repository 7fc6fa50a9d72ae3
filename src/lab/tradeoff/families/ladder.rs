//! Contact with a moving edge on the ladder of meshes that a sweep climbs: Q8 as a sweep does it, and Q4.

use crate::engine::body_request::Fidelity;
use crate::lab::tradeoff::choice::{Choice, Family, Scope, Solve};
use crate::lab::tradeoff::families::series;
use crate::lab::tradeoff::joints::Terms;
use crate::lab::tradeoff::meshed::{Condenser, MeshedPath};
use crate::mechanics::element::ElementKind;
use crate::mechanics::grading::LEVEL_COUNT;

pub static QUAD8: Family =
    Family { name: "moving-edge-q8", about: "moving edge, Q8 (a sweep's own)", parameter: "mesh level" };

pub static QUAD4: Family =
    Family { name: "moving-edge-q4", about: "moving edge, Q4", parameter: "mesh level" };

pub fn on_quad8<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    levels(family, |level| {
        Box::new(move |cases| series::solve(Terms::ByDepth, Fidelity::Mesh { level }, cases))
    })
}

pub fn on_quad4<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    levels(family, |level| {
        let (element, terms, condenser) = (ElementKind::Quad4, Terms::ByDepth, Condenser::Lanes);
        let path = MeshedPath { element, level, terms, condenser };
        Box::new(move |cases| path.solve(cases))
    })
}

fn levels<'a>(family: &Family, solve: impl Fn(usize) -> Solve<'a>) -> Vec<Choice<'a>> {
    let choice = |level: usize| Choice {
        family: family.name,
        name: format!("level {level}"),
        parameter: Some(level as f64),
        solve: solve(level),
    };
    (1..LEVEL_COUNT).map(choice).collect()
}
