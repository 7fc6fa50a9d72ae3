//! `jointsweep merge`: from shards to the result of the whole sweep.

use std::path::PathBuf;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::output::folder::Permissions;
use jointsweep::internals::output::merge::{Merged, merge as put_together};

use super::run::ending;
use super::{Ending, print, report};

#[derive(Args)]
pub struct MergeArgs {
    /// Folder of the shards, where the result will be
    dir: PathBuf,
    /// Overwrite the result of another config
    #[arg(long)]
    force: bool,
    /// Merge again what was merged
    #[arg(long)]
    again: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn merge(args: &MergeArgs) -> Result<Ending, Error> {
    let merged = put_together(&args.dir, Permissions { force: args.force, again: args.again })?;
    let (Merged::Now(origin) | Merged::Before(origin)) = &merged;
    if !args.quiet {
        print(&report::merged(origin, &args.dir, matches!(merged, Merged::Now(_))))?;
    }
    Ok(ending(origin.counts.failed_designs))
}
