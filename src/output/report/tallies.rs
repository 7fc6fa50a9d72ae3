//! What is counted over all rows of a table, with memory that does not grow with it: values of inputs, ranges, errors, statuses.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::Error;
use crate::output::results::TableRows;
use crate::study::columns::Column;

/// The most different values of an input that are told apart.
pub const MOST_VALUES: usize = 64;

/// A value of an input.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Word(String),
    Empty,
}

/// What an input column holds over the sweep.
#[derive(Clone, Debug)]
pub struct Input {
    /// In words: "radial clearance".
    pub name: String,
    pub unit: &'static str,
    pub column: String,
    place: Option<usize>,
    pub range: Option<(f64, f64)>,
    /// Different numbers and words, as far as they are few.
    pub numbers: Vec<f64>,
    pub words: BTreeSet<String>,
    pub many_numbers: bool,
    pub has_empty: bool,
}

impl Input {
    pub fn new(column: &Column, rows: &TableRows) -> Input {
        let name = column.name();
        let words = name.trim_end_matches("_mm").trim_end_matches("_mpa").replace('_', " ");
        Input {
            name: words.replace("youngs", "Young's").replace("poissons", "Poisson's"),
            unit: column.unit(),
            place: rows.place(&name),
            column: name,
            range: None,
            numbers: Vec::new(),
            words: BTreeSet::new(),
            many_numbers: false,
            has_empty: false,
        }
    }

    pub fn varies(&self) -> bool {
        self.many_numbers || self.numbers.len() + self.words.len() + usize::from(self.has_empty) > 1
    }

    /// Whether numbers alone tell designs apart here.
    pub fn has_numbers(&self) -> bool {
        self.many_numbers || self.numbers.len() > 1
    }

    pub fn add(&mut self, rows: &TableRows) -> Result<Value, Error> {
        let Some(cell) = rows.cell_at(self.place) else {
            self.has_empty = true;
            return Ok(Value::Empty);
        };
        let is_number = self.unit != "-" || self.column.ends_with("ratio");
        if !is_number {
            if !self.words.contains(cell) && self.words.len() < MOST_VALUES {
                self.words.insert(cell.to_string());
            }
            return Ok(Value::Word(cell.to_string()));
        }
        let Some(number) = rows.number_at(self.place, &self.column)? else { return Ok(Value::Empty) };
        let (low, high) = self.range.unwrap_or((number, number));
        self.range = Some((low.min(number), high.max(number)));
        if !self.many_numbers && !self.numbers.contains(&number) {
            if self.numbers.len() < MOST_VALUES {
                self.numbers.push(number);
            } else {
                self.many_numbers = true;
                self.numbers.clear();
            }
        }
        Ok(Value::Number(number))
    }
}

/// A quantity over all rows with an answer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extremes {
    /// Least and greatest, and whose they are.
    pub least: Option<(f64, u64)>,
    pub greatest: Option<(f64, u64)>,
}

impl Extremes {
    pub fn add(&mut self, value: f64, design: u64) {
        if value.is_nan() {
            return;
        }
        if self.least.is_none_or(|(least, _)| value < least) {
            self.least = Some((value, design));
        }
        if self.greatest.is_none_or(|(greatest, _)| value > greatest) {
            self.greatest = Some((value, design));
        }
    }

    pub fn range(&self) -> Option<(f64, f64)> {
        Some((self.least?.0, self.greatest?.0))
    }
}

/// How errors are spread: counts in steps of a tenth of a decade.
#[derive(Clone, Debug)]
pub struct Distribution {
    pub count: u64,
    pub extremes: Extremes,
    /// Above `limit`.
    pub limit: f64,
    pub above: u64,
    bins: Vec<u64>,
}

const BINS_PER_DECADE: i32 = 10;
const FIRST_DECADE: i32 = -12;
const LAST_DECADE: i32 = 2;

impl Distribution {
    pub fn new(limit: f64) -> Distribution {
        let bins = vec![0; ((LAST_DECADE - FIRST_DECADE) * BINS_PER_DECADE) as usize];
        Distribution { count: 0, extremes: Extremes::default(), limit, above: 0, bins }
    }

    pub fn add(&mut self, value: f64, design: u64) {
        if value.is_nan() {
            return;
        }
        self.count += 1;
        self.extremes.add(value, design);
        self.above += u64::from(value > self.limit);
        let place = (value.log10() - f64::from(FIRST_DECADE)) * f64::from(BINS_PER_DECADE);
        // Also of zero, whose logarithm is infinitely low.
        let place = (place.max(0.0) as usize).min(self.bins.len() - 1);
        self.bins[place] += 1;
    }

    /// Lower ends of the bins from the first to behind the last that holds something, with their counts.
    pub fn bins(&self) -> Vec<(f64, u64)> {
        let Some(first) = self.bins.iter().position(|count| *count > 0) else { return Vec::new() };
        let last = self.bins.iter().rposition(|count| *count > 0).unwrap_or(first);
        let end =
            |place: usize| 10f64.powf(f64::from(FIRST_DECADE) + place as f64 / f64::from(BINS_PER_DECADE));
        (first..=last + 1).map(|place| (end(place), self.bins.get(place).copied().unwrap_or(0))).collect()
    }
}

/// The most different statuses.
const MOST_STATUSES: usize = 200;

/// Rows of one status.
#[derive(Clone, Copy, Debug)]
pub struct StatusShare {
    pub rows: u64,
    pub designs: u64,
    /// The first design that has it.
    pub example: u64,
    last: u64,
}

/// Counts a row of a status; those beyond the most are counted together.
pub fn add_status(statuses: &mut BTreeMap<String, StatusShare>, status: &str, design: u64) {
    let full = statuses.len() >= MOST_STATUSES;
    let key = if full && !statuses.contains_key(status) { "others" } else { status };
    if !statuses.contains_key(key) {
        let share = StatusShare { rows: 0, designs: 0, example: design, last: u64::MAX };
        statuses.insert(key.to_string(), share);
    }
    if let Some(share) = statuses.get_mut(key) {
        share.rows += 1;
        share.designs += u64::from(share.last != design);
        share.last = design;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_counted_by_tenths_of_a_decade() {
        let mut errors = Distribution::new(0.01);
        for value in [0.0, 1.05e-3, 1.2e-3, 0.5, f64::NAN] {
            errors.add(value, 3);
        }
        assert_eq!((errors.count, errors.above), (4, 1));
        let bins = errors.bins();
        assert_eq!(bins.iter().map(|bin| bin.1).sum::<u64>(), 4);
        let of_two = bins.iter().find(|bin| bin.1 == 2).unwrap();
        assert!((of_two.0 / 1e-3 - 1.0).abs() < 1e-9);
    }
}
