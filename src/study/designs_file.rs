//! A CSV list of designs, one load case a row: read row by row, so that its length does not matter.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::error::{Error, shortened, suggest};
use crate::mechanics::body::{MAX_PARAMETERS, Shape, Side};
use crate::mechanics::material::{Idealization, Material};
use crate::study::columns::{
    Cell, Column, Extras, FORCE, INDENTATION, LayerQuantity, OFFSET, joint_columns, layers_in,
};
use crate::study::design::{DesignCase, JointDesign, Limits, Load, Part, refuse_clearance};
use crate::study::fingerprint::{Fingerprint, Fingerprinted};
use crate::study::layers::{Layer, LayerCounts, Layers};
use crate::study::line_guard::LineGuard;

/// A list of designs that has been read once and found good.
#[derive(Clone, Debug)]
pub struct DesignsFile {
    path: PathBuf,
    row_count: u64,
    fingerprint: Fingerprint,
    /// Inputs that are the same in all rows.
    constants: Vec<(Column, Cell)>,
    extras: Extras,
}

impl DesignsFile {
    /// Reads and checks every row.
    pub fn open(path: PathBuf) -> Result<DesignsFile, Error> {
        let mut rows = Rows::open(&path, None)?;
        let mut row_count = 0;
        let mut constants = Vec::new();
        let columns = joint_columns(rows.layers);
        let mut extras = rows.extras();
        for case in rows.by_ref() {
            let joint = case?.joint;
            extras.offset |= joint.is_press_fit();
            extras.peak_angle |= joint.is_lopsided_fit();
            match row_count {
                0 => constants.extend(columns.iter().map(|column| (*column, column.cell(&joint)))),
                _ => constants.retain(|(column, cell)| column.cell(&joint) == *cell),
            }
            row_count += 1;
        }
        if row_count == 0 {
            return Err(rows.error(Some(1), "", "there is no row below the header".to_string()));
        }
        Ok(DesignsFile { fingerprint: rows.fingerprint(), path, row_count, constants, extras })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn row_count(&self) -> u64 {
        self.row_count
    }

    /// The inputs that are the same in all rows, in the order of the table's columns.
    pub fn constants(&self) -> &[(Column, Cell)] {
        &self.constants
    }

    /// Which columns it has of those that only some have.
    pub fn extras(&self) -> Extras {
        self.extras
    }

    /// Of the file as it was when it was checked.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// The designs, in the order of the rows; an error at the end where the file is no longer the one that was checked.
    pub fn rows(&self) -> Result<Rows, Error> {
        Rows::open(&self.path, Some(self.clone()))
    }
}

/// How the text of a file is read.
pub type OpenText = fn(&Path) -> std::io::Result<Box<dyn Read + Send>>;

/// A file that is text as it stands.
pub fn open_plain(path: &Path) -> std::io::Result<Box<dyn Read + Send>> {
    Ok(Box::new(File::open(path)?))
}

/// The designs of a list, as they are read.
pub struct Rows {
    path: PathBuf,
    open: OpenText,
    reader: csv::Reader<Guarded>,
    record: StringRecord,
    /// Where the header has each column a list may have; `None` when it was left out. Constants stand behind the columns.
    places: Vec<(String, Option<usize>)>,
    /// Cells that are the same in all rows and stand in none.
    constants: Vec<String>,
    layers: LayerCounts,
    next: u64,
    /// What the file was when it was checked.
    checked: Option<DesignsFile>,
    failed: bool,
}

/// Whether a column is that of a layer.
fn is_of_layer(name: &str) -> bool {
    layers_in(std::iter::once(name)) != LayerCounts::NONE
}

type Guarded = LineGuard<Fingerprinted<Box<dyn Read + Send>>>;

impl Rows {
    fn open(path: &Path, checked: Option<DesignsFile>) -> Result<Rows, Error> {
        let mut names: Vec<String> = joint_columns(LayerCounts::MOST).iter().map(Column::name).collect();
        names.extend([INDENTATION, OFFSET, FORCE].map(String::from));
        Ok(Rows { checked, ..Rows::open_columns(path, open_plain, &names)? })
    }

