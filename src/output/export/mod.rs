//! Tables for other simulators: one file a format, all of them listed in `FORMATS`.

pub mod numbers;
pub mod interpolation;
pub mod source;
mod samples;
mod breakpoints;
pub mod table;
pub mod impact;
pub mod sheet;
mod csv;
mod hermite_text;
mod c;
mod python;
mod exudyn;
mod adams;
mod modelica;
mod opensim;
mod simscape;
mod nastran;
mod motionsolve;
mod recurdyn;
mod chrono;
mod mbdyn;
mod calculix;
mod abaqus;
mod ls_dyna;

use std::path::{Path, PathBuf};

use crate::error::{Error, shortened, suggest};
use crate::output::folder::MANIFEST;
use crate::output::results::Results;
use crate::output::whole_file::{publish, stage_bytes, staged};
use crate::study::fingerprint::Fingerprint;
use impact::{Impact, ImpactRequest};
use sheet::{Format, Sheet, head};
use source::{Fits, Reference, Selection, Source};
use table::{Quality, Wish, tabulate};

/// Every format there is.
pub static FORMATS: [&Format; 16] = [
    &csv::FORMAT,
    &c::FORMAT,
    &python::FORMAT,
    &exudyn::FORMAT,
    &adams::FORMAT,
    &modelica::FORMAT,
    &opensim::FORMAT,
    &simscape::FORMAT,
    &nastran::FORMAT,
    &motionsolve::FORMAT,
    &recurdyn::FORMAT,
    &chrono::FORMAT,
    &mbdyn::FORMAT,
    &calculix::FORMAT,
    &abaqus::FORMAT,
    &ls_dyna::FORMAT,
];

/// What is to be exported, and how.
#[derive(Clone)]
pub struct Request {
    pub format: &'static Format,
    pub selection: Selection,
    pub reference: Reference,
    /// Relative error of the interpolation.
    pub error: f64,
    /// An identifier: of functions, tables and files.
    pub name: String,
    pub impact: Option<ImpactRequest>,
    /// End of the range, mm against the support.
    pub up_to: Option<f64>,
    pub allow_warned: bool,
    /// The main file; without it beside the result's table.
    pub out: Option<PathBuf>,
}

/// What was made: the texts by the files they belong in, the main one first.
pub struct Export {
    pub files: Vec<(PathBuf, String)>,
    pub points: usize,
    pub clearances: usize,
    pub quality: Quality,
    pub impact: Option<Impact>,
}

/// The format of a name.
pub fn format(name: &str) -> Result<&'static Format, Error> {
    let names = FORMATS.map(|format| format.name);
    FORMATS.into_iter().find(|format| format.name == name).ok_or_else(|| Error::Export {
        what: "to".into(),
        problem: format!("`{}`: not known; {}", shortened(name), suggest(name, &names)),
    })
}

/// Makes the texts; writes nothing.
pub fn export(results: &Results, request: &Request) -> Result<Export, Error> {
    let format = request.format;
    check(request)?;
    let source =
        Source::read(results, request.selection, request.reference, request.up_to, request.allow_warned)?;
    let Format { rules, between, least_step, .. } = *format;
    let wish = Wish { rules, between, least_step, error: request.error };
    let (table, quality) = tabulate(&source, wish, request.allow_warned)?;
    if request.impact.is_some() && source.fits() != Fits::Clearance {
        let problem = "a press fit is never out of contact: there is no impact, and no damping of one";
        return source::refuse("restitution", problem);
    }
    let impact = request.impact.map(|asked| Impact::of(&table, asked)).transpose()?;
    let hash = Fingerprint::of(results.manifest.as_bytes()).hash();
    let head = head(&source, &results.origin, &hash, format, &table, &quality, impact.as_ref());
    let (points, clearances) = (table.indentations.len(), table.clearances.len());
    let sheet = Sheet { name: request.name.clone(), table, impact, head, length: format.length };
    let main = match &request.out {
        Some(path) => path.clone(),
        None => results.dir().join(format!("{}{}", request.name, format.suffix)),
    };
    let texts = (format.write)(&sheet);
    let files = texts.into_iter().enumerate().map(|(place, (ending, text))| match place {
        0 => (main.clone(), text),
        _ => (beside(&main, ending), text),
    });
    Ok(Export { files: files.collect(), points, clearances, quality, impact })
}

