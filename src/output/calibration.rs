//! `calibration.csv`, `residuals.csv`, `residuals.svg` and their manifest: a joint fitted to measured points.

use std::time::SystemTime;

use serde::Serialize;

use crate::calibrate::calibration::{CONFIDENCE, Calibration, Fitted};
use crate::error::Error;
use crate::output::claim::Claim;
use crate::output::host::utc;
use crate::output::manifest_parts::FileEntry;
use crate::output::number::rounded_cell as cell;
use crate::output::residual_plot;
use crate::output::texts::{self, Beginning};
use crate::study::config::Study;
use crate::study::measured::Measured;

/// What was fitted to what, and how well.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationManifest {
    #[serde(flatten)]
    beginning: Beginning,
    measured: FileEntry,
    files: Vec<FileEntry>,
    /// Names, in the order of the correlations.
    fit: Vec<&'static str>,
    /// Mean of the intervals.
    confidence: f64,
    correlation: Vec<Vec<Option<f64>>>,
    /// Of the normalised Jacobian; absent where it is infinite.
    condition: Option<f64>,
    points: usize,
    residual_deviation_n: Option<f64>,
    reduced_chi_square: Option<f64>,
    iterations: usize,
    warnings: Vec<String>,
    started_utc: String,
}

impl CalibrationManifest {
    pub fn new(study: &Study, measured: &Measured, started: SystemTime) -> CalibrationManifest {
        CalibrationManifest {
            beginning: Beginning::of(study, "calibrate"),
            measured: FileEntry::new(&measured.path.display().to_string(), &measured.fingerprint),
            files: Vec::new(),
            fit: Vec::new(),
            confidence: CONFIDENCE,
            correlation: Vec::new(),
            condition: None,
            points: measured.points.len(),
            residual_deviation_n: None,
            reduced_chi_square: None,
            iterations: 0,
            warnings: Vec::new(),
            started_utc: utc(started),
        }
    }

    /// Writes everything into the folder, the manifest last.
    pub fn save(mut self, claim: &Claim, calibration: &Calibration) -> Result<(), Error> {
        self.fit = calibration.fitted.iter().map(|fitted| fitted.unknown.name()).collect();
        self.correlation.clone_from(&calibration.correlation);
        self.condition = Some(calibration.condition).filter(|condition| condition.is_finite());
        self.residual_deviation_n = calibration.residual_deviation;
        self.reduced_chi_square = calibration.reduced_chi_square;
        self.iterations = calibration.iterations;
        self.warnings.clone_from(&calibration.warnings);
        let picture = residual_plot::svg(&self.beginning.title, calibration)?;
        let files = [
            ("calibration.csv", values(&calibration.fitted)),
            ("residuals.csv", residuals(calibration)),
            ("residuals.svg", picture),
        ];
        self.files = texts::write(claim, files)?;
        texts::publish(claim, &self)
    }
}

/// One row an unknown; empty cells where the points do not decide.
fn values(fitted: &[Fitted]) -> String {
    let mut text = "name,unit,start,value,low_95,high_95,standard_error\n".to_string();
    for Fitted { unknown, start, value, standard_error, interval } in fitted {
        let [low, high] = interval.map_or([String::new(), String::new()], |ends| ends.map(cell));
        let error = standard_error.map_or(String::new(), cell);
        let [start, value] = [*start, *value].map(cell);
        text += &format!("{},{},{start},{value},{low},{high},{error}\n", unknown.name(), unknown.unit());
    }
    text
}

fn residuals(calibration: &Calibration) -> String {
    let mut text = "indentation_mm,force_n,sigma_n,fitted_force_n,residual_n\n".to_string();
    for point in &calibration.points {
        let measured = &point.measured;
        let sigma = measured.sigma.map_or(String::new(), cell);
        let [indentation, force, fitted, residual] =
            [measured.indentation, measured.force, point.force, point.residual()].map(cell);
        text += &format!("{indentation},{force},{sigma},{fitted},{residual}\n");
    }
    text
}
