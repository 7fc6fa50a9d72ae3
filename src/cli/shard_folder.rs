//! The folder of a sweep in shards: which shards are in it, and the scripts of `jointsweep submit`.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use jointsweep::Error;
use jointsweep::internals::output::folder::MANIFEST;
use jointsweep::internals::output::slurm::{ARRAY, FOLDER, read_array};
use jointsweep::internals::output::survey::{Survey, survey};

/// The shards of a folder, of which none may be there yet where it holds the scripts of `submit`.
pub fn shards(dir: &Path) -> Result<Survey, Error> {
    let refuse = |problem: String| Err(Error::NoResult { dir: dir.into(), problem });
    let asked = match std::fs::read_to_string(script(dir)) {
        Ok(text) => read_array(&text).map(|(shards, _)| shards),
        Err(_) => None,
    };
    match (asked, has_shards(dir)?) {
        (Some(asked), false) => Ok(Survey { of: asked, missing: (1..=asked).collect(), ..Survey::default() }),
        (None, false) => refuse("holds no shards, nor scripts of `jointsweep submit`".into()),
        (asked, true) => {
            let survey = survey(dir, &mut drop)?;
            match asked.filter(|asked| *asked != survey.of) {
                Some(asked) => {
                    refuse(format!("holds shards of a sweep in {}, and scripts for {asked}", survey.of))
                }
                None => Ok(survey),
            }
        }
    }
}

/// Where an array's script is.
pub fn script(dir: &Path) -> PathBuf {
    dir.join(FOLDER).join(ARRAY)
}

/// Whether anything there is called as shards are.
pub fn has_shards(dir: &Path) -> Result<bool, Error> {
    let entries = match std::fs::read_dir(dir) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(source) => return Err(Error::Io { action: "read", path: dir.into(), source }),
    };
    let is_shard = |name: &str| name.starts_with("shard-") && name.contains("-of-");
    Ok(entries.flatten().any(|entry| entry.file_name().to_str().is_some_and(is_shard)))
}

/// From the root on, for jobs that begin somewhere else; in characters that a script can hold.
pub fn absolute(path: &Path) -> Result<PathBuf, Error> {
    let absolute = std::path::absolute(path);
    absolute.map_err(|source| Error::Io { action: "find", path: path.into(), source })
}

/// Whether a folder has a merged result.
pub fn is_merged(dir: &Path) -> bool {
    dir.join(MANIFEST).is_file()
}
