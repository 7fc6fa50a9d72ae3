//! One pass over a table, with memory that does not grow with it: counts, ranges, distributions, and a sample of designs.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::Error;
use crate::output::results::{Results, TableRows};
use crate::study::columns::{Column, FORCE, INDENTATION, Quantity, joint_columns};
use crate::study::design::JointDesign;

/// The most designs and rows that are kept.
const MOST_DESIGNS: usize = 20_000;
const MOST_ROWS: usize = 200_000;
/// The most rows of one design that are kept, evenly taken.
const MOST_STEPS: usize = 128;
/// The most different values of an input that are told apart.
pub const MOST_VALUES: usize = 64;
/// The most different statuses.
const MOST_STATUSES: usize = 200;

/// Results of a row that has an answer; NaN where its method does not say.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    pub stiffness: f64,
    pub half_angle: f64,
    pub peak_pressure: f64,
    pub force_error: f64,
    pub linearity_error: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// NaN where it is not known: in rows without an answer, what was not asked.
    pub indentation: f64,
    pub force: f64,
    pub answer: Option<Answer>,
}

/// A value of an input.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Word(String),
    Empty,
}

#[derive(Clone, Debug)]
pub struct SampledDesign {
    pub number: u64,
    pub joint: JointDesign,
    /// In the order of `Scan::inputs`.
    pub inputs: Vec<Value>,
    pub rows: Vec<Row>,
    /// Every so many rows are kept, and the last one.
    stride: usize,
    seen: usize,
    /// Rows without an answer, and why the first of them has none.
    pub failed: u64,
    pub failure: Option<String>,
}

/// What an input column holds over the sweep.
#[derive(Clone, Debug)]
pub struct Input {
    /// In words: "radial clearance".
    pub name: String,
    pub unit: &'static str,
    column: String,
    place: Option<usize>,
    pub range: Option<(f64, f64)>,
    /// Different numbers and words, as far as they are few.
    pub numbers: Vec<f64>,
    pub words: BTreeSet<String>,
    pub many_numbers: bool,
    pub has_empty: bool,
}

