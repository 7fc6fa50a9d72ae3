//! What can be asked on the command line, and what the exit code answers.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use jointsweep::Error;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::setting::Setting;

mod backend;
mod bench;
mod bench_gpu;
mod calibrate;
mod devices;
mod explain;
mod init;
mod export;
mod interrupt;
mod laws;
mod merge;
mod progress;
mod report;
mod report_page;
mod resubmit;
mod retry;
mod run;
mod sbatch;
mod sensitivity;
mod shard;
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
    Init(InitArgs),
    /// Solves every design of a config and writes table.csv and manifest.json
    Run(RunArgs),
    /// Puts the shards of a sweep together into the result of the whole
    Merge(MergeArgs),
    /// Submits a sweep to a Slurm cluster, one task of a job array for each shard, and the merge after them
    Submit(SubmitArgs),
    /// Says which shards of a sweep are complete, in work, damaged or missing, as their files tell
    Status(StatusArgs),
    /// Submits the missing shards of a sweep once more, and the merge after them
    Resubmit(ResubmitArgs),
    /// Fits laws to the designs of a result and writes laws.csv beside its table
    Laws(LawsArgs),
    /// Says what each design is solved with and why, what was ruled out, and the estimated error and time
    Explain(ExplainArgs),
    /// Fits what is not known of a joint to measured forces and indentations
    Calibrate(CalibrateArgs),
    /// Says which swept quantities the scatter of a result comes from: first-order and total Sobol indices
    Sensitivity(SensitivityArgs),
    /// Makes one page of a result, for people: curves, map, errors, what failed and why
    Report(ReportArgs),
    /// Writes the force of a design, or of a sweep over the clearance, as a table that another simulator reads
    #[command(after_help = export::formats())]
    Export(ExportArgs),
    /// Measures whole runs of configs and writes sweep.csv and sweep.manifest.json
    Bench(BenchArgs),
    /// Measures a GPU: checks it, times whole sweeps and each kernel, and compares them with the processor and the peaks
    BenchGpu(BenchGpuArgs),
    /// Measures what each method, mesh, contact formulation, solver and precision costs and is worth on designs of a config
    Tradeoff(TradeoffArgs),
    /// Lists the GPUs with a Vulkan driver, and what a sweep would be computed on
    Devices,
    /// Prints what a shell needs to complete command lines
    Completions(CompletionsArgs),
    /// Prints the manual page
    Man(ManArgs),
}

