//! Everything that the outcomes of a run go to: its tables, its counts and its answers.

use crate::engine::question::Question;
use crate::engine::sweep::{CountedDesigns, SolvedDesigns};
use crate::output::asking::Asking;
use crate::output::counts::Counts;
use crate::output::filter::{Filter, kept_rows, retain};
use crate::output::laws_table::LawsTable;
use crate::output::reduce::Reductions;
use crate::output::schema::{TableColumn, result_columns};
use crate::output::sink::Sink;
use crate::output::table::settle;
use crate::output::table_sink::{portion, table_sink};
use crate::study::config::Study;

/// What the outcomes of a run go to.
pub struct Sinks {
    pub all: Vec<Box<dyn Sink>>,
    /// The columns of results.
    results: Vec<TableColumn>,
    filter: Option<Filter>,
    /// Before the first row.
    answers: Option<Reductions>,
    /// What a device may count.
    question: Option<Question>,
    portion: u64,
}

/// What some designs add to a run: bytes for each of its files, counts and answers.
pub struct Rows {
    /// Of each sink.
    pub bytes: Vec<Vec<u8>>,
    pub counts: Counts,
    pub answers: Option<Reductions>,
}

impl Rows {
    /// How many designs they are of.
    pub fn designs(&self) -> u64 {
        self.counts.designs
    }
}

impl Sinks {
    pub fn of(study: &Study) -> Sinks {
        let mut all: Vec<Box<dyn Sink>> = Vec::new();
        if study.writes_table() {
            all.push(table_sink(study));
        }
        if study.fits_laws() {
            all.push(Box::new(LawsTable));
        }
        let (filter, answers) = (Filter::of(study), Reductions::of(study));
        let question = Question::of(study);
        Sinks { all, results: result_columns(), filter, answers, question, portion: portion(study) }
    }

    /// Designs whose rows are made together.
    pub fn portion(&self) -> u64 {
        self.portion
    }

    /// Rows of designs that follow each other, made by any thread.
    pub fn rows(&self, SolvedDesigns { mut outcomes, on_device }: SolvedDesigns) -> Rows {
        settle(&self.results, &mut outcomes);
        let (mut counts, mut answers) = (Counts::default(), self.answers());
        outcomes.iter().for_each(|outcome| counts.add(outcome));
        if self.filter.is_some() || answers.is_some() {
            let kept = kept_rows(self.filter.as_ref(), &outcomes);
            if let Some(answers) = &mut answers {
                answers.add(&outcomes, &kept);
            }
            if self.filter.is_some() {
                counts.kept_rows = Some(kept.len() as u64);
                if !self.all.is_empty() {
                    retain(&mut outcomes, &kept);
                }
            }
        }
        if let (Some(CountedDesigns { counted, mut candidates }), Some(answers), Some(question)) =
            (on_device, &mut answers, &self.question)
        {
            settle(&self.results, &mut candidates);
            counts.add_counted(&counted);
            if let Some(kept) = &mut counts.kept_rows {
                *kept += counted.kept_rows;
            }
            answers.add_extremes(&candidates, &kept_rows(self.filter.as_ref(), &candidates));
            answers.add_counted(&counted, question);
        }
        let bytes = self.all.iter().map(|sink| sink.rows(&outcomes)).collect();
        Rows { bytes, counts, answers }
    }

    /// Asks for nothing but answers of all rows together, which a device may count; nothing where rows are written, too.
    pub fn asking(&self) -> Option<Asking<'_>> {
        Some(Asking::new(self.question.as_ref()?, self.filter.as_ref(), &self.results, self.answers()?))
    }

    /// Answers to what the config asks, before the first row.
    pub fn answers(&self) -> Option<Reductions> {
        self.answers.clone()
    }
}