    /// Of any file whose columns are among these.
    pub fn open_columns(path: &Path, open: OpenText, names: &[String]) -> Result<Rows, Error> {
        let file = open(path).map_err(|source| unreadable(path, source))?;
        let guarded = LineGuard::new(Fingerprinted::new(file));
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(guarded);
        let header = match reader.headers() {
            Ok(header) => header.clone(),
            Err(error) => return Err(csv_error(path, open, reader.get_ref(), error)),
        };
        let refuse = |key: &str, problem: String| Error::Input {
            file: path.to_path_buf(),
            line: Some(1),
            key: key.to_string(),
            problem,
        };
        for (place, found) in header.iter().enumerate() {
            if !names.iter().any(|name| name == found) {
                let allowed: Vec<&str> = names.iter().map(String::as_str).collect();
                let separator =
                    if found.contains([';', '\t']) { "columns are separated by commas; " } else { "" };
                return Err(refuse(
                    &shortened(found),
                    format!("unknown column; {separator}{}", suggest(found, &allowed)),
                ));
            }
            if header.iter().take(place).any(|earlier| earlier == found) {
                return Err(refuse(found, "the column stands there twice".to_string()));
            }
        }
        let layers = layers_in(header.iter());
        let place = |name: &String| (name.clone(), header.iter().position(|found| found == name));
        Ok(Rows {
            path: path.to_path_buf(),
            open,
            reader,
            record: StringRecord::new(),
            // Few lists have layers, and none has all.
            places: names
                .iter()
                .map(place)
                .filter(|(name, place)| place.is_some() || !is_of_layer(name))
                .collect(),
            constants: Vec::new(),
            layers,
            next: 0,
            checked: None,
            failed: false,
        })
    }

    /// Gives every row a cell in a column that the header has left out.
    pub fn add_constant(&mut self, name: &str, cell: String) {
        // Every row has as many cells as the header, which was read.
        let columns = self.reader.headers().map_or(0, StringRecord::len);
        let behind = columns + self.constants.len();
        match self.places.iter_mut().find(|(own, _)| own == name) {
            Some((_, Some(_))) => return,
            Some((_, place)) => *place = Some(behind),
            // Left out of the places as well.
            None if is_of_layer(name) => self.places.push((name.to_string(), Some(behind))),
            None => return,
        }
        self.constants.push(cell);
        self.layers = self.layers.and(layers_in(std::iter::once(name)));
    }

    /// Goes on to the next row; `false` at the end.
    pub fn read(&mut self) -> Result<bool, Error> {
        let found = self.reader.read_record(&mut self.record);
        found.map_err(|error| csv_error(&self.path, self.open, self.reader.get_ref(), error))
    }

    fn advance(&mut self) -> Result<Option<DesignCase>, Error> {
        let found = self.read()?;
        if let Some(checked) = &self.checked {
            let is_over = self.next == checked.row_count;
            if found == is_over || (is_over && self.fingerprint() != checked.fingerprint) {
                let problem = "the file has changed since it was checked, before the sweep began";
                return Err(self.error(None, "", problem.to_string()));
            }
        }
        if !found {
            return Ok(None);
        }
        let joint = self.joint()?;
        let case = DesignCase { index: self.next, steps: [self.load(&joint)?].into(), joint };
        self.next += 1;
        Ok(Some(case))
    }

    /// Of what has been read: at the end, of the file.
    pub fn fingerprint(&self) -> Fingerprint {
        self.reader.get_ref().inner().fingerprint()
    }

    /// The joint of the current row.
    pub fn joint(&self) -> Result<JointDesign, Error> {
        let hole_radius = self.number(&Column::HoleRadius.name(), Limits::POSITIVE)?;
        let clearance_name = Column::RadialClearance.name();
        let radial_clearance = self.number(&clearance_name, Limits::ANY)?;
        if let Some(problem) = refuse_clearance(radial_clearance, hole_radius) {
            return Err(self.complain(&clearance_name, format!("`{radial_clearance}`: {problem}")));
        }
        let idealizations = Idealization::ALL.map(|one| one.name());
        Ok(JointDesign {
            idealization: Idealization::ALL[self.word(&Column::Idealization.name(), &idealizations)?],
            hole_radius,
            radial_clearance,
            thickness: self.number(&Column::Thickness.name(), Limits::POSITIVE)?,
            pin: self.part(Side::Pin)?,
            plate: self.part(Side::Plate)?,
        })
    }

