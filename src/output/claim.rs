//! A folder claimed for a new result: one process at a time writes there, and the result takes the place of the one before.
//!
//! When a run is complete its files are renamed from their `.partial` names, the manifest last. So what stood there before stays
//! until something whole takes its place, however a run ends.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::folder::{ResultFolder, SAFE, partial};
use crate::output::lock::FolderLock;
use crate::output::whole_file::staged;

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

/// To have a folder that others remove again and again.
const MOST_TRIES: usize = 1000;

impl ResultFolder {
    /// Creates the folder and takes its lock; `what` is to be said of the holder to others.
    pub fn claim(&self, what: &str) -> Result<Claim, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            match self.create_and_lock(what) {
                Err(Error::Io { source, .. }) if self.was_removed(&source) && tries < MOST_TRIES => {}
                taken => {
                    let (created, lock) = taken?;
                    self.settle()?;
                    return Ok(Claim { folder: self.clone(), created, lock: Some(lock), is_to_go: false });
                }
            }
        }
    }

    /// The folders that were not there before, outermost first, and the lock; without it they go again.
    fn create_and_lock(&self, what: &str) -> Result<(Vec<PathBuf>, FolderLock), Error> {
        let created = self.create()?;
        match FolderLock::take(self.dir(), what) {
            Ok(lock) => Ok((created, lock)),
            Err(error) => {
                remove_empty(&created);
                Err(error)
            }
        }
    }

    /// Whether an error comes of others who remove the folder meanwhile: it was gone when something was to be put there, or when what had been in
    /// the way of making it was looked at.
    fn was_removed(&self, error: &std::io::Error) -> bool {
        match error.kind() {
            ErrorKind::NotFound => true,
            ErrorKind::AlreadyExists => !self.dir().is_file(),
            _ => false,
        }
    }

    /// Creates the folder, and returns the folders that were not there before, outermost first.
    fn create(&self) -> Result<Vec<PathBuf>, Error> {
        let missing = |dir: &&Path| !dir.as_os_str().is_empty() && !dir.exists();
        let mut created: Vec<PathBuf> =
            self.dir().ancestors().take_while(missing).map(Path::to_path_buf).collect();
        created.reverse();
        if let Err(source) = std::fs::create_dir_all(self.dir()) {
            remove_empty(&created);
            return Err(Error::Io { action: "create", path: self.dir().into(), source });
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
        left.push(partial(&self.dir().join(SAFE)));
        left.iter().try_for_each(|path| remove_file(path))
    }

    /// Ends what a process that was killed between its renames has left undone.
    fn settle(&self) -> Result<(), Error> {
        let Some((origin, places)) = self.unnamed() else { return Ok(()) };
        for ((name, _), found) in origin.files.iter().zip(places) {
            let path = self.dir().join(name);
            if found != path {
                rename(&found, &path)?;
            }
        }
        rename(&partial(&self.manifest()), &self.manifest())?;
        let is_new = |path: &PathBuf| origin.files.iter().any(|(name, _)| self.dir().join(name) == *path);
        let mut others = self.files().filter(|path| !is_new(path)).chain([partial(&self.dir().join(SAFE))]);
        others.try_for_each(|path| remove_file(&path))
    }
}

impl Claim {
    pub fn folder(&self) -> &ResultFolder {
        &self.folder
    }

    /// Where a file is written until it is whole.
    pub fn partial(&self, name: &str) -> PathBuf {
        partial(&self.folder.dir().join(name))
    }

    /// Removes what an unfinished run before has left of files that this one does not write.
    pub fn remove_others<'a>(&self, own: impl Iterator<Item = &'a str>) -> Result<(), Error> {
        let own: Vec<&str> = own.collect();
        let mut others = self.folder.file_names().iter().filter(|name| !own.contains(*name)).chain([&SAFE]);
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
            remove_empty(&[self.folder.dir().into()]);
        }
        remove_empty(&self.created);
    }
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
