//! The folder of a result: where it is, what is in it, and whether it may be written.
//!
//! A result that is whole has its own names, like `table.csv` and `manifest.json`. What a run writes has `.partial` behind its
//! name until the run is complete.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::manifest_parts::State;
use crate::output::origin::{Inputs, Origin};
use crate::output::whole_file::with_suffix;
use crate::study::config::Study;
use crate::study::fingerprint::Fingerprint;
use crate::study::output_options::Format;

pub const TABLE: &str = "table.csv";
pub const TABLE_ZST: &str = "table.csv.zst";
pub const TABLE_PARQUET: &str = "table.parquet";
/// A result has one of these.
pub const TABLES: [&str; 3] = [TABLE, TABLE_ZST, TABLE_PARQUET];
pub const LAWS: &str = "laws.csv";
pub const MANIFEST: &str = "manifest.json";
/// Of a run that goes on: the manifest as it was when all it speaks of was last known to be on the disk.
pub const SAFE: &str = "manifest.safe.json";

/// The name of a table's file.
pub fn table_name(format: Format) -> &'static str {
    match format {
        Format::Csv => TABLE,
        Format::CsvZst => TABLE_ZST,
        Format::Parquet => TABLE_PARQUET,
    }
}

/// What a command leaves in a folder besides the manifest.
#[derive(Debug)]
pub struct Contents {
    /// As its manifests name it; runs do not.
    command: Option<&'static str>,
    files: &'static [&'static str],
}

pub static RUN: Contents = Contents {
    command: None,
    files: &[
        TABLE,
        TABLE_ZST,
        TABLE_PARQUET,
        LAWS,
        "statistics.csv",
        "best.csv",
        "pareto.csv",
        "histogram.csv",
    ],
};
pub static TRADEOFF: Contents =
    Contents { command: Some("tradeoff"), files: &["tradeoff.csv", "front.csv", "tradeoff.svg"] };
pub static CALIBRATION: Contents =
    Contents { command: Some("calibrate"), files: &["calibration.csv", "residuals.csv", "residuals.svg"] };
pub static GPU_BENCHMARK: Contents = Contents {
    command: Some("bench-gpu"),
    files: &["precisions.csv", "scaling.csv", "answers.csv", "kernels.csv", "peaks.csv"],
};
pub static SENSITIVITY: Contents =
    Contents { command: Some("sensitivity"), files: &["sensitivity.csv", "sensitivity.svg"] };

/// What may be put in the place of what is there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Permissions {
    /// The result of another config, or files that nobody vouches for.
    pub force: bool,
    /// A result of the same config, finished or not; what was begun in its place goes on, unless `force` is given, too.
    pub again: bool,
}

/// Whether there is anything to do.
#[derive(Debug)]
pub enum Verdict {
    ToDo,
    /// The same config was run before, to the end.
    Done(Box<Origin>),
    /// The same config was run before, but not to the end.
    Begun(Box<Origin>),
}

/// The folder of a result, which may not be there yet.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    dir: PathBuf,
    contents: &'static Contents,
}

impl ResultFolder {
    pub fn new(contents: &'static Contents, dir: PathBuf) -> ResultFolder {
        ResultFolder { dir, contents }
    }

    /// Of a run: `dir`, or `out/<config's name>`.
    pub fn of_run(dir: Option<&Path>, study: &Study) -> ResultFolder {
        let dir = dir.map_or_else(|| Path::new("out").join(study.name()), Path::to_path_buf);
        ResultFolder::new(&RUN, dir)
    }

    /// Looks whether the study's result may be written here: not over a result of another config or command, nor over files that
    /// no manifest vouches for, unless that is permitted. Writes nothing.
    pub fn check(&self, study: &Study, permissions: Permissions) -> Result<Verdict, Error> {
        let in_the_way = |path: &PathBuf| study.designs_file().is_some_and(|file| is_same_file(file, path));
        if let Some(path) = self.files().flat_map(|path| [partial(&path), path]).find(in_the_way) {
            return Err(Error::DesignsInTheWay { path });
        }
        self.check_for(&Inputs::of(study), permissions)
    }

    /// The same for a config that need not be there.
    pub fn check_for(&self, inputs: &Inputs, permissions: Permissions) -> Result<Verdict, Error> {
        let taken = |occupant| Error::FolderTaken { dir: self.dir.clone(), occupant };
        // Files that wait for their names take the place of what was there.
        let whole = match self.unnamed() {
            Some(_) => Occupant::Nobody,
            None => self.occupant(inputs, &self.manifest(), |path| path)?,
        };
        let unfinished = self.occupant(inputs, &partial(&self.manifest()), |path| partial(&path))?;
        match (whole, unfinished) {
            (Occupant::Other(occupant), _) | (_, Occupant::Other(occupant)) if !permissions.force => {
                Err(taken(occupant))
            }
            (_, Occupant::Same(origin)) if permissions.again && origin.begun_anew && !permissions.force => {
                Ok(Verdict::Begun(origin))
            }
            (_, _) if permissions.again => Ok(Verdict::ToDo),
            (Occupant::Same(origin), _) => match self.changed(&origin) {
                None => Ok(Verdict::Done(origin)),
                Some(_) if permissions.force => Ok(Verdict::ToDo),
                Some(file) if self.dir.join(&file).exists() => {
                    Err(taken(format!("a {file} that was changed after it was written")))
                }
                Some(file) => Err(taken(format!("a result whose {file} is missing"))),
            },
            (_, Occupant::Same(origin)) => Ok(Verdict::Begun(origin)),
            _ => Ok(Verdict::ToDo),
        }
    }

