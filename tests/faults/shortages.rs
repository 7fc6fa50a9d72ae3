//! No memory, no room, nobody who listens.

#[cfg(target_os = "linux")]
use std::collections::BTreeSet;
#[cfg(target_os = "linux")]
use std::fs::File;
use std::process::Command;

use crate::common::workdir::{Ended, Workdir};
use crate::{config, slow_config};

/// The program in a shell that limits it first.
fn limited(work: &Workdir, limit: &str, arguments: &str) -> Ended {
    let program = env!("CARGO_BIN_EXE_jointsweep");
    let command = format!("{limit}; exec '{program}' {arguments}");
    Ended::new(Command::new("sh").args(["-c", &command]).current_dir(work.path("")).output().unwrap())
}

/// A process that gets no memory is ended at once, in the middle of whatever it does. A body of this sweep takes 10 to 14 MB, beyond what the
/// program itself does.
#[test]
fn a_run_that_gets_no_memory_loses_nothing_that_was_finished() {
    let work = Workdir::new("no-memory");
    work.write("slow.toml", &slow_config().replace("0.1 %", "10 %"));
    work.run(&["run", "slow.toml"]).expect(0);
    let table = work.read("out/slow/table.csv");
    // What is coarse can be solved with so little.
    let limit = "ulimit -v 50000";
    limited(&work, limit, "run slow.toml --again --force --threads 1").expect(0);
    work.write("slow.toml", &slow_config());
    let ended = limited(&work, limit, "run slow.toml --force --threads 1");
    assert!(ended.code != Some(0) && ended.code != Some(2), "{:?} {}", ended.code, ended.stderr);
    assert!(work.read("out/slow/table.csv") == table);
    assert_eq!(work.json("out/slow/manifest.json")["state"], "complete");
    for name in ["out/slow/manifest.json.partial", "out/slow/manifest.json.partial.tmp"] {
        if work.path(name).exists() {
            assert_eq!(work.json(name)["state"], "incomplete", "{name}");
        }
    }
}

/// Each thread takes 4 GiB of addresses here, so that the limits let the first, the second ... of them fail.
#[test]
fn a_thread_that_cannot_be_had_is_an_error() {
    let work = Workdir::new("no-threads");
    work.write("sweep.toml", &config(3));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let table = work.read("whole/table.csv");
    let (mut refused, mut complete) = (0, 0);
    // With six threads there are crews, each with threads of its own.
    for (command, most) in [
        ("run sweep.toml --force --again --threads 1", 6),
        ("run sweep.toml --force --again --threads 6 --backend cpu", 20),
        ("explain sweep.toml --design 1", 8),
    ] {
        for threads in 0..=most {
            let limit = format!("export RUST_MIN_STACK=4294967296; ulimit -v {}", (2 * threads + 1) << 21);
            let ended = limited(&work, &limit, command);
            if ended.code == Some(0) {
                complete += 1;
                continue;
            }
            let ended = ended.expect(1);
            assert!(ended.stderr.starts_with("error: cannot start "), "{command}: {}", ended.stderr);
            refused += 1;
        }
    }
    assert!(refused >= 15 && complete >= 3, "{refused} refused, {complete} complete");
    assert_eq!(work.read("out/sweep/table.csv"), table);
}

/// The signal that a file has grown too large ends a process that does not expect it.
#[test]
fn a_file_that_may_not_grow_is_an_error() {
    let work = Workdir::new("no-room");
    work.write("sweep.toml", &config(20_000));
    let ended = limited(&work, "ulimit -f 300", "run sweep.toml").expect(1);
    assert!(
        ended.stderr.starts_with("error: cannot write out/sweep/table.csv.partial: "),
        "{}",
        ended.stderr
    );
    assert_eq!(work.json("out/sweep/manifest.json.partial")["state"], "failed");
    assert!(work.read("out/sweep/table.csv.partial").ends_with(",ok\n"), "the last row is cut");
    assert!(!work.path("out/sweep/table.csv").exists());
}

