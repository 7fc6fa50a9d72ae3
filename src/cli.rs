//! The commands, each of which has its arguments in its own file of `cli/`, and what the exit code says of their end.

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use jointsweep::Error;
use jointsweep::internals::engine::backend::gpu::context::is_guarded;
use jointsweep::internals::output::folder::LAWS;

mod arguments;
mod backend;
mod bench;
#[cfg_attr(feature = "gpu", path = "cli/bench_gpu.rs")]
#[cfg_attr(not(feature = "gpu"), path = "cli/no_bench_gpu.rs")]
mod bench_gpu;
mod calibrate;
mod chosen_designs;
mod devices;
mod explain;
mod export;
#[cfg(feature = "gpu")]
mod gpu_summary;
#[cfg(feature = "gpu")]
mod gpu_sweeps;
mod init;
mod interrupt;
mod laws;
mod materials;
mod merge;
mod pressure;
mod stresses;
mod progress;
mod report;
mod report_page;
mod resubmit;
mod retry;
mod run;
mod sbatch;
mod sensitivity;
mod shard;
mod shard_folder;
mod shell;
mod status;
mod submit;
mod tradeoff;

/// Parametric sweeps of pin joints with clearance: contact stiffness tables of a stated accuracy.
#[derive(Parser)]
#[command(version = VERSION, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// With the commit, where it is known.
const VERSION: &str = match option_env!("JOINTSWEEP_VERSION") {
    Some(version) => version,
    None => env!("CARGO_PKG_VERSION"),
};

const EXIT_CODES: &str = "Exit codes: 0 done; 1 an error, nothing computed is lost; 2 done, but some designs \
failed and say why in their status; 3 `status` only: shards are missing; 130 interrupted, the rows so far are kept.";

#[derive(Subcommand)]
enum Command {
    /// Writes a commented config to start from
    Init(init::InitArgs),
    /// Solves every design of a config and writes table.csv and manifest.json
    Run(run::RunArgs),
    /// Puts the shards of a sweep together into the result of the whole
    Merge(merge::MergeArgs),
    /// Submits a sweep to a Slurm cluster, one task of a job array for each shard, and the merge after them
    Submit(submit::SubmitArgs),
    /// Says which shards of a sweep are complete, in work, damaged or missing, as their files tell
    Status(status::StatusArgs),
    /// Submits the missing shards of a sweep once more, and the merge after them
    Resubmit(resubmit::ResubmitArgs),
    /// Fits laws to the designs of a result and writes laws.csv beside its table
    Laws(laws::LawsArgs),
    /// Says what each design is solved with and why, what was ruled out, and the estimated error and time
    Explain(explain::ExplainArgs),
    /// Writes the contact pressure along the arc, of chosen designs of a config
    Pressure(pressure::PressureArgs),
    /// Writes the stresses at the contact, at each interface and where a body is held, of chosen designs of a config
    Stresses(stresses::StressesArgs),
    /// Says how much of the work and of the force each material of a joint decides, of chosen designs of a config
    Materials(materials::MaterialsArgs),
    /// Fits what is not known of a joint to measured forces and indentations
    Calibrate(calibrate::CalibrateArgs),
    /// Says which swept quantities the scatter of a result comes from: first-order and total Sobol indices
    Sensitivity(sensitivity::SensitivityArgs),
    /// Makes one page of a result, for people: curves, map, errors, what failed and why
    Report(report_page::ReportArgs),
    /// Writes the force of a design, or of a sweep over the clearance, as a table that another simulator reads
    #[command(after_help = export::formats())]
    Export(export::ExportArgs),
    /// Measures whole runs of configs and writes sweep.csv and sweep.manifest.json
    Bench(bench::BenchArgs),
    /// Measures a GPU: checks it, times whole sweeps and each kernel, and compares them with the processor and the peaks
    BenchGpu(bench_gpu::BenchGpuArgs),
    /// Measures what each method, mesh, contact formulation, solver and precision costs and is worth on designs of a config, which have
    /// clearance and no layers
    Tradeoff(tradeoff::TradeoffArgs),
    /// Lists the GPUs with a Vulkan driver, and what a sweep would be computed on
    Devices(devices::DevicesArgs),
    /// Prints what a shell needs to complete command lines
    Completions(shell::CompletionsArgs),
    /// Prints the manual page
    Man(shell::ManArgs),
}

