//! What is committed under results/ is what the program of today makes: every table, cell by cell. `benches/results` makes
//! them anew.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::engine::unit_costs::Pace;
use jointsweep::internals::output::sink::Sink;
use jointsweep::internals::output::table::Table;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::fingerprint::Fingerprint;
use serde_json::Value;

/// Each with its manifest beside it.
const TABLES: [&str; 7] =
    ["liu2007", "liu2007-plates", "quickstart", "thin-liners", "bush", "lined-block", "press-fit"];

/// A table has nine digits; the last ones hang on the width of a machine's vectors.
const ROUNDING: f64 = 1e-7;

/// `force_error` is a share of the force, whose own rounding it does not tell: exact bodies have some 1e-8.
const OF_FORCE: f64 = 1e-12;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn json(path: &str) -> Value {
    serde_json::from_str(&read(path)).unwrap()
}

/// The table of a study, as `run` writes it.
fn table(study: &Study) -> String {
    let table = Table::of(study);
    let mut text = table.header();
    sweep::run(study, &SweepOptions::default(), &mut |outcome| {
        text.extend(table.rows(&[outcome]));
        Ok(ControlFlow::Continue(()))
    })
    .unwrap();
    String::from_utf8(text).unwrap()
}

/// Checks what every manifest says of the config it belongs to, and of the program.
fn check_manifest(manifest: &Value, config: &str) {
    assert_eq!(manifest["config"]["text"], read(config), "{config} is not what was run");
    let commit = manifest["commit"].as_str().unwrap_or_default();
    let is_one = commit.len() >= 7 && commit.chars().all(|digit| digit.is_ascii_hexdigit());
    assert!(is_one, "{config}: made from `{commit}`, which is no commit");
}

#[test]
fn every_table_is_that_of_the_program_of_today() {
    let mut cells = 0;
    for name in TABLES {
        let config = format!("configs/{name}.toml");
        let committed = read(&format!("results/{name}.csv"));
        let manifest = json(&format!("results/{name}.manifest.json"));
        check_manifest(&manifest, &config);
        let print = Fingerprint::of(committed.as_bytes());
        let file = &manifest["files"][0];
        assert_eq!(
            (file["bytes"].as_u64(), file["xxh128"].as_str()),
            (Some(print.bytes), Some(&*print.hash()))
        );
        assert_eq!((&manifest["state"], &manifest["backend"]), (&"complete".into(), &"cpu".into()));

        let study = Study::from_text(Path::new(&config), read(&config)).unwrap();
        let today = table(&study);
        let [mut found, mut expected] =
            [&today, &committed].map(|text| csv::Reader::from_reader(text.as_bytes()));
        assert_eq!(found.headers().unwrap(), expected.headers().unwrap(), "{name}");
        let names = found.headers().unwrap().clone();
        let rows: Vec<_> = found.records().zip(expected.records()).collect();
        let count = [&today, &committed].map(|text| text.lines().count());
        assert_eq!(count, [rows.len() + 1; 2], "{name}");
        assert_eq!(manifest["counts"]["rows"], rows.len());
        for (row, (found, expected)) in rows.into_iter().enumerate() {
            let (found, expected) = (found.unwrap(), expected.unwrap());
            for ((column, found), expected) in names.iter().zip(&found).zip(&expected) {
                cells += 1;
                if found == expected {
                    continue;
                }
                let numbers = found.parse::<f64>().and_then(|found| Ok((found, expected.parse::<f64>()?)));
                let least = if column == "force_error" { OF_FORCE } else { 0.0 };
                let is_alike = numbers.is_ok_and(|(a, b)| (a - b).abs() <= (ROUNDING * b.abs()).max(least));
                assert!(is_alike, "{name}, row {row}, {column}: {found} today, {expected} in results/");
            }
        }
    }
    assert!(cells > 20_000, "{cells} cells compared");
}

/// The times of whole runs are those of a machine; what was run, how much it was, and the forecast are the program's.
#[test]
fn recorded_runs_are_what_was_foreseen() {
    let manifest = json("results/sweep.manifest.json");
    let mut reader = csv::Reader::from_path(root().join("results/sweep.csv")).unwrap();
    let names = reader.headers().unwrap().clone();
    let mut configs = Vec::new();
    for (index, record) in reader.records().enumerate() {
        let record = record.unwrap();
        let cell = |name: &str| &record[names.iter().position(|own| own == name).unwrap()];
        let number = |name: &str| cell(name).parse::<f64>().unwrap();
        let config = cell("config").to_string();
        let commit = &manifest["commit"];
        let own = &manifest["configs"][index];
        check_manifest(&serde_json::json!({ "config": own, "commit": commit }), &config);

        let study = Study::load(&root().join(&config)).unwrap();
        let estimate = cost::estimate(&study).unwrap();
        let counts = [estimate.designs, estimate.rows, estimate.distinct_bodies].map(|count| count as f64);
        assert_eq!(["designs", "rows", "distinct_bodies"].map(number), counts, "{config}");
        let forecast = number("forecast_core_s");
        let pace = Pace { in_lanes: number("pace_in_lanes"), others: number("pace_others") };
        let today = estimate.time.at(pace);
        assert!((today / forecast - 1.0).abs() < 0.02, "{config}: {today} {forecast}");
        let ratio = forecast / number("processor_median_s");
        println!("{config}: {ratio:.2} of the time that it took");
        assert!((0.4..1.5).contains(&ratio), "{config}: {ratio}");
        assert!(number("peak_memory_bytes") < 2.5e8, "{config}");
        configs.push(config);
    }
    let mut all: Vec<String> = std::fs::read_dir(root().join("configs"))
        .unwrap()
        .map(|file| format!("configs/{}", file.unwrap().file_name().to_string_lossy()))
        .filter(|name| name.ends_with(".toml"))
        .collect();
    all.sort();
    assert_eq!(configs, all, "every config is measured");
}
