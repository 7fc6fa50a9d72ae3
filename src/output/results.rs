//! A finished result, read again: what was asked, and its rows.

use std::path::{Path, PathBuf};

use crate::engine::status::Remark;
use crate::error::{Error, quoted};
use crate::output::folder::{MANIFEST, TABLE, TABLE_PARQUET, TABLE_ZST, TABLES, partial};
use crate::output::manifest_parts::State;
use crate::output::origin::Origin;
use crate::output::{parquet_text, zst_table};
use crate::study::columns::{DESIGN, Extras, FORCE, INDENTATION, OFFSET, Quantity, joint_columns, layers_in};
use crate::study::config::Asked;
use crate::study::design::JointDesign;
use crate::study::designs_file::{OpenText, Rows, open_plain};
use crate::study::fingerprint::Fingerprint;
use crate::study::layers::LayerCounts;
use crate::study::output_options::column_names;

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
    /// mm; `None` where the table has no column of it.
    pub offset: Option<f64>,
    pub force: Option<f64>,
    pub tangent_stiffness: Option<f64>,
    pub force_error: Option<f64>,
    pub linearity_error: Option<f64>,
    pub method: String,
    pub status: String,
}

impl TableRow {
    /// Whether there is an answer without a remark that it is uncertain. A force of 0 without contact is certain.
    pub fn is_ok(&self) -> bool {
        self.status == "ok" || self.status == Remark::NoContact.text()
    }
}

impl Results {
    /// What its config asks for.
    pub fn asked(&self) -> Result<Asked, Error> {
        let inputs = &self.origin.inputs;
        Asked::from_text(Path::new(&inputs.path), &inputs.text)
    }

    /// Of a folder that `run` has written, to its end.
    pub fn open(dir: &Path) -> Result<Results, Error> {
        let path = dir.join(MANIFEST);
        let manifest = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(_) if !path.exists() => {
                let problem = match partial(&path).exists() {
                    true => "its run is unfinished: the same `jointsweep run` goes on with it".into(),
                    false => format!("there is no {MANIFEST}: `jointsweep run` makes results"),
                };
                return Err(Error::NoResult { dir: dir.into(), problem });
            }
            Err(source) => return Err(Error::Io { action: "read", path, source }),
        };
        let refuse = |problem: String| Err(Error::NoResult { dir: dir.into(), problem });
        let Some(origin) = Origin::of(&manifest) else {
            return refuse(format!("its {MANIFEST} {}", Origin::complaint(&manifest)));
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
        self.dir.join(self.table_name())
    }

    /// Whether rows were written.
    pub fn has_table(&self) -> bool {
        self.origin.files.iter().any(|(file, _)| TABLES.contains(&file.as_str()))
    }

    /// The name of the table's file.
    pub fn table_name(&self) -> &'static str {
        let is_there = |name: &&str| self.origin.files.iter().any(|(file, _)| file == *name);
        TABLES.into_iter().find(is_there).unwrap_or(TABLE)
    }

    /// The rows in their order, as they are read. Refuses a table that has not all that tells of the joints, or not the quantities that
    /// are needed.
    pub fn rows(&self, needed: &[Quantity]) -> Result<TableRows, Error> {
        if !self.has_table() {
            let problem =
                "it has no rows, only answers: run the config with `table = true` in [output]".into();
            return Err(Error::NoResult { dir: self.dir.clone(), problem });
        }
        let open: OpenText = match self.table_name() {
            TABLE_ZST => zst_table::open_text,
            TABLE_PARQUET => parquet_text::open_text,
            _ => open_plain,
        };
        let mut rows = Rows::open_columns(&self.table(), open, &column_names(Extras::MOST))?;
        for (name, cell) in &self.origin.constants {
            rows.add_constant(name, cell.clone());
        }
        let quantities = needed.iter().map(|quantity| quantity.name().to_string());
        // Of layers all of whose columns were left out the table says nothing.
        let layers = rows.layer_counts().and(layers_in(self.origin.left_out.iter().map(String::as_str)));
        let inputs = joint_columns(layers).into_iter().map(|column| column.name());
        let needed = std::iter::once(DESIGN.to_string()).chain(inputs).chain(quantities);
        let missing: Vec<String> = needed.filter(|name| rows.place(name).is_none()).collect();
        if missing.is_empty() {
            let print = self.origin.files.iter().find(|(file, _)| file == TABLE).map(|(_, print)| *print);
            return Ok(TableRows { rows, written: print.map(|print| (self.dir.clone(), print)) });
        }
        let missing: Vec<&str> = missing.iter().map(String::as_str).collect();
        let (them, columns) = if missing.len() == 1 { ("it", "column") } else { ("them", "columns") };
        let problem = format!(
            "its {} lacks the {columns} {}: run the config with {them} in `columns` of [output], or without `columns`",
            self.table_name(),
            quoted(&missing)
        );
        Err(Error::NoResult { dir: self.dir.clone(), problem })
    }

    /// All rows of a design, by its number.
    pub fn design(&self, number: u64, needed: &[Quantity]) -> Result<Vec<TableRow>, Error> {
        let mut rows = self.rows(needed)?;
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
    /// What the file was when it was written; `None` where it is not read as it stands, and vouches for itself.
    written: Option<(PathBuf, Fingerprint)>,
}

impl TableRows {
    /// Goes on to the next row, and says whose it is; `None` at the end. There a file is refused that is no longer what it was.
    pub fn advance(&mut self) -> Result<Option<u64>, Error> {
        if self.rows.read()? {
            return self.rows.whole("design").map(Some);
        }
        match &self.written {
            Some((dir, print)) if self.rows.fingerprint() != *print => {
                let problem = format!("its {TABLE} was changed after it was written: run the config again");
                Err(Error::NoResult { dir: dir.clone(), problem })
            }
            _ => Ok(None),
        }
    }

    /// The joint of the row gone on to.
    pub fn joint(&self) -> Result<JointDesign, Error> {
        self.rows.joint()
    }

    /// The most layers of pin and plate.
    pub fn layer_counts(&self) -> LayerCounts {
        self.rows.layer_counts()
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
            offset: number(OFFSET)?,
            force: number(FORCE)?,
            tangent_stiffness: number("tangent_stiffness_n_per_mm")?,
            force_error: number("force_error")?,
            linearity_error: number("linearity_error")?,
            method: word("method"),
            status: word("status"),
        })
    }
}
