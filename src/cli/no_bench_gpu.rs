//! `jointsweep bench-gpu` of a program that is built without GPUs: says so, whatever is asked.

use std::ffi::OsString;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::backend::adapter::GpuError;

use super::Ending;

#[derive(Args)]
pub struct BenchGpuArgs {
    /// Not read
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

pub fn bench_gpu(_: &BenchGpuArgs) -> Result<Ending, Error> {
    Err(Error::Adapter { problem: GpuError::NotBuilt.to_string() })
}
