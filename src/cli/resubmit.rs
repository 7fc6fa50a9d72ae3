//! `jointsweep resubmit`: the missing shards of a sweep once more, and the merge.

use std::path::{Path, PathBuf};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::output::slurm::{quoted, read_array};

use super::sbatch::Submission;
use super::shard_folder::{absolute, is_merged, script, shards};
use super::{Ending, print};

#[derive(Args)]
pub struct ResubmitArgs {
    /// Folder of the shards, with the scripts of `jointsweep submit`
    dir: PathBuf,
    /// Submit the shards that are not complete
    #[arg(long, required = true)]
    missing: bool,
    /// Only say how they would be submitted
    #[arg(long, visible_alias = "no-submit")]
    dry_run: bool,
    /// For sbatch, in the place of what was given to `submit`; options that are not named here stay
    #[arg(last = true, value_name = "SBATCH ARGUMENTS")]
    sbatch: Vec<String>,
}

pub fn resubmit(args: &ResubmitArgs) -> Result<Ending, Error> {
    let survey = shards(&args.dir)?;
    if survey.missing.is_empty() && is_merged(&args.dir) {
        print(&format!("all {} shards are complete and merged: there is nothing to submit\n", survey.of))?;
        return Ok(Ending::Complete);
    }
    let dir = absolute(&args.dir)?;
    check_scripts(&dir)?;
    let submission =
        Submission { dir: &dir, shards: &survey.missing, arguments: &args.sbatch, dry_run: args.dry_run };
    submission.submit()?;
    Ok(Ending::Complete)
}

/// Refuses a folder without scripts, and one that was moved: the scripts would go on where it was.
fn check_scripts(dir: &Path) -> Result<(), Error> {
    let refuse = |problem: String| Err(Error::NoResult { dir: dir.into(), problem });
    let path = script(dir);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => {
            return refuse(format!(
                "cannot read the script of `jointsweep submit`, {}: {error}",
                path.display()
            ));
        }
    };
    let Some((_, own)) = read_array(&text) else {
        return refuse(format!("{} is no script of `jointsweep submit`", path.display()));
    };
    let is_here = match (Path::new(&own).canonicalize(), dir.canonicalize()) {
        (Ok(own), Ok(dir)) => own == dir,
        _ => false,
    };
    if !is_here {
        return refuse(format!("its scripts write to {}: was it moved? Submit it again", quoted(&own)));
    }
    Ok(())
}
