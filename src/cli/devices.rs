//! `jointsweep devices`: what could compute here, and what would.

use std::fmt::Write as _;

use jointsweep::Error;
use jointsweep::internals::engine::backend::gpu::context::{
    AdapterChoice, AdapterFacts, Adapters, GpuError, choose,
};

use super::{Ending, backend, print};

pub fn devices() -> Result<Ending, Error> {
    backend::quiet_driver();
    let text = listing(&Adapters::enumerate().facts);
    print(&text)?;
    Ok(Ending::Complete)
}

fn listing(adapters: &[AdapterFacts]) -> String {
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
        for (what, value) in lines {
            let _ = writeln!(text, "  {what:<10} {value}");
        }
        text.push('\n');
    }
    let gpu = match choose(adapters, AdapterChoice::Best) {
        Ok(index) => adapters[index].name.clone(),
        Err(error @ GpuError::NotBuilt) => format!("refused: {error}"),
        Err(error) => format!("the processor: {error}"),
    };
    let _ = writeln!(text, "--backend auto   the processor");
    let _ = writeln!(text, "--backend gpu    {gpu}");
    text
}
