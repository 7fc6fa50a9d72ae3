//! Draws tradeoff.svg of a result of `jointsweep tradeoff` again, from its tradeoff.csv: nothing is measured anew.
//!
//! ```sh
//! cargo run --release --example tradeoff_picture -- results/tradeoff-random
//! ```

use std::path::PathBuf;

use jointsweep::internals::lab::tradeoff::errors::{Errors, Quantiles};
use jointsweep::internals::lab::tradeoff::families::FAMILIES;
use jointsweep::internals::lab::tradeoff::measure::Measured;
use jointsweep::internals::lab::tradeoff::plot;
use jointsweep::internals::study::fingerprint::Fingerprint;
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir = PathBuf::from(std::env::args().nth(1).ok_or("name the folder of a result")?);
    let mut reader = csv::Reader::from_path(dir.join("tradeoff.csv"))?;
    let names = reader.headers()?.clone();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let cell = |name: &str| names.iter().position(|own| own == name).map_or("", |place| &record[place]);
        let number = |name: &str| cell(name).parse::<f64>().ok();
        let Some(family) = FAMILIES.iter().find(|family| family.name == cell("family")) else { continue };
        let force = number("force_error_median").map(|median| Quantiles {
            median,
            p95: number("force_error_p95").unwrap_or(f64::INFINITY),
            max: number("force_error_max").unwrap_or(f64::INFINITY),
        });
        let whole = |name: &str| cell(name).parse().unwrap_or(0);
        rows.push(Measured {
            family: family.name,
            choice: cell("choice").into(),
            parameter: number("parameter"),
            runs: whole("runs"),
            time_per_design: number("time_per_design_s").unwrap_or(f64::NAN),
            least_time_per_design: number("time_per_design_min_s").unwrap_or(f64::NAN),
            shared: number("shared_s").unwrap_or(f64::NAN),
            errors: Errors {
                force,
                steps: whole("steps"),
                unanswered: whole("unanswered"),
                ..Errors::default()
            },
            on_front: cell("on_front") == "true",
        });
    }
    let path = dir.join("manifest.json");
    let mut manifest: Value = serde_json::from_str(&std::fs::read_to_string(&path)?)?;
    let picture = plot::svg(manifest["title"].as_str().unwrap_or_default(), &rows)?;
    let print = Fingerprint::of(picture.as_bytes());
    for file in manifest["files"].as_array_mut().into_iter().flatten() {
        if file["path"] == "tradeoff.svg" {
            (file["bytes"], file["xxh128"]) = (json!(print.bytes), json!(print.hash()));
        }
    }
    std::fs::write(dir.join("tradeoff.svg"), picture)?;
    std::fs::write(path, serde_json::to_string_pretty(&manifest)? + "\n")?;
    Ok(())
}
