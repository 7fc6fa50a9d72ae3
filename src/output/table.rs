//! `table.csv`: the text of its rows. mm, N, MPa, mJ, degrees.
//!
//! The inputs are exact: a table's own input columns are a valid designs file. Results have nine significant digits.

use crate::engine::outcome::{DesignOutcome, Response, StepOutcome};
use crate::engine::status::{Failure, Status};
use crate::output::folder::TABLE;
use crate::output::number::{push_exact, push_rounded};
use crate::output::schema::{Kind, TableColumn, columns_of, non_finite, table_columns};
use crate::output::sink::Sink;
use crate::study::columns::{Cell, Extras};
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// Writes outcomes as rows.
pub struct Table {
    columns: Vec<TableColumn>,
    /// How many of the columns are the same in each row of a design.
    input_count: usize,
}

/// Of all columns of bare joints.
impl Default for Table {
    fn default() -> Table {
        Table::with(table_columns(Extras::NONE))
    }
}

/// What the rows of designs that follow each other have in common, as text.
#[derive(Default)]
struct Common {
    /// A design's inputs, the same in each of its rows; kept only to spare the allocation.
    inputs: Vec<u8>,
    /// The loads of the design before: most sweeps load all designs alike.
    loads: Vec<(f64, Vec<u8>)>,
}

impl Sink for Table {
    fn file_name(&self) -> &'static str {
        TABLE
    }

    fn header(&self) -> Vec<u8> {
        let names: Vec<&str> = self.columns.iter().map(|column| &*column.name).collect();
        format!("{}\n", names.join(",")).into()
    }

    fn rows(&self, outcomes: &[DesignOutcome]) -> Vec<u8> {
        let (mut out, mut common) = (Vec::new(), Common::default());
        for (place, outcome) in outcomes.iter().enumerate() {
            self.push_rows(&mut out, &mut common, outcome);
            if place == 0 {
                // Rows are about as long as each other.
                out.reserve(out.len() * outcomes.len());
            }
        }
        out
    }
}

impl Table {
    /// As the study asks for it.
    pub fn of(study: &Study) -> Table {
        Table::with(columns_of(study))
    }

    pub fn with(columns: Vec<TableColumn>) -> Table {
        let is_input = |column: &&TableColumn| matches!(column.kind, Kind::Design | Kind::Input(_));
        let input_count = columns.iter().take_while(is_input).count();
        Table { columns, input_count }
    }

    fn push_rows(&self, out: &mut Vec<u8>, common: &mut Common, outcome: &DesignOutcome) {
        assert_eq!(outcome.case.steps.len(), outcome.steps.len(), "an outcome for every step");
        let (inputs, results) = self.columns.split_at(self.input_count);
        common.inputs.clear();
        push_inputs(&mut common.inputs, inputs, &outcome.case);
        // NaN is no load, and equals none.
        common.loads.resize(outcome.steps.len(), (f64::NAN, Vec::new()));
        for ((load, text), step) in outcome.case.steps.iter().zip(&mut common.loads).zip(&outcome.steps) {
            let value = load.value();
            if value != text.0 {
                text.0 = value;
                text.1.clear();
                push_exact(&mut text.1, value);
            }
            let start = out.len();
            out.extend_from_slice(&common.inputs);
            for column in results {
                let response = step.response.as_ref();
                match column.kind {
                    Kind::Load(own) if (own.asked)(*load).is_some() => out.extend_from_slice(&text.1),
                    Kind::Load(own) => push_result(out, response.map(own.found)),
                    Kind::Result(value) => push_result(out, response.and_then(value)),
                    Kind::Word(word) => out.extend_from_slice(word(step, outcome.backend).as_bytes()),
                    Kind::Status if step.status == Status::OK => out.extend_from_slice(b"ok"),
                    Kind::Status => push_text(out, &step.status.to_string()),
                    Kind::Design | Kind::Input(_) => {}
                }
                out.push(b',');
            }
            out.pop();
            if out.len() == start {
                // The only column, and its cell is empty: an empty line would be no row.
                out.extend_from_slice(b"\"\"");
            }
            out.push(b'\n');
        }
    }
}

/// Appends the design's number and its inputs, each with a comma behind.
fn push_inputs(out: &mut Vec<u8>, inputs: &[TableColumn], case: &DesignCase) {
    for column in inputs {
        match column.kind {
            Kind::Input(input) => match input.cell(&case.joint) {
                Cell::Number(value) => push_exact(out, value),
                Cell::Word(word) => out.extend_from_slice(word.as_bytes()),
                Cell::Empty => {}
            },
            _ => out.extend_from_slice(case.index.to_string().as_bytes()),
        }
        out.push(b',');
    }
}

/// A response that is not a number in every part is no response; `columns` are those of results.
pub fn settle(columns: &[TableColumn], outcomes: &mut [DesignOutcome]) {
    for step in outcomes.iter_mut().flat_map(|outcome| &mut outcome.steps) {
        let doubtful = step.response.as_ref().filter(|response| !is_within_bounds(response));
        if let Some(name) = doubtful.and_then(|response| non_finite(columns, response)) {
            *step = StepOutcome::failed(Failure::NotFinite(name));
        }
    }
}

/// Whether every number is so far from the largest one that no column of results can hold an infinity.
fn is_within_bounds(response: &Response) -> bool {
    // Each field by its name, so that none that is added is forgotten.
    let Response {
        indentation,
        offset,
        force,
        tangent_stiffness,
        contact_half_angle,
        peak_pressure,
        peak_pressure_angle,
        energy,
        force_error,
        linearity_error,
        method: _,
    } = *response;
    let optional = [contact_half_angle, peak_pressure, peak_pressure_angle, energy, linearity_error];
    let is_small = |value: f64| value.abs() < 1e300;
    [indentation, offset, force, tangent_stiffness, force_error].into_iter().all(is_small)
        && optional.into_iter().all(|value| is_small(value.unwrap_or(0.0)))
}