#[derive(Args)]
struct InitArgs {
    /// The config to write
    #[arg(default_value = "joint.toml")]
    file: PathBuf,
    /// Overwrite a file that is there
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct SettingArgs {
    /// Another value than the config's, like joint.plate.youngs_modulus="70 GPa" or solve.accuracy=0.1%; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl SettingArgs {
    /// The config with these values.
    fn load(&self, config: &Path) -> Result<Study, Error> {
        let settings =
            self.set.iter().map(|text| Setting::parse(text, "--set")).collect::<Result<Vec<_>, _>>()?;
        Study::load_with(config, &settings)
    }
}

#[derive(Args)]
struct RunArgs {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// Folder of the result [default: out/<config's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArgs,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Overwrite the result of another config
    #[arg(long)]
    force: bool,
    /// Begin anew where the config was run before; a complete result stays until the new one is
    #[arg(long)]
    again: bool,
    /// Solve only one of N parts of the sweep, of about the same cost, into one file of the folder; `merge` puts them together
    #[arg(long, value_name = "I/N", value_parser = shard::part)]
    shard: Option<shard::Part>,
    /// Do the failed rows of a finished result again, and nothing else
    #[arg(long, conflicts_with_all = ["shard", "again", "force", "dry_run"])]
    retry_failed: bool,
    /// Only say what the sweep has to do and what it will cost
    #[arg(long)]
    dry_run: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Say the time of each stage, too
    #[arg(long, conflicts_with = "quiet")]
    verbose: bool,
}

#[derive(Args)]
struct MergeArgs {
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

#[derive(Args)]
struct SubmitArgs {
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

#[derive(Args)]
struct StatusArgs {
    /// Folder of the shards
    dir: PathBuf,
}

#[derive(Args)]
struct ResubmitArgs {
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

#[derive(Args)]
struct LawsArgs {
    /// Folder of a result
    dir: PathBuf,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Overwrite the laws that are there
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct ExplainArgs {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// Only this design, by its number in the table [default: all, by what is chosen for them]
    #[arg(long, value_name = "N")]
    design: Option<u64>,
}

#[derive(Args)]
struct CalibrateArgs {
    /// The joint as far as it is known, a TOML file of one design; what is fitted starts from its values
    config: PathBuf,
    /// The measured points, a CSV file with the columns indentation_mm, force_n and, if known, sigma_n
    #[arg(long, value_name = "FILE")]
    measured: PathBuf,
    /// What to fit, with commas between: plate_youngs_modulus, pin_youngs_modulus, radial_clearance, support_compliance,
    /// zero_offset
    #[arg(long, value_name = "NAME", value_delimiter = ',', required = true)]
    fit: Vec<String>,
    /// Folder of the result [default: out/<config's name>/calibration]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Overwrite a result that is there
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct SensitivityArgs {
    /// The factors and their ranges, a TOML file: what sweeps there, whatever its [sampling] says
    config: PathBuf,
    /// Columns of results, with or without their unit, or expressions like "force / thickness", with commas between
    /// [default: force_n, or indentation_mm where the force is prescribed]
    #[arg(long, value_name = "COLUMN")]
    of: Vec<String>,
    /// The load step, from 1 [default: the last]
    #[arg(long, value_name = "N")]
    step: Option<u64>,
    /// Samples; each is as many designs as there are factors, and two. Best a power of two
    #[arg(long, value_name = "N", default_value = "1024", value_parser = sample_count)]
    samples: u64,
    /// Other samples
    #[arg(long, value_name = "N", default_value = "0")]
    seed: u64,
    /// Folder of the result [default: out/<config's name>/sensitivity]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Overwrite a result that is there
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

#[derive(Args)]
struct ManArgs {
    /// Write the pages of all commands into this folder instead
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite pages that are there
    #[arg(long, requires = "out")]
    force: bool,
}

#[derive(Args)]
struct ReportArgs {
    /// Folder of a finished run
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Draw the curves of these designs, by their numbers in the table [default: a handful spread over the sweep]
    #[arg(long, value_name = "N", num_args = 1..)]
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

#[derive(Args)]
struct ExportArgs {
    /// Folder of a finished run
    dir: PathBuf,
    /// The format; they are listed below
    #[arg(long, value_name = "FORMAT")]
    to: String,
    /// The design, by its number in the table [default: the only one]
    #[arg(long, value_name = "N", conflicts_with = "over")]
    design: Option<u64>,
    /// A table of all designs, over this quantity and the indentation; they differ in nothing else
    #[arg(long, value_enum, value_name = "QUANTITY")]
    over: Option<OverQuantity>,
    /// What the indentation is measured from
    #[arg(long, value_enum, value_name = "REFERENCE", default_value_t = ReferenceChoice::Support)]
    reference: ReferenceChoice,
    /// The file [default: DIR/NAME with the format's ending]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// How far the simulator's own interpolation may be off, relative to the force
    #[arg(long, value_name = "ERROR", default_value = "0.1 %")]
    error: String,
    /// Name of the functions, tables and files
    #[arg(long, value_name = "NAME", default_value = "joint")]
    name: String,
    /// With damping: speed after an impact over the speed before
    #[arg(long, value_name = "E", requires = "speed", allow_negative_numbers = true)]
    restitution: Option<f64>,
    /// Speed before the impact, like "100 mm/s"
    #[arg(long, value_name = "V", requires = "restitution", allow_hyphen_values = true)]
    speed: Option<String>,
    /// End of the table, like "0.1 mm" [default: the largest indentation of the designs]
    #[arg(long, value_name = "INDENTATION")]
    up_to: Option<String>,
    /// Take rows that are answered with a remark
    #[arg(long)]
    allow_warned: bool,
    /// Overwrite files
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings
    #[arg(long)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum OverQuantity {
    RadialClearance,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ReferenceChoice {
    /// The pin's rigid part against the plate's support, as in the table
    Support,
    /// The mean motion of the pin's ring against the hole's: for bodies that are flexible themselves
    RingMean,
}

#[derive(Args)]
struct BenchArgs {
    /// The sweeps to run [default: those of configs/liu2007.toml and configs/random.toml that are here]
    #[arg(value_name = "CONFIG")]
    configs: Vec<PathBuf>,
    /// Runs of each that are measured, after one that is not
    #[arg(long, value_name = "N", default_value = "5", value_parser = count::<usize>)]
    runs: usize,
    /// Threads that compute [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
    /// Folder of the figures
    #[arg(long, value_name = "DIR", default_value = "out/bench")]
    out: PathBuf,
}

#[derive(Args)]
struct BenchGpuArgs {
    /// The GPU whose name or driver holds this, software too [default: the best GPU]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Only these numbers [default: f32, and mixed and f64 where the GPU has them]
    #[arg(long, value_enum)]
    precision: Option<Precision>,
    /// Designs of the largest sweep
    #[arg(long, value_name = "N", default_value = "1000000", value_parser = count::<u64>)]
    most: u64,
    /// Folder of the figures [default: results/<adapter's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads of the processor [default: all cores]
    #[arg(long, value_name = "N", value_parser = thread_count)]
    threads: Option<usize>,
}

#[derive(Args)]
struct TradeoffArgs {
    /// The sweep whose designs are taken, a TOML file
    config: PathBuf,
    /// Designs, evenly spaced over the sweep
    #[arg(long, value_name = "N", default_value = "100", value_parser = count::<u64>)]
    designs: u64,
    /// Folder of the result [default: out/<config's name>/tradeoff]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Measure the GPU whose name or driver holds this too, software or not [default: the best GPU, if there is one]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Runs of each choice; fewer of those that take seconds
    #[arg(long, value_name = "N", default_value = "5", value_parser = count::<usize>)]
    runs: usize,
    /// Overwrite the result of another config
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct BackendArgs {
    /// What computes
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// The GPU whose name or driver holds this, software too; `jointsweep devices` lists them
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// The numbers a GPU computes in [default: mixed below 0.1 % of accuracy or where f64 is at least a quarter as fast as
    /// f32, else f32]
    #[arg(long, value_enum)]
    precision: Option<Precision>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Backend {
    /// The processor, until it is measured that a GPU is faster for sweeps
    Auto,
    Cpu,
    /// A GPU, and the processor where there is none or it is lost
    Gpu,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Precision {
    F32,
    F64,
    /// Conjugate gradients in f32, refined in f64; all else in f64
    Mixed,
}

/// How a command that met no error has ended.
enum Ending {
    Complete,
    SomeDesignsFailed,
    ShardsMissing,
    Interrupted,
}

pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Not clap's own 2, which says here that some designs failed.
            let is_told = error.print().and_then(|()| std::io::stdout().flush()).is_ok();
            return ExitCode::from(u8::from(error.use_stderr() || !is_told));
        }
    };
    let ending = match cli.command {
        Command::Init(args) => init::init(&args),
        Command::Run(args) => run::run(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Submit(args) => submit::submit(&args),
        Command::Status(args) => status::status(&args),
        Command::Resubmit(args) => resubmit::resubmit(&args),
        Command::Laws(args) => laws::laws(&args),
        Command::Explain(args) => explain::explain(&args),
        Command::Calibrate(args) => calibrate::calibrate(&args),
        Command::Sensitivity(args) => sensitivity::sensitivity(&args),
        Command::Report(args) => report_page::report_page(&args),
        Command::Export(args) => export::run(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::BenchGpu(args) => bench_gpu::bench_gpu(&args),
        Command::Tradeoff(args) => tradeoff::tradeoff(&args),
        Command::Devices => devices::devices(),
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

/// What makes an option of what an export's error is about.
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
        Error::CannotGoOn { .. } => ": go on with that program, or begin anew with --again",
        Error::FolderInUse { .. } => ": wait for it, or name another folder with --out",
        Error::DesignsInTheWay { .. } | Error::InputInTheWay { .. } => ": name another folder with --out",
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

/// Threads that compute: as asked, or one a processor.
fn threads(asked: Option<usize>) -> usize {
    asked.or(std::thread::available_parallelism().ok().map(usize::from)).unwrap_or(1)
}

/// More threads than any machine of today has processors.
const MOST_THREADS: usize = 1024;

fn thread_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MOST_THREADS).contains(&count) => Ok(count),
        _ => Err(format!("a whole number from 1 to {MOST_THREADS} is needed")),
    }
}

/// Fewer say nothing: intervals come from groups of samples, and there are half a hundred of those then.
const FEWEST_SAMPLES: u64 = 64;

fn sample_count(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| *number >= FEWEST_SAMPLES);
    number.ok_or(format!("a whole number from {FEWEST_SAMPLES} on is needed, best a power of two"))
}

/// A count of things to do, at least one.
fn count<T: FromStr + PartialOrd + From<u8>>(text: &str) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| *number >= T::from(1));
    number.ok_or("a whole number from 1 on is needed".into())
}

/// Prints a line for the user. A closed stderr is no reason to lose a result, as it would be with `eprintln!`.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
