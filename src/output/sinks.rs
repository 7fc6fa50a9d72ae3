//! Everything that the outcomes of a run go to: its tables, its counts and its answers.

use crate::engine::outcome::DesignOutcome;
use crate::output::counts::Counts;
use crate::output::filter::Filter;
use crate::output::laws_table::LawsTable;
use crate::output::reduce::Reductions;
use crate::output::schema::{TableColumn, result_columns};
use crate::output::sink::Sink;
use crate::output::table::settle;
use crate::output::table_sink::{cut, portion, table_sink};
use crate::study::config::Study;
use crate::study::expression::Expression;
use crate::study::reduce::Reduce;

/// What the outcomes of a run go to.
pub struct Sinks {
    pub all: Vec<Box<dyn Sink>>,
    /// The columns of results.
    results: Vec<TableColumn>,
    select: Option<Expression>,
    filter: Option<Filter>,
    reduce: Option<Reduce>,
    portion: u64,
    cut: u64,
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
        let (select, reduce) = (study.select.clone(), study.reduce.clone());
        let (filter, results) = (Filter::of(study), result_columns());
        Sinks { all, results, filter, select, reduce, portion: portion(study), cut: cut(study) }
    }

    /// Designs whose rows are made together.
    pub fn portion(&self) -> u64 {
        self.portion
    }

    /// Rows of designs that follow each other, made by any thread.
    pub fn rows(&self, mut outcomes: Vec<DesignOutcome>) -> Rows {
        settle(&self.results, &mut outcomes);
        let (mut counts, mut answers) = (Counts::default(), self.answers());
        for outcome in &mut outcomes {
            counts.add(outcome);
            if let Some(answers) = &mut answers {
                answers.add(outcome);
            }
            if let Some(filter) = &self.filter {
                filter.retain(outcome);
                *counts.kept_rows.get_or_insert(0) += outcome.steps.len() as u64;
            }
        }
        let bytes = self.all.iter().map(|sink| sink.rows(&outcomes)).collect();
        Rows { bytes, counts, answers }
    }

    /// Answers to what the config asks, before the first row.
    pub fn answers(&self) -> Option<Reductions> {
        self.reduce.as_ref().map(|asked| Reductions::new(asked, self.select.clone()))
    }

    /// A shard begins at a multiple of this many designs.
    pub fn cut(&self) -> u64 {
        self.cut
    }
}
