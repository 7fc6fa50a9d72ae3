//! One pass over a table, with memory that does not grow with it: counts, ranges, distributions, and a sample of designs.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::output::report::sample::{Answer, Row, Sample, SampledDesign};
use crate::output::report::tallies::{
    Distribution, Extremes, Input, MOST_VALUES, StatusShare, Value, add_status,
};
use crate::output::results::{Results, TableRows};
use crate::output::travel::Travel;
use crate::study::columns::{FORCE, OFFSET, Quantity, joint_columns};

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
    /// What the `way` of rows is.
    pub travel: Travel,
    pub way: Extremes,
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

/// Where the results of a row stand.
struct Places {
    way: Option<usize>,
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
pub const NEEDED: [Quantity; 4] =
    [Quantity::Indentation, Quantity::Force, Quantity::Method, Quantity::Status];

impl Scan {
    /// Reads the table once. `named` designs are kept whole; `accuracy`, as it was asked, is the limit of `force_error`.
    pub fn read(results: &Results, accuracy: f64, named: &[u64]) -> Result<Scan, Error> {
        let mut rows = results.rows(&NEEDED)?;
        let travel = if rows.place(OFFSET).is_some() { Travel::Offset } else { Travel::Indentation };
        let places = Places {
            way: rows.place(travel.column()),
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
            inputs: joint_columns(rows.layer_counts())
                .iter()
                .map(|column| Input::new(column, &rows))
                .collect(),
            steps: (u64::MAX, 0),
            travel,
            way: Extremes::default(),
            force: Extremes::default(),
            stiffness: Extremes::default(),
            half_angle: Extremes::default(),
            peak_pressure: Extremes::default(),
            force_error: Distribution::new(accuracy),
            linearity_error: Distribution::new(LINEARITY_LIMIT.max(accuracy)),
            methods: BTreeMap::new(),
            statuses: BTreeMap::new(),
            sample: Vec::new(),
            named: BTreeMap::new(),
        };
        let mut sample = Sample::default();
        let mut current: Option<SampledDesign> = None;
        let mut open: Option<(u64, u64)> = None;
        while let Some(design) = rows.advance()? {
            if open.is_none_or(|(number, _)| number != design) {
                scan.close(open, current.take(), &mut sample, named);
                let inputs: Result<Vec<Value>, Error> =
                    scan.inputs.iter_mut().map(|input| input.add(&rows)).collect();
                let inputs = inputs?;
                let is_kept = sample.has_place_for(design) || named.contains(&design);
                current =
                    is_kept.then(|| Ok(SampledDesign::new(design, rows.joint()?, inputs))).transpose()?;
                open = Some((design, 0));
                scan.designs += 1;
            }
            if let Some((_, steps)) = &mut open {
                *steps += 1;
            }
            let row = scan.row(design, &rows, &places)?;
            if let Some(current) = &mut current {
                current.add(row, rows.cell_at(places.status));
            }
        }
        scan.close(open, current.take(), &mut sample, named);
        scan.sample = sample.designs;
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
        let way = or_nan(rows.number_at(places.way, self.travel.column())?);
        let force = or_nan(rows.number_at(places.force, FORCE)?);
        self.rows += 1;
        let status = rows.cell_at(places.status).unwrap_or_default();
        add_status(&mut self.statuses, status, design);
        let method = rows.cell_at(places.method);
        let Some(method) = method.filter(|_| !status.starts_with("failed")) else {
            return Ok(Row { way, force, answer: None });
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
        self.way.add(way, design);
        self.force.add(force, design);
        self.stiffness.add(stiffness, design);
        self.half_angle.add(half_angle, design);
        self.peak_pressure.add(peak_pressure, design);
        self.force_error.add(force_error, design);
        self.linearity_error.add(linearity_error, design);
        let answer = Answer { stiffness, half_angle, peak_pressure, force_error, linearity_error };
        Ok(Row { way, force, answer: Some(answer) })
    }

    /// Ends a design.
    fn close(
        &mut self,
        open: Option<(u64, u64)>,
        design: Option<SampledDesign>,
        sample: &mut Sample,
        named: &[u64],
    ) {
        if let Some((_, steps)) = open {
            self.steps = (self.steps.0.min(steps), self.steps.1.max(steps));
        }
        let Some(design) = design else { return };
        if named.contains(&design.number) {
            self.named.insert(design.number, design.clone());
        }
        if sample.has_place_for(design.number) {
            sample.add(design);
        }
    }
}
