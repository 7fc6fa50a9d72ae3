//! `calibration.csv`, `residuals.csv`, `residuals.svg` and their manifest: a joint fitted to measured points.

use std::time::SystemTime;

use serde::Serialize;

use crate::calibrate::calibration::{CONFIDENCE, Calibration, Fitted};
use crate::error::Error;
use crate::output::folder::{Claim, MANIFEST};
use crate::output::host::{Program, utc};
use crate::output::manifest::{self, Config, FileEntry, State};
use crate::output::number::push_rounded;
use crate::output::residual_plot;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;
use crate::study::measured::Measured;

/// What was fitted to what, and how well.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationManifest {
    #[serde(flatten)]
    program: Program,
    state: State,
    command: &'static str,
    title: String,
    config: Config,
    inputs: Vec<FileEntry>,
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
            program: Program::CURRENT,
            state: State::Complete,
            command: "calibrate",
            title: study.title().to_string(),
            config: Config::of(study),
            inputs: FileEntry::inputs(study),
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
        let picture = residual_plot::svg(&self.title, calibration)?;
        for (name, text) in [
            ("calibration.csv", values(&calibration.fitted)),
            ("residuals.csv", residuals(calibration)),
            ("residuals.svg", picture),
        ] {
            let path = claim.partial(name);
            self.files.push(FileEntry::new(name, &Fingerprint::of(text.as_bytes())));
            std::fs::write(&path, text).map_err(|source| Error::Io { action: "write", path, source })?;
        }
        let path = claim.partial(MANIFEST);
        manifest::stage(&self, &path)?;
        manifest::publish(&path)?;
        claim.publish()
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

/// Nine digits.
fn cell(value: f64) -> String {
    let mut text = Vec::new();
    push_rounded(&mut text, value);
    String::from_utf8(text).unwrap_or_default()
}
