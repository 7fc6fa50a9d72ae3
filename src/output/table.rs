//! The columns of `table.csv`, their units and their order, and the text of its rows. mm, N, MPa, mJ, degrees.
//!
//! The inputs are exact: a table's own input columns are a valid designs file. Results have nine significant digits.

use crate::engine::outcome::{BackendKind, DesignOutcome, Response, StepOutcome};
use crate::output::number::{push_exact, push_rounded};
use crate::study::columns::{self, Cell, Column};
use crate::study::design::{DesignCase, Load};

/// A result: its name, and its value where the method gives one.
type ResultColumn = (&'static str, fn(&Response) -> Option<f64>);

/// The results after the load (indentation and force).
const RESULTS: [ResultColumn; 6] = [
    ("tangent_stiffness_n_per_mm", |response| Some(response.tangent_stiffness)),
    ("contact_half_angle_deg", |response| response.contact_half_angle.map(f64::to_degrees)),
    ("peak_pressure_mpa", |response| response.peak_pressure),
    ("energy_mj", |response| response.energy),
    ("force_error", |response| Some(response.force_error)),
    ("linearity_error", |response| response.linearity_error),
];

const REMARKS: [&str; 3] = ["method", "backend", "status"];

/// Writes outcomes as rows.
pub struct Table {
    inputs: Vec<Column>,
    /// The text of a design's inputs, the same in each of its rows; kept only to spare the allocation.
    input_text: Vec<u8>,
    /// The values of the loads of the design before, with their text: most sweeps load all designs alike.
    loads: Vec<(f64, Vec<u8>)>,
}

impl Default for Table {
    fn default() -> Table {
        Table { inputs: columns::joint_columns(), input_text: Vec::new(), loads: Vec::new() }
    }
}

impl Table {
    /// The names of all columns.
    pub fn names(&self) -> Vec<String> {
        let mut names = vec!["design".to_string()];
        names.extend(self.inputs.iter().map(Column::name));
        let load = [columns::INDENTATION, columns::FORCE];
        let others = load.into_iter().chain(RESULTS.map(|(name, _)| name)).chain(REMARKS);
        names.extend(others.map(str::to_string));
        names
    }

    /// Appends the row of names.
    pub fn push_header(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self.names().join(",").as_bytes());
        out.push(b'\n');
    }

    /// Appends a row for each step of a design. A response that is not a number in every part is no response:
    /// its step is turned into a failed one, here and in `outcome`.
    pub fn push_rows(&mut self, out: &mut Vec<u8>, outcome: &mut DesignOutcome) {
        assert_eq!(outcome.case.steps.len(), outcome.steps.len(), "an outcome for every step");
        self.input_text.clear();
        push_inputs(&mut self.input_text, &self.inputs, &outcome.case);
        // NaN is no load, and equals none.
        self.loads.resize(outcome.steps.len(), (f64::NAN, Vec::new()));
        for ((load, text), step) in outcome.case.steps.iter().zip(&mut self.loads).zip(&mut outcome.steps) {
            let (Load::Indentation(value) | Load::Force(value)) = *load;
            if value != text.0 {
                text.0 = value;
                text.1.clear();
                push_exact(&mut text.1, value);
            }
            refuse_non_finite(step);
            out.extend_from_slice(&self.input_text);
            push_step(out, (load, &text.1), step, outcome.backend);
        }
    }
}

/// `load` with its text.
fn push_step(out: &mut Vec<u8>, load: (&Load, &[u8]), step: &StepOutcome, backend: BackendKind) {
    let response = step.response.as_ref();
    match load {
        (Load::Indentation(_), text) => {
            out.extend_from_slice(text);
            out.push(b',');
            push_result(out, response.map(|response| response.force));
        }
        (Load::Force(_), text) => {
            push_result(out, response.map(|response| response.indentation));
            out.push(b',');
            out.extend_from_slice(text);
        }
    }
    for (_, value) in RESULTS {
        out.push(b',');
        push_result(out, response.and_then(value));
    }
    let (method, backend) = response.map_or(("", ""), |r| (r.method.name(), backend.name()));
    for word in [method, backend] {
        out.push(b',');
        out.extend_from_slice(word.as_bytes());
    }
    out.push(b',');
    push_text(out, &step.status);
    out.push(b'\n');
}

/// Appends the design's number and its inputs, each with a comma behind.
fn push_inputs(out: &mut Vec<u8>, inputs: &[Column], case: &DesignCase) {
    out.extend_from_slice(case.index.to_string().as_bytes());
    out.push(b',');
    for column in inputs {
        match column.cell(&case.joint) {
            Cell::Number(value) => push_exact(out, value),
            Cell::Word(word) => out.extend_from_slice(word.as_bytes()),
            Cell::Empty => {}
        }
        out.push(b',');
    }
}