fn push_result(out: &mut Vec<u8>, value: Option<f64>) {
    if let Some(value) = value {
        push_rounded(out, value);
    }
}

/// Appends free text, quoted where CSV (RFC 4180) asks for it.
pub(super) fn push_text(out: &mut Vec<u8>, text: &str) {
    if !text.contains([',', '"', '\n', '\r']) {
        return out.extend_from_slice(text.as_bytes());
    }
    out.push(b'"');
    out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
    out.push(b'"');
}

#[cfg(test)]
mod tests {
    use std::ops::Bound::Included;

    use super::*;
    use crate::engine::outcome::{Answer, BackendKind, Method};
    use crate::mechanics::body::{annulus, half_disc};
    use crate::mechanics::laws::LawError;
    use crate::mechanics::material::{Idealization, Material};
    use crate::output::schema::result_columns;
    use crate::study::design::Load;
    use crate::study::design::{JointDesign, Part};

    const RESPONSE: Response = Response {
        offset: 0.5,
        indentation: 0.1,
        force: 1.0 / 3.0,
        tangent_stiffness: 144_700.0,
        contact_half_angle: Some(std::f64::consts::FRAC_PI_4),
        peak_pressure: None,
        peak_pressure_angle: None,
        energy: Some(2e-7),
        force_error: 0.0012,
        linearity_error: Some(0.02),
        method: Method::Fe,
    };

    fn rows(loads: &[Load], steps: Vec<StepOutcome>) -> String {
        let material = Material { youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let part = |shape, parameters| Part {
            shape,
            parameters,
            support: 0,
            material,
            layers: Default::default(),
            yield_stress: None,
        };
        let joint = JointDesign {
            idealization: Idealization::PlaneStress,
            hole_radius: 100.0,
            radial_clearance: 0.1 + 0.2,
            thickness: 1.0,
            pin: part(&half_disc::SHAPE, [0.0; 3]),
            plate: part(&annulus::SHAPE, [2.0, 0.0, 0.0]),
        };
        let case = DesignCase { index: 7, joint, steps: loads.to_vec().into() };
        let mut outcomes = [DesignOutcome::new(case, Answer { backend: BackendKind::Cpu, steps })];
        settle(&result_columns(), &mut outcomes);
        String::from_utf8(Table::default().rows(&outcomes)).unwrap()
    }

    const OK: StepOutcome = StepOutcome { response: Some(RESPONSE), status: Status::OK };

    const INPUTS: &str =
        "7,100,0.30000000000000004,1,plane-stress,rigid-midplane,,200000,0.3,annulus,2,,,,,200000,0.3";

    #[test]
    fn a_prescribed_indentation_is_exact_and_its_force_rounded() {
        let text = rows(&[Load::Indentation(0.1 + 0.2)], vec![OK]);
        let results = "0.30000000000000004,0.333333333,144700,45,,2e-7,0.0012,0.02,fe,cpu,ok";
        assert_eq!(text, format!("{INPUTS},{results}\n"));
    }

    #[test]
    fn a_prescribed_force_is_exact_and_its_indentation_found() {
        let text = rows(&[Load::Force(0.1 + 0.2)], vec![OK]);
        let results = "0.1,0.30000000000000004,144700,45,,2e-7,0.0012,0.02,fe,cpu,ok";
        assert_eq!(text, format!("{INPUTS},{results}\n"));
    }

    #[test]
    fn a_failed_step_keeps_its_load_and_says_why() {
        let loads = [Load::Indentation(0.1), Load::Force(5.0)];
        let law = LawError::OutOfRange {
            law: "x",
            quantity: "y",
            value: 2.0,
            allowed: (Included(0.0), Included(1.0)),
        };
        let steps = [Failure::Law(law), Failure::NotAPush].map(StepOutcome::failed).to_vec();
        let text = rows(&loads, steps);
        let lines: Vec<&str> = text.lines().collect();
        // Commas are quoted.
        assert_eq!(lines[0], format!("{INPUTS},0.1,,,,,,,,,,\"failed: x: y = 2 is outside [0, 1]\""));
        let why = "the bodies do not push each other, the mesh is too coarse for them";
        assert_eq!(lines[1], format!("{INPUTS},,5,,,,,,,,,\"failed: {why}\""));
    }

    #[test]
    fn a_response_with_a_nan_or_an_infinity_becomes_a_failed_row() {
        let nan = Response { energy: Some(f64::NAN), ..RESPONSE };
        let infinite = Response { force: f64::INFINITY, ..RESPONSE };
        let text = rows(
            &[Load::Indentation(0.1); 2],
            [nan, infinite].map(|response| StepOutcome { response: Some(response), ..OK }).to_vec(),
        );
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("{INPUTS},0.1,,,,,,,,,,failed: energy_mj is not a finite number"));
        assert_eq!(lines[1], format!("{INPUTS},0.1,,,,,,,,,,failed: force_n is not a finite number"));
    }

    /// Read by an independent CSV reader, which refuses rows of another length than the header's.
    #[test]
    fn every_row_has_a_cell_for_each_column() {
        let mut text = Table::default().header();
        let steps = vec![OK, StepOutcome::failed(Failure::NotAPush)];
        text.extend_from_slice(rows(&[Load::Indentation(0.1); 2], steps).as_bytes());
        let mut reader = csv::Reader::from_reader(text.as_slice());
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), 2);
        let status = records[1].iter().next_back().unwrap();
        assert!(status.starts_with("failed: ") && status.contains(", the mesh"), "{status}");
    }
}
