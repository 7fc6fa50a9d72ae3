//! `[reduce]`: answers in the place of rows. What is asked of all kept rows together takes memory that does not grow with the
//! sweep, and parts of a sweep (threads, shards, a run that went on later) join to the same bytes in any order.

mod line;
pub mod exact_sum;
pub mod sketch;
mod statistics;
mod ranking;
mod front;
mod histogram;

use serde::{Deserialize, Serialize};

use crate::engine::outcome::{Answer, DesignOutcome};
use crate::error::Error;
use crate::output::filter::Filter;
use crate::output::row_value::{Formula, Row};
use crate::output::sink::Sink;
use crate::output::table::Table;
use crate::study::config::Study;
use crate::study::design::DesignCase;
use crate::study::expression::Expression;
use crate::study::reduce::Reduce;
use front::Front;
use histogram::Histogram;
use ranking::Ranking;
use statistics::Statistics;

pub use front::MOST_POINTS;

/// What all rows together come to, and the file that tells it. A new kind of answer is one of these, in a file of its own.
pub trait Reduction {
    /// Several reductions may share a file.
    fn file_name(&self) -> &'static str;

    /// What it wants to know of each row.
    fn quantities(&self) -> Vec<&Expression>;

    /// Adds a row with the values of its quantities, NaN for none. `text` makes the row's line of the table.
    fn add(&mut self, values: &[f64], row: &Row, text: &mut dyn FnMut() -> String);

    /// Appends what the file begins with.
    fn push_header(&self, out: &mut Vec<u8>);

    /// Appends its own lines.
    fn push_rows(&self, out: &mut Vec<u8>);
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Statistics(Statistics),
    Ranking(Ranking),
    Front(Front),
    Histogram(Histogram),
}

impl Kind {
    fn reduction(&self) -> &dyn Reduction {
        match self {
            Kind::Statistics(own) => own,
            Kind::Ranking(own) => own,
            Kind::Front(own) => own,
            Kind::Histogram(own) => own,
        }
    }

    fn reduction_mut(&mut self) -> &mut dyn Reduction {
        match self {
            Kind::Statistics(own) => own,
            Kind::Ranking(own) => own,
            Kind::Front(own) => own,
            Kind::Histogram(own) => own,
        }
    }

    fn is_like(&self, other: &Kind) -> bool {
        match (self, other) {
            (Kind::Statistics(own), Kind::Statistics(theirs)) => own.is_like(theirs),
            (Kind::Ranking(own), Kind::Ranking(theirs)) => own.is_like(theirs),
            (Kind::Front(own), Kind::Front(theirs)) => own.is_like(theirs),
            (Kind::Histogram(own), Kind::Histogram(theirs)) => own.is_like(theirs),
            _ => false,
        }
    }

    fn merge(&mut self, other: &Kind) {
        match (self, other) {
            (Kind::Statistics(own), Kind::Statistics(theirs)) => own.merge(theirs),
            (Kind::Ranking(own), Kind::Ranking(theirs)) => own.merge(theirs),
            (Kind::Front(own), Kind::Front(theirs)) => own.merge(theirs),
            (Kind::Histogram(own), Kind::Histogram(theirs)) => own.merge(theirs),
            _ => {}
        }
    }
}

/// All reductions of a config, over the rows that its `[select]` keeps.
#[derive(Serialize, Deserialize)]
#[serde(try_from = "State")]
pub struct Reductions {
    select: Option<Expression>,
    rows: u64,
    kept: u64,
    reductions: Vec<Kind>,
    #[serde(skip)]
    work: Work,
}

/// What is known so far, as data.
#[derive(Deserialize)]
struct State {
    select: Option<Expression>,
    rows: u64,
    kept: u64,
    reductions: Vec<Kind>,
}

/// What rows are read with.
struct Work {
    filter: Option<Filter>,
    /// Of each reduction.
    formulas: Vec<Vec<Formula>>,
    values: Vec<f64>,
    table: Table,
}

impl Work {
    fn new(select: Option<&Expression>, reductions: &[Kind]) -> Work {
        let of = |kind: &Kind| kind.reduction().quantities().into_iter().map(Formula::of).collect();
        let formulas = reductions.iter().map(of).collect();
        Work { filter: select.map(Filter::new), formulas, values: Vec::new(), table: Table::default() }
    }
}

impl TryFrom<State> for Reductions {
    type Error = String;

