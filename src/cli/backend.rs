//! Which device a run is computed on.

use jointsweep::Error;
use jointsweep::engine::backend::gpu::context::{AdapterChoice, Adapters, GpuDevice, GpuError};
use jointsweep::engine::backend::gpu::kernels::Precision;
use jointsweep::study::config::{MethodChoice, Study};

use super::{Backend, BackendArgs, say};

/// Designs from which on `auto` starts a GPU: the processor should do fewer in about the time that a device takes to
/// start and its kernels to compile. An estimate: it was not measured on a GPU.
pub const WORTH_A_GPU: u64 = 10_000;

/// The device and the numbers it computes in; `None` for the processor. A device that was asked for and cannot be had
/// is told in a line; one whose name no adapter has is an error.
pub fn choose(args: &BackendArgs, study: &Study) -> Result<Option<(GpuDevice, Precision)>, Error> {
    let on_meshes = matches!(study.solve.method, MethodChoice::Auto | MethodChoice::Fe);
    let choice = match (args.backend, &args.adapter) {
        (Backend::Cpu, Some(_)) => return Err(Error::ForGpuOnly { option: "--adapter" }),
        (Backend::Cpu, None) if args.precision.is_some() => {
            return Err(Error::ForGpuOnly { option: "--precision" });
        }
        (Backend::Cpu, None) => return Ok(None),
        (_, Some(name)) => AdapterChoice::Named(name),
        (Backend::Auto, None) if !on_meshes || study.design_count() < WORTH_A_GPU => return Ok(None),
        (_, None) => AdapterChoice::Best,
    };
    let asked = args.backend == Backend::Gpu || args.adapter.is_some();
    match open(choice, args) {
        Ok(opened) => Ok(Some(opened)),
        Err(error @ GpuError::NoSuchAdapter { .. }) => Err(Error::Adapter { problem: error.to_string() }),
        // Nothing was promised.
        Err(GpuError::NoAdapter | GpuError::OnlySoftware { .. }) if !asked => Ok(None),
        Err(error) => {
            say(&format!("warning: {error}; the processor computes instead"));
            Ok(None)
        }
    }
}

fn open(choice: AdapterChoice, args: &BackendArgs) -> Result<(GpuDevice, Precision), GpuError> {
    let device = Adapters::enumerate().open(choice)?;
    let precision = args.precision.map_or_else(|| Precision::best(&device), Precision::from);
    precision.check(&device)?;
    Ok((device, precision))
}

impl From<super::Precision> for Precision {
    fn from(asked: super::Precision) -> Precision {
        match asked {
            super::Precision::F32 => Precision::F32,
            super::Precision::F64 => Precision::F64,
            super::Precision::Mixed => Precision::Mixed,
        }
    }
}
