//! A program that is built without GPUs says so wherever one is asked for, and sweeps on the processor all the same.
//!
//! cargo test --release --no-default-features --features cli --test without_gpu
#![cfg(not(feature = "gpu"))]

#[path = "common/ring_joint.rs"]
mod ring_joint;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const TOLD: &str = "this jointsweep was built without GPUs: build it with `--features gpu`, or leave the choice to `--backend auto`";

/// A folder with a small sweep in it, and nothing else.
fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    std::fs::write(dir.join("small.toml"), ring_joint::ring_joint("\"0.1 mm\"", "\"0.001 mm\"")).unwrap();
    dir
}

fn run(dir: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_jointsweep")).args(arguments).current_dir(dir).output().unwrap()
}

#[test]
fn a_gpu_that_is_asked_for_is_refused() {
    let dir = folder("without-gpu");
    for asked in [
        &["run", "small.toml", "--backend", "gpu"][..],
        &["run", "small.toml", "--adapter", "H200"],
        &["tradeoff", "small.toml", "--adapter", "H200"],
        &["bench-gpu"],
        &["bench-gpu", "--most", "100"],
    ] {
        let refused = run(&dir, asked);
        assert_eq!(refused.status.code(), Some(1), "{asked:?}");
        assert_eq!(String::from_utf8(refused.stderr).unwrap(), format!("error: {TOLD}\n"), "{asked:?}");
    }
    assert!(!dir.join("out/small").exists());
    let listed = String::from_utf8(run(&dir, &["devices"]).stdout).unwrap();
    assert_eq!(listed, format!("--backend auto   the processor\n--backend gpu    refused: {TOLD}\n"));
}

#[test]
fn the_processor_sweeps() {
    let dir = folder("without-gpu-auto");
    assert_eq!(run(&dir, &["run", "small.toml", "--quiet"]).status.code(), Some(0));
    let table = std::fs::read_to_string(dir.join("out/small/table.csv")).unwrap();
    assert_eq!(table.lines().count(), 2, "{table}");
    let manifest = std::fs::read_to_string(dir.join("out/small/manifest.json")).unwrap();
    assert!(manifest.contains("\"backend\": \"cpu\""), "{manifest}");
}
