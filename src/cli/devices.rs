//! `jointsweep devices`: what could compute here, and what would.

use std::fmt::Write as _;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::gpu::context::{
    AdapterChoice, AdapterFacts, Adapters, GpuDevice, GpuError, choose,
};
use jointsweep::internals::engine::backend::precision::Precision;
use jointsweep::internals::output::kept_rates::measured_anew;

use super::{Ending, backend, print, say};

#[derive(Args)]
pub struct DevicesArgs {
    /// Measure how fast each condenses bodies and solves joints, some seconds each; `--backend auto` then goes by it
    #[arg(long)]
    measure: bool,
}

/// Accuracy of sweeps that are measured for.
const ACCURACY: f64 = 0.01;

pub fn devices(args: &DevicesArgs) -> Result<Ending, Error> {
    backend::quiet_driver();
    let adapters = Adapters::enumerate();
    let measured = |facts: &AdapterFacts| {
        let told = adapters.open(AdapterChoice::Named(&facts.name)).and_then(|device| measured(&device));
        told.unwrap_or_else(|error| error.to_string())
    };
    let text = listing(&adapters.facts, |facts| args.measure.then(|| measured(facts)));
    print(&text)?;
    Ok(Ending::Complete)
}

/// How fast a device is, in words; kept.
fn measured(device: &GpuDevice) -> Result<String, GpuError> {
    let choice = GpuChoice::new(device, Precision::preferred(&device.facts, ACCURACY));
    let (rates, not_kept) = measured_anew(backend::cache_folder().as_deref(), &choice)?;
    if let Some(error) = not_kept {
        say(&format!("warning: what was measured is not kept: {error}"));
    }
    let (name, threads) = (choice.precision.name(), rates.threads());
    let contact = rates.threads_of_contact();
    let contact = contact.map_or(String::new(), |threads| format!(", solves contact like {threads:.2}"));
    Ok(format!(
        "condenses like {threads:.2} threads of the processor in {name}{contact}, ready after {:.1} s",
        rates.start
    ))
}

fn listing(adapters: &[AdapterFacts], measured: impl Fn(&AdapterFacts) -> Option<String>) -> String {
    let mut text = String::new();
    for adapter in adapters {
        let AdapterFacts { name, kind, driver, limits, features } = adapter;
        let mebibytes = |bytes: u64| format!("{} MiB", bytes >> 20);
        let features =
            [("f64", features.f64), ("subgroups", features.subgroups), ("timestamps", features.timestamps)];
        let had: Vec<&str> = features.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect();
        let _ = writeln!(text, "{name}");
        let lines = [
            ("type", kind.to_string()),
            ("driver", driver.clone()),
            ("features", if had.is_empty() { "none".to_string() } else { had.join(", ") }),
            ("binding", mebibytes(limits.binding_bytes)),
            ("buffer", mebibytes(limits.buffer_bytes)),
            (
                "workgroup",
                format!(
                    "{} invocations, {} KiB; {} a dimension, {} storage buffers",
                    limits.invocations_per_workgroup,
                    limits.workgroup_bytes >> 10,
                    limits.workgroups_per_dimension,
                    limits.storage_buffers
                ),
            ),
        ];
        let measured = measured(adapter).map(|measured| ("measured", measured));
        for (what, value) in lines.into_iter().chain(measured) {
            let _ = writeln!(text, "  {what:<10} {value}");
        }
        text.push('\n');
    }
    let gpu = match choose(adapters, AdapterChoice::Best) {
        Ok(index) => adapters[index].name.clone(),
        Err(error @ GpuError::NotBuilt) => format!("refused: {error}"),
        Err(error) => format!("the processor: {error}"),
    };
    let auto = match choose(adapters, AdapterChoice::Best) {
        Ok(_) => "the processor, or that GPU for a large sweep where it is clearly faster",
        Err(_) => "the processor",
    };
    let _ = writeln!(text, "--backend auto   {auto}");
    let _ = writeln!(text, "--backend gpu    {gpu}");
    text
}
