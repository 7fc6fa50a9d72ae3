//! Answers and every kind of table, in shards and killed: the bytes are those of a run in one piece.

use std::time::Instant;

use crate::common::workdir::Workdir;
use crate::config;
use crate::kills::{done, killed_after, killed_beyond};

const DESIGNS: usize = 16_000;

const ANSWERS: &str = r#"
[select]
keep = "peak_pressure < 100 MPa and force > 300 N"
[reduce]
statistics = ["force", "energy"]
quantiles = [0.1, 0.5]
best = { count = 20, by = "tangent_stiffness / peak_pressure" }
pareto = { largest = "force", smallest = "peak_pressure" }
histogram = { of = "peak_pressure", bins = 7, spacing = "log" }
"#;

/// The files of a folder with their bytes, without the manifest and the shards.
fn results(work: &Workdir, folder: &str) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<(String, Vec<u8>)> = std::fs::read_dir(work.path(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_none_or(|ending| ending != "shard" && ending != "json"))
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_string(), std::fs::read(&path).unwrap()))
        .collect();
    found.sort();
    found
}

#[track_caller]
fn assert_alike(work: &Workdir, folder: &str, expected: &[(String, Vec<u8>)]) {
    let found = results(work, folder);
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&found), names(expected));
    for ((name, found), (_, expected)) in found.iter().zip(expected) {
        assert!(found == expected, "{folder}/{name} is not that of a run in one piece");
    }
}

#[test]
fn shards_and_kills_leave_no_trace_in_answers_and_tables() {
    let work = Workdir::new("kinds");
    let answers_only = ANSWERS.to_string();
    let with_rows =
        format!("{ANSWERS}[output]\ntable = true\ncolumns = [\"design\", \"force_n\", \"status\"]\n");
    let table = |format: &str| format!("[output]\nformat = \"{format}\"\ninputs = \"varying\"\n");
    let kept = format!("[select]\nkeep = \"force > 300 N\"\n{}", table("parquet"));
    let kinds = [
        (answers_only, 4),
        (with_rows, 5),
        (table("csv"), 1),
        (table("csv.zst"), 1),
        (table("parquet"), 1),
        (kept, 1),
    ];
    for (more, files) in kinds {
        work.write("sweep.toml", &format!("{}{more}", config(DESIGNS)));
        let started = Instant::now();
        work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
        let whole_run = started.elapsed().as_secs_f64();
        let whole = results(&work, "whole");
        assert_eq!(whole.len(), files);
        assert!(whole.iter().all(|(_, bytes)| bytes.len() > 100));
        for shard in ["2/3", "3/3", "1/3"] {
            work.run(&["run", "sweep.toml", "--out", "parts", "--shard", shard, "--threads", "1"]).expect(0);
        }
        work.run(&["merge", "parts"]).expect(0);
        assert_alike(&work, "parts", &whole);
        let counts = |folder: &str| work.json(&format!("{folder}/manifest.json"))["counts"].clone();
        for key in ["rows", "kept_rows", "statuses"] {
            assert_eq!(counts("parts")[key], counts("whole")[key], "{key}");
        }
        let run = ["run", "sweep.toml", "--out", "killed"];
        // The first is killed in the middle, the others at any moment.
        let mut killed = vec![killed_beyond(&work, 0, "killed", &run)];
        assert!(killed[0].code.is_none() && done(&work, "killed") > 0, "{}", killed[0].stderr);
        killed.extend([0.5, 0.2, 0.8].map(|share| killed_after(&work, share * whole_run, &run)));
        for ended in &killed {
            assert!(!ended.stderr.contains("warning"), "{}", ended.stderr);
        }
        let went_on = killed.iter().filter(|ended| ended.stderr.contains("were done before; going on"));
        assert!(went_on.count() > 0, "none went on");
        work.run(&["run", "sweep.toml", "--out", "killed"]).expect(0);
        assert_alike(&work, "killed", &whole);
        for folder in ["whole", "parts", "killed"] {
            std::fs::remove_dir_all(work.path(folder)).unwrap();
        }
    }
}
