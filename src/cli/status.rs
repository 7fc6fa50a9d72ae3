//! `jointsweep status`: how far the shards of a sweep are, as their files tell.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::output::shard::file_name;
use jointsweep::internals::output::survey::{Survey, ranges};

use super::sbatch::shell_word;
use super::shard_folder::{is_merged, script, shards};
use super::{Ending, print};

#[derive(Args)]
pub struct StatusArgs {
    /// Folder of the shards
    dir: PathBuf,
}

pub fn status(args: &StatusArgs) -> Result<Ending, Error> {
    let survey = shards(&args.dir)?;
    print(&told(&survey, &args.dir))?;
    Ok(if survey.missing.is_empty() { Ending::Complete } else { Ending::ShardsMissing })
}

fn told(survey: &Survey, dir: &Path) -> String {
    let mut text = String::new();
    let mut line = |name: &str, shards: &[u64]| {
        if !shards.is_empty() {
            _ = writeln!(text, "{name:<14}{} ({})", shards.len(), ranges(shards));
        }
    };
    let damaged: Vec<u64> = survey.damaged.iter().map(|(shard, _)| *shard).collect();
    let begun: HashSet<u64> = survey.started.iter().chain(&damaged).copied().collect();
    let untouched: Vec<u64> = survey.missing.iter().copied().filter(|shard| !begun.contains(shard)).collect();
    line("complete", &survey.complete);
    line("in work", &survey.started);
    line("damaged", &damaged);
    line("not begun", &untouched);
    for (shard, why) in &survey.damaged {
        _ = writeln!(text, "{}: {why}", file_name(*shard, survey.of));
    }
    let shown = shell_word(&dir.to_string_lossy());
    let missing = survey.missing.len();
    text += &match (missing, is_merged(dir)) {
        (0, true) => format!("all {} shards are complete and merged: {}\n", survey.of, dir.display()),
        (0, false) => {
            format!("all {} shards are complete; to make the table: jointsweep merge {shown}\n", survey.of)
        }
        _ => format!("{missing} of {} shards are missing\n", survey.of),
    };
    if !survey.started.is_empty() {
        text += "a shard whose task was killed counts as in work, too: squeue tells which tasks run\n";
    }
    if missing > 0 && script(dir).exists() {
        _ = writeln!(
            text,
            "when none of them is in the queue any more: jointsweep resubmit {shown} --missing"
        );
    }
    text
}
