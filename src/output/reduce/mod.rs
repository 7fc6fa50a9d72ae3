//! `[reduce]`: answers in the place of rows. What is asked of all kept rows together takes memory that does not grow with the
//! sweep, and parts of a sweep (threads, shards, a run that went on later) join to the same bytes in any order.

mod line;
pub mod exact_sum;
mod tally;
pub mod sketch;
mod statistics;
mod ranking;
mod front;
mod histogram;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::engine::outcome::{Answer, DesignOutcome};
use crate::engine::question::counted::{Counted, CountedQuantity};
use crate::engine::question::{Limits, MOST_POINTS as MOST_COMPARED, Question};
use crate::error::Error;
use crate::output::filter::{ROWS, RowPlace, row_at};
use crate::output::row_value::{Formula, Row};
use crate::output::schema::table_columns;
use crate::output::sink::Sink;
use crate::output::table::Table;
use crate::study::columns::Extras;
use crate::study::config::Study;
use crate::study::design::DesignCase;
use crate::study::expression::Expression;
use crate::study::reduce::Reduce;
use front::Front;
use histogram::Histogram;
use ranking::Ranking;
use statistics::Statistics;

pub use front::MOST_POINTS;

/// The number of a row's design, and of its load step.
pub type RowNumbers = (u64, u64);

/// What all rows together come to, and the file that tells it. A new kind of answer is one of these, in a file of its own.
pub trait Reduction {
    /// Several reductions may share a file.
    fn file_name(&self) -> &'static str;

    /// What it wants to know of each row.
    fn quantities(&self) -> Vec<&Expression>;

    /// Adds rows with the values of its quantities, each a column of them with NaN for none.
    fn add(&mut self, columns: &[&[f64]], rows: &[RowNumbers]);

    /// The same of rows that are counted already: only those that are told by themselves are of account.
    fn add_extremes(&mut self, columns: &[&[f64]], rows: &[RowNumbers]) {
        self.add(columns, rows);
    }

    /// What a value times its sign (`engine::question`) must not exceed to be told by itself, of each extreme.
    fn limits(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Has the lines of the table made for the rows that were added and stay; `line` makes one.
    fn make_lines(&mut self, _line: &dyn Fn(RowNumbers) -> String) {}

    /// Appends what the file begins with; some have the columns of the table, too.
    fn push_header(&self, table_header: &str, out: &mut Vec<u8>);

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
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "State")]
pub struct Reductions {
    reductions: Vec<Kind>,
    /// Of the table, lines of which some answers have.
    extras: Extras,
    /// The same for all parts of a run.
    #[serde(skip)]
    work: Arc<Work>,
}

/// What is known so far, as data.
#[derive(Deserialize)]
struct State {
    reductions: Vec<Kind>,
    extras: Extras,
}

/// What rows are read with.
struct Work {
    /// Each once, however many reductions ask for it.
    formulas: Vec<Formula>,
    /// The places of each reduction's formulas.
    places: Vec<Vec<usize>>,
    table: Table,
}

impl Work {
    fn new(reductions: &[Kind], extras: Extras) -> Work {
        let mut quantities: Vec<&Expression> = Vec::new();
        let mut places = Vec::with_capacity(reductions.len());
        for kind in reductions {
            let mut own = Vec::new();
            for quantity in kind.reduction().quantities() {
                let known = quantities.iter().position(|known| *known == quantity);
                own.push(known.unwrap_or(quantities.len()));
                if known.is_none() {
                    quantities.push(quantity);
                }
            }
            places.push(own);
        }
        let formulas = quantities.into_iter().map(Formula::of).collect();
        Work { formulas, places, table: Table::with(table_columns(extras)) }
    }
}

impl TryFrom<State> for Reductions {
    type Error = String;

    fn try_from(State { reductions, extras }: State) -> Result<Reductions, String> {
        let is_sound = |kind: &Kind| match kind {
            Kind::Statistics(own) => own.is_sound(),
            Kind::Histogram(own) => own.is_sound(),
            Kind::Ranking(_) => true,
            Kind::Front(own) => own.is_sound(),
        };
        if !reductions.iter().all(is_sound) {
            return Err("the answers so far are not what a run has left".to_string());
        }
        Ok(Reductions::with(reductions, extras))
    }
}

impl Reductions {
    /// `None` where the config asks for none.
    pub fn of(study: &Study) -> Option<Reductions> {
        let Reduce { statistics, quantiles, best, pareto, histograms } = study.reduce.as_ref()?;
        let statistics = statistics.iter().map(|of| Kind::Statistics(Statistics::new(of, quantiles)));
        let rankings = best.iter().map(|best| Kind::Ranking(Ranking::new(best)));
        let front = (!pareto.is_empty()).then(|| Kind::Front(Front::new(pareto)));
        let histograms =
            (1..).zip(histograms).map(|(number, one)| Kind::Histogram(Histogram::new(number, one)));
        let reductions = statistics.chain(rankings).chain(front).chain(histograms).collect();
        Some(Reductions::with(reductions, study.extras()))
    }

    fn with(reductions: Vec<Kind>, extras: Extras) -> Reductions {
        let work = Arc::new(Work::new(&reductions, extras));
        Reductions { reductions, extras, work }
    }

