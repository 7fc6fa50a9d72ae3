//! Who asks a device to count rows: it keeps the extreme ones so far, so that few others come back.

use std::sync::{Mutex, PoisonError};

use crate::engine::outcome::DesignOutcome;
use crate::engine::question::{Asker, Limits, Question};
use crate::output::filter::{Filter, kept_rows};
use crate::output::reduce::Reductions;

/// Of one run.
pub struct Asking<'a> {
    question: &'a Question,
    filter: Option<&'a Filter>,
    /// Of the designs that were looked at.
    extremes: Mutex<Reductions>,
}

impl<'a> Asking<'a> {
    /// With answers before the first row.
    pub fn new(question: &'a Question, filter: Option<&'a Filter>, answers: Reductions) -> Asking<'a> {
        Asking { question, filter, extremes: Mutex::new(answers) }
    }
}

impl Asker for Asking<'_> {
    fn question(&self) -> &Question {
        self.question
    }

    fn limits(&self) -> Limits {
        self.extremes.lock().unwrap_or_else(PoisonError::into_inner).limits()
    }

    fn look(&self, outcomes: &[DesignOutcome]) {
        let kept = kept_rows(self.filter, outcomes);
        self.extremes.lock().unwrap_or_else(PoisonError::into_inner).add_extremes(outcomes, &kept);
    }
}
