//! `jointsweep report`: one page of a finished result.

use std::path::PathBuf;

use jointsweep::Error;
use jointsweep::internals::output::manifest::write_whole;
use jointsweep::internals::output::report::page;
use jointsweep::internals::output::results::Results;

use super::{Ending, ReportArgs, print};

pub fn report_page(args: &ReportArgs) -> Result<Ending, Error> {
    let results = Results::open(&args.dir)?;
    let path = args.out.clone().unwrap_or_else(|| PathBuf::from(results.dir()).join("report.html"));
    if path.exists() && !args.force {
        return Err(Error::FileTaken { path });
    }
    let page = page(&results, &args.design)?;
    write_whole(&path, page.as_bytes())?;
    if !args.quiet {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(Ending::Complete)
}
