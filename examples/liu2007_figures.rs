//! Draws the figures of docs/liu2007.md, and their manifest.
//!
//! ```sh
//! cargo run --release --example liu2007_figures -- results/liu2007
//! ```

#[path = "common/study_figures.rs"]
mod study_figures;

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use jointsweep::Error;
use jointsweep::internals::output::host::{Host, Program, utc};
use jointsweep::internals::output::manifest;
use jointsweep::internals::output::manifest_parts::FileEntry;
use jointsweep::internals::output::whole_file::write_whole;
use jointsweep::internals::study::fingerprint::Fingerprint;
use study_figures::{ACCURACY, Anything, PLATES, figures};

fn main() -> Result<(), Anything> {
    let Some(dir) = std::env::args().nth(1).map(PathBuf::from) else {
        return Err("name the folder of the figures: liu2007_figures DIR".into());
    };
    let started = SystemTime::now();
    std::fs::create_dir_all(&dir)?;
    let mut files = Vec::new();
    for (name, chart) in figures()? {
        let path = dir.join(name);
        write_whole(&path, chart.alone().as_bytes())?;
        files.push(FileEntry::new(name, &Fingerprint::of_file(&path)?));
    }
    save_manifest(&dir, files, started)?;
    println!("{}", dir.display());
    Ok(())
}

fn save_manifest(dir: &Path, files: Vec<FileEntry>, started: SystemTime) -> Result<(), Error> {
    #[derive(serde::Serialize)]
    struct Figures {
        #[serde(flatten)]
        program: Program,
        command: &'static str,
        accuracy: f64,
        outer_radius_ratios: [f64; 5],
        files: Vec<FileEntry>,
        started_utc: String,
        wall_seconds: f64,
        host: Host,
    }
    let path = dir.join("manifest.json");
    let figures = Figures {
        program: Program::CURRENT,
        command: "cargo run --release --example liu2007_figures -- results/liu2007",
        accuracy: ACCURACY,
        outer_radius_ratios: PLATES,
        files,
        started_utc: utc(started),
        wall_seconds: started.elapsed().map_or(0.0, |time| time.as_secs_f64()),
        host: Host::current(),
    };
    manifest::write(&figures, &path)
}
