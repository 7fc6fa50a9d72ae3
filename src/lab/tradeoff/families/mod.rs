//! Every family of choices: one file each, one line in `FAMILIES`.

pub mod closed_form;
pub mod series;
pub mod ladder;
pub mod trial_pressures;
pub mod node_contact;
pub mod penalty;
pub mod augmented_lagrangian;
pub mod cholesky;
pub mod pcg;
pub mod gpu;
pub mod planner;

use crate::lab::tradeoff::choice::{Choice, Family, Scope};

/// In the order of tables and legends.
pub static FAMILIES: [&Family; 16] = [
    &closed_form::FAMILY,
    &series::FAMILY,
    &ladder::QUAD8,
    &ladder::QUAD4,
    &trial_pressures::FAMILY,
    &node_contact::QUAD8,
    &node_contact::QUAD4,
    &penalty::FAMILY,
    &augmented_lagrangian::FAMILY,
    &cholesky::FAMILY,
    &pcg::F64,
    &pcg::F64_PLAIN,
    &pcg::F32,
    &pcg::MIXED,
    &gpu::FAMILY,
    &planner::FAMILY,
];

/// Every choice there is.
pub fn choices<'a>(scope: &Scope<'a>) -> Vec<Choice<'a>> {
    FAMILIES.iter().flat_map(|family| (family.choices)(family, scope)).collect()
}

/// The family of that name.
pub fn named(name: &str) -> Option<&'static Family> {
    FAMILIES.into_iter().find(|family| family.name == name)
}
