//! A run that was killed goes on where it stopped, and nothing tells the result from that of a run in one piece.

use std::time::{Duration, SystemTime};

use crate::common::length::count;
use crate::common::random::Random;
use crate::common::workdir::Workdir;
use crate::config;
use crate::kills::{done, killed_after, killed_beyond};

/// Some seconds of a machine with two cores, in a table of many megabytes.
const DESIGNS: usize = 20_000;

#[test]
fn a_run_killed_at_any_moments_ends_with_the_bytes_of_one_in_a_piece() {
    let work = Workdir::new("resume");
    work.write("sweep.toml", &config(DESIGNS));
    let started = SystemTime::now();
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let whole_run = started.elapsed().unwrap().as_secs_f64();
    let table = work.read("whole/table.csv");
    let mut random = Random::new(16);
    let all_kills = count(10, 20);
    let (mut kills, mut went_on, mut completed) = (0, 0, 0);
    while kills < all_kills {
        let before = done(&work, "result");
        let threads = if random.unit() < 0.5 { "1" } else { "2" };
        let delay = random.linear(0.05, 0.8) * whole_run;
        let ended =
            killed_after(&work, delay, &["run", "sweep.toml", "--out", "result", "--threads", threads]);
        let told = format!("{before} of {DESIGNS} designs were done before; going on");
        if before > 0 && ended.stderr.contains(&told) {
            went_on += 1;
        } else {
            // Killed before it had looked at what is there, or nothing was; or only names were left to be given.
            assert!(
                [0, DESIGNS as u64].contains(&before) || ended.code.is_none(),
                "not told: {}",
                ended.stderr
            );
            assert!(!ended.stderr.contains("beginning anew"), "{}", ended.stderr);
        }
        // A run may have been killed between its last rename and its end.
        if ended.code == Some(0) || work.path("result/manifest.json").exists() {
            assert!(work.read("result/table.csv") == table, "not the bytes of a run in one piece");
            std::fs::remove_dir_all(work.path("result")).unwrap();
            completed += 1;
        } else {
            assert_eq!(ended.code, None, "{}", ended.stderr);
            assert!(done(&work, "result") >= before, "the run went back");
            kills += 1;
        }
    }
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    assert!(work.read("result/table.csv") == table);
    let (one, other) = (work.json("whole/manifest.json"), work.json("result/manifest.json"));
    for key in ["state", "files", "inputs"] {
        assert_eq!(one[key], other[key], "{key}");
    }
    for key in ["designs", "rows", "failed_rows", "statuses", "greatest_force_error", "forces_n"] {
        assert_eq!(one["counts"][key], other["counts"][key], "{key}");
    }
    println!("{kills} kills, went on {went_on} times, {completed} completed in between");
    assert!(2 * went_on >= all_kills, "went on {went_on} times only");
    assert_eq!(
        work.files(),
        ["result/manifest.json", "result/table.csv", "sweep.toml", "whole/manifest.json", "whole/table.csv"]
    );
}

/// Of a run that is to be killed long before its end, also by a quick machine.
const MANY: usize = 50_000;

/// An unfinished result with some rows in it.
fn unfinished(work: &Workdir) {
    work.write("sweep.toml", &config(MANY));
    leave_beyond(work, 0);
}

/// Leaves an unfinished result of more than `designs` designs.
fn leave_beyond(work: &Workdir, designs: u64) {
    let ended =
        killed_beyond(work, designs, "result", &["run", "sweep.toml", "--out", "result", "--threads", "1"]);
    assert_eq!(ended.code, None, "{}", ended.stderr);
}