    /// Adds the kept rows of designs that follow each other.
    pub fn add(&mut self, outcomes: &[DesignOutcome], kept: &[RowPlace]) {
        self.add_rows(outcomes, kept, |reduction, columns, rows| reduction.add(columns, rows));
        self.make_lines(outcomes);
    }

    /// Adds kept rows that a device has counted, for what is told of single rows.
    pub fn add_extremes(&mut self, outcomes: &[DesignOutcome], kept: &[RowPlace]) {
        self.add_rows(outcomes, kept, |reduction, columns, rows| reduction.add_extremes(columns, rows));
        self.make_lines(outcomes);
    }

    /// The same for `limits` alone: no lines of the table are made.
    pub fn look_at(&mut self, outcomes: &[DesignOutcome], kept: &[RowPlace]) {
        self.add_rows(outcomes, kept, |reduction, columns, rows| reduction.add_extremes(columns, rows));
    }

    /// Adds what a device has counted for a question of the same config.
    pub fn add_counted(&mut self, counted: &Counted, question: &Question) {
        let none = CountedQuantity::default();
        let place = |of: &Expression| question.quantities.iter().position(|known| known.of == *of);
        let of_quantity = |of: &Expression| place(of).map_or(&none, |place| &counted.quantities[place]);
        let mut in_bins = counted.histograms.iter();
        for kind in &mut self.reductions {
            match kind {
                Kind::Statistics(own) => own.add_counted(of_quantity(own.of())),
                Kind::Histogram(own) => {
                    let bins = own.has_range().then(|| in_bins.next()).flatten();
                    own.add_counted(of_quantity(own.of()), bins.map(Vec::as_slice));
                }
                // Every row of theirs is told by itself.
                Kind::Ranking(_) | Kind::Front(_) => {}
            }
        }
    }

    /// What rows must reach to be told by themselves.
    pub fn limits(&self) -> Limits {
        let watches = self.reductions.iter().flat_map(|kind| kind.reduction().limits()).collect();
        let points = self.reductions.iter().flat_map(|kind| match kind {
            Kind::Front(front) => front.beaten_by().take(MOST_COMPARED).collect(),
            _ => Vec::new(),
        });
        Limits { watches, points: points.collect() }
    }

    fn add_rows(
        &mut self,
        outcomes: &[DesignOutcome],
        kept: &[RowPlace],
        add: impl Fn(&mut dyn Reduction, &[&[f64]], &[RowNumbers]),
    ) {
        let Work { formulas, places, .. } = &*self.work;
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); formulas.len()];
        let mut numbers = Vec::new();
        let mut stack = Vec::new();
        for kept in kept.chunks(ROWS) {
            let rows: Vec<Row> = kept.iter().map(|place| row_at(outcomes, *place)).collect();
            for (column, formula) in columns.iter_mut().zip(formulas) {
                column.clear();
                column.extend_from_slice(formula.values(&rows, &mut stack));
            }
            numbers.clear();
            numbers.extend(kept.iter().map(|(place, step)| (outcomes[*place].case.index, *step as u64)));
            for (kind, places) in self.reductions.iter_mut().zip(places) {
                let values: Vec<&[f64]> = places.iter().map(|place| columns[*place].as_slice()).collect();
                add(kind.reduction_mut(), &values, &numbers);
            }
        }
    }

    /// Of the rows that were added from these designs and stay.
    fn make_lines(&mut self, outcomes: &[DesignOutcome]) {
        let line = |(design, step): RowNumbers| {
            let place = outcomes.partition_point(|outcome| outcome.case.index < design);
            table_line(&self.work.table, &row_at(outcomes, (place, step as usize)))
        };
        self.reductions.iter_mut().for_each(|kind| kind.reduction_mut().make_lines(&line));
    }

    /// Adds what another part of the same sweep has found. Parts of different questions do not go together.
    pub fn merge(&mut self, other: &Reductions) -> Result<(), Error> {
        let alike = self.reductions.len() == other.reductions.len()
            && self.reductions.iter().zip(&other.reductions).all(|(own, theirs)| own.is_like(theirs));
        if !alike {
            let problem = "answers to different questions cannot be joined: [reduce] differs";
            return Err(Error::Asked { problem: problem.to_string() });
        }
        self.reductions.iter_mut().zip(&other.reductions).for_each(|(own, theirs)| own.merge(theirs));
        Ok(())
    }

    /// The files that tell the answers, with their names.
    pub fn files(&self) -> Vec<(&'static str, Vec<u8>)> {
        let mut files: Vec<(&'static str, Vec<u8>)> = Vec::new();
        // As the table's first line has them.
        let table_header = String::from_utf8_lossy(&self.work.table.header()).trim_end().to_string();
        for kind in &self.reductions {
            let reduction = kind.reduction();
            let name = reduction.file_name();
            if files.last().is_none_or(|(last, _)| *last != name) {
                let mut text = Vec::new();
                reduction.push_header(&table_header, &mut text);
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

/// The row as a line of the table, without the line's end.
fn table_line(table: &Table, row: &Row) -> String {
    let Row { case, step, outcome, backend } = *row;
    let case = DesignCase { index: case.index, joint: case.joint.clone(), steps: [case.steps[step]].into() };
    let line = table.rows(&[DesignOutcome::new(case, Answer { backend, steps: vec![outcome.clone()] })]);
    String::from_utf8_lossy(&line).trim_end().to_string()
}
