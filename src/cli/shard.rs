//! `jointsweep run --shard`: a part of a sweep, for `jointsweep merge` to put together with the others.

use std::path::Path;
use std::time::{Duration, SystemTime};

use jointsweep::Error;
use jointsweep::internals::engine::shares::share;
use jointsweep::internals::output::claim::Claim;
use jointsweep::internals::output::folder::{Permissions, ResultFolder, Verdict};
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::manifest_parts::Shard;
use jointsweep::internals::output::origin::{Inputs, Origin};
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::output::shard::{MOST_SHARDS, ShardFile};
use jointsweep::internals::output::survey::stranger;
use jointsweep::internals::output::table_sink::cut;
use jointsweep::internals::study::config::Study;

use super::arguments::threads;
use super::run::{RunArgs, already_done, ending, go_on, record};
use super::{Ending, backend, print, report, say};

/// Which shard, from 1, and of how many.
#[derive(Clone, Copy)]
pub struct Part {
    shard: u64,
    of: u64,
}

/// Reads "3/100".
pub fn part(text: &str) -> Result<Part, String> {
    let numbers = text.split_once('/').map(|(shard, of)| (shard.trim().parse(), of.trim().parse()));
    let Some((Ok(shard), Ok(of))) = numbers else {
        return Err("a shard is named like 3/100: the third of a hundred".into());
    };
    match (shard, of) {
        (_, 0) => Err("there must be at least one shard".into()),
        (_, of) if of > MOST_SHARDS => {
            Err(format!("{of} shards are too many: at most {MOST_SHARDS} are allowed"))
        }
        (0, _) => Err(format!("shards are counted from 1 to {of}")),
        (shard, of) if shard > of => Err(format!("there is no shard {shard} of {of}")),
        _ => Ok(Part { shard, of }),
    }
}

pub fn run(args: &RunArgs, study: &Study, part: Part, started: SystemTime) -> Result<Ending, Error> {
    let Part { shard, of } = part;
    let count = study.design_count();
    if of > count {
        let problem = format!("{of} shards of a sweep with {count} designs: at most {count} are possible");
        return Err(Error::Asked { problem });
    }
    let whole = ResultFolder::of_run(args.out.as_deref(), study);
    let dir = whole.dir();
    let designs = share(study, shard, of, cut(study))?;
    let shard = Shard { shard, of, designs, sweep_designs: count };
    if args.dry_run {
        return print(&report::shard(&shard, &shard.file(dir))).map(|()| Ending::Complete);
    }
    let permissions = Permissions { force: args.force, again: args.again };
    // A merged result of the same sweep says nothing of this shard; one of another sweep is in the way.
    whole.check(study, permissions)?;
    if let Some(origin) = complete(study, &shard, dir, permissions)? {
        remove_rest(&shard.folder(dir))?;
        return already_done(args, &shard.file(dir), &origin);
    }
    let stranger = if args.force { None } else { stranger(dir, &Inputs::of(study), of) };
    if let Some(occupant) = stranger {
        return Err(Error::FolderTaken { dir: dir.into(), occupant });
    }
    let chosen = backend::choose(&args.backend, study)?;
    let gpu = backend::gpu(&chosen);
    let conditions = Conditions { gpu, threads: threads(args.threads), started, anew: args.again };
    let mut claim = claim(args, &shard.folder(dir))?;
    // While this one waited another may have made it.
    if let Some(origin) = complete(study, &shard, dir, permissions)? {
        claim.remove()?;
        return already_done(args, &shard.file(dir), &origin);
    }
    let begun = match shard.folder(dir).check(study, permissions)? {
        Verdict::Begun(origin) => Some(origin),
        Verdict::Done(_) | Verdict::ToDo => None,
    };
    let file = shard.file(dir);
    let mut recorder = Recorder::of_shard(claim, study, &conditions, shard, file.clone())?;
    if let Some(begun) = begun {
        go_on(args, &mut recorder, &begun)?;
    }
    let Some(manifest) = record(args, study, recorder, &conditions)? else { return Ok(Ending::Interrupted) };
    if !args.quiet {
        print(&report::shard_summary(&manifest, &file))?;
    }
    Ok(ending(manifest.counts.failed_designs))
}

/// The shard, where it is complete already and may stay.
fn complete(
    study: &Study,
    shard: &Shard,
    dir: &Path,
    permissions: Permissions,
) -> Result<Option<Origin>, Error> {
    let path = shard.file(dir);
    if permissions.again || !path.exists() {
        return Ok(None);
    }
    match ShardFile::open(&path) {
        Ok(file) if file.origin.inputs == Inputs::of(study) => Ok(Some(file.origin)),
        Ok(_) if permissions.force => Ok(None),
        Ok(file) => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let occupant = format!("{name}, a shard of another config ({})", file.origin.inputs.path);
            Err(Error::FolderTaken { dir: dir.into(), occupant })
        }
        // It is made anew.
        Err(Error::DamagedShard { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Removes the folder of a complete shard, which a run leaves that is killed before it can.
fn remove_rest(folder: &ResultFolder) -> Result<(), Error> {
    if !folder.dir().exists() {
        return Ok(());
    }
    match folder.claim("that removes what is left of a shard") {
        // It is being made anew.
        Err(Error::FolderInUse { .. }) => Ok(()),
        claim => claim?.remove(),
    }
}

/// Between two tries to have a folder that another process has.
const PAUSE: Duration = Duration::from_millis(200);

/// The folder of a shard. Batch systems may start a shard twice: who comes second waits, and finds it complete.
fn claim(args: &RunArgs, folder: &ResultFolder) -> Result<Claim, Error> {
    let mut is_told = args.quiet;
    loop {
        match folder.claim(&format!("of {}", args.config.display())) {
            Err(error @ Error::FolderInUse { .. }) => {
                if !is_told {
                    say(&format!("{error}: waiting for it"));
                    is_told = true;
                }
                std::thread::sleep(PAUSE);
            }
            claim => return claim,
        }
    }
}
