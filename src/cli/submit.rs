//! `jointsweep submit`: a sweep on a Slurm cluster, one task of a job array for each shard.

use std::path::{Path, PathBuf};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::output::folder::{Permissions, ResultFolder, Verdict};
use jointsweep::internals::output::shard::MOST_SHARDS;
use jointsweep::internals::output::slurm::{ARRAY, FOLDER, Job, MERGE, does_the_same};
use jointsweep::internals::output::whole_file::{create_dir, write_whole};
use jointsweep::internals::study::config::Study;

use super::arguments::{SettingArgs, count};
use super::report::plural;
use super::sbatch::{Submission, shell_word};
use super::shard_folder::{absolute, has_shards, script, shards};
use super::{Ending, print, report};

#[derive(Args)]
pub struct SubmitArgs {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// Shards that the sweep is divided into: tasks of the array
    #[arg(long, value_name = "N", value_parser = count::<u64>)]
    shards: u64,
    /// Folder of the shards and of the result, seen by all machines of the cluster [default: out/<config's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only write the scripts, and say how they would be submitted
    #[arg(long, visible_alias = "no-submit")]
    dry_run: bool,
    /// For sbatch, like --time=1:00:00 --mem=4G --partition=NAME; array and merge both have them
    #[arg(last = true, value_name = "SBATCH ARGUMENTS")]
    sbatch: Vec<String>,
}

pub fn submit(args: &SubmitArgs) -> Result<Ending, Error> {
    let study = args.settings.load(&args.config)?;
    check_count(args.shards, &study)?;
    let folder = ResultFolder::of_run(args.out.as_deref(), &study);
    match folder.check(&study, Permissions::default()) {
        Ok(Verdict::ToDo | Verdict::Begun(_)) => {}
        Ok(Verdict::Done(origin)) => {
            print(&report::already_done(&origin, &folder.table(&study)))?;
            return Ok(Ending::Complete);
        }
        Err(Error::FolderTaken { dir, occupant }) => return Err(in_the_way(&dir, &occupant)),
        Err(error) => return Err(error),
    }
    let dir = absolute(folder.dir())?;
    let program = std::env::current_exe().map_err(|source| Error::Io {
        action: "find",
        path: "jointsweep".into(),
        source,
    })?;
    let config = absolute(&args.config)?;
    let job = Job {
        program: text(&program)?,
        config: text(&config)?,
        name: &format!("jointsweep-{}", study.name()),
        settings: &args.settings.set,
        dir: text(&dir)?,
        shards: args.shards,
        sbatch: &args.sbatch,
    };
    job.check()?;
    check_folder(&dir, &job)?;

    let scripts = dir.join(FOLDER);
    create_dir(&scripts)?;
    write_whole(&scripts.join(ARRAY), job.array().as_bytes())?;
    write_whole(&scripts.join(MERGE), job.merge().as_bytes())?;
    let numbers: Vec<u64> = (1..=args.shards).collect();
    let submission =
        Submission { dir: &dir, shards: &numbers, arguments: &args.sbatch, dry_run: args.dry_run };
    submission.submit()?;
    if !args.dry_run {
        let designs = plural(study.design_count(), "design", "designs");
        let shown = shell_word(&folder.dir().to_string_lossy());
        print(&format!("{designs} in all; how far they are: jointsweep status {shown}\n"))?;
    }
    Ok(Ending::Complete)
}

fn check_count(shards: u64, study: &Study) -> Result<(), Error> {
    let designs = study.design_count();
    let most = designs.min(MOST_SHARDS);
    if shards <= most {
        return Ok(());
    }
    let why = if most == designs { ", one for each design" } else { "" };
    let problem = format!("--shards {shards} are too many: {most} at most{why}");
    Err(Error::Slurm { problem })
}

/// Refuses a folder with the shards or the scripts of something else.
fn check_folder(dir: &Path, job: &Job) -> Result<(), Error> {
    let there = std::fs::read_to_string(script(dir));
    if there.is_ok_and(|there| !does_the_same(&there, &job.array())) {
        return Err(in_the_way(dir, "the scripts of another submission, in its folder slurm"));
    }
    if has_shards(dir)? {
        let there = shards(dir)?;
        if there.of != job.shards {
            return Err(in_the_way(dir, &format!("shards of a sweep in {}", there.of)));
        }
    }
    Ok(())
}

fn in_the_way(dir: &Path, occupant: &str) -> Error {
    let problem =
        format!("{} holds {occupant}: remove that, or name another folder with --out", dir.display());
    Error::Slurm { problem }
}

/// A path as a script has it.
fn text(path: &Path) -> Result<&str, Error> {
    let refuse = || Error::Slurm {
        problem: format!("{} is not a name in UTF-8, as scripts have them", path.display()),
    };
    path.to_str().ok_or_else(refuse)
}