/// How a command that met no error has ended.
enum Ending {
    Complete,
    SomeDesignsFailed,
    ShardsMissing,
    Interrupted,
}

/// Values of options may be negative: each says then what is allowed.
fn parsed() -> Result<Cli, clap::Error> {
    let negative = |option: Arg| match option.get_long() {
        Some(_) if option.get_action().takes_values() => option.allow_negative_numbers(true),
        _ => option,
    };
    let command = Cli::command().mut_subcommands(|verb| verb.mut_args(negative));
    Cli::from_arg_matches(&command.try_get_matches()?)
}

pub fn main() -> ExitCode {
    let cli = match parsed() {
        Ok(cli) => cli,
        Err(error) => {
            // Not clap's own 2, which says here that some designs failed.
            let is_told = error.print().and_then(|()| std::io::stdout().flush()).is_ok();
            return ExitCode::from(u8::from(error.use_stderr() || !is_told));
        }
    };
    let told = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !is_guarded() {
            told(panic);
        }
    }));
    let ending = match cli.command {
        Command::Init(args) => init::init(&args),
        Command::Run(args) => run::run(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Submit(args) => submit::submit(&args),
        Command::Status(args) => status::status(&args),
        Command::Resubmit(args) => resubmit::resubmit(&args),
        Command::Laws(args) => laws::laws(&args),
        Command::Explain(args) => explain::explain(&args),
        Command::Pressure(args) => pressure::pressure(&args),
        Command::Stresses(args) => stresses::stresses(&args),
        Command::Materials(args) => materials::materials(&args),
        Command::Calibrate(args) => calibrate::calibrate(&args),
        Command::Sensitivity(args) => sensitivity::sensitivity(&args),
        Command::Report(args) => report_page::report_page(&args),
        Command::Export(args) => export::run(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::BenchGpu(args) => bench_gpu::bench_gpu(&args),
        Command::Tradeoff(args) => tradeoff::tradeoff(&args),
        Command::Devices(args) => devices::devices(&args),
        Command::Completions(args) => shell::completions(&args),
        Command::Man(args) => shell::man(&args),
    };
    match ending {
        Ok(Ending::Complete) => ExitCode::SUCCESS,
        Ok(Ending::SomeDesignsFailed) => ExitCode::from(2),
        Ok(Ending::ShardsMissing) => ExitCode::from(3),
        Ok(Ending::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            say(&format!("error: {}{error}{}", option(&error), way_out(&error)));
            ExitCode::FAILURE
        }
    }
}

/// `--`, where the error of an export begins with the name of an option.
fn option(error: &Error) -> &'static str {
    const OPTIONS: [&str; 8] = ["to", "out", "name", "error", "restitution", "speed", "up-to", "design"];
    match error {
        Error::Export { what, .. } if OPTIONS.contains(&what.as_str()) => "--",
        Error::Export { what, .. } if what.starts_with("over ") || what.starts_with("reference ") => "--",
        _ => "",
    }
}

/// What a user can do about an error, in the words of the command line.
fn way_out(error: &Error) -> &'static str {
    match error {
        Error::FolderTaken { .. } => ": name another folder with --out, or overwrite it with --force",
        Error::DamagedShard { .. } => ": run this shard again",
        Error::CannotGoOn { .. } => ": go on with that program on that device, or begin anew with --again",
        Error::FolderInUse { .. } => ": wait for it, or name another folder with --out",
        Error::DesignsInTheWay { .. } | Error::InputInTheWay { .. } => ": name another folder with --out",
        Error::Threads { .. } => ": raise the limits on processes and memory (ulimit -u, ulimit -v)",
        Error::FileTaken { path } if path.ends_with(LAWS) => ": overwrite it with --force",
        Error::FileTaken { .. } => ": name another file, or overwrite it with --force",
        _ => "",
    }
}

/// 128 + SIGINT, as shells have it.
const INTERRUPTED: u8 = 130;

/// Prints what was asked for. Who reads it may stop reading; a device that takes nothing is an error.
fn print(text: &str) -> Result<(), Error> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Error::Output { source }),
        _ => Ok(()),
    }
}

/// Prints a line for the user. A closed stderr is no reason to lose a result, as it would be with `eprintln!`.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
