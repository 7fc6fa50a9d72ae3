//! What is refused: a clear error, exit code 1, and nothing written.

use super::solved;
use crate::common::workdir::Workdir;
use jointsweep::internals::output::folder::TABLE;
use jointsweep::internals::output::manifest::with_file;
use jointsweep::internals::study::fingerprint::Fingerprint;

/// Runs, wants an error that says all of this, and no file that was not there.
#[track_caller]
fn refused(work: &Workdir, arguments: &[&str], said: &[&str]) {
    let before = work.files();
    let ended = work.run(&[&["export"], arguments].concat()).expect(1);
    for said in said {
        assert!(ended.stderr.contains(said), "{arguments:?} does not say `{said}`: {}", ended.stderr);
    }
    assert_eq!(work.files(), before, "{arguments:?}");
    assert_eq!(ended.stdout, "", "{arguments:?}");
}

#[test]
fn what_is_asked_wrongly_is_told() {
    let work = solved("export-refusals", "[\"0.02 mm\", \"0.03 mm\"]", "3");
    let dir = "out/sweep";
    let design = ["--design", "0"];
    let with = |arguments: &[&'static str]| [&[dir], &design[..], arguments].concat();
    refused(
        &work,
        &with(&["--to", "adam"]),
        &["--to: `adam`: not known; did you mean `adams`?", "`csv`, `c`, "],
    );
    refused(&work, &["nowhere", "--to", "c"], &["nowhere: there is no manifest.json"]);
    refused(&work, &[dir, "--to", "c", "--design", "7"], &["there is no design 7: the sweep has 2"]);
    refused(
        &work,
        &[dir, "--to", "c"],
        &["--design: the result has 2 designs", "`design`", "`over` radial_clearance"],
    );
    for format in
        ["nastran", "opensim", "motionsolve", "recurdyn", "chrono", "mbdyn", "calculix", "abaqus", "ls-dyna"]
    {
        let said = format!("`{format}` holds one clearance only");
        refused(&work, &[dir, "--to", format, "--over", "radial_clearance"], &[&said, "`adams`", "`design`"]);
    }
    refused(&work, &[dir, "--to", "c", "--over", "thickness"], &["radial_clearance"]);
    refused(&work, &with(&["--to", "c", "--over", "radial_clearance"]), &["cannot be used with"]);
    for name in ["1a", "a-b", "", "a b", "\u{e9}", "a_name_that_is_longer_than_others_are"] {
        refused(
            &work,
            &with(&["--to", "c", "--name"]).into_iter().chain([name]).collect::<Vec<_>>(),
            &["--name: `"],
        );
    }
    for (format, word) in [("python", "class"), ("modelica", "end"), ("simscape", "function")] {
        let said = format!("--name: `{word}` is a word of the language of `{format}`");
        refused(&work, &with(&["--to", format, "--name", word]), &[&said]);
    }
    for (error, said) in
        [("0", "at least"), ("-1 %", ""), ("100 %", "below 1"), ("x", "--error"), ("nan", "at least")]
    {
        let error = format!("--error={error}");
        let arguments: Vec<&str> = with(&["--to", "c"]).into_iter().chain([error.as_str()]).collect();
        refused(&work, &arguments, &[said]);
    }
    for (restitution, speed, said) in [
        ("0", "100 mm/s", "--restitution: 0: must be above 0 and at most 1"),
        ("1.5", "100", "--restitution: 1.5"),
        ("-0.5", "100", "--restitution: -0.5"),
        ("0.5", "0", "--speed: 0 mm/s"),
        ("0.5", "-3 m/s", "--speed: -3000 mm/s"),
        ("0.5", "fast", "--speed: `fast`: a speed is written like"),
    ] {
        let arguments: Vec<&str> = with(&["--to", "c", "--restitution"])
            .into_iter()
            .chain([restitution, "--speed", speed])
            .collect();
        refused(&work, &arguments, &[said]);
    }
    refused(&work, &with(&["--to", "c", "--restitution", "0.5"]), &["--speed"]);
    refused(
        &work,
        &with(&["--to", "nastran", "--restitution", "0.5", "--speed", "1"]),
        &["`nastran` has no place for damping", "`exudyn`"],
    );
    refused(&work, &with(&["--to", "c", "--up-to", "0.01"]), &["--up-to", "the unit is missing"]);
    refused(&work, &with(&["--to", "c", "--up-to", "0 mm"]), &["--up-to: 0 mm: must be above 0"]);
    refused(&work, &with(&["--to", "c", "--out", "no/folder/joint.h"]), &["cannot write"]);
    refused(&work, &with(&["--to", "c", "--out", "out"]), &["is a folder"]);
    refused(
        &work,
        &with(&["--to", "csv", "--out", "out/sweep/table.csv", "--force"]),
        &["is the result itself"],
    );
}

#[test]
fn files_that_are_there_stay() {
    let work = solved("export-there", "\"0.02 mm\"", "3");
    // Also the one beside the main file.
    work.write("joint.cmd", "mine");
    refused(
        &work,
        &["out/sweep", "--to", "adams", "--out", "joint.adm"],
        &["joint.cmd is there already", "--force"],
    );
    assert_eq!(work.read("joint.cmd"), "mine");
    work.run(&["export", "out/sweep", "--to", "adams", "--out", "joint.adm", "--force"]).expect(0);
    assert!(work.read("joint.cmd").contains("data_element"));
    // By default beside the table.
    work.run(&["export", "out/sweep", "--to", "c", "--name", "pin"]).expect(0);
    assert!(work.read("out/sweep/pin.h").contains("pin_force(double indentation_mm)"));
    refused(&work, &["out/sweep", "--to", "c", "--name", "pin"], &["pin.h is there already"]);
}

#[test]
fn a_family_that_differs_otherwise_is_told_in_what() {
    let work = solved("export-differs", "[\"0.02 mm\", \"0.03 mm\"]", "[3, 4]");
    let over = ["out/sweep", "--to", "c", "--over", "radial_clearance"];
    refused(&work, &over, &["the designs differ in `outer_radius_ratio` too"]);
    let work = solved("export-lonely", "\"0.02 mm\"", "3");
    refused(&work, &over, &["one clearance only"]);
}

#[test]
fn rows_that_are_not_ok_are_named() {
    let work = Workdir::new("export-warned");
    let config = super::CONFIG.replace("CLEARANCES", "\"0.02 mm\"").replace("RATIOS", "3");
    work.write("large.toml", &config.replace("\"0.0291 mm\"", "\"0.3 mm\""));
    work.run(&["run", "large.toml", "--quiet"]).expect(0);
    let arguments = ["out/large", "--to", "c", "--out", "joint.h"];
    refused(
        &work,
        &arguments,
        &["design 0: 1 of its rows are not ok", "at 0.3 mm: large displacement", "`--allow-warned`"],
    );
    work.run(&[&["export"], &arguments[..], &["--allow-warned"]].concat()).expect(0);
    work.run(&[&["export"], &arguments[..], &["--force", "--up-to", "0.004 mm"]].concat()).expect(0);
    // Between the good rows and the bad one the curve turns bad: found although no row is there.
    refused(&work, &["out/large", "--to", "c", "--out", "j.h", "--up-to", "0.2 mm"], &["large displacement"]);

    // Half a disc is held at the ends of its contact: beyond them there is no answer.
    let half = config
        .replace("\"rigid-core\"\ncore_radius_ratio = 0.2", "\"rigid-midplane\"")
        .replace("outer_radius_ratio = 3", "outer_radius_ratio = 1.2")
        .replace("\"0.0291 mm\"", "\"50 mm\"");
    work.write("failed.toml", &half);
    work.run(&["run", "failed.toml", "--quiet"]).expect(2);
    let arguments = ["out/failed", "--to", "c", "--out", "k.h"];
    refused(&work, &arguments, &["design 0: 1 of its rows failed (at 50 mm: failed: ", "`--up-to`"]);
    refused(&work, &[&arguments[..], &["--allow-warned"]].concat(), &["1 of its rows failed"]);
    work.run(&[&["export"], &arguments[..], &["--up-to", "0.004 mm"]].concat()).expect(0);
    refused(
        &work,
        &[
            "out/failed",
            "--to",
            "opensim",
            "--out",
            "l.osim",
            "--reference",
            "ring-mean",
            "--up-to",
            "0.004 mm",
        ],
        &["--reference ring-mean", "not of `rigid-midplane`", "`reference support`"],
    );

    work.write("none.toml", &config.replace("[\"0.0004 mm\", \"0.004 mm\", \"0.0291 mm\"]", "\"0 mm\""));
    work.run(&["run", "none.toml", "--quiet"]).expect(0);
    refused(&work, &["out/none", "--to", "c"], &["no row has an answer at an indentation above 0"]);
    work.write("closed.toml", &(config + "method = \"closed-form\"\n"));
    work.run(&["run", "closed.toml", "--quiet"]);
    refused(&work, &["out/closed", "--to", "c"], &["closed forms"]);
}

/// A table that is no longer what the program solves.
#[test]
fn a_result_that_says_other_numbers_is_told() {
    let work = solved("export-other", "\"0.02 mm\"", "3");
    let table = work.read("out/sweep/table.csv");
    let row = work.table("out/sweep/table.csv");
    let force = row.column("force_n")[2].to_string();
    let other = table.replace(&force, "20000");
    work.write("out/sweep/table.csv", &other);
    refused(&work, &["out/sweep", "--to", "c"], &["its table.csv was changed after it was written"]);
    // As if a program had written it that solves otherwise.
    let manifest =
        with_file(&work.read("out/sweep/manifest.json"), TABLE, &Fingerprint::of(other.as_bytes()));
    work.write("out/sweep/manifest.json", &manifest.unwrap());
    refused(&work, &["out/sweep", "--to", "c"], &["says 20000 N", "run the config again"]);
}
