//! `[select]`: which rows are wanted.

use crate::engine::outcome::DesignOutcome;
use crate::output::row_value::{Formula, Row};
use crate::study::config::Study;
use crate::study::expression::Expression;

/// The condition of `[select]`, ready for many rows.
#[derive(Clone, Debug)]
pub struct Filter(Formula);

/// A row of some designs: the place of its design among them, and its load step.
pub type RowPlace = (usize, usize);

impl Filter {
    /// `None` where all rows are wanted.
    pub fn of(study: &Study) -> Option<Filter> {
        study.select.as_ref().map(Filter::new)
    }

    pub fn new(condition: &Expression) -> Filter {
        Filter(Formula::of(condition))
    }

    /// Whether the condition holds for sure: a row without a value that would decide it is not kept.
    pub fn keeps(&self, row: &Row) -> bool {
        self.0.value(row) == 1.0
    }
}

/// The rows that a filter keeps, in their order; without one all of them.
pub fn kept_rows(filter: Option<&Filter>, outcomes: &[DesignOutcome]) -> Vec<RowPlace> {
    let mut kept = Vec::with_capacity(outcomes.iter().map(|outcome| outcome.steps.len()).sum());
    for (place, outcome) in outcomes.iter().enumerate() {
        let steps = (0..outcome.steps.len().min(outcome.case.steps.len())).map(|step| (place, step));
        match filter {
            Some(filter) => kept.extend(steps.filter(|place| filter.keeps(&row_at(outcomes, *place)))),
            None => kept.extend(steps),
        }
    }
    kept
}

pub fn row_at(outcomes: &[DesignOutcome], (place, step): RowPlace) -> Row<'_> {
    let DesignOutcome { case, backend, steps, .. } = &outcomes[place];
    Row { case, step, outcome: &steps[step], backend: *backend }
}

/// Takes the rows that are not kept out of their designs.
pub fn retain(outcomes: &mut [DesignOutcome], kept: &[RowPlace]) {
    let mut rest = kept;
    for (place, DesignOutcome { case, steps, .. }) in outcomes.iter_mut().enumerate() {
        let own;
        (own, rest) = rest.split_at(rest.partition_point(|row| row.0 <= place));
        if own.len() < steps.len() {
            case.steps = own.iter().map(|row| case.steps[row.1]).collect();
            *steps = own.iter().map(|row| steps[row.1]).collect();
        }
    }
}
