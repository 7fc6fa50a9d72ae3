//! How many trial pressures a mesh is worth.

use crate::engine::body_request::Fidelity;
use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::families::series;
use crate::lab::tradeoff::joints::Terms;
use crate::mechanics::compliance::arc::{FEW_TERMS, TERM_CHOICES};

pub static FAMILY: Family = Family {
    name: "trial-pressures",
    about: "moving edge, Q8, level 3, by trial pressures",
    parameter: "trial pressures",
};

/// Of the mesh.
pub const LEVEL: usize = 3;

pub fn choices<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    let fidelity = Fidelity::Mesh { level: LEVEL };
    let choice = |terms: usize| {
        family.choice(format!("{terms} terms"), Some(terms as f64), move |cases| {
            series::solve(Terms::Fixed(terms), fidelity, cases)
        })
    };
    FEW_TERMS.into_iter().chain(TERM_CHOICES).map(choice).collect()
}
