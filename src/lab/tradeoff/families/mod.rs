//! Every family of choices: one file each, one line in `FAMILIES` and one in `choices_of`.

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

type MakeChoices = for<'a> fn(&Family, &Scope<'a>) -> Vec<Choice<'a>>;

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
    FAMILIES.iter().flat_map(|family| choices_of(family, scope)).collect()
}

/// Those of a family of `FAMILIES`.
///
/// A compiler takes all that a static leads to into every program: if `FAMILIES` led here, the unit tests would be built with the whole engine.
pub fn choices_of<'a>(family: &Family, scope: &Scope<'a>) -> Vec<Choice<'a>> {
    let makers: [(&Family, MakeChoices); FAMILIES.len()] = [
        (&closed_form::FAMILY, closed_form::choices),
        (&series::FAMILY, series::choices),
        (&ladder::QUAD8, ladder::on_quad8),
        (&ladder::QUAD4, ladder::on_quad4),
        (&trial_pressures::FAMILY, trial_pressures::choices),
        (&node_contact::QUAD8, node_contact::on_quad8),
        (&node_contact::QUAD4, node_contact::on_quad4),
        (&penalty::FAMILY, penalty::choices),
        (&augmented_lagrangian::FAMILY, augmented_lagrangian::choices),
        (&cholesky::FAMILY, cholesky::choices),
        (&pcg::F64, pcg::in_f64),
        (&pcg::F64_PLAIN, pcg::in_f64_plain),
        (&pcg::F32, pcg::in_f32),
        (&pcg::MIXED, pcg::in_mixed),
        (&gpu::FAMILY, gpu::choices),
        (&planner::FAMILY, planner::choices),
    ];
    let (_, make) = makers.into_iter().find(|(own, _)| own.name == family.name).expect("one of `FAMILIES`");
    make(family, scope)
}

/// The family of that name.
pub fn named(name: &str) -> Option<&'static Family> {
    FAMILIES.into_iter().find(|family| family.name == name)
}