/// A file of the same name with another ending.
fn beside(main: &Path, ending: &str) -> PathBuf {
    let with = |more: &str| {
        let mut name = main.file_stem().unwrap_or_default().to_os_string();
        name.push(more);
        main.with_file_name(name)
    };
    let path = with(ending);
    if path == main { with(&format!("_more{ending}")) } else { path }
}

/// The longest name that every format takes.
const LONGEST_NAME: usize = 31;

fn check(request: &Request) -> Result<(), Error> {
    let refuse = |what: &str, problem: String| Err(Error::Export { what: what.into(), problem });
    let Request { format, name, error, .. } = request;
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.len() <= LONGEST_NAME;
    if !is_word {
        let problem = format!(
            "`{}`: a letter and up to {} letters, digits and `_` are allowed",
            shortened(name),
            LONGEST_NAME - 1
        );
        return refuse("name", problem);
    }
    if format.reserved.split(' ').any(|word| word == name) {
        return refuse(
            "name",
            format!("`{name}` is a word of the language of `{}`: take another", format.name),
        );
    }
    if !(*error >= LEAST_ERROR && *error < 1.0) {
        return refuse("error", format!("{error}: must be at least {LEAST_ERROR} and below 1 (100 %)"));
    }
    let able = |is_able: fn(&Format) -> bool| -> String {
        let names: Vec<String> =
            FORMATS.iter().filter(|f| is_able(f)).map(|f| format!("`{}`", f.name)).collect();
        names.join(", ")
    };
    if request.selection == Selection::OverRadialClearance && !format.two_dimensional {
        let problem = format!(
            "`{}` holds one clearance only: name a `design`, or take {}",
            format.name,
            able(|format| format.two_dimensional)
        );
        return refuse("over radial_clearance", problem);
    }
    if request.impact.is_some() && !format.damping {
        let problem =
            format!("`{}` has no place for damping; {} have", format.name, able(|format| format.damping));
        return refuse("restitution", problem);
    }
    if let Some(end) = request.up_to.filter(|end| !(*end > 0.0 && end.is_finite())) {
        return refuse("up-to", format!("{end} mm: must be above 0"));
    }
    Ok(())
}

/// Tables have nine digits.
const LEAST_ERROR: f64 = 1e-6;

impl Export {
    /// Writes the files, all or none; over files that are there only by `force`.
    pub fn write(&self, results: &Results, force: bool) -> Result<(), Error> {
        for (path, _) in &self.files {
            let of_result = [results.table(), results.dir().join(MANIFEST)];
            let is_same = |own: &PathBuf| match (own.canonicalize(), path.canonicalize()) {
                (Ok(own), Ok(path)) => own == path,
                _ => false,
            };
            if of_result.iter().any(is_same) {
                let problem = format!("{} is the result itself: name another file", path.display());
                return Err(Error::Export { what: "out".into(), problem });
            }
            if path.is_dir() {
                let problem = format!("{} is a folder: name a file", path.display());
                return Err(Error::Export { what: "out".into(), problem });
            }
            if !force && path.exists() {
                return Err(Error::FileTaken { path: path.clone() });
            }
        }
        for (path, text) in &self.files {
            if let Err(error) = stage_bytes(path, text.as_bytes()) {
                self.files.iter().for_each(|(path, _)| _ = std::fs::remove_file(staged(path)));
                return Err(error);
            }
        }
        self.files.iter().try_for_each(|(path, _)| publish(path))
    }
}
