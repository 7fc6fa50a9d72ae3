//! Who asks a device to count rows: it keeps the extreme ones so far, so that few others come back.

use std::sync::{Mutex, PoisonError};

use crate::engine::outcome::DesignOutcome;
use crate::engine::question::{Asker, Limits, Question};
use crate::output::filter::{Filter, kept_rows};
use crate::output::reduce::Reductions;
use crate::output::schema::TableColumn;
use crate::output::table::settle;

/// Of one run.
pub struct Asking<'a> {
    question: &'a Question,
    filter: Option<&'a Filter>,
    /// The columns of results.
    results: &'a [TableColumn],
    /// Of the designs that were looked at.
    extremes: Mutex<Reductions>,
}

impl<'a> Asking<'a> {
    /// With answers before the first row.
    pub fn new(
        question: &'a Question,
        filter: Option<&'a Filter>,
        results: &'a [TableColumn],
        answers: Reductions,
    ) -> Asking<'a> {
        Asking { question, filter, results, extremes: Mutex::new(answers) }
    }
}

impl Asker for Asking<'_> {
    fn question(&self) -> &Question {
        self.question
    }

    fn limits(&self) -> Limits {
        self.extremes.lock().unwrap_or_else(PoisonError::into_inner).limits()
    }

    fn look(&self, outcomes: &mut [DesignOutcome]) {
        // A row that fails for one of its numbers is no extreme one for another.
        settle(self.results, outcomes);
        let kept = kept_rows(self.filter, outcomes);
        self.extremes.lock().unwrap_or_else(PoisonError::into_inner).look_at(outcomes, &kept);
    }
}
