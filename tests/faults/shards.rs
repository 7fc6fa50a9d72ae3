//! Shards that are killed, made twice, damaged, missing or of something else.

use crate::common::workdir::{Ended, Workdir};
use crate::config;
use crate::kills::{done, end, killed_beyond};

const SHARDS: u64 = 5;

fn shard(work: &Workdir, number: u64, more: &[&str]) -> Ended {
    let part = format!("{number}/{SHARDS}");
    work.run(&[&["run", "sweep.toml", "--out", "shards", "--shard", &part], more].concat())
}

/// A sweep on meshes, which do not carry the thinnest of its plates.
fn sweep(work: &Workdir, designs: usize) -> String {
    let config = config(designs)
        .replace("{ from = \"0.01 mm\", to = \"0.1 mm\",", "\"0.05 mm\" #")
        .replace(
            "outer_radius_ratio = 3.0",
            &format!("outer_radius_ratio = {{ from = 1.00001, to = 1.3, count = {designs} }}"),
        )
        .replace("method = \"series\"", "method = \"fe\"\naccuracy = \"5 %\"\ninterpolation = \"off\"");
    work.write("sweep.toml", &config);
    work.run(&["run", "sweep.toml", "--out", "whole"]);
    work.read("whole/table.csv")
}

#[test]
fn merged_shards_are_the_whole_sweep_to_the_byte() {
    let work = Workdir::new("shards");
    for designs in [7, 900] {
        let table = sweep(&work, designs);
        // Laws are fitted to so few, and have a table of their own.
        let laws = work.read("whole/laws.csv");
        for number in (1..=SHARDS).rev() {
            let ended = shard(&work, number, &["--threads", if number % 2 == 0 { "1" } else { "2" }]);
            assert!(matches!(ended.code, Some(0 | 2)), "{}", ended.stderr);
        }
        let merged = work.run(&["merge", "shards"]);
        let whole = work.json("whole/manifest.json");
        let failed = whole["counts"]["failed_designs"].as_u64().unwrap();
        assert_eq!(merged.code, Some(if failed > 0 { 2 } else { 0 }), "{}", merged.stderr);
        assert!(work.read("shards/table.csv") == table && work.read("shards/laws.csv") == laws);
        let manifest = work.json("shards/manifest.json");
        assert_eq!(manifest["files"], whole["files"]);
        for key in [
            "designs",
            "designs_asked",
            "rows",
            "rows_asked",
            "failed_designs",
            "statuses",
            "failures",
            "forces_n",
        ] {
            assert_eq!(manifest["counts"][key], whole["counts"][key], "{key}");
        }
        // It is a result as any other.
        let again = work.run(&["run", "sweep.toml", "--out", "shards"]);
        assert!(again.stdout.contains("already complete"), "{}", again.stderr);
        assert!(work.run(&["merge", "shards"]).stdout.contains("already merged"));
        std::fs::remove_dir_all(work.path("shards")).unwrap();
        std::fs::remove_dir_all(work.path("whole")).unwrap();
    }
}

#[test]
fn a_merge_says_what_is_missing_or_damaged_and_writes_nothing() {
    let work = Workdir::new("shards-damage");
    let table = sweep(&work, 900);
    (1..=SHARDS).for_each(|number| drop(shard(&work, number, &[])));
    let path = |number: u64| work.path(&format!("shards/shard-{number}-of-{SHARDS}.shard"));
    let refused = |told: &str| {
        let ended = work.run(&["merge", "shards"]).expect(1);
        assert!(ended.stderr.contains(told), "{told}: {}", ended.stderr);
        assert!(!work.path("shards/table.csv").exists() && !work.path("shards/manifest.json").exists());
    };
    let bytes = std::fs::read(path(3)).unwrap();
    std::fs::remove_file(path(3)).unwrap();
    refused("shard 3 of 5 is missing");
    std::fs::rename(path(2), work.path("aside")).unwrap();
    refused("shards 2-3 of 5 are missing");
    std::fs::rename(work.path("aside"), path(2)).unwrap();
    // Every byte counts: of the header, the rows, the manifest and the end.
    let length = bytes.len();
    for place in [0, 1000, length / 2, length - 1500, length - 40, length - 30, length - 20, length - 3] {
        let mut damaged = bytes.clone();
        damaged[place] ^= 4;
        std::fs::write(path(3), damaged).unwrap();
        refused("shard-3-of-5.shard is damaged");
    }
    for cut in [0, 10, length / 2, length - 1] {
        std::fs::write(path(3), &bytes[..cut]).unwrap();
        refused("shard-3-of-5.shard is damaged");
    }
    // A shard that was copied under another name.
    std::fs::write(path(3), std::fs::read(path(4)).unwrap()).unwrap();
    refused("shard-3-of-5.shard is damaged");
    // It is made again without being asked twice.
    std::fs::write(path(3), &bytes[..length / 2]).unwrap();
    shard(&work, 3, &[]);
    work.run(&["merge", "shards"]);
    assert!(work.read("shards/table.csv") == table);
}

