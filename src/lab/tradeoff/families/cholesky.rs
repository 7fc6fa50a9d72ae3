//! The meshes of a sweep condensed by sparse Cholesky, body by body: beside the lanes of `ladder`, and what conjugate
//! gradients are measured against.

use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::joints::Terms;
use crate::lab::tradeoff::meshed::{Condenser, MeshedPath};
use crate::lab::tradeoff::ring_mesh::RingSolver;
use crate::mechanics::element::ElementKind;

pub static FAMILY: Family =
    Family { name: "cholesky", about: "moving edge, Q8, sparse Cholesky", parameter: "mesh level" };

pub fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    let choice = |level: usize| {
        let path = ring_path(level, RingSolver::Cholesky);
        family.choice(format!("level {level}"), Some(level as f64), move |cases| path.solve(cases))
    };
    (1..=3).map(choice).collect()
}

/// The path of a sweep on Q8 meshes, but for the solver.
pub fn ring_path(level: usize, solver: RingSolver) -> MeshedPath {
    MeshedPath {
        element: ElementKind::Quad8,
        level,
        terms: Terms::ByDepth,
        condenser: Condenser::Ring(solver),
    }
}
