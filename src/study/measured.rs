//! Measured points of a joint: forces at indentations, from a CSV file.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::study::columns::{FORCE, INDENTATION};
use crate::study::design::Limits;
use crate::study::designs_file::{Rows, open_plain};
use crate::study::fingerprint::Fingerprint;

/// The standard deviation of a point's force, N.
pub const SIGMA: &str = "sigma_n";

/// More are no help to a fit, and make it slow.
const MOST_POINTS: usize = 100_000;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPoint {
    /// mm; below zero where the zero of the measurement is off.
    pub indentation: f64,
    /// N, not negative.
    pub force: f64,
    /// N, of the force.
    pub sigma: Option<f64>,
}

#[derive(Clone, Debug)]
pub struct Measured {
    pub path: PathBuf,
    pub points: Vec<MeasuredPoint>,
    pub fingerprint: Fingerprint,
}

impl Measured {
    /// Reads and checks every row.
    pub fn load(path: &Path) -> Result<Measured, Error> {
        let names = [INDENTATION, FORCE, SIGMA].map(String::from);
        let mut rows = Rows::open_columns(path, open_plain, &names)?;
        let mut points: Vec<MeasuredPoint> = Vec::new();
        while rows.read()? {
            let sigma = rows.cell(SIGMA).map(|_| rows.number(SIGMA, Limits::POSITIVE)).transpose()?;
            if points.first().is_some_and(|first| first.sigma.is_some() != sigma.is_some()) {
                let problem = "some rows have a standard deviation and some have none; all need one, or none";
                return Err(rows.complain(SIGMA, problem.into()));
            }
            if points.len() == MOST_POINTS {
                return Err(rows.complain("", format!("at most {MOST_POINTS} points are allowed")));
            }
            points.push(MeasuredPoint {
                indentation: rows.number(INDENTATION, Limits::ANY)?,
                force: rows.number(FORCE, Limits::NOT_NEGATIVE)?,
                sigma,
            });
        }
        Ok(Measured { path: path.into(), points, fingerprint: rows.fingerprint() })
    }
}