    fn part(&self, side: Side) -> Result<Part, Error> {
        let shapes: Vec<&'static Shape> = Shape::of_side(side).collect();
        let names: Vec<&str> = shapes.iter().map(|shape| shape.name).collect();
        let shape = shapes[self.word(&Column::Model(side).name(), &names)?];
        let mut parameters = [0.0; MAX_PARAMETERS];
        for (slot, parameter) in parameters.iter_mut().zip(shape.parameters) {
            *slot = match (self.cell(parameter.name), parameter.default) {
                (None, Some(default)) => default,
                _ => self.number(parameter.name, Limits::of_parameter(parameter))?,
            };
        }
        // A filled cell that nothing reads is a misunderstanding; better said than passed over.
        for other in shapes.iter().flat_map(|other| other.parameters) {
            let used = shape.parameters.iter().any(|parameter| parameter.name == other.name);
            if let (false, Some(value)) = (used, self.cell(other.name)) {
                return Err(self.complain(other.name, unused(value, shape)));
            }
        }
        let support_name = Column::Support(side).name();
        let support = match self.cell(&support_name) {
            None => 0,
            Some(value) if shape.supports.is_empty() => {
                return Err(self.complain(&support_name, unused(value, shape)));
            }
            Some(_) => self.word(&support_name, shape.supports)?,
        };
        let material = Material {
            youngs_modulus: self.number(&Column::YoungsModulus(side).name(), Limits::POSITIVE)?,
            poissons_ratio: self.number(&Column::PoissonsRatio(side).name(), Limits::POISSONS_RATIO)?,
        };
        let layers = self.part_layers(side)?;
        Ok(Part { shape, parameters, support, material, yield_stress: None, layers })
    }

    /// The layers of a part, from the contact on: those whose cells are filled.
    fn part_layers(&self, side: Side) -> Result<Layers, Error> {
        let mut layers = Vec::new();
        let mut empty: Option<String> = None;
        for layer in 0..self.layers.of(side) {
            let names = LayerQuantity::ALL.map(|quantity| Column::Layer(side, layer, quantity).name());
            let Some(filled) = names.iter().find(|name| self.cell(name).is_some()) else {
                empty.get_or_insert(names[0].clone());
                continue;
            };
            if let Some(empty) = empty {
                let problem =
                    format!("`{empty}` is empty: layers are counted from the contact without a gap");
                return Err(self.complain(filled, problem));
            }
            let [thickness, youngs_modulus, poissons_ratio] = &names;
            let thickness = self.number(thickness, Limits::POSITIVE)?;
            let material = Material {
                youngs_modulus: self.number(youngs_modulus, Limits::POSITIVE)?,
                poissons_ratio: self.number(poissons_ratio, Limits::POISSONS_RATIO)?,
            };
            layers.push(Layer::new(thickness, material));
        }
        Ok(Layers::new(layers))
    }

    fn load(&self, joint: &JointDesign) -> Result<Load, Error> {
        type Make = fn(f64) -> Load;
        let loads: [(&str, Make); 3] =
            [(INDENTATION, Load::Indentation), (OFFSET, Load::Offset), (FORCE, Load::Force)];
        let mut given = loads.iter().filter(|(name, _)| self.cell(name).is_some());
        let Some((name, make)) = given.next() else {
            return Err(self.complain(INDENTATION, format!("the row needs this, `{OFFSET}` or `{FORCE}`")));
        };
        if let Some((other, _)) = given.next() {
            return Err(self.complain(other, format!("`{name}` is given, too; a row has only one load")));
        }
        if *name == INDENTATION && joint.is_press_fit() {
            let problem = format!("a press fit has no indentation; give `{OFFSET}` or `{FORCE}`");
            return Err(self.complain(INDENTATION, problem));
        }
        Ok(make(self.number(name, Limits::NOT_NEGATIVE)?))
    }

    /// How many layers the columns are for.
    pub fn layer_counts(&self) -> LayerCounts {
        self.layers
    }

    fn extras(&self) -> Extras {
        Extras {
            layers: self.layers,
            offset: self.place(OFFSET).is_some(),
            peak_angle: self.layers != LayerCounts::NONE,
        }
    }

    /// The cell of the current row; `None` when it is empty or its column was left out.
    pub fn cell(&self, name: &str) -> Option<&str> {
        self.cell_at(self.place(name)?)
    }

    /// Where a column stands in each row; `None` when the header has left it out.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.places.iter().find(|place| place.0 == name)?.1
    }