    /// Refuses a file that is read and would be written, with whatever permission.
    pub fn refuse_overwriting(&self, read: &Path) -> Result<(), Error> {
        let files = self.files().chain([self.manifest()]);
        let in_the_way = files.flat_map(|path| [partial(&path), path]).find(|path| is_same_file(read, path));
        in_the_way.map_or(Ok(()), |path| Err(Error::InputInTheWay { path }))
    }

    /// What a manifest says of the files beside it, `name` being where they are.
    fn occupant(
        &self,
        inputs: &Inputs,
        manifest: &Path,
        name: impl Fn(PathBuf) -> PathBuf,
    ) -> Result<Occupant, Error> {
        let text = match std::fs::read(manifest) {
            Ok(text) => String::from_utf8_lossy(&text).into_owned(),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                // A run that is killed when it has made its files and not yet its manifest leaves them empty.
                let is_something = |path: &PathBuf| path.metadata().is_ok_and(|file| file.len() > 0);
                let left = self.files().map(name).find(is_something);
                return Ok(left.map_or(Occupant::Nobody, |path| {
                    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                    Occupant::Other(format!("a {file} without a {MANIFEST}"))
                }));
            }
            Err(source) => return Err(Error::Io { action: "read", path: manifest.into(), source }),
        };
        Ok(match Origin::of(&text) {
            None => Occupant::Other(format!("a {MANIFEST} that {}", Origin::complaint(&text))),
            Some(origin) if origin.command.as_deref() != self.contents.command => {
                let command = origin.command.as_deref().unwrap_or("run");
                Occupant::Other(format!("the result of `jointsweep {command}` for {}", origin.inputs.path))
            }
            Some(origin) if origin.inputs == *inputs => Occupant::Same(Box::new(origin)),
            Some(Origin { inputs: own, .. }) if own.text == inputs.text => {
                Occupant::Other(format!("the result of {} for another list of designs", own.path))
            }
            Some(Origin { inputs: own, .. }) if own.path == inputs.path => Occupant::Other(format!(
                "the result of {} as it was before its last change, or with other values set",
                own.path
            )),
            Some(origin) => Occupant::Other(format!("the result of another config ({})", origin.inputs.path)),
        })
    }

    /// A complete result whose files do not all have their own names yet, and where each file is: it is being given them, or
    /// who did so was killed.
    pub fn unnamed(&self) -> Option<(Origin, Vec<PathBuf>)> {
        let text = std::fs::read_to_string(partial(&self.manifest())).ok()?;
        let origin = Origin::of(&text).filter(|origin| origin.state == Some(State::Complete))?;
        let place = |(name, print): &(String, Fingerprint)| {
            let path = self.dir.join(name);
            [partial(&path), path].into_iter().find(|path| is_still(path, print))
        };
        let places: Option<Vec<PathBuf>> = origin.files.iter().map(place).collect();
        places.map(|places| (origin, places))
    }

    /// The first of a result's files that is not what its manifest says.
    fn changed(&self, origin: &Origin) -> Option<String> {
        let is_changed = |(name, print): &&(String, Fingerprint)| !is_still(&self.dir.join(name), print);
        origin.files.iter().find(is_changed).map(|(name, _)| name.clone())
    }

    /// The table of a run of this study, or the folder where it writes none.
    pub fn table(&self, study: &Study) -> PathBuf {
        if study.writes_table() { self.dir.join(table_name(study.output.format)) } else { self.dir.clone() }
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The names of what is written here besides the manifest.
    pub fn file_names(&self) -> &'static [&'static str] {
        self.contents.files
    }

    /// What is written here besides the manifest.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.file_names().iter().map(|file| self.dir.join(file))
    }

    pub fn manifest(&self) -> PathBuf {
        self.dir.join(MANIFEST)
    }
}

/// Who has left something in a folder.
enum Occupant {
    Nobody,
    /// The same config, with the same list of designs.
    Same(Box<Origin>),
    /// Somebody else, in words.
    Other(String),
}

/// The name of a file that is not whole yet.
pub fn partial(path: &Path) -> PathBuf {
    with_suffix(path, ".partial")
}

/// Whether a file is what it was; its length alone tells of most that are not.
pub fn is_still(path: &Path, print: &Fingerprint) -> bool {
    let is_as_long = path.metadata().is_ok_and(|file| file.len() == print.bytes);
    is_as_long && Fingerprint::of_file(path).is_ok_and(|now| now == *print)
}

/// True when both are there and are one file.
fn is_same_file(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}