/// Before it is solved, not when hours later all are put together.
#[test]
fn a_shard_beside_those_of_another_sweep_is_refused() {
    let work = Workdir::new("shards-beside");
    sweep(&work, 90);
    shard(&work, 1, &[]);
    work.write("other.toml", &config(95));
    let of_other = ["run", "other.toml", "--out", "shards", "--shard", "2/5"];
    let ended = work.run(&of_other).expect(1);
    assert!(ended.stderr.contains("a shard of another config (sweep.toml)"), "{}", ended.stderr);
    assert!(!work.path("shards/shard-2-of-5.shard").exists());
    shard(&work, 2, &[]);
}

#[test]
fn shards_of_different_sweeps_are_not_mixed() {
    let work = Workdir::new("shards-other");
    sweep(&work, 90);
    (1..=SHARDS).for_each(|number| drop(shard(&work, number, &[])));
    // The same shard of another config.
    work.write("other.toml", &config(95));
    let ended = work.run(&["run", "other.toml", "--out", "shards", "--shard", "2/5"]).expect(1);
    assert!(ended.stderr.contains("a shard of another config (sweep.toml)"), "{}", ended.stderr);
    work.run(&["run", "other.toml", "--out", "shards", "--shard", "2/5", "--force"]).expect(0);
    let ended = work.run(&["merge", "shards"]).expect(1);
    assert!(ended.stderr.contains("are of different configs: sweep.toml and other.toml"), "{}", ended.stderr);
    // Another count of shards.
    let sevenths = ["run", "sweep.toml", "--out", "shards", "--shard", "2/7"];
    let ended = work.run(&sevenths).expect(1);
    assert!(ended.stderr.contains("a shard of a sweep in 5, not in 7"), "{}", ended.stderr);
    let ended = work.run(&[&sevenths[..], &["--force"]].concat());
    assert!(matches!(ended.code, Some(0 | 2)), "{}", ended.stderr);
    let ended = work.run(&["merge", "shards"]).expect(1);
    assert!(ended.stderr.contains("there are shards of 5 and shards of 7"), "{}", ended.stderr);
    // Another program.
    let work = Workdir::new("shards-program");
    sweep(&work, 90);
    (1..=SHARDS).for_each(|number| drop(shard(&work, number, &[])));
    for (arguments, told) in [
        ("0/5", "shards are counted from 1 to 5"),
        ("6/5", "there is no shard 6 of 5"),
        ("1/0", "there must be at least one shard"),
        ("1/91", "91 shards of a sweep with 90 designs: at most 90 are possible"),
        ("one", "a shard is named like 3/100"),
        ("1/99999999999", "are too many"),
    ] {
        let ended = work.run(&["run", "sweep.toml", "--shard", arguments]).expect(1);
        assert!(ended.stderr.contains(told), "{arguments}: {}", ended.stderr);
    }
    for (arguments, told) in
        [(&["merge", "nowhere"][..], "cannot read nowhere"), (&["merge", "whole"], "there are no shards")]
    {
        let ended = work.run(arguments).expect(1);
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
    }
}

