//! The folder of a result: where it is, when it may be written, and how a new result takes the place of an old one.
//!
//! A result that is whole has its own names, like `table.csv` and `manifest.json`. What a run writes has `.partial` behind its
//! name until the run is complete; then its files are renamed, the manifest last. So what stood there before stays until
//! something whole takes its place, however a run ends.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::lock::FolderLock;
use crate::output::manifest_parts::State;
use crate::output::origin::{Inputs, Origin};
use crate::output::whole_file::{staged, with_suffix};
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
pub static SENSITIVITY: Contents =
    Contents { command: Some("sensitivity"), files: &["sensitivity.csv", "sensitivity.svg"] };

/// What may be put in the place of what is there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Permissions {
    /// The result of another config, or files that nobody vouches for.
    pub force: bool,
    /// A result of the same config, finished or not.
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
        let whole = self.occupant(inputs, &self.manifest(), |path| path)?;
        let unfinished = self.occupant(inputs, &partial(&self.manifest()), |path| partial(&path))?;
        match (whole, unfinished) {
            (Occupant::Other(occupant), _) | (_, Occupant::Other(occupant)) if !permissions.force => {
                Err(taken(occupant))
            }
            (_, _) if permissions.again => Ok(Verdict::ToDo),
            (Occupant::Same(origin), _) => match self.changed(&origin) {
                None => Ok(Verdict::Done(origin)),
                Some(_) if permissions.force => Ok(Verdict::ToDo),
                Some(file) => Err(taken(format!("a {file} that was changed after it was written"))),
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
                let left = self.files().map(name).find(|path| path.exists());
                return Ok(left.map_or(Occupant::Nobody, |path| {
                    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                    Occupant::Other(format!("a {file} without a {MANIFEST}"))
                }));
            }
            Err(source) => return Err(Error::Io { action: "read", path: manifest.into(), source }),
        };
        Ok(match Origin::of(&text) {
            None => Occupant::Other(format!("a {MANIFEST} of another program")),
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

    /// What is written here besides the manifest.
    fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.contents.files.iter().map(|file| self.dir.join(file))
    }

    pub fn manifest(&self) -> PathBuf {
        self.dir.join(MANIFEST)
    }

    /// Creates the folder and takes its lock; `what` is to be said of the holder to others.
    pub fn claim(&self, what: &str) -> Result<Claim, Error> {
        let created = self.create()?;
        match FolderLock::take(&self.dir, what) {
            Ok(lock) => {
                self.settle()?;
                Ok(Claim { folder: self.clone(), created, lock: Some(lock), is_to_go: false })
            }
            Err(error) => {
                remove_empty(&created);
                Err(error)
            }
        }
    }

    /// Creates the folder, and returns the folders that were not there before, outermost first.
    fn create(&self) -> Result<Vec<PathBuf>, Error> {
        let missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
        let mut created: Vec<PathBuf> =
            self.dir.ancestors().take_while(missing).map(Path::to_path_buf).collect();
        created.reverse();
        if let Err(source) = std::fs::create_dir_all(&self.dir) {
            remove_empty(&created);
            return Err(Error::Io { action: "create", path: self.dir.clone(), source });
        }
        Ok(created)
    }

    /// Gives the files of a complete result their own names, the manifest last. Files of the result before that the new one does
    /// not have are gone then.
    fn publish(&self) -> Result<(), Error> {
        let mut left = Vec::new();
        for path in self.files() {
            if partial(&path).exists() {
                rename(&partial(&path), &path)?;
            } else if path.exists() {
                left.push(path);
            }
        }
        rename(&partial(&self.manifest()), &self.manifest())?;
        left.push(partial(&self.dir.join(SAFE)));
        left.iter().try_for_each(|path| remove_file(path))
    }

    /// Ends what a process that was killed between its renames has left undone.
    fn settle(&self) -> Result<(), Error> {
        let Ok(text) = std::fs::read_to_string(partial(&self.manifest())) else { return Ok(()) };
        let Some(origin) = Origin::of(&text).filter(|origin| origin.state == Some(State::Complete)) else {
            return Ok(());
        };
        let place = |(name, print): &(String, Fingerprint)| {
            let path = self.dir.join(name);
            [partial(&path), path].into_iter().find(|path| is_still(path, print))
        };
        let places: Option<Vec<PathBuf>> = origin.files.iter().map(place).collect();
        let Some(places) = places else { return Ok(()) };
        for ((name, _), found) in origin.files.iter().zip(places) {
            let path = self.dir.join(name);
            if found != path {
                rename(&found, &path)?;
            }
        }
        rename(&partial(&self.manifest()), &self.manifest())?;
        let is_new = |path: &PathBuf| origin.files.iter().any(|(name, _)| self.dir.join(name) == *path);
        let mut others = self.files().filter(|path| !is_new(path)).chain([partial(&self.dir.join(SAFE))]);
        others.try_for_each(|path| remove_file(&path))
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

/// A folder that is this process's own to write to, until it is dropped.
#[derive(Debug)]
pub struct Claim {
    folder: ResultFolder,
    /// Folders made for it, outermost first; they go again where nothing is put into them.
    created: Vec<PathBuf>,
    lock: Option<FolderLock>,
    /// Whether the folder goes, too.
    is_to_go: bool,
}

impl Claim {
    pub fn folder(&self) -> &ResultFolder {
        &self.folder
    }

    /// Where a file is written until it is whole.
    pub fn partial(&self, name: &str) -> PathBuf {
        partial(&self.folder.dir.join(name))
    }

    /// Removes what an unfinished run before has left of files that this one does not write.
    pub fn remove_others<'a>(&self, own: impl Iterator<Item = &'a str>) -> Result<(), Error> {
        let own: Vec<&str> = own.collect();
        let mut others = self.folder.contents.files.iter().filter(|name| !own.contains(*name)).chain([&SAFE]);
        others.try_for_each(|name| remove_file(&self.partial(name)))
    }

    /// Gives the files of a complete result their own names.
    pub fn publish(&self) -> Result<(), Error> {
        self.folder.publish()
    }

    /// Removes the folder with what an unfinished run has left in it.
    pub fn remove(&mut self) -> Result<(), Error> {
        self.folder.files().try_for_each(|path| remove_file(&partial(&path)))?;
        remove_file(&partial(&self.folder.manifest()))?;
        remove_file(&staged(&partial(&self.folder.manifest())))?;
        remove_file(&self.partial(SAFE))?;
        // The lock goes with this claim; only then the folder is empty.
        self.is_to_go = true;
        Ok(())
    }

    /// Whether other processes can see that the folder is taken.
    pub fn is_locked(&self) -> bool {
        self.lock.as_ref().is_some_and(FolderLock::is_effective)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.lock = None;
        if self.is_to_go {
            remove_empty(std::slice::from_ref(&self.folder.dir));
        }
        remove_empty(&self.created);
    }
}

/// The name of a file that is not whole yet.
fn partial(path: &Path) -> PathBuf {
    with_suffix(path, ".partial")
}

/// Whether a file is what it was; its length alone tells of most that are not.
fn is_still(path: &Path, print: &Fingerprint) -> bool {
    let is_as_long = path.metadata().is_ok_and(|file| file.len() == print.bytes);
    is_as_long && Fingerprint::of_file(path).is_ok_and(|now| now == *print)
}

fn rename(from: &Path, to: &Path) -> Result<(), Error> {
    std::fs::rename(from, to).map_err(|source| Error::Io { action: "write", path: to.into(), source })
}

/// Removes a file that may not be there.
fn remove_file(path: &Path) -> Result<(), Error> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(Error::Io { action: "remove", path: path.into(), source })
        }
        _ => Ok(()),
    }
}

/// Takes back folders, innermost first, as far as nobody has put anything there.
fn remove_empty(created: &[PathBuf]) {
    for dir in created.iter().rev() {
        let _ = std::fs::remove_dir(dir);
    }
}

/// True when both are there and are one file.
fn is_same_file(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}
