//! `jointsweep report`: one page of a finished result.

use std::path::PathBuf;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::threads::common_pool;
use jointsweep::internals::output::report::page;
use jointsweep::internals::output::results::Results;
use jointsweep::internals::output::whole_file::write_whole;

use super::{Ending, print};

#[derive(Args)]
pub struct ReportArgs {
    /// Folder of a finished run
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Draw the curve of this design, by its number in the table; may be repeated [default: a handful spread over the sweep]
    #[arg(long, value_name = "N")]
    design: Vec<u64>,
    /// The page [default: DIR/report.html]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite a page that is there already
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn report_page(args: &ReportArgs) -> Result<Ending, Error> {
    let results = Results::open(&args.dir)?;
    let path = args.out.clone().unwrap_or_else(|| PathBuf::from(results.dir()).join("report.html"));
    if path.exists() && !args.force {
        return Err(Error::FileTaken { path });
    }
    common_pool()?;
    let page = page(&results, &args.design)?;
    write_whole(&path, page.as_bytes())?;
    if !args.quiet {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(Ending::Complete)
}