    fn try_from(state: State) -> Result<Reductions, String> {
        let State { select, rows, kept, reductions } = state;
        let is_sound = |kind: &Kind| match kind {
            Kind::Statistics(own) => own.is_sound(),
            Kind::Histogram(own) => own.is_sound(),
            Kind::Ranking(_) => true,
            Kind::Front(own) => own.is_sound(),
        };
        if !reductions.iter().all(is_sound) {
            return Err("the answers so far are not what a run has left".to_string());
        }
        let work = Work::new(select.as_ref(), &reductions);
        Ok(Reductions { select, rows, kept, reductions, work })
    }
}

impl Reductions {
    /// `None` where the config asks for none.
    pub fn of(study: &Study) -> Option<Reductions> {
        study.reduce.as_ref().map(|asked| Reductions::new(asked, study.select.clone()))
    }

    pub fn new(asked: &Reduce, select: Option<Expression>) -> Reductions {
        let Reduce { statistics, quantiles, best, pareto, histograms } = asked;
        let statistics = statistics.iter().map(|of| Kind::Statistics(Statistics::new(of, quantiles)));
        let rankings = best.iter().map(|best| Kind::Ranking(Ranking::new(best)));
        let front = (!pareto.is_empty()).then(|| Kind::Front(Front::new(pareto)));
        let histograms =
            (1..).zip(histograms).map(|(number, one)| Kind::Histogram(Histogram::new(number, one)));
        let reductions: Vec<Kind> = statistics.chain(rankings).chain(front).chain(histograms).collect();
        let work = Work::new(select.as_ref(), &reductions);
        Reductions { select, rows: 0, kept: 0, reductions, work }
    }

    /// Adds the rows of a design, those that are kept.
    pub fn add(&mut self, outcome: &DesignOutcome) {
        let DesignOutcome { case, backend, steps, .. } = outcome;
        let Work { filter, formulas, values, table } = &mut self.work;
        for (step, outcome) in steps.iter().enumerate().take(case.steps.len()) {
            let row = Row { case, step, outcome, backend: *backend };
            self.rows += 1;
            if filter.as_ref().is_some_and(|filter| !filter.keeps_row(&row)) {
                continue;
            }
            self.kept += 1;
            for (kind, formulas) in self.reductions.iter_mut().zip(formulas.iter()) {
                values.clear();
                values.extend(formulas.iter().map(|formula| formula.value(&row)));
                kind.reduction_mut().add(values, &row, &mut || table_line(table, &row));
            }
        }
    }

    /// Adds what another part of the same sweep has found. Parts of different questions do not go together.
    pub fn merge(&mut self, other: &Reductions) -> Result<(), Error> {
        let alike = self.reductions.len() == other.reductions.len()
            && self.reductions.iter().zip(&other.reductions).all(|(own, theirs)| own.is_like(theirs));
        if !alike || self.select != other.select {
            let problem = "answers to different questions cannot be joined: [select] and [reduce] differ";
            return Err(Error::Asked { problem: problem.to_string() });
        }
        self.rows += other.rows;
        self.kept += other.kept;
        self.reductions.iter_mut().zip(&other.reductions).for_each(|(own, theirs)| own.merge(theirs));
        Ok(())
    }

    /// Rows that were added, kept or not.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Rows that `[select]` has kept.
    pub fn kept(&self) -> u64 {
        self.kept
    }

    /// The files that tell the answers, with their names.
    pub fn files(&self) -> Vec<(&'static str, Vec<u8>)> {
        let mut files: Vec<(&'static str, Vec<u8>)> = Vec::new();
        for kind in &self.reductions {
            let reduction = kind.reduction();
            let name = reduction.file_name();
            if files.last().is_none_or(|(last, _)| *last != name) {
                let mut text = Vec::new();
                reduction.push_header(&mut text);
                files.push((name, text));
            }
            if let Some((_, text)) = files.last_mut() {
                reduction.push_rows(text);
            }
        }
        files
    }

    /// What a reader of the files must know, in words; empty mostly.
    pub fn remarks(&self) -> Vec<String> {
        let remark = |kind: &Kind| match kind {
            Kind::Front(front) => front.remark(),
            _ => None,
        };
        self.reductions.iter().filter_map(remark).collect()
    }
}

/// The columns of the table, as its first line has them.
fn table_header() -> String {
    String::from_utf8_lossy(&Table::default().header()).trim_end().to_string()
}

/// The row as a line of the table, without the line's end.
fn table_line(table: &Table, row: &Row) -> String {
    let Row { case, step, outcome, backend } = *row;
    let case = DesignCase { index: case.index, joint: case.joint, steps: vec![case.steps[step]] };
    let line = table.rows(&[DesignOutcome::new(case, Answer { backend, steps: vec![*outcome] })]);
    String::from_utf8_lossy(&line).trim_end().to_string()
}