#[test]
fn damaged_rows_are_made_anew_and_it_is_said() {
    let work = Workdir::new("resume-damage");
    unfinished(&work);
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let table = work.read("whole/table.csv");
    let save = |name: &str| std::fs::read(work.path(name)).unwrap();
    let (rows, manifest) = (save("result/table.csv.partial"), save("result/manifest.json.partial"));
    type Damage = fn(&mut Vec<u8>);
    let damages: [(&str, Damage); 3] = [
        ("a byte", |rows| rows[500] ^= 1),
        ("the end", |rows| rows.truncate(rows.len() / 100)),
        ("all", |rows| rows.clear()),
    ];
    for (what, damage) in damages {
        let mut damaged = rows.clone();
        damage(&mut damaged);
        std::fs::write(work.path("result/table.csv.partial"), damaged).unwrap();
        std::fs::write(work.path("result/manifest.json.partial"), &manifest).unwrap();
        let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
        let told = "warning: table.csv is not what it was when the run before ended; beginning anew";
        assert!(ended.stderr.contains(told), "{what}: {}", ended.stderr);
        assert!(work.read("result/table.csv") == table, "{what}");
        std::fs::remove_dir_all(work.path("result")).unwrap();
        std::fs::create_dir(work.path("result")).unwrap();
    }
    // A manifest that cannot be read vouches for nothing: nothing is overwritten unasked.
    for bytes in [&manifest[..manifest.len() / 2], b"\0\0\0"] {
        std::fs::write(work.path("result/table.csv.partial"), &rows).unwrap();
        std::fs::write(work.path("result/manifest.json.partial"), bytes).unwrap();
        let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(1);
        assert!(ended.stderr.contains("--force"), "{}", ended.stderr);
        assert_eq!(save("result/table.csv.partial"), rows);
    }
    work.run(&["run", "sweep.toml", "--out", "result", "--force"]).expect(0);
    assert!(work.read("result/table.csv") == table);
}

/// Killed when its manifest was there and had marked nothing yet: there is nothing to go on with, and nothing is damaged.
#[test]
fn a_run_that_was_killed_before_its_first_mark_is_no_damage() {
    let work = Workdir::new("resume-unmarked");
    work.write("sweep.toml", &config(30));
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    let table = work.read("result/table.csv");
    let mut manifest = work.json("result/manifest.json");
    let marked = manifest["files"].as_array().unwrap().len();
    assert!(marked > 0);
    manifest["files"] = serde_json::json!([]);
    manifest["state"] = "incomplete".into();
    for name in ["designs", "rows"] {
        manifest["counts"][name] = 0.into();
    }
    for name in ["manifest.json", "table.csv", "laws.csv"] {
        let _ = std::fs::remove_file(work.path(&format!("result/{name}")));
    }
    work.write("result/manifest.json.partial", &manifest.to_string());
    work.write("result/table.csv.partial", table.lines().next().unwrap());
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    assert!(!ended.stderr.contains("warning"), "{}", ended.stderr);
    assert_eq!(work.read("result/table.csv"), table);
    // And killed when its files were there and not yet its manifest: they are empty.
    std::fs::remove_dir_all(work.path("result")).unwrap();
    std::fs::create_dir(work.path("result")).unwrap();
    work.write("result/table.csv.partial", "");
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    assert_eq!(work.read("result/table.csv"), table);
    std::fs::remove_dir_all(work.path("result")).unwrap();
    std::fs::create_dir(work.path("result")).unwrap();
    work.write("result/table.csv.partial", "d");
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(1);
}

/// What a run was begun with, a device of a name and its numbers, it goes on with where nothing else is asked.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_run_goes_on_with_the_device_that_it_was_begun_with() {
    let work = Workdir::new("resume-device");
    work.write("sweep.toml", &config(30));
    let on_device =
        ["run", "sweep.toml", "--out", "result", "--adapter", "", "--precision", "f32", "--solver", "pcg"];
    work.run(&on_device).expect(0);
    let complete = work.json("result/manifest.json");
    let mut manifest = complete.clone();
    (manifest["files"], manifest["state"]) = (serde_json::json!([]), "incomplete".into());
    for name in ["designs", "rows"] {
        manifest["counts"][name] = 0.into();
    }
    std::fs::remove_dir_all(work.path("result")).unwrap();
    std::fs::create_dir(work.path("result")).unwrap();
    work.write("result/manifest.json.partial", &manifest.to_string());
    let other = work.run(&["run", "sweep.toml", "--out", "result", "--backend", "cpu"]).expect(1);
    assert!(other.stderr.contains("go on with that program on that device"), "{}", other.stderr);
    work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    let found = work.json("result/manifest.json");
    let of = |manifest: &serde_json::Value| ["adapter", "precision"].map(|name| manifest[name].clone());
    assert_eq!(of(&found), of(&complete));
    assert_eq!((&found["adapter"]["solver"], &found["precision"]), (&"pcg".into(), &"f32".into()));
}