/// Batch systems start a shard twice, and kill it in the middle.
#[test]
fn a_shard_that_is_started_twice_or_killed_is_made_once() {
    let work = Workdir::new("shards-twice");
    let few_columns = "[output]\ncolumns = [\"design\", \"force_n\", \"status\"]\n";
    work.write("sweep.toml", &format!("{}{few_columns}", config(60_000)));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let table = work.read("whole/table.csv");
    let first = ["run", "sweep.toml", "--out", "shards", "--shard", "1/5"];
    let ended = [work.start(&first), work.start(&first)].map(end);
    let said: String = ended.iter().map(|ended| ended.stdout.clone()).collect();
    assert!(
        ended.iter().all(|ended| matches!(ended.code, Some(0 | 2))),
        "{}{}",
        ended[0].stderr,
        ended[1].stderr
    );
    assert!(said.contains("written:") && said.contains("already complete"), "{said}");
    for number in 2..=SHARDS {
        let folder = format!("shards/shard-{number}-of-{SHARDS}.partial");
        let part = format!("{number}/{SHARDS}");
        // Some designs are done when it is killed; of the second time it may be all.
        let arguments = ["run", "sweep.toml", "--out", "shards", "--threads", "1", "--shard", &part];
        let ended = killed_beyond(&work, 0, &folder, &arguments);
        assert_eq!(ended.code, None, "{}", ended.stderr);
        killed_beyond(&work, done(&work, &folder), &folder, &arguments);
        assert!(matches!(shard(&work, number, &[]).code, Some(0 | 2)));
    }
    work.run(&["merge", "shards"]);
    assert!(work.read("shards/table.csv") == table);
    let left: Vec<String> = work.files().into_iter().filter(|name| name.contains("partial")).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// Killed when all its rows were there and its file was not: nothing is computed again. Killed when its file was there, too:
/// the folder of its rows goes.
#[test]
fn a_shard_that_is_killed_at_its_very_end_leaves_nothing_behind() {
    const DESIGNS: u64 = 20_000;
    let work = Workdir::new("shards-end");
    work.write("sweep.toml", &config(DESIGNS as usize));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let arguments = ["run", "sweep.toml", "--out", "shards", "--shard", "1/1"];
    let (folder, kept) = (work.path("shards/shard-1-of-1.partial"), work.path("kept"));
    let mut tries = 0;
    while done(&work, "shards/shard-1-of-1.partial") < DESIGNS {
        assert!(tries < 20, "it is never killed between its rows and its file");
        tries += 1;
        let _ = std::fs::remove_dir_all(work.path("shards"));
        killed_beyond(&work, DESIGNS - 1, "shards/shard-1-of-1.partial", &arguments);
    }
    std::fs::create_dir(&kept).unwrap();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), kept.join(entry.file_name())).unwrap();
    }
    let ended = work.run(&arguments).expect(0);
    let told = format!("{DESIGNS} of {DESIGNS} designs were done before; going on");
    assert!(ended.stderr.contains(&told), "{}", ended.stderr);
    std::fs::rename(&kept, &folder).unwrap();
    let ended = work.run(&arguments).expect(0);
    assert!(ended.stdout.contains("already complete"), "{}", ended.stdout);
    assert!(!folder.exists());
    work.run(&["merge", "shards"]).expect(0);
    assert!(work.read("shards/table.csv") == work.read("whole/table.csv"));
}

/// Failed rows are done again, and nothing else.
#[test]
fn failed_rows_alone_are_done_again() {
    let work = Workdir::new("retry");
    let table = sweep(&work, 900);
    let manifest = work.json("whole/manifest.json");
    assert!(manifest["counts"]["failed_rows"].as_u64() > Some(0), "{manifest}");
    // Nothing is different the second time.
    let ended = work.run(&["run", "sweep.toml", "--out", "whole", "--retry-failed"]).expect(2);
    assert!(ended.stdout.contains("failed rows were done again"), "{}", ended.stdout);
    assert!(work.read("whole/table.csv") == table);
    assert_eq!(work.json("whole/manifest.json")["counts"], manifest["counts"]);
    // Rows that failed for reasons of that day.
    let mut broken = 0;
    let lines = table.lines().enumerate().map(|(number, line)| {
        if number % 37 != 5 || line.contains("failed") {
            return format!("{line}\n");
        }
        broken += 1;
        let cells: Vec<&str> = line.split(',').collect();
        let inputs = 17;
        format!("{},{},,,,,,,,,,failed: the device was lost\n", cells[..inputs].join(","), cells[inputs])
    });
    let text: String = lines.collect();
    assert!(broken > 100);
    work.write("whole/table.csv", &text);
    // The manifest vouches for the broken table.
    let print = jointsweep::internals::study::fingerprint::Fingerprint::of(text.as_bytes());
    let mut forged = manifest.clone();
    forged["files"][0]["bytes"] = print.bytes.into();
    forged["files"][0]["xxh128"] = print.hash().into();
    let failed = manifest["counts"]["failed_rows"].as_u64().unwrap();
    forged["counts"]["failed_rows"] = (failed + broken).into();
    let ok = manifest["counts"]["statuses"]["ok"].as_u64().unwrap();
    forged["counts"]["statuses"]["ok"] = (ok - broken).into();
    for map in ["statuses", "failures"] {
        forged["counts"][map]["failed: the device was lost"] = broken.into();
    }
    work.write("whole/manifest.json", &forged.to_string());
    work.run(&["run", "sweep.toml", "--out", "whole", "--retry-failed"]).expect(2);
    assert!(work.read("whole/table.csv") == table, "the rows are not those of the first run");
    let now = work.json("whole/manifest.json");
    assert_eq!(now["counts"], manifest["counts"]);
    assert_eq!(now["files"], manifest["files"]);
    assert!(work.path("whole/laws.csv").exists());
    // Only what is finished has failed.
    let ended = work.run(&["run", "sweep.toml", "--out", "new", "--retry-failed"]).expect(1);
    assert!(ended.stderr.contains("there is no finished result"), "{}", ended.stderr);
}
