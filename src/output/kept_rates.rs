//! What devices were measured to do, kept from one run of the program to the next.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::engine::backend::choice::GpuChoice;
use crate::engine::backend::gpu::calibration::measure;
use crate::engine::backend::gpu::context::GpuError;
use crate::engine::backend::precision::Precision;
use crate::engine::backend::rates::Rates;
use crate::error::Error;
use crate::output::host::{Host, Program};
use crate::output::whole_file::{create_dir, write_whole};

/// The file, in a folder that the user may empty at any time.
pub const RATES: &str = "rates.json";

/// More than this is no file of ours, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Most entries: the oldest go.
const MOST_KEPT: usize = 64;

/// What rates hold for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Measured {
    /// With its commit.
    program: String,
    cpu: Option<String>,
    adapter: String,
    driver: String,
    precision: String,
    solver: String,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Entry {
    of: Measured,
    rates: Rates,
}

/// Those of a device as it was chosen: as they were kept, or else measured now and kept, if there is a folder. Where they cannot be kept
/// there are rates all the same, and why they could not.
pub fn rates(folder: Option<&Path>, choice: &GpuChoice) -> Result<(Rates, Option<Error>), GpuError> {
    let of = Measured::of(choice);
    match folder.and_then(|folder| entries(folder).into_iter().find(|entry| entry.of == of)) {
        Some(entry) => Ok((entry.rates, None)),
        None => measured_anew(folder, choice),
    }
}

/// What is kept of any device beside this processor, in numbers of this precision: enough to leave devices alone that would not help.
pub fn known(folder: Option<&Path>, precision: Precision) -> Vec<Rates> {
    let (program, cpu) = (Program::CURRENT.in_words(), Host::current().cpu);
    let all = folder.map(entries).unwrap_or_default().into_iter();
    let is_here = |of: &Measured| of.program == program && of.cpu == cpu && of.precision == precision.name();
    all.filter(|entry| is_here(&entry.of)).map(|entry| entry.rates).collect()
}

/// The same as `rates`, measured now whatever was kept.
pub fn measured_anew(folder: Option<&Path>, choice: &GpuChoice) -> Result<(Rates, Option<Error>), GpuError> {
    let rates = measure(choice.device, choice.precision, choice.solver, choice.joints)?;
    let Some(folder) = folder else { return Ok((rates, None)) };
    let of = Measured::of(choice);
    let mut all = entries(folder);
    all.retain(|entry| entry.of != of);
    all.push(Entry { of, rates });
    let from = all.len().saturating_sub(MOST_KEPT);
    let text = serde_json::to_string_pretty(&all[from..]).unwrap_or_default() + "\n";
    let kept = create_dir(folder).and_then(|()| write_whole(&folder.join(RATES), text.as_bytes()));
    Ok((rates, kept.err()))
}

impl Measured {
    fn of(GpuChoice { device, precision, solver, .. }: &GpuChoice) -> Measured {
        Measured {
            program: Program::CURRENT.in_words(),
            cpu: Host::current().cpu,
            adapter: device.facts.name.clone(),
            driver: device.facts.driver.clone(),
            precision: precision.name().into(),
            solver: solver.name().into(),
        }
    }
}

/// None where there is no such file, or one that cannot be read.
fn entries(folder: &Path) -> Vec<Entry> {
    let mut text = String::new();
    let file = File::open(folder.join(RATES)).map(|file| file.take(MOST_BYTES));
    if file.and_then(|mut file| file.read_to_string(&mut text)).is_err() {
        return Vec::new();
    }
    let mut entries: Vec<Entry> = serde_json::from_str(&text).unwrap_or_default();
    entries.retain(|entry| entry.rates.are_sound());
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::unit_costs::Pace;

    /// Of this program beside this processor alone, in these numbers alone; of no file and of one that is no rates nothing.
    #[test]
    fn what_is_known_is_of_this_machine() {
        let folder = std::env::temp_dir().join(format!("jointsweep-rates-{}", std::process::id()));
        assert_eq!(known(Some(&folder), Precision::F32), []);
        assert_eq!(known(None, Precision::F32), []);
        let rates = |in_lanes| {
            let processor = Pace { in_lanes, others: 1.0 };
            Rates { processor, device: 0.1, host: 1e-6, start: 0.1, joints: None }
        };
        let here = Measured {
            program: Program::CURRENT.in_words(),
            cpu: Host::current().cpu,
            adapter: "one".into(),
            driver: "its own".into(),
            precision: "f32".into(),
            solver: "auto".into(),
        };
        let entry = |of: Measured, processor| Entry { of, rates: rates(processor) };
        let all = [
            entry(here.clone(), 2.0),
            entry(Measured { adapter: "another".into(), ..here.clone() }, 3.0),
            entry(Measured { precision: "mixed".into(), ..here.clone() }, 4.0),
            entry(Measured { cpu: Some("another".into()), ..here.clone() }, 5.0),
            entry(Measured { program: "another".into(), ..here }, 6.0),
        ];
        create_dir(&folder).unwrap();
        let write = |text: &str| write_whole(&folder.join(RATES), text.as_bytes()).unwrap();
        write(&serde_json::to_string(&all).unwrap());
        assert_eq!(known(Some(&folder), Precision::F32), [rates(2.0), rates(3.0)]);
        assert_eq!(known(Some(&folder), Precision::Mixed), [rates(4.0)]);
        write("no rates");
        assert_eq!(known(Some(&folder), Precision::F32), []);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