impl Input {
    fn new(column: &Column, rows: &TableRows) -> Input {
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

    fn add(&mut self, rows: &TableRows) -> Result<Value, Error> {
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
    fn add(&mut self, value: f64, design: u64) {
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
    fn new(limit: f64) -> Distribution {
        let bins = vec![0; ((LAST_DECADE - FIRST_DECADE) * BINS_PER_DECADE) as usize];
        Distribution { count: 0, extremes: Extremes::default(), limit, above: 0, bins }
    }

    fn add(&mut self, value: f64, design: u64) {
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

/// Rows of one status.
#[derive(Clone, Copy, Debug)]
pub struct StatusShare {
    pub rows: u64,
    pub designs: u64,
    /// The first design that has it.
    pub example: u64,
    last: u64,
}

/// What a table holds.
pub struct Scan {
    pub designs: u64,
    pub rows: u64,
    pub answered: u64,
    /// Rows that are neither `ok` nor failed.
    pub remarked: u64,
    pub inputs: Vec<Input>,
    /// Rows of a design: least and most.
    pub steps: (u64, u64),
    pub indentation: Extremes,
    pub force: Extremes,
    pub stiffness: Extremes,
    pub half_angle: Extremes,
    pub peak_pressure: Extremes,
    pub force_error: Distribution,
    pub linearity_error: Distribution,
    pub methods: BTreeMap<String, u64>,
    pub statuses: BTreeMap<String, StatusShare>,
    /// Taken evenly, all where they are few, in their order.
    pub sample: Vec<SampledDesign>,
    /// Those asked for.
    pub named: BTreeMap<u64, SampledDesign>,
}

/// From here on `linearity_error` is remarked on, whatever the accuracy.
pub const LINEARITY_LIMIT: f64 = 0.01;

/// A fixed order of designs that has nothing to do with their order in the sweep (the finalizer of splitmix64): those
/// below a threshold are an even sample of any grid.
fn shuffled(design: u64) -> u64 {
    let mut bits = design.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// Where the results of a row stand.
struct Places {
    indentation: Option<usize>,
    force: Option<usize>,
    answer: [(&'static str, Option<usize>); 5],
    method: Option<usize>,
    status: Option<usize>,
}

const ANSWERS: [&str; 5] = [
    "tangent_stiffness_n_per_mm",
    "contact_half_angle_deg",
    "peak_pressure_mpa",
    "force_error",
    "linearity_error",
];

/// What a page cannot do without; other columns may be missing.
const NEEDED: [Quantity; 4] = [Quantity::Indentation, Quantity::Force, Quantity::Method, Quantity::Status];

impl Scan {
    /// Reads the table once. `named` designs are kept whole; the accuracy asked is the limit of `force_error`.
    pub fn read(results: &Results, named: &[u64]) -> Result<Scan, Error> {
        let asked = crate::study::config::Asked::from_text(
            std::path::Path::new(&results.origin.inputs.path),
            &results.origin.inputs.text,
        )?;
        let mut rows = results.rows(&NEEDED)?;
        let places = Places {
            indentation: rows.place(INDENTATION),
            force: rows.place(FORCE),
            answer: ANSWERS.map(|name| (name, rows.place(name))),
            method: rows.place("method"),
            status: rows.place("status"),
        };
        let mut scan = Scan {
            designs: 0,
            rows: 0,
            answered: 0,
            remarked: 0,
            inputs: joint_columns().iter().map(|column| Input::new(column, &rows)).collect(),
            steps: (u64::MAX, 0),
            indentation: Extremes::default(),
            force: Extremes::default(),
            stiffness: Extremes::default(),
            half_angle: Extremes::default(),
            peak_pressure: Extremes::default(),
            force_error: Distribution::new(asked.solve.accuracy),
            linearity_error: Distribution::new(LINEARITY_LIMIT.max(asked.solve.accuracy)),
            methods: BTreeMap::new(),
            statuses: BTreeMap::new(),
            sample: Vec::new(),
            named: BTreeMap::new(),
        };
        let (mut threshold, mut kept_rows) = (u64::MAX, 0);
        let mut current: Option<SampledDesign> = None;
        let mut open: Option<(u64, u64)> = None;
        while let Some(design) = rows.advance()? {
            if open.is_none_or(|(number, _)| number != design) {
                scan.close(open, current.take(), &mut kept_rows, &mut threshold, named);
                let values: Result<Vec<Value>, Error> =
                    scan.inputs.iter_mut().map(|input| input.add(&rows)).collect();
                let is_kept = shuffled(design) <= threshold || named.contains(&design);
                let values = values?;
                current = is_kept.then(|| rows.joint()).transpose()?.map(|joint| SampledDesign {
                    number: design,
                    joint,
                    inputs: values,
                    rows: Vec::new(),
                    stride: 1,
                    seen: 0,
                    failed: 0,
                    failure: None,
                });
                open = Some((design, 0));
                scan.designs += 1;
            }
            if let Some((_, steps)) = &mut open {
                *steps += 1;
            }
            let row = scan.row(design, &rows, &places)?;
            if let Some(current) = &mut current {
                if row.answer.is_none() && current.failure.is_none() {
                    current.failure = rows.cell_at(places.status).map(str::to_string);
                }
                current.failed += u64::from(row.answer.is_none());
                current.add(row);
            }
        }
        scan.close(open, current.take(), &mut kept_rows, &mut threshold, named);
        if scan.rows == 0 {
            let problem = "its table has no rows".into();
            return Err(Error::NoResult { dir: results.dir().into(), problem });
        }
        for input in &mut scan.inputs {
            input.numbers.sort_by(f64::total_cmp);
        }
        if let Some(&missing) = named.iter().find(|number| !scan.named.contains_key(number)) {
            return Err(Error::NoSuchDesign { design: missing, count: scan.designs });
        }
        Ok(scan)
    }

    fn row(&mut self, design: u64, rows: &TableRows, places: &Places) -> Result<Row, Error> {
        let or_nan = |number: Option<f64>| number.unwrap_or(f64::NAN);
        let indentation = or_nan(rows.number_at(places.indentation, INDENTATION)?);
        let force = or_nan(rows.number_at(places.force, FORCE)?);
        self.rows += 1;
        let status = rows.cell_at(places.status).unwrap_or_default();
        self.add_status(status, design);
        let method = rows.cell_at(places.method);
        let Some(method) = method.filter(|_| !status.starts_with("failed")) else {
            return Ok(Row { indentation, force, answer: None });
        };
        if let Some(count) = self.methods.get_mut(method) {
            *count += 1;
        } else if self.methods.len() < MOST_VALUES {
            self.methods.insert(method.to_string(), 1);
        }
        let mut numbers = [f64::NAN; 5];
        for (number, (name, place)) in numbers.iter_mut().zip(places.answer) {
            *number = or_nan(rows.number_at(place, name)?);
        }
        let [stiffness, half_angle, peak_pressure, force_error, linearity_error] = numbers;
        self.answered += 1;
        self.remarked += u64::from(status != "ok");
        self.indentation.add(indentation, design);
        self.force.add(force, design);
        self.stiffness.add(stiffness, design);
        self.half_angle.add(half_angle, design);
        self.peak_pressure.add(peak_pressure, design);
        self.force_error.add(force_error, design);
        self.linearity_error.add(linearity_error, design);
        let answer = Answer { stiffness, half_angle, peak_pressure, force_error, linearity_error };
        Ok(Row { indentation, force, answer: Some(answer) })
    }

    fn add_status(&mut self, status: &str, design: u64) {
        let full = self.statuses.len() >= MOST_STATUSES;
        let key = if full && !self.statuses.contains_key(status) { "others" } else { status };
        if !self.statuses.contains_key(key) {
            let share = StatusShare { rows: 0, designs: 0, example: design, last: u64::MAX };
            self.statuses.insert(key.to_string(), share);
        }
        if let Some(share) = self.statuses.get_mut(key) {
            share.rows += 1;
            share.designs += u64::from(share.last != design);
            share.last = design;
        }
    }

    /// Ends a design, and thins the sample out where it has grown too large.
    fn close(
        &mut self,
        open: Option<(u64, u64)>,
        design: Option<SampledDesign>,
        kept_rows: &mut usize,
        threshold: &mut u64,
        named: &[u64],
    ) {
        if let Some((_, steps)) = open {
            self.steps = (self.steps.0.min(steps), self.steps.1.max(steps));
        }
        let Some(design) = design else { return };
        if named.contains(&design.number) {
            self.named.insert(design.number, design.clone());
        }
        if shuffled(design.number) > *threshold {
            return;
        }
        *kept_rows += design.rows.len();
        self.sample.push(design);
        while self.sample.len() > MOST_DESIGNS || *kept_rows > MOST_ROWS {
            *threshold /= 2;
            let limit = *threshold;
            self.sample.retain(|design| shuffled(design.number) <= limit);
            *kept_rows = self.sample.iter().map(|design| design.rows.len()).sum();
        }
    }
}

impl SampledDesign {
    /// Keeps every `stride`-th row, and in any case the last one.
    fn add(&mut self, row: Row) {
        if self.seen > 0 && !(self.seen - 1).is_multiple_of(self.stride) {
            // The last row so far was only kept as the last.
            self.rows.pop();
        }
        self.rows.push(row);
        self.seen += 1;
        if self.rows.len() > MOST_STEPS && (self.seen - 1).is_multiple_of(self.stride) {
            let mut place = 0;
            self.rows.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.stride *= 2;
        }
    }

    /// The last row with an answer.
    pub fn last(&self) -> Option<(Row, Answer)> {
        self.rows.iter().rev().find_map(|row| row.answer.map(|answer| (*row, answer)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::material::{Idealization, Material};
    use crate::study::design::Part;

    #[test]
    fn few_rows_are_kept_of_many_and_the_last_is_among_them() {
        let steel = Material { youngs_modulus: 2e5, poissons_ratio: 0.3 };
        let joint = JointDesign {
            idealization: Idealization::PlaneStress,
            hole_radius: 10.0,
            radial_clearance: 0.1,
            thickness: 1.0,
            pin: Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, steel).unwrap(),
            plate: Part::new("annulus", &[("outer_radius_ratio", 2.0)], None, steel).unwrap(),
        };
        for count in [1, 2, 127, 128, 129, 130, 257, 1000, 100_000] {
            let mut design = SampledDesign {
                number: 0,
                joint,
                inputs: Vec::new(),
                rows: Vec::new(),
                stride: 1,
                seen: 0,
                failed: 0,
                failure: None,
            };
            for step in 0..count {
                design.add(Row { indentation: f64::from(step), force: 0.0, answer: None });
            }
            let kept: Vec<f64> = design.rows.iter().map(|row| row.indentation).collect();
            assert!(
                kept.len() <= MOST_STEPS + 1 && kept.len() as i32 >= count.min(60),
                "{count}: {}",
                kept.len()
            );
            assert_eq!((kept[0], kept[kept.len() - 1]), (0.0, f64::from(count - 1)), "{count}");
            assert!(kept.windows(2).all(|pair| pair[0] < pair[1]), "{count}: {kept:?}");
            let gaps: Vec<f64> = kept.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let even = gaps.iter().rev().skip(1).all(|gap| *gap == gaps[0]);
            assert!(even, "{count}: {gaps:?}");
        }
    }

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