/// Drops a response with a NaN or an infinity in it, and says which value it was.
fn refuse_non_finite(step: &mut StepOutcome) {
    let Some(response) = &step.response else { return };
    let load = [(columns::INDENTATION, Some(response.indentation)), (columns::FORCE, Some(response.force))];
    let results = RESULTS.iter().map(|(name, value)| (*name, value(response)));
    let culprit = load.into_iter().chain(results).find(|(_, value)| value.is_some_and(|v| !v.is_finite()));
    if let Some((name, _)) = culprit {
        *step = StepOutcome { response: None, status: format!("{name} is not a finite number").into() };
    }
}

fn push_result(out: &mut Vec<u8>, value: Option<f64>) {
    if let Some(value) = value {
        push_rounded(out, value);
    }
}

/// Appends free text, quoted where CSV (RFC 4180) asks for it.
fn push_text(out: &mut Vec<u8>, text: &str) {
    if !text.contains([',', '"', '\n', '\r']) {
        return out.extend_from_slice(text.as_bytes());
    }
    out.push(b'"');
    out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
    out.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::outcome::Method;
    use crate::mechanics::body::{annulus, half_disc};
    use crate::mechanics::material::{Idealization, Material};
    use crate::study::design::{JointDesign, Part};

    const RESPONSE: Response = Response {
        indentation: 0.1,
        force: 1.0 / 3.0,
        tangent_stiffness: 144_700.0,
        contact_half_angle: Some(std::f64::consts::FRAC_PI_4),
        peak_pressure: None,
        energy: Some(2e-7),
        force_error: 0.0012,
        linearity_error: Some(0.02),
        method: Method::Fe,
    };

    fn rows(loads: &[Load], steps: Vec<StepOutcome>) -> String {
        let material = Material { youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let part = |shape, parameters| Part { shape, parameters, support: 0, material };
        let joint = JointDesign {
            idealization: Idealization::PlaneStress,
            hole_radius: 100.0,
            radial_clearance: 0.1 + 0.2,
            thickness: 1.0,
            pin: part(&half_disc::SHAPE, [0.0; 3]),
            plate: part(&annulus::SHAPE, [2.0, 0.0, 0.0]),
        };
        let case = DesignCase { index: 7, joint, steps: loads.to_vec() };
        let mut text = Vec::new();
        Table::default().push_rows(&mut text, &mut DesignOutcome { case, backend: BackendKind::Cpu, steps });
        String::from_utf8(text).unwrap()
    }

    fn step(response: Option<Response>, status: &'static str) -> StepOutcome {
        StepOutcome { response, status: status.into() }
    }

    const INPUTS: &str =
        "7,100,0.30000000000000004,1,plane-stress,rigid-midplane,,200000,0.3,annulus,2,,,,,200000,0.3";

    #[test]
    fn a_prescribed_indentation_is_exact_and_its_force_rounded() {
        let text = rows(&[Load::Indentation(0.1 + 0.2)], vec![step(Some(RESPONSE), "ok")]);
        let results = "0.30000000000000004,0.333333333,144700,45,,2e-7,0.0012,0.02,fe,cpu,ok";
        assert_eq!(text, format!("{INPUTS},{results}\n"));
    }

    #[test]
    fn a_prescribed_force_is_exact_and_its_indentation_found() {
        let text = rows(&[Load::Force(0.1 + 0.2)], vec![step(Some(RESPONSE), "ok")]);
        let results = "0.1,0.30000000000000004,144700,45,,2e-7,0.0012,0.02,fe,cpu,ok";
        assert_eq!(text, format!("{INPUTS},{results}\n"));
    }

    #[test]
    fn a_failed_step_keeps_its_load_and_says_why() {
        let loads = [Load::Indentation(0.1), Load::Force(5.0)];
        let text = rows(&loads, vec![step(None, "no contact, \"lost\""), step(None, "no root")]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("{INPUTS},0.1,,,,,,,,,,\"no contact, \"\"lost\"\"\""));
        assert_eq!(lines[1], format!("{INPUTS},,5,,,,,,,,,no root"));
    }

    #[test]
    fn a_response_with_a_nan_or_an_infinity_becomes_a_failed_row() {
        let nan = Response { energy: Some(f64::NAN), ..RESPONSE };
        let infinite = Response { force: f64::INFINITY, ..RESPONSE };
        let text =
            rows(&[Load::Indentation(0.1); 2], vec![step(Some(nan), "ok"), step(Some(infinite), "ok")]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("{INPUTS},0.1,,,,,,,,,,energy_mj is not a finite number"));
        assert_eq!(lines[1], format!("{INPUTS},0.1,,,,,,,,,,force_n is not a finite number"));
    }

    /// Read by an independent CSV reader, which refuses rows of another length than the header's.
    #[test]
    fn every_row_has_a_cell_for_each_column() {
        let mut text = Vec::new();
        Table::default().push_header(&mut text);
        let steps = vec![step(Some(RESPONSE), "ok"), step(None, "a \"quoted\", long\nstatus")];
        text.extend_from_slice(rows(&[Load::Indentation(0.1); 2], steps).as_bytes());
        let mut reader = csv::Reader::from_reader(text.as_slice());
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), 2);
        assert_eq!(records[1].iter().next_back(), Some("a \"quoted\", long\nstatus"));
    }
}
