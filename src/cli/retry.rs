//! `jointsweep run --retry-failed`: the failed rows of a finished result done again, and nothing else.

use std::ops::ControlFlow;

use jointsweep::Error;
use jointsweep::internals::engine::drawing::Chosen;
use jointsweep::internals::engine::sweep::{self, Digest, SweepOptions};
use jointsweep::internals::output::folder::{Permissions, ResultFolder, Verdict};
use jointsweep::internals::output::origin::Origin;
use jointsweep::internals::output::results::Results;
use jointsweep::internals::output::retry::{Rewriter, failed_rows, new_rows, refusal};
use jointsweep::internals::output::table::Table;
use jointsweep::internals::study::config::Study;

use super::arguments::threads;
use super::run::{RunArgs, ending};
use super::{Ending, backend, print, report, say};

/// Designs whose rows are made together.
const PORTION: u64 = 64;

pub fn retry(args: &RunArgs, study: &Study, folder: &ResultFolder) -> Result<Ending, Error> {
    let nothing = |problem: &str| Error::NoResult { dir: folder.dir().into(), problem: problem.into() };
    if let Some(why) = refusal(study) {
        return Err(nothing(&format!(
            "failed rows cannot be done again alone: {why}; --again does all of them"
        )));
    }
    let claim = folder.claim(&format!("of {}", args.config.display()))?;
    if !matches!(folder.check(study, Permissions::default())?, Verdict::Done(_)) {
        return Err(nothing(
            "there is no finished result of this config whose failed rows could be done again",
        ));
    }
    let results = Results::open(folder.dir())?;
    let failed = failed_rows(&results.table())?;
    if failed.is_empty() {
        print(&format!("no row has failed, nothing to do\n{}\n", results.table().display()))?;
        return Ok(Ending::Complete);
    }
    let chosen = backend::choose(&args.backend, study)?;
    let gpu = backend::gpu(&chosen);
    let mut designs: Vec<u64> = failed.iter().map(|row| row.design).collect();
    designs.dedup();
    let options = SweepOptions {
        threads: threads(args.threads),
        gpu,
        notify: Some(&say),
        asker: None,
        designs: Chosen::Listed(designs),
        ..SweepOptions::default()
    };
    let count = failed.len() as u64;
    let mut rewriter = Rewriter::new(&claim, &results, failed)?;
    let table = Table::of(study);
    let digest = Digest { designs: PORTION, make: &|solved| new_rows(&table, solved.outcomes) };
    sweep::run_digested(study, &options, &digest, &mut |rows| {
        rewriter.add(&rows)?;
        Ok(ControlFlow::Continue(()))
    })?;
    let manifest = rewriter.finish()?;
    let Some(origin) = Origin::of(&manifest) else {
        return Err(nothing("its manifest cannot be read"));
    };
    if !args.quiet {
        print(&report::done_again(count, &origin, &results.table()))?;
    }
    Ok(ending(origin.counts.failed_designs))
}
