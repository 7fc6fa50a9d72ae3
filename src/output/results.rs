//! A finished result, read again: what was asked, and its rows.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::folder::{MANIFEST, TABLE};
use crate::output::manifest::{Origin, State};
use crate::output::schema::table_columns;
use crate::study::columns::{FORCE, INDENTATION};
use crate::study::design::JointDesign;
use crate::study::designs_file::Rows;

/// The folder of a run that went to its end.
pub struct Results {
    dir: PathBuf,
    pub origin: Origin,
    /// The manifest's text.
    pub manifest: String,
}

/// A row of the table. Numbers are `None` in rows without an answer.
#[derive(Clone, Debug)]
pub struct TableRow {
    pub design: u64,
    pub joint: JointDesign,
    /// mm and N: the one that was asked is there in any case.
    pub indentation: Option<f64>,
    pub force: Option<f64>,
    pub tangent_stiffness: Option<f64>,
    pub force_error: Option<f64>,
    pub linearity_error: Option<f64>,
    pub method: String,
    pub status: String,
}

impl TableRow {
    /// Whether there is an answer, and no remark on it.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }
}

impl Results {
    /// Of a folder that `run` has written, to its end.
    pub fn open(dir: &Path) -> Result<Results, Error> {
        let path = dir.join(MANIFEST);
        let manifest = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(_) if !path.exists() => {
                let problem = format!("there is no {MANIFEST}: `jointsweep run` makes results");
                return Err(Error::NoResult { dir: dir.into(), problem });
            }
            Err(source) => return Err(Error::Io { action: "read", path, source }),
        };
        let refuse = |problem: String| Err(Error::NoResult { dir: dir.into(), problem });
        let Some(origin) = Origin::of(&manifest) else {
            return refuse(format!("its {MANIFEST} is of another program"));
        };
        if let Some(command) = &origin.command {
            return refuse(format!("it holds what `jointsweep {command}` makes, not `jointsweep run`"));
        }
        if origin.state != Some(State::Complete) {
            return refuse("its run did not go to its end".into());
        }
        Ok(Results { dir: dir.into(), origin, manifest })
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    pub fn table(&self) -> PathBuf {
        self.dir.join(TABLE)
    }

    /// The rows in their order, as they are read.
    pub fn rows(&self) -> Result<TableRows, Error> {
        let names: Vec<String> = table_columns().into_iter().map(|column| column.name.into()).collect();
        Ok(TableRows { rows: Rows::open_columns(&self.table(), &names)? })
    }

    /// All rows of a design, by its number.
    pub fn design(&self, number: u64) -> Result<Vec<TableRow>, Error> {
        let mut rows = self.rows()?;
        let (mut found, mut count) = (Vec::new(), 0);
        while let Some(design) = rows.advance()? {
            count = count.max(design + 1);
            if design == number {
                found.push(rows.row()?);
            } else if !found.is_empty() {
                break;
            }
        }
        if found.is_empty() { Err(Error::NoSuchDesign { design: number, count }) } else { Ok(found) }
    }
}

/// Reads a table row by row.
pub struct TableRows {
    rows: Rows,
}

impl TableRows {
    /// Goes on to the next row, and says whose it is; `None` at the end.
    pub fn advance(&mut self) -> Result<Option<u64>, Error> {
        if self.rows.read()? { self.rows.whole("design").map(Some) } else { Ok(None) }
    }

    /// The joint of the row gone on to.
    pub fn joint(&self) -> Result<JointDesign, Error> {
        self.rows.joint()
    }

    /// Where a column stands, for those who read many rows; `None` where the table does not have it.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.rows.place(column)
    }

    /// A cell of the row gone on to, by the place of its column; `None` where it is empty.
    pub fn cell_at(&self, place: Option<usize>) -> Option<&str> {
        self.rows.cell_at(place?)
    }

    /// A number of the row gone on to, by the place of its column; the error names the column.
    pub fn number_at(&self, place: Option<usize>, column: &str) -> Result<Option<f64>, Error> {
        match self.cell_at(place).map(str::parse::<f64>) {
            None => Ok(None),
            Some(Ok(number)) if number.is_finite() => Ok(Some(number)),
            Some(_) => self.rows.optional_number(column),
        }
    }

    /// The row gone on to.
    pub fn row(&self) -> Result<TableRow, Error> {
        let number = |name: &str| self.rows.optional_number(name);
        let word = |name: &str| self.rows.cell(name).unwrap_or_default().to_string();
        Ok(TableRow {
            design: self.rows.whole("design")?,
            joint: self.rows.joint()?,
            indentation: number(INDENTATION)?,
            force: number(FORCE)?,
            tangent_stiffness: number("tangent_stiffness_n_per_mm")?,
            force_error: number("force_error")?,
            linearity_error: number("linearity_error")?,
            method: word("method"),
            status: word("status"),
        })
    }
}
