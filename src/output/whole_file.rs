//! Files that nobody meets half written: the bytes go into a file beside the one they are for, which then takes its name.

use std::path::{Path, PathBuf};

use crate::error::Error;

/// A folder with those it is in, where they are not there.
pub fn create_dir(dir: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(dir).map_err(|source| Error::Io { action: "create", path: dir.into(), source })
}

/// A path whose file name ends with something more.
pub fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(suffix);
    path.with_file_name(name)
}

/// Where a file waits before it is published.
pub fn staged(path: &Path) -> PathBuf {
    with_suffix(path, ".tmp")
}

/// Writes bytes where a file waits before it is published; nothing stays there where that fails.
pub fn stage_bytes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let staged = staged(path);
    std::fs::write(&staged, bytes).map_err(|source| {
        let _ = std::fs::remove_file(&staged);
        Error::Io { action: "write", path: path.into(), source }
    })
}

/// Puts a staged file in place.
pub fn publish(path: &Path) -> Result<(), Error> {
    let into_error = |source| Error::Io { action: "write", path: path.into(), source };
    std::fs::rename(staged(path), path).map_err(into_error)
}

/// Writes a file so that nobody meets half of it.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    stage_bytes(path, bytes)?;
    publish(path)
}
