//! The folder of a result: where it is, and when it may be written.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::manifest::origin;
use crate::study::config::Study;

pub const TABLE: &str = "table.csv";
pub const MANIFEST: &str = "manifest.json";

/// What a command leaves in a folder besides the manifest.
#[derive(Debug)]
pub struct Contents {
    /// As its manifests name it; runs do not.
    command: Option<&'static str>,
    files: &'static [&'static str],
}

pub static RUN: Contents = Contents { command: None, files: &[TABLE] };
pub static TRADEOFF: Contents =
    Contents { command: Some("tradeoff"), files: &["tradeoff.csv", "front.csv", "tradeoff.svg"] };

/// A folder that a study's result may be written to.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    dir: PathBuf,
    contents: &'static Contents,
}

impl ResultFolder {
    /// Looks whether `dir` (`out/<config's name>` unless named) is free for the study's result: it is not when
    /// it holds a result of another config, or a table nobody vouches for, unless `force`. Writes nothing.
    pub fn check(dir: Option<&Path>, study: &Study, force: bool) -> Result<ResultFolder, Error> {
        let dir = dir.map_or_else(|| Path::new("out").join(study.name()), Path::to_path_buf);
        ResultFolder::check_for(&RUN, dir, study, force)
    }

    /// The same for what a command leaves behind; a result of another command is in its way, too.
    pub fn check_for(
        contents: &'static Contents,
        dir: PathBuf,
        study: &Study,
        force: bool,
    ) -> Result<ResultFolder, Error> {
        let folder = ResultFolder { dir, contents };
        let in_the_way = |path: &PathBuf| study.designs_file().is_some_and(|file| is_same_file(file, path));
        if let Some(path) = folder.files().find(in_the_way) {
            return Err(Error::DesignsInTheWay { path });
        }
        match folder.occupant(study)? {
            Some(occupant) if !force => Err(Error::FolderTaken { dir: folder.dir, occupant }),
            _ => Ok(folder),
        }
    }

    /// What is there already and is not this config's own.
    fn occupant(&self, study: &Study) -> Result<Option<String>, Error> {
        let path = self.manifest();
        let manifest = match std::fs::read(&path) {
            Ok(manifest) => String::from_utf8_lossy(&manifest).into_owned(),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                let left = self.contents.files.iter().find(|file| self.dir.join(file).exists());
                return Ok(left.map(|file| format!("a {file} without a {MANIFEST}")));
            }
            Err(source) => return Err(Error::Io { action: "read", path, source }),
        };
        Ok(match origin(&manifest) {
            None => Some(format!("a {MANIFEST} of another program")),
            Some(origin) if origin.command.as_deref() != self.contents.command => {
                let command = origin.command.as_deref().unwrap_or("run");
                Some(format!("the result of `jointsweep {command}` for {}", origin.path))
            }
            Some(origin) if origin.text == study.source_text() => None,
            Some(origin) if Path::new(&origin.path) == study.path() => {
                Some(format!("the result of {} as it was before its last change", origin.path))
            }
            Some(origin) => Some(format!("the result of another config ({})", origin.path)),
        })
    }

    pub fn table(&self) -> PathBuf {
        self.dir.join(TABLE)
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

    /// Creates the folder, and returns the folders that were not there before, outermost first.
    pub fn create(&self) -> Result<Vec<PathBuf>, Error> {
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
}

/// Takes back what `create` made, innermost first, as far as nobody has put anything there.
pub fn remove_empty(created: &[PathBuf]) {
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