/// `> /dev/full` is an error of every verb; what was computed is there.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_takes_nothing_is_an_error_of_every_verb() {
    let work = Workdir::new("no-listener");
    work.write("sweep.toml", &config(3));
    work.write(
        "one.toml",
        &config(3).replace("{ from = \"0.01 mm\", to = \"0.1 mm\", count = 3 }", "\"0.05 mm\""),
    );
    work.write("points.csv", "indentation_mm,force_n\n0.001,500\n0.004,2400\n0.01,6800\n");
    let commands = [
        &["--help"][..],
        &["--version"],
        &["help", "run"],
        &["run", "sweep.toml"],
        // What is complete says so.
        &["run", "sweep.toml"],
        &["run", "sweep.toml", "--dry-run"],
        &["explain", "sweep.toml"],
        &["explain", "sweep.toml", "--design", "2"],
        &["devices"],
        &["run", "sweep.toml", "--shard", "1/1", "--out", "shards"],
        &["run", "sweep.toml", "--shard", "1/1", "--dry-run"],
        &["status", "shards"],
        &["merge", "shards"],
        &["run", "sweep.toml", "--retry-failed"],
        &["laws", "out/sweep", "--force"],
        &["report", "out/sweep"],
        &["export", "out/sweep", "--to", "csv", "--design", "0"],
        &["calibrate", "one.toml", "--measured", "points.csv", "--fit", "plate_youngs_modulus"],
        &["sensitivity", "sweep.toml", "--samples", "64"],
        &["pressure", "sweep.toml", "--design", "0"],
        &["materials", "sweep.toml", "--design", "0"],
        &["stresses", "sweep.toml", "--design", "0"],
        &["submit", "sweep.toml", "--shards", "2", "--out", "cluster", "--dry-run"],
        &["resubmit", "cluster", "--missing", "--dry-run"],
        &["init", "new.toml"],
        &["completions", "bash"],
        &["man"],
        &["bench", "sweep.toml", "--runs", "1", "--out", "bench"],
        // On any adapter, be it software: every name holds the empty one.
        &["bench-gpu", "--adapter", "", "--precision", "f32", "--most", "1", "--out", "bench-gpu"],
        &["tradeoff", "sweep.toml", "--runs", "1", "--designs", "1", "--out", "tradeoff", "--quiet"],
    ];
    let tried: BTreeSet<&str> = commands.iter().map(|arguments| arguments[0]).collect();
    let help = work.run(&["--help"]).expect(0).stdout;
    // A verb stands two spaces from the margin, what is said of it further in.
    let verbs: Vec<&str> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(verbs.len() > 15 && verbs.contains(&"bench-gpu"), "{verbs:?}");
    let forgotten: Vec<_> = verbs.iter().filter(|verb| !tried.contains(*verb)).collect();
    assert!(forgotten.is_empty(), "verbs that are not tried here: {forgotten:?}");
    for arguments in commands {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let ended = Ended::new(work.command(arguments).stdout(full).output().unwrap());
        let quiet = arguments.contains(&"--quiet");
        assert_eq!(ended.code, Some(if quiet { 0 } else { 1 }), "{arguments:?}: {}", ended.stderr);
        // Without a driver there is an error before there is anything to print.
        let prints = !quiet && (arguments[0] != "bench-gpu" || cfg!(vulkan_driver));
        if prints && !arguments[0].starts_with('-') && arguments[0] != "help" {
            let told = ended.stderr.lines().last().unwrap_or_default();
            assert!(told.starts_with("error: cannot write to standard output: "), "{arguments:?}: {told}");
        }
    }
    for name in ["out/sweep/table.csv", "bench/sweep.csv", "tradeoff/tradeoff.csv"] {
        assert!(work.path(name).exists(), "{name}");
    }
    // Who has stopped reading is no error.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let ended = Ended::new(work.command(&["explain", "sweep.toml"]).stdout(writer).output().unwrap());
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
}
