//! The figures of docs/liu2007.md in results/liu2007 are what the program of today draws.

#[path = "../../examples/common/study_figures.rs"]
mod figures;

use std::path::{Path, PathBuf};

use jointsweep::internals::study::fingerprint::Fingerprint;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

/// Numbers of a picture, and what stands between them.
fn parts(picture: &str) -> (Vec<f64>, String) {
    let (mut numbers, mut rest) = (Vec::new(), String::new());
    let mut number = String::new();
    for character in picture.chars().chain(['\n']) {
        if character.is_ascii_digit() || character == '.' {
            number.push(character);
            continue;
        }
        if let Ok(value) = number.parse::<f64>() {
            numbers.push(value);
        }
        number.clear();
        rest.push(character);
    }
    (numbers, rest)
}

#[test]
fn the_committed_figures_are_todays() {
    let dir = root().join("results/liu2007");
    let manifest = std::fs::read_to_string(dir.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    let document = std::fs::read_to_string(root().join("docs/liu2007.md")).unwrap();
    let figures = figures::figures().unwrap();
    assert_eq!(figures.len(), 14);
    assert_eq!(manifest["files"].as_array().unwrap().len(), figures.len());
    let mut compared = 0;
    for ((name, chart), entry) in figures.iter().zip(manifest["files"].as_array().unwrap()) {
        let committed = std::fs::read_to_string(dir.join(name)).unwrap();
        assert!(committed.len() < 100_000, "{name}: {} bytes", committed.len());
        let print = Fingerprint::of_file(&dir.join(name)).unwrap();
        assert_eq!((entry["path"].as_str(), entry["xxh128"].as_str()), (Some(*name), Some(&*print.hash())));
        assert!(document.contains(&format!("../results/liu2007/{name}")), "{name} is not in docs/liu2007.md");
        // Coordinates have a decimal, px: one digit of it, for round-off of other processors.
        let ((expected, text), (found, drawn)) = (parts(&committed), parts(&chart.alone()));
        assert_eq!(text, drawn, "{name}");
        assert_eq!(expected.len(), found.len(), "{name}");
        for (expected, found) in expected.iter().zip(&found) {
            assert!((expected - found).abs() < 0.101, "{name}: {expected} committed, {found} today");
            compared += 1;
        }
    }
    assert!(compared > 10_000, "{compared}");
}
