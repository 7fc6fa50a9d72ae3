//! `[select]`: which rows are wanted.

use crate::engine::outcome::DesignOutcome;
use crate::output::row_value::{Formula, Row};
use crate::study::config::Study;
use crate::study::expression::Expression;

/// The condition of `[select]`, ready for many rows.
#[derive(Clone, Debug)]
pub struct Filter(Formula);

/// Rows whose values are made together: they stay in the processor's nearest memory.
pub const ROWS: usize = 512;

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

    /// Of each row whether the condition holds for sure: one without a value that would decide it is not kept. `stack` is overwritten.
    pub fn keeps<'a>(
        &self,
        rows: &[Row],
        stack: &'a mut Vec<Vec<f64>>,
    ) -> impl Iterator<Item = bool> + use<'a> {
        self.0.values(rows, stack).iter().map(|value| *value == 1.0)
    }
}

/// The rows that a filter keeps, in their order; without one all of them.
pub fn kept_rows(filter: Option<&Filter>, outcomes: &[DesignOutcome]) -> Vec<RowPlace> {
    let mut kept: Vec<RowPlace> =
        Vec::with_capacity(outcomes.iter().map(|outcome| outcome.steps.len()).sum());
    for (place, outcome) in outcomes.iter().enumerate() {
        kept.extend((0..outcome.steps.len().min(outcome.case.steps.len())).map(|step| (place, step)));
    }
    let Some(filter) = filter else { return kept };
    let (mut stack, mut is_kept) = (Vec::new(), Vec::with_capacity(kept.len()));
    for places in kept.chunks(ROWS) {
        let rows: Vec<Row> = places.iter().map(|place| row_at(outcomes, *place)).collect();
        is_kept.extend(filter.keeps(&rows, &mut stack));
    }
    let mut is_kept = is_kept.into_iter();
    kept.retain(|_| is_kept.next() == Some(true));
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
            *steps = own.iter().map(|row| steps[row.1].clone()).collect();
        }
    }
}
