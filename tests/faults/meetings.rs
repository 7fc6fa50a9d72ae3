//! Two runs in one folder, one of them killed at any moment.

use std::time::Duration;

use crate::common::length::count;
use crate::common::random::Random;
use crate::common::workdir::{Ended, Workdir};
use crate::config;
use crate::kills::{end, send};

/// Of each kind of ending.
fn times() -> u64 {
    count(5, 10)
}

/// What one meeting came to.
struct Meeting {
    killed: Ended,
    other: Ended,
    manifest: Option<serde_json::Value>,
}

/// Two runs at about the same time, of which one is killed after a while of about the time that a whole run takes.
fn meet(work: &Workdir, random: &mut Random, more: &[&str], signal: &str) -> Meeting {
    let arguments = [&["run", "sweep.toml", "--out", "result"], more].concat();
    let first = work.start(&arguments);
    std::thread::sleep(Duration::from_secs_f64(random.linear(0.0, 0.05)));
    let second = work.start(&arguments);
    std::thread::sleep(Duration::from_secs_f64(random.linear(0.0, 0.6)));
    let (killed, other) = if random.unit() < 0.7 { (first, second) } else { (second, first) };
    send(signal, &killed);
    let (killed, other) = (end(killed), end(other));
    let manifest = work.path("result/manifest.json").exists().then(|| work.json("result/manifest.json"));
    for name in ["result/manifest.json", "result/manifest.json.partial"] {
        if work.path(name).exists() {
            assert_ne!(work.json(name)["state"], "running");
        }
    }
    Meeting { killed, other, manifest }
}

/// What a run that was not killed says: that it is done, or that another has the folder.
#[track_caller]
fn check_survivor(other: &Ended) -> bool {
    let is_refused = other.code == Some(1) && other.stderr.contains("is in use by another run");
    assert!(is_refused || other.code == Some(0), "{:?} {}", other.code, other.stderr);
    is_refused
}

/// A finished result outlives every rerun.
#[test]
fn a_finished_result_is_never_lost_by_a_rerun() {
    let work = Workdir::new("meetings-finished");
    work.write("sweep.toml", &config(20_000));
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    let table = work.read("result/table.csv");
    let mut random = Random::new(7);
    let (mut refused, mut cut) = (0, 0);
    for signal in ["-INT", "-KILL"] {
        for _ in 0..times() {
            let meeting = meet(&work, &mut random, &["--again"], signal);
            refused += u64::from(check_survivor(&meeting.other));
            cut += u64::from(meeting.killed.code != Some(0));
            assert!(work.read("result/table.csv") == table, "the table has changed");
            let manifest = meeting.manifest.expect("the manifest stays");
            assert_eq!(
                (&manifest["state"], &manifest["counts"]["rows"]),
                (&"complete".into(), &200_000.into())
            );
        }
    }
    // They did meet, and did not all end before they were killed.
    println!("{refused} refused, {cut} cut short");
    assert!(refused >= times() / 2 && cut >= times() / 2, "{refused} refused, {cut} cut short");
    work.run(&["run", "sweep.toml", "--out", "result", "--again"]).expect(0);
    assert_eq!(work.files(), ["result/manifest.json", "result/table.csv", "sweep.toml"]);
    assert!(work.read("result/table.csv") == table);
}

/// Where there is no result yet, whoever goes through has the right one; and if nobody does, what is there are the first rows.
#[test]
fn the_survivor_of_two_runs_has_the_right_table() {
    let work = Workdir::new("meetings-new");
    work.write("sweep.toml", &config(20_000));
    work.run(&["run", "sweep.toml", "--out", "expected"]).expect(0);
    let table = work.read("expected/table.csv");
    let mut random = Random::new(8);
    let (mut complete, mut partial) = (0, 0);
    for signal in ["-INT", "-KILL"] {
        for _ in 0..times() {
            let meeting = meet(&work, &mut random, &[], signal);
            let is_refused = check_survivor(&meeting.other);
            if let Some(manifest) = &meeting.manifest {
                assert_eq!(manifest["state"], "complete");
                assert!(work.read("result/table.csv") == table, "the table is wrong");
                complete += 1;
            } else {
                assert!(is_refused && meeting.killed.code != Some(0));
                assert!(!work.path("result/table.csv").exists());
                if work.path("result/table.csv.partial").exists() {
                    // A kill may stop the system itself in the middle of a write, and so of a row.
                    let rows = work.read("result/table.csv.partial");
                    assert!(table.starts_with(&rows), "{} bytes are not the first", rows.len());
                    assert!(signal == "-KILL" || rows.ends_with('\n'), "the last row is cut");
                    partial += u64::from(rows.len() > 1000);
                }
            }
            if work.path("result").exists() {
                std::fs::remove_dir_all(work.path("result")).unwrap();
            }
        }
    }
    println!("{complete} complete, {partial} with first rows");
    assert!(complete >= 2 && partial >= 2, "{complete} complete, {partial} with first rows");
}
