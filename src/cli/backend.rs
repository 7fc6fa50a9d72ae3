//! Which device a run is computed on.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointsweep::Error;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::device_solver::DeviceSolver;
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters, GpuDevice, GpuError};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::rates::Rates;
use jointsweep::internals::engine::forecast::Demand;
use jointsweep::internals::engine::unit_costs::Pace;
use jointsweep::internals::output::kept_rates;
use jointsweep::internals::output::origin::Origin;
use jointsweep::internals::study::config::Study;

use super::say;

#[derive(Args, Clone)]
pub struct BackendArgs {
    /// What computes
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// The GPU whose name or driver holds this, software too; `jointsweep devices` lists them
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// The numbers a GPU computes in [default: f32 from an accuracy of 0.1 % on; below that mixed, where the GPU has f64]
    #[arg(long, value_enum)]
    precision: Option<PrecisionChoice>,
    /// How a GPU condenses bodies [default: auto]
    #[arg(long, value_enum)]
    solver: Option<SolverChoice>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The processor, or a GPU for large sweeps where that is clearly faster by what both were measured to do; of shards and
    /// failed rows always the processor
    Auto,
    Cpu,
    /// A GPU, and the processor where there is none or it is lost
    Gpu,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PrecisionChoice {
    F32,
    F64,
    /// Conjugate gradients in f32, refined in f64; all else in f64
    Mixed,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverChoice {
    /// By what is the least work: elimination; the processor takes meshes that are too fine
    Auto,
    /// By elimination; the processor takes meshes that are too fine
    Eliminate,
    /// By conjugate gradients
    Pcg,
}

impl BackendArgs {
    /// What a run was begun with, where nothing else is asked.
    fn begun_as(self, begun: &Origin) -> BackendArgs {
        let Some(device) = &begun.adapter else { return BackendArgs { backend: Backend::Cpu, ..self } };
        BackendArgs {
            backend: Backend::Gpu,
            adapter: Some(device.name.clone()),
            precision: self.precision.or_else(|| PrecisionChoice::from_str(&begun.precision, true).ok()),
            solver: self.solver.or_else(|| SolverChoice::from_str(&device.solver, true).ok()),
        }
    }
}

/// Refuses what contradicts itself.
pub fn check(args: &BackendArgs) -> Result<(), Error> {
    let for_gpu = [
        ("--adapter", args.adapter.is_some()),
        ("--precision", args.precision.is_some()),
        ("--solver", args.solver.is_some()),
    ];
    match for_gpu.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) if args.backend == Backend::Cpu => Err(Error::Asked {
            problem: format!("{option} is for a GPU, --backend cpu asks for none: leave one of them out"),
        }),
        _ => Ok(()),
    }
}

/// The device and the numbers it computes in; `None` for the processor. A device that was asked for and cannot be had
/// is told in a line; one whose name no adapter has is an error, and so is any in a program without GPUs. `auto` is the processor.
pub fn choose(args: &BackendArgs, study: &Study) -> Result<Option<OpenGpu>, Error> {
    let choice = match (args.backend, &args.adapter) {
        (_, Some(name)) => AdapterChoice::Named(name),
        (Backend::Gpu, None) => AdapterChoice::Best,
        (Backend::Cpu | Backend::Auto, None) => return Ok(None),
    };
    match open(choice, args, study.solve.accuracy) {
        Ok(opened) => Ok(Some(opened)),
        Err(error @ (GpuError::NoSuchAdapter { .. } | GpuError::NotBuilt)) => {
            Err(Error::Adapter { problem: error.to_string() })
        }
        Err(error) => {
            say(&format!("warning: {error}; the processor computes instead"));
            Ok(None)
        }
    }
}

/// The same of a whole sweep on so many threads, `auto` by a forecast of both; of one that was begun it is what it was begun with.
pub fn choose_for_sweep(
    args: &BackendArgs,
    study: &Study,
    threads: usize,
    begun: Option<&Origin>,
) -> Result<Option<OpenGpu>, Error> {
    if args.backend != Backend::Auto || args.adapter.is_some() {
        return choose(args, study);
    }
    if let Some(begun) = begun {
        return choose(&args.clone().begun_as(begun), study);
    }
    match clearly_faster(args, study, threads) {
        Ok(chosen) => Ok(chosen),
        // Nobody has asked for one.
        Err(GpuError::NoAdapter | GpuError::OnlySoftware { .. } | GpuError::NotBuilt) => Ok(None),
        Err(error) => {
            say(&format!("warning: {error}; the processor computes instead"));
            Ok(None)
        }
    }
}