    /// What stands at a place of the current row: what `cell` gives, without a search for the name.
    pub fn cell_at(&self, place: usize) -> Option<&str> {
        let constant = || self.constants.get(place.checked_sub(self.record.len())?).map(String::as_str);
        self.record.get(place).or_else(constant).filter(|cell| !cell.is_empty())
    }

    fn needed(&self, name: &str) -> Result<&str, Error> {
        let left_out = self.places.iter().any(|place| place.0 == name && place.1.is_none());
        self.cell(name).ok_or_else(|| {
            let problem =
                if left_out { "the column is missing; this row needs it" } else { "the cell is empty" };
            self.complain(name, problem.to_string())
        })
    }

    /// A finite number within limits.
    pub fn number(&self, name: &str, limits: Limits) -> Result<f64, Error> {
        let cell = self.needed(name)?;
        let refuse = |problem: String| self.complain(name, format!("`{}`: {problem}", shortened(cell)));
        let number: f64 = cell.parse().map_err(|_| refuse("not a number".to_string()))?;
        if !number.is_finite() {
            return Err(refuse("the number is not finite".to_string()));
        }
        limits.refuse(number).map_err(refuse)?;
        Ok(number)
    }

    /// A finite number, where there is one.
    pub fn optional_number(&self, name: &str) -> Result<Option<f64>, Error> {
        self.cell(name).map(|_| self.number(name, Limits::ANY)).transpose()
    }

    /// A whole number.
    pub fn whole(&self, name: &str) -> Result<u64, Error> {
        let cell = self.needed(name)?;
        let refuse = |_| self.complain(name, format!("`{}`: not a whole number", shortened(cell)));
        cell.parse().map_err(refuse)
    }

    fn word(&self, name: &str, allowed: &[&str]) -> Result<usize, Error> {
        let cell = self.needed(name)?;
        let problem = || format!("`{}`: not known; {}", shortened(cell), suggest(cell, allowed));
        let found = allowed.iter().position(|&word| word == cell);
        found.ok_or_else(|| self.complain(name, problem()))
    }

    /// A complaint about the current row.
    pub fn complain(&self, column: &str, problem: String) -> Error {
        self.error(
            self.record.position().and_then(|position| line_of(&self.path, self.open, position)),
            column,
            problem,
        )
    }

    fn error(&self, line: Option<u64>, column: &str, problem: String) -> Error {
        Error::Input { file: self.path.clone(), line, key: column.to_string(), problem }
    }
}

impl Iterator for Rows {
    type Item = Result<DesignCase, Error>;

    /// Ends after the first error.
    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let case = self.advance().transpose();
        self.failed = matches!(case, Some(Err(_)));
        case
    }
}

fn unused(value: &str, shape: &Shape) -> String {
    format!("`{}`: model `{}` does not use this column; leave the cell empty", shortened(value), shape.name)
}

/// The line, from 1, of the row at `position`. Counted anew: the reader's own count runs ahead of blank lines and
/// of the second half of a Windows line end. `None` when the file can no longer be read.
fn line_of(path: &Path, open: OpenText, position: &csv::Position) -> Option<u64> {
    let mut line = 1;
    for (place, byte) in (0..).zip(BufReader::new(open(path).ok()?).bytes()) {
        let byte = byte.ok()?;
        if place >= position.byte() && byte != b'\r' && byte != b'\n' {
            break;
        }
        line += u64::from(byte == b'\n');
    }
    Some(line)
}

fn unreadable(path: &Path, source: std::io::Error) -> Error {
    Error::Io { action: "read", path: path.to_path_buf(), source }
}

fn csv_error(path: &Path, open: OpenText, guard: &Guarded, error: csv::Error) -> Error {
    let mut line = error.position().and_then(|position| line_of(path, open, position));
    let problem = match error.into_kind() {
        csv::ErrorKind::Io(source) if source.kind() == ErrorKind::InvalidData => {
            line = Some(guard.line());
            source.to_string()
        }
        csv::ErrorKind::Io(source) => return unreadable(path, source),
        csv::ErrorKind::Utf8 { .. } => "this is not UTF-8 text".to_string(),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} cells, the header has {expected_len}")
        }
        other => format!("not readable as CSV: {other:?}"),
    };
    Error::Input { file: path.to_path_buf(), line, key: String::new(), problem }
}