/// When the machine goes down, what was last written may be lost: the manifest of a safer moment tells where to go on.
#[test]
fn rows_that_never_reached_the_disk_are_made_again_from_the_last_safe_moment_on() {
    let work = Workdir::new("resume-safe");
    unfinished(&work);
    let safe = work.read("result/manifest.json.partial");
    work.write("result/manifest.safe.json.partial", &safe);
    let designs = done(&work, "result");
    let bytes = work.json("result/manifest.json.partial")["files"][0]["bytes"].as_u64().unwrap() as usize;
    leave_beyond(&work, designs);
    let rows = std::fs::read(work.path("result/table.csv.partial")).unwrap();
    assert!(rows.len() > bytes);
    std::fs::write(work.path("result/table.csv.partial"), &rows[..bytes + 100]).unwrap();
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    let told = format!("{designs} of {MANY} designs were done before; going on");
    assert!(ended.stderr.contains(&told) && ended.stderr.contains("is not what it was"), "{}", ended.stderr);
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    assert!(work.read("result/table.csv") == work.read("whole/table.csv"));
    assert!(!work.path("result/manifest.safe.json.partial").exists());
}

/// What another program or another part of the sweep has begun is not mixed with this one's rows.
#[test]
fn what_another_program_has_begun_is_refused_and_what_differs_is_said() {
    let work = Workdir::new("resume-other");
    unfinished(&work);
    let manifest = work.read("result/manifest.json.partial");
    let rows = work.read("result/table.csv.partial");
    let version = concat!("\"version\": \"", env!("CARGO_PKG_VERSION"), "\"");
    assert!(manifest.contains(version));
    work.write("result/manifest.json.partial", &manifest.replace(version, "\"version\": \"0.0.7\""));
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(1);
    let told = ["an unfinished result by jointsweep 0.0.7", "this is jointsweep", "begin anew with --again"];
    assert!(told.iter().all(|told| ended.stderr.contains(told)), "{}", ended.stderr);
    assert!(work.read("result/table.csv.partial") == rows);
    // Another config, or other values, are another sweep.
    work.write("result/manifest.json.partial", &manifest);
    let ended = work.run(&["run", "sweep.toml", "--out", "result", "--set", "solve.accuracy=0.5%"]).expect(1);
    assert!(ended.stderr.contains("with other values set"), "{}", ended.stderr);
    let again = work.run(&["run", "sweep.toml", "--out", "result", "--again"]).expect(0);
    assert!(!again.stderr.contains("going on"), "{}", again.stderr);
}

/// The list of designs is part of what a result is of.
#[test]
fn a_list_that_was_changed_in_between_is_another_sweep() {
    let work = Workdir::new("resume-list");
    let row = |clearance: f64| {
        format!("10,{clearance},5,plane-stress,rigid-core,200000,0.3,annulus,3,70000,0.33,100\n")
    };
    let header = "hole_radius_mm,radial_clearance_mm,thickness_mm,idealization,pin_model,pin_youngs_modulus_mpa,\
                  pin_poissons_ratio,plate_model,outer_radius_ratio,plate_youngs_modulus_mpa,plate_poissons_ratio,force_n\n";
    let rows: String = (0..60_000).map(|i| row(0.01 + 1e-6 * f64::from(i))).collect();
    work.write("list.csv", &format!("{header}{rows}"));
    work.write("sweep.toml", "[designs]\nfile = \"list.csv\"\n[solve]\nmethod = \"series\"\n");
    leave_beyond(&work, 0);
    work.write("list.csv", &format!("{header}{}", rows.replacen("0.010001", "0.010002", 1)));
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(1);
    assert!(ended.stderr.contains("for another list of designs"), "{}", ended.stderr);
    work.write("list.csv", &format!("{header}{rows}"));
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    assert!(ended.stderr.contains("going on"), "{}", ended.stderr);
    assert_eq!(work.table("result/table.csv").records.len(), 60_000);
}

/// No time of day decides anything.
#[test]
fn a_clock_that_goes_backwards_changes_nothing() {
    let work = Workdir::new("resume-clock");
    unfinished(&work);
    let future = "2199-01-01T00:00:00Z";
    let mut manifest = work.json("result/manifest.json.partial");
    manifest["started_utc"] = future.into();
    work.write("result/manifest.json.partial", &manifest.to_string());
    for name in ["result/table.csv.partial", "result/manifest.json.partial", "sweep.toml"] {
        let file = std::fs::File::options().append(true).open(work.path(name)).unwrap();
        file.set_modified(SystemTime::now() + Duration::from_secs(1 << 32)).unwrap();
    }
    let ended = work.run(&["run", "sweep.toml", "--out", "result"]).expect(0);
    assert!(ended.stderr.contains("going on"), "{}", ended.stderr);
    assert_eq!(work.json("result/manifest.json")["started_utc"], future);
}