/// The best GPU, where a sweep is large enough and the forecast says so.
fn clearly_faster(args: &BackendArgs, study: &Study, threads: usize) -> Result<Option<OpenGpu>, GpuError> {
    // As a device with f64 has it.
    let precision = args.precision.map_or_else(|| Precision::suited(study.solve.accuracy), Into::into);
    let known = kept_rates::known(cache_folder().as_deref(), precision);
    let processor = known.iter().map(|rates| rates.processor).reduce(Pace::or_slower);
    let Some(demand) = Demand::worth_a_device(study, threads, processor) else { return Ok(None) };
    let may_help = |rates: &Rates| demand.forecast(rates, threads).prefers_device();
    if !known.is_empty() && !known.iter().any(may_help) {
        return Ok(None);
    }
    let opened = open(AdapterChoice::Best, args, study.solve.accuracy)?;
    let (rates, not_kept) = kept_rates::rates(cache_folder().as_deref(), &opened.choice())?;
    if let Some(error) = not_kept {
        say(&format!("warning: what {} was measured to do is not kept: {error}", opened.device.facts.name));
    }
    let demand = demand.on(opened.device.facts.features.f64);
    Ok(demand.forecast(&rates, threads).prefers_device().then_some(opened))
}

/// Where what is measured of this machine is kept.
pub fn cache_folder() -> Option<PathBuf> {
    dirs::cache_dir().map(|dir| dir.join("jointsweep"))
}

/// A device that is open, and how it computes.
pub struct OpenGpu {
    device: GpuDevice,
    precision: Precision,
    solver: DeviceSolver,
}

impl OpenGpu {
    /// As a sweep takes it.
    pub fn choice(&self) -> GpuChoice<'_> {
        GpuChoice { solver: self.solver, ..GpuChoice::new(&self.device, self.precision) }
    }
}

/// What was chosen, as a sweep takes it.
pub fn gpu(chosen: &Option<OpenGpu>) -> Option<GpuChoice<'_>> {
    chosen.as_ref().map(OpenGpu::choice)
}

/// Gives a driver the folder that Mesa's looks for, so that it does not complain of it to the user. Mesa's maps the files where it keeps kernels:
/// where the disk has no room for these, that would end the process, and it is to keep none.
pub fn quiet_driver() {
    let mut settings = vec![("XDG_RUNTIME_DIR", std::env::temp_dir().into_os_string())];
    if dirs::cache_dir().is_some_and(|folder| is_full(&folder)) {
        settings.push(("MESA_SHADER_CACHE_DISABLE", "true".into()));
    }
    for (name, value) in settings {
        if std::env::var_os(name).is_none() {
            // SAFETY: no other thread runs yet that could read the environment.
            unsafe { std::env::set_var(name, value) };
        }
    }
}

/// More than drivers write at a time, bytes.
#[cfg(unix)]
const ROOM_FOR_KERNELS: u64 = 64 << 20;

/// Whether the disk of a folder, or of those it would be in, has hardly any room.
#[cfg(unix)]
fn is_full(folder: &Path) -> bool {
    let there = folder.ancestors().find(|folder| folder.is_dir());
    let disk = there.and_then(|folder| rustix::fs::statvfs(folder).ok());
    disk.is_some_and(|disk| disk.f_bavail.saturating_mul(disk.f_frsize) < ROOM_FOR_KERNELS)
}

/// There is no such driver here.
#[cfg(not(unix))]
fn is_full(_: &Path) -> bool {
    false
}

fn open(choice: AdapterChoice, args: &BackendArgs, accuracy: f64) -> Result<OpenGpu, GpuError> {
    quiet_driver();
    let device = Adapters::enumerate().open(choice)?;
    let precision = args.precision.map_or_else(|| Precision::preferred(&device.facts, accuracy), Into::into);
    precision.check(&device.facts)?;
    let solver = args.solver.map_or(DeviceSolver::Auto, Into::into);
    Ok(OpenGpu { device, precision, solver })
}

impl From<SolverChoice> for DeviceSolver {
    fn from(asked: SolverChoice) -> DeviceSolver {
        match asked {
            SolverChoice::Auto => DeviceSolver::Auto,
            SolverChoice::Eliminate => DeviceSolver::Eliminate,
            SolverChoice::Pcg => DeviceSolver::Pcg,
        }
    }
}

impl From<PrecisionChoice> for Precision {
    fn from(asked: PrecisionChoice) -> Precision {
        match asked {
            PrecisionChoice::F32 => Precision::F32,
            PrecisionChoice::F64 => Precision::F64,
            PrecisionChoice::Mixed => Precision::Mixed,
        }
    }
}
