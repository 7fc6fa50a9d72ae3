//! `jointsweep laws`: laws for a result that has none.

use std::path::PathBuf;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::laws_of_all;
use jointsweep::internals::engine::outcome::{Answer, BackendKind, DesignOutcome};
use jointsweep::internals::engine::threads::pool;
use jointsweep::internals::output::folder::{LAWS, MANIFEST};
use jointsweep::internals::output::laws_table::LawsTable;
use jointsweep::internals::output::lock::FolderLock;
use jointsweep::internals::output::manifest::with_file;
use jointsweep::internals::output::results::{Results, TableRow, TableRows};
use jointsweep::internals::output::sink::{Sink, SinkFile};
use jointsweep::internals::output::whole_file::{publish, staged, write_whole};
use jointsweep::internals::study::columns::Quantity;
use jointsweep::internals::study::config::{Asked, MethodChoice};
use jointsweep::internals::study::design::{DesignCase, Load};

use super::arguments::{thread_count, threads};
use super::progress::Progress;
use super::{Ending, print};

#[derive(Args)]
pub struct LawsArgs {
    /// Folder of a result
    dir: PathBuf,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Overwrite the laws that are there
    #[arg(long)]
    force: bool,
}

/// Designs that are solved together.
const BATCH: usize = 4096;

pub fn laws(args: &LawsArgs) -> Result<Ending, Error> {
    let results = Results::open(&args.dir)?;
    let path = args.dir.join(LAWS);
    if path.exists() && !args.force {
        return Err(Error::FileTaken { path });
    }
    let Asked { solve: options, in_common, .. } = results.asked()?;
    let refuse = |problem: &str| Err(Error::NoResult { dir: args.dir.clone(), problem: problem.into() });
    if options.method == MethodChoice::ClosedForm {
        return refuse("a closed form has no curve to fit laws to");
    }
    let _lock = FolderLock::take(&args.dir, "of its laws")?;
    let threads = threads(args.threads);
    let pool = pool(threads)?;
    let mut file = SinkFile::new(LAWS, staged(&path));
    let mut progress = Progress::new(0, results.origin.counts.designs, false);
    let written = pool
        .install(|| write_laws(&results, Ladder::new(options).sharing(in_common), &mut file, &mut progress));
    progress.finish();
    if written.is_err() {
        // What is half written is of no use to anybody.
        let _ = std::fs::remove_file(staged(&path));
    }
    let count = written?;
    publish(&path)?;
    let Some(manifest) = with_file(&results.manifest, LAWS, &file.fingerprint()) else {
        return refuse("its manifest cannot be read");
    };
    write_whole(&args.dir.join(MANIFEST), manifest.as_bytes())?;
    print(&format!("laws of {count} designs: {}\n", path.display()))?;
    Ok(Ending::Complete)
}

/// Fits all designs of a result, and says how many there are.
fn write_laws(
    results: &Results,
    mut ladder: Ladder,
    file: &mut SinkFile,
    progress: &mut Progress,
) -> Result<usize, Error> {
    file.open()?;
    file.begin(&LawsTable.header())?;
    let mut designs = Designs { rows: results.rows(&[Quantity::Indentation, Quantity::Force])?, next: None };
    let mut count = 0;
    loop {
        let mut batch = Vec::new();
        while batch.len() < BATCH {
            let Some(design) = designs.next()? else { break };
            batch.push(design);
        }
        if batch.is_empty() {
            break;
        }
        let done = batch.len();
        count += done;
        let asked: Vec<_> = batch.iter().map(|(case, working)| (case, *working)).collect();
        let fitted = laws_of_all(&mut ladder, &asked);
        let with_laws = batch.into_iter().zip(fitted).map(|((case, _), laws)| {
            let answer = Answer { backend: BackendKind::Cpu, steps: Vec::new() };
            DesignOutcome { laws: Some(Box::new(laws)), ..DesignOutcome::new(case, answer) }
        });
        file.append(&LawsTable.rows(&with_laws.collect::<Vec<DesignOutcome>>()))?;
        progress.advance(done as u64);
    }
    Ok(count)
}

/// A design with the least and the greatest indentation that was answered, mm; `None` where none was.
type AnsweredDesign = (DesignCase, Option<(f64, f64)>);

/// The designs of a table.
struct Designs {
    rows: TableRows,
    /// The first row of the next design, where it was read.
    next: Option<TableRow>,
}

impl Designs {
    fn next(&mut self) -> Result<Option<AnsweredDesign>, Error> {
        let first = match self.next.take() {
            Some(row) => row,
            None if self.rows.advance()?.is_some() => self.rows.row()?,
            None => return Ok(None),
        };
        let case =
            DesignCase { index: first.design, joint: first.joint.clone(), steps: Vec::<Load>::new().into() };
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        let mut row = first;
        loop {
            let answered = row.indentation.filter(|value| *value > 0.0 && row.force.is_some());
            if let Some(value) = answered {
                (low, high) = (low.min(value), high.max(value));
            }
            if self.rows.advance()?.is_none() {
                break;
            }
            row = self.rows.row()?;
            if row.design != case.index {
                self.next = Some(row);
                break;
            }
        }
        Ok(Some((case, (high > 0.0).then_some((low, high)))))
    }
}
