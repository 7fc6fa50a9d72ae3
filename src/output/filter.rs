//! `[select]`: which rows are wanted.

use crate::engine::outcome::{BackendKind, DesignOutcome, StepOutcome};
use crate::output::row_value::{Formula, Row};
use crate::study::config::Study;
use crate::study::design::DesignCase;
use crate::study::expression::Expression;

/// The condition of `[select]`, ready for many rows.
#[derive(Clone, Debug)]
pub struct Filter(Formula);

impl Filter {
    /// `None` where all rows are wanted.
    pub fn of(study: &Study) -> Option<Filter> {
        study.select.as_ref().map(Filter::new)
    }

    pub fn new(condition: &Expression) -> Filter {
        Filter(Formula::of(condition))
    }

    /// Whether the condition holds for sure: a row without a value that would decide it is not kept.
    pub fn keeps(&self, case: &DesignCase, step: usize, outcome: &StepOutcome, backend: BackendKind) -> bool {
        self.keeps_row(&Row { case, step, outcome, backend })
    }

    /// Takes the rows that are not kept out of a design.
    pub fn retain(&self, outcome: &mut DesignOutcome) {
        let DesignOutcome { case, backend, steps, .. } = outcome;
        let is_kept = |step: usize| self.keeps(case, step, &steps[step], *backend);
        let kept: Vec<usize> = (0..steps.len()).filter(|step| is_kept(*step)).collect();
        if kept.len() < steps.len() {
            case.steps = kept.iter().map(|step| case.steps[*step]).collect();
            *steps = kept.iter().map(|step| steps[*step]).collect();
        }
    }

    pub fn keeps_row(&self, row: &Row) -> bool {
        self.0.value(row) == 1.0
    }
}
