//! One run at a time in a folder: a lock of the system's, which is gone with the process that holds it, however that ends.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::Error;
use crate::output::host::utc;

/// The file that is locked; it is there as long as a run is, or when a run was killed.
pub const LOCK: &str = ".jointsweep.lock";

/// The right to write to a folder, until it is dropped.
#[derive(Debug)]
pub struct FolderLock {
    path: PathBuf,
    /// `None` where the file system has no locks.
    file: Option<File>,
}

impl FolderLock {
    /// Takes the lock of a folder, which must be there; an error that names the holder where another process has it.
    pub fn take(dir: &Path, what: &str) -> Result<FolderLock, Error> {
        let path = dir.join(LOCK);
        loop {
            let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = match open {
                Ok(file) => file,
                Err(source) => return Err(Error::Io { action: "write", path, source }),
            };
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let mut holder = String::new();
                    let _ = file.read_to_string(&mut holder);
                    let holder = holder.trim().to_string();
                    return Err(Error::FolderInUse { dir: dir.into(), holder });
                }
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                    let _ = std::fs::remove_file(&path);
                    return Ok(FolderLock { path, file: None });
                }
                Err(TryLockError::Error(source)) => return Err(Error::Io { action: "lock", path, source }),
            }
            // Who had the lock before may have removed the file after it was opened here: that lock is of no use.
            if !is_at(&file, &path) {
                continue;
            }
            let holder = format!("{what}, process {}, since {}", std::process::id(), utc(SystemTime::now()));
            let _ = file.set_len(0).and_then(|()| writeln!(file, "{holder}"));
            return Ok(FolderLock { path, file: Some(file) });
        }
    }

    /// Whether another process can see the lock.
    pub fn is_effective(&self) -> bool {
        self.file.is_some()
    }
}

/// Before the lock goes with the file: who comes next makes a file of its own.
impl Drop for FolderLock {
    fn drop(&mut self) {
        if self.file.is_some() {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), path.metadata()) {
        (Ok(own), Ok(there)) => place(own) == place(there),
        _ => false,
    }
}

/// An open file cannot be removed there.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}
