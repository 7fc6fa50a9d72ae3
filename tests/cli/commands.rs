//! What a newcomer meets: init, --set, the summary of a run, completions, the manual, the version, and calibrate.

use crate::SMALL;
use crate::common::workdir::Workdir;

fn small(name: &str) -> Workdir {
    let work = Workdir::new(name);
    work.write("small.toml", &SMALL);
    work
}

#[test]
fn a_config_to_start_from_runs_and_no_file_is_overwritten() {
    let work = Workdir::new("init");
    let told = work.run(&["init"]).expect(0);
    assert!(told.stdout.starts_with("joint.toml\n") && told.stdout.contains("jointsweep run joint.toml"));
    work.run(&["run", "joint.toml"]).expect(0);
    let table = work.table("out/joint/table.csv");
    assert_eq!(table.records.len(), 40);
    assert!(table.column("status").iter().all(|status| *status == "ok"));

    let written = work.read("joint.toml");
    work.write("joint.toml", "mine");
    let refused = work.run(&["init", "joint.toml"]).expect(1);
    assert_eq!(
        refused.stderr,
        "error: joint.toml is there already: name another file, or overwrite it with --force\n"
    );
    assert_eq!(work.read("joint.toml"), "mine");
    work.run(&["init", "--force"]).expect(0);
    assert_eq!(work.read("joint.toml"), written);
    let nowhere = work.run(&["init", "no/such/folder.toml"]).expect(1);
    assert!(nowhere.stderr.starts_with("error: cannot write no/such/folder.toml"), "{}", nowhere.stderr);
}

/// As if the file had the value: in the table, in the manifest, and in what is the same result.
#[test]
fn a_value_that_is_set_is_a_value_of_the_config() {
    let work = small("set");
    let soft = ["--set", "joint.plate.youngs_modulus=35 GPa", "--set", "solve.accuracy=0.1%"];
    let run = |more: &[&str]| work.run(&[&["run", "small.toml", "--quiet"], more].concat());
    run(&soft).expect(0);
    let table = work.read("out/small/table.csv");
    assert_eq!(work.table("out/small/table.csv").column("plate_youngs_modulus_mpa"), ["35000"; 6]);
    let text = SMALL
        .replace("\"70 GPa\"", "\"35 GPa\"")
        .replace("method = \"series\"\n", "method = \"series\"\naccuracy = \"0.1%\"\n");
    let manifest = work.json("out/small/manifest.json");
    assert_eq!(manifest["config"]["text"], text);
    assert_eq!(manifest["inputs"][0]["bytes"], text.len());
    assert_eq!(work.read("small.toml"), *SMALL);

    // A file that says the same is the same config.
    work.write("soft.toml", &text);
    work.run(&["run", "soft.toml", "--quiet"]).expect(0);
    assert_eq!(work.read("out/soft/table.csv"), table);
    let again = work.run(&[&["run", "small.toml"], &soft[..]].concat()).expect(0);
    assert!(again.stdout.starts_with("already complete"), "{}", again.stdout);

    // Without the values, and with others, it is another one.
    for other in [&[][..], &["--set", "joint.plate.youngs_modulus=36 GPa"]] {
        let refused = run(other).expect(1);
        assert!(refused.stderr.contains("or with other values set"), "{}", refused.stderr);
    }
    assert_eq!(work.read("out/small/table.csv"), table);
    let explained = work.run(&["explain", "small.toml", "--set", "solve.accuracy=0.001"]).expect(0);
    assert!(explained.stdout.starts_with("2 designs at 0.1 %"), "{}", explained.stdout);
}

#[test]
fn what_cannot_be_set_is_said_by_its_key_and_other_errors_keep_their_line() {
    let work = small("set-bad");
    work.write("bad.toml", &SMALL.replace("poissons_ratio = 0.33", "poissons_ratio = 0.66"));
    for (config, settings, expected) in [
        (
            "small.toml",
            &["joint.plate.yongs_modulus=70 GPa"][..],
            "error: --set: joint.plate.yongs_modulus: unknown key; did you mean `youngs_modulus`? Allowed: `model`, \
             `youngs_modulus`, `poissons_ratio`, `outer_radius_ratio`, `yield_stress`, `layers`\n",
        ),
        (
            "small.toml",
            &["joint.plate.youngs_modulus=70"],
            "error: --set: joint.plate.youngs_modulus: `70`: the unit is missing; write it like \"70 MPa\"\n",
        ),
        (
            "small.toml",
            &["joint.thickness"],
            "error: --set: joint.thickness: a key and its value are needed, like solve.accuracy=0.1%\n",
        ),
        (
            "small.toml",
            &["load.force=1 kN"],
            "error: --set: load.force: `indentation` is given, too; only one kind of load is allowed\n",
        ),
        // Line 17 of the file, although a line is added above it and a list of lines is made one.
        (
            "bad.toml",
            &["joint.pin.core_radius_ratio=[0.1, 0.2]", "solve.accuracy=0.1%", "sampling.method=zip"],
            "error: bad.toml:17: joint.plate.poissons_ratio: `0.66`: must be above -1 and below 0.5\n",
        ),
        (
            "bad.toml",
            &["title=[\"a\"]"],
            "error: --set: title: `[\"a\"]`: a string is needed here, not a list\n",
        ),
    ] {
        let settings = settings.iter().flat_map(|setting| ["--set", setting]);
        let arguments: Vec<&str> = ["run", config].into_iter().chain(settings).collect();
        let refused = work.run(&arguments).expect(1);
        assert_eq!(refused.stderr, expected, "{arguments:?}");
    }
    assert!(!work.path("out").exists());
}

/// A key that was added above moves the lines of the text, not those of the file.
#[test]
fn lines_are_those_of_the_file() {
    let work = Workdir::new("set-lines");
    let text = SMALL.replace("core_radius_ratio = 0.2\n", "").replace("3.0\n", "0.5\n");
    work.write("bad.toml", &text);
    let line = 1 + text.lines().position(|line| line.starts_with("outer_radius_ratio")).unwrap();
    for settings in [&[][..], &["--set", "joint.pin.core_radius_ratio=0.3"]] {
        let refused = work.run(&[&["run", "bad.toml"], settings].concat()).expect(1);
        let expected = format!("error: bad.toml:{line}: joint.plate.outer_radius_ratio: ");
        assert!(refused.stderr.starts_with(&expected), "{expected} {}", refused.stderr);
    }
}

#[test]
fn a_run_ends_with_a_summary_in_words() {
    let work = small("summary");
    let told = work.run(&["run", "small.toml"]).expect(0).stdout;
    let manifest = work.json("out/small/manifest.json");
    let table = work.table("out/small/table.csv");
    let of = |column: &str| -> Vec<f64> {
        table.column(column).iter().map(|cell| cell.parse().unwrap()).collect()
    };
    let least = of("force_n").into_iter().reduce(f64::min).unwrap();
    let greatest = of("force_n").into_iter().reduce(f64::max).unwrap();
    let counts = &manifest["counts"];
    let close =
        |value: &serde_json::Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs() < 1e-8;
    assert!(close(&counts["forces_n"][0], least) && close(&counts["forces_n"][1], greatest), "{counts}");
    assert!(close(&counts["greatest_force_error"], of("force_error").into_iter().reduce(f64::max).unwrap()));
    let lines: Vec<&str> = told.lines().collect();
    assert!(lines[0].starts_with("2 designs, 6 rows, 2 distinct bodies in"), "{told}");
    assert_eq!(lines[1], "all 6 rows are ok");
    let three = |force: f64| format!("{:.2e}", force).parse::<f64>().unwrap();
    assert_eq!(lines[2], format!("force: {} N to {} kN", three(least), three(1e-3 * greatest)));
    assert!(
        lines[3].starts_with("force_error: ") && lines[3].contains(" % at most; linearity_error: "),
        "{told}"
    );
    let written = ["table.csv", "laws.csv", "manifest.json"].map(|file| format!("  out/small/{file}"));
    assert_eq!((lines[4], lines[8]), ("written:", "next:"));
    assert_eq!(lines[5..8], written);
    assert!(
        lines[9].starts_with("  jointsweep report out/small ")
            && lines[10].contains("jointsweep export out/small")
    );
    assert!(!told.contains("time by stage"));

    let told = work.run(&["run", "small.toml", "--again", "--verbose"]).expect(0).stdout;
    assert!(told.contains("time by stage, summed over the threads:\n  preparation "), "{told}");
    work.run(&["run", "small.toml", "--quiet", "--verbose"]).expect(1);
}

/// A command that would be refused is not named.
#[test]
fn a_summary_names_what_can_be_done_with_the_columns_there_are() {
    let work = small("next");
    let next = |settings: &[&str]| -> Vec<String> {
        let settings = settings.iter().flat_map(|setting| ["--set", setting]);
        let told =
            work.run(&["run", "small.toml", "--force"].into_iter().chain(settings).collect::<Vec<_>>());
        let told = told.expect(0).stdout;
        let named = told.split_once("next:\n").map_or("", |(_, commands)| commands).lines();
        named.map(|line| line.split_whitespace().nth(1).unwrap().to_string()).collect()
    };
    let columns = |without: &str| {
        let names = work.table("out/small/table.csv").names;
        format!("output.columns={:?}", names.iter().filter(|name| *name != without).collect::<Vec<_>>())
    };
    assert_eq!(next(&[]), ["report", "export"]);
    let [without_method, without_status] = ["method", "status"].map(columns);
    assert_eq!(next(&[&without_method]), ["export"]);
    work.run(&["report", "out/small"]).expect(1);
    assert_eq!(next(&[&without_status]), [""; 0]);
    // Answers make a page, too.
    let rows = ["output.table=false", "output.laws=false"];
    assert_eq!(next(&rows), [""; 0]);
    let asked = ["reduce.statistics=[\"force\"]"];
    assert_eq!(next(&[&rows[..], &asked].concat()), ["report"]);
    work.run(&["report", "out/small"]).expect(0);
}

/// The same with pins that carry up to some half angle only.
pub fn half_pins(text: &str) -> String {
    let text = text.replace("rigid-core", "rigid-midplane").replace("core_radius_ratio = 0.2\n", "");
    text.replace("method = \"series\"", "")
}

#[test]
fn rows_that_are_not_ok_are_counted_by_their_status() {
    let work = Workdir::new("summary-remarks");
    // At 4 mm displacement is large; at 20 mm contact of the looser pin is wider than it can be.
    let text = half_pins(&SMALL).replace("\"0.002 mm\", \"0.005 mm\"", "\"4 mm\", \"20 mm\"");
    let text = text.replace("\"0.1 mm\"", "\"3 mm\"");
    work.write("deep.toml", &text);
    let ended = work.run(&["run", "deep.toml"]);
    let table = work.table("out/deep/table.csv");
    let statuses = table.column("status");
    let count = |like: &dyn Fn(&str) -> bool| statuses.iter().filter(|status| like(status)).count();
    let (ok, failed) = (count(&|status| status == "ok"), count(&|status| status.starts_with("failed")));
    let remarks = statuses.len() - ok - failed;
    assert!(ok > 1 && failed == 1 && remarks > 1, "{statuses:?}");
    let told = ended.expect(2).stdout;
    for line in [
        format!("\n{ok} of 6 rows are ok\n"),
        format!("\nanswered with a remark: {remarks} rows\n"),
        "\nfailed: 1 row of 1 design\n".to_string(),
    ] {
        assert!(told.contains(&line), "{line:?} not in {told}");
    }
    let remark = statuses.iter().find(|status| !status.starts_with("failed") && **status != "ok").unwrap();
    assert!(told.contains(&format!("  {remark}\n")), "{told}");
}

#[test]
fn completions_and_manual_pages_name_every_command() {
    let work = Workdir::new("shells");
    let help = work.run(&["--help"]).expect(0).stdout;
    let (_, listed) = help.split_once("Commands:\n").unwrap();
    let commands: Vec<&str> = listed
        .lines()
        .take_while(|line| line.starts_with("  "))
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() >= 10 && commands.contains(&"calibrate"), "{commands:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = work.run(&["completions", shell]).expect(0).stdout;
        for word in commands.iter().chain(&["bench-gpu", "dry-run"]) {
            assert!(script.contains(word), "{word} not for {shell}");
        }
    }
    assert!(work.run(&["completions", "csh"]).expect(1).stderr.contains("possible values: bash"));

    let page = work.run(&["man"]).expect(0).stdout;
    assert!(page.contains(".TH jointsweep 1") && page.contains("Exit codes: 0 done"), "{page}");
    work.run(&["man", "--out", "share/man1"]).expect(0);
    let mut expected: Vec<String> =
        commands.iter().map(|name| format!("share/man1/jointsweep-{name}.1")).collect();
    expected.push("share/man1/jointsweep.1".into());
    expected.sort();
    assert_eq!(work.files(), expected);
    assert!(work.read("share/man1/jointsweep-run.1").contains("dry"));
    let refused = work.run(&["man", "--out", "share/man1"]).expect(1);
    assert!(refused.stderr.contains("share/man1/jointsweep.1 is there already"), "{}", refused.stderr);
    work.run(&["man", "--out", "share/man1", "--force"]).expect(0);
}

/// The syntax, by the shell itself.
#[cfg(unix)]
#[test]
fn bash_reads_its_completions() {
    let work = Workdir::new("bash");
    work.write("completions.bash", &work.run(&["completions", "bash"]).expect(0).stdout);
    let script = "source ./completions.bash && COMP_WORDS=(jointsweep cal) COMP_CWORD=1 && _jointsweep jointsweep cal jointsweep \
                  && echo \"${COMPREPLY[@]}\"";
    let Ok(output) =
        std::process::Command::new("bash").args(["-c", script]).current_dir(work.path("")).output()
    else {
        return;
    };
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "calibrate", "{output:?}");
}

/// The commit is that of the source, as git says it, unless who builds has said another.
#[test]
fn the_version_has_the_commit() {
    let work = small("version");
    let told = work.run(&["--version"]).expect(0).stdout;
    let (number, commit) = (env!("CARGO_PKG_VERSION"), option_env!("JOINTSWEEP_COMMIT"));
    let is_checkout = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(".git").exists();
    assert!(commit.is_some() || !is_checkout, "a build of a checkout knows its commit");
    let expected = commit.map_or(String::new(), |commit| format!(" ({commit})"));
    assert_eq!(told, format!("jointsweep {number}{expected}\n"));
    // The manifest says the same.
    work.run(&["run", "small.toml", "--quiet"]).expect(0);
    assert_eq!(work.json("out/small/manifest.json")["commit"].as_str(), commit);
}

/// One design of `SMALL`, with a modulus that is not the one of the points below.
fn one() -> String {
    SMALL.replace("[\"0.1 mm\", \"0.03 mm\"]", "\"0.03 mm\"").replace("\"70 GPa\"", "\"100 GPa\"")
}

/// Forces of the same joint with a plate of 70 GPa, from the program's own table.
fn measured(work: &Workdir) -> String {
    let loads = "indentation = { from = \"0.001 mm\", to = \"0.02 mm\", count = 12 }";
    let text = one().replace("\"100 GPa\"", "\"70 GPa\"");
    let text = text.replace("indentation = [\"0.001 mm\", \"0.002 mm\", \"0.005 mm\"]", loads);
    assert!(text.contains(loads));
    work.write("true.toml", &text);
    work.run(&["run", "true.toml", "--quiet", "--out", "true"]).expect(0);
    let table = work.table("true/table.csv");
    let rows = table.column("indentation_mm").into_iter().zip(table.column("force_n"));
    let mut csv = "indentation_mm,force_n\n".to_string();
    // A scatter of one newton, the same in each test.
    for (place, (indentation, force)) in rows.enumerate() {
        let off = [0.3, -1.0, 0.8, 0.1, -0.6, 1.1, -0.2, 0.5, -0.9, 0.7, -0.4, 0.2][place];
        csv += &format!("{indentation},{}\n", force.parse::<f64>().unwrap() + off);
    }
    csv
}

fn calibrated(name: &str) -> Workdir {
    let work = Workdir::new(name);
    work.write("one.toml", &one());
    let csv = measured(&work);
    work.write("data.csv", &csv);
    work
}

#[test]
fn a_joint_is_calibrated_and_what_is_found_can_be_run() {
    let work = calibrated("calibrate");
    let arguments =
        ["calibrate", "one.toml", "--measured", "data.csv", "--fit", "plate_youngs_modulus,zero_offset"];
    let told = work.run(&arguments).expect(0);
    assert_eq!(told.stderr, "");
    let table = work.table("out/one/calibration/calibration.csv");
    assert_eq!(table.column("name"), ["plate_youngs_modulus", "zero_offset"]);
    assert_eq!(table.column("unit"), ["MPa", "mm"]);
    assert_eq!(table.column("start"), ["100000", "0"]);
    let [value, low, high] =
        ["value", "low_95", "high_95"].map(|name| table.column(name)[0].parse::<f64>().unwrap());
    assert!((value / 70e3 - 1.0).abs() < 0.01 && low < 70e3 && 70e3 < high, "{low} {value} {high}");
    let residuals = work.table("out/one/calibration/residuals.csv");
    assert_eq!(residuals.records.len(), 12);
    let left = residuals.column("residual_n").into_iter().map(|cell| cell.parse::<f64>().unwrap().abs());
    assert!(left.fold(0.0, f64::max) < 2.0);
    let picture = work.read("out/one/calibration/residuals.svg");
    assert!(picture.trim_end().ends_with("</svg>") && picture.matches("<circle").count() == 2 * 12);
    let manifest = work.json("out/one/calibration/manifest.json");
    assert_eq!(manifest["command"], "calibrate");
    assert_eq!(manifest["config"]["text"], one());
    assert_eq!(manifest["measured"]["path"], "data.csv");
    assert_eq!(manifest["files"].as_array().unwrap().len(), 3);
    let correlation = manifest["correlation"][0][1].as_f64().unwrap();
    assert!(
        correlation.abs() > 0.1 && correlation.abs() < 1.0 && manifest["correlation"][1][0] == correlation
    );

    // The command that is told runs.
    let (_, command) = told.stdout.split_once("next:\n  jointsweep ").unwrap();
    assert!(command.starts_with("run one.toml --set \"joint.plate.youngs_modulus="), "{command}");
    let words: Vec<&str> = command.trim().split(" \"").flat_map(|part| part.split("\" ")).collect();
    let setting = words[1].trim_end_matches('"');
    work.run(&["run", "one.toml", "--quiet", "--set", setting]).expect(0);
    let used = work.table("out/one/table.csv").column("plate_youngs_modulus_mpa")[0].parse::<f64>().unwrap();
    assert!((used / value - 1.0).abs() < 1e-5);

    // Never over what is there.
    let before = work.read("out/one/calibration/calibration.csv");
    let other = [&arguments[..5], &["plate_youngs_modulus"]].concat();
    let refused = work.run(&other).expect(1);
    assert!(refused.stderr.contains("holds a calibration of one.toml"), "{}", refused.stderr);
    assert_eq!(work.read("out/one/calibration/calibration.csv"), before);
    work.run(&[&other[..], &["--force", "--quiet"]].concat()).expect(0);
    assert_eq!(work.table("out/one/calibration/calibration.csv").records.len(), 1);
}

#[test]
fn a_config_with_a_diametral_clearance_is_told_how_to_take_the_fitted_one() {
    let work = calibrated("calibrate-diametral");
    let text = one().replace("radial_clearance = \"0.03 mm\"", "diametral_clearance = \"0.06 mm\"");
    work.write("one.toml", &text.replace("\"100 GPa\"", "\"70 GPa\""));
    let told =
        work.run(&["calibrate", "one.toml", "--measured", "data.csv", "--fit", "radial_clearance"]).expect(0);
    let (_, value) = told.stdout.split_once("--set \"joint.diametral_clearance=").unwrap();
    let value: f64 = value.split(' ').next().unwrap().parse().unwrap();
    assert!((value / 0.06 - 1.0).abs() < 0.05, "{value}");
    assert!(!told.stdout.contains("joint.radial_clearance"), "{}", told.stdout);
}

#[test]
fn what_cannot_be_told_apart_is_warned_of() {
    let work = calibrated("calibrate-apart");
    let fit = "plate_youngs_modulus,support_compliance";
    let told =
        work.run(&["calibrate", "one.toml", "--measured", "data.csv", "--fit", fit, "--quiet"]).expect(0);
    let expected =
        "warning: plate_youngs_modulus and support_compliance cannot be told apart by these points: ";
    assert!(told.stderr.starts_with(expected), "{}", told.stderr);
    assert_eq!(told.stdout, "");
    let manifest = work.json("out/one/calibration/manifest.json");
    assert!(manifest["warnings"][0].as_str().unwrap().starts_with("plate_youngs_modulus and"));
}

#[test]
fn bad_measurements_and_bad_questions_are_refused_and_nothing_is_written() {
    let work = Workdir::new("calibrate-bad");
    work.write("one.toml", &one());
    work.write("half.toml", &half_pins(&one()).replace("\"0.03 mm\"", "\"3 mm\""));
    work.write("two.toml", &SMALL);
    work.write("closed.toml", &one().replace("\"series\"", "\"closed-form\""));
    let header = "indentation_mm,force_n\n";
    let files = [
        ("good", "0.001,100\n0.002,220\n0.004,500\n".to_string()),
        ("word", "0.001,100\n0.002,many\n".into()),
        ("empty", "0.001,100\n0.002,\n".into()),
        ("negative", "0.001,100\n0.002,-3\n".into()),
        ("short", "0.001,100\n0.002\n".into()),
        ("few", "0.001,100\n".into()),
        ("none", String::new()),
        ("infinite", "0.001,inf\n".into()),
        ("flat", "0.001,0\n0.002,0\n".into()),
        ("deep", "19,100\n20,200\n".into()),
    ];
    for (name, rows) in &files {
        work.write(&format!("{name}.csv"), &format!("{header}{rows}"));
    }
    work.write("columns.csv", "indentation_um,force_n\n1,2\n");
    work.write("missing.csv", "indentation_mm\n1\n");
    work.write("sigma.csv", "indentation_mm,force_n,sigma_n\n0.001,100,1\n0.002,200,0\n");
    work.write("some.csv", "indentation_mm,force_n,sigma_n\n0.001,100,1\n0.002,200,\n");
    let before = work.files();
    let both = "plate_youngs_modulus,zero_offset";
    for (config, data, fit, expected) in [
        ("one", "word", both, "word.csv:3: force_n: `many`: not a number"),
        ("one", "empty", both, "empty.csv:3: force_n: the cell is empty"),
        ("one", "negative", both, "negative.csv:3: force_n: `-3`: must be 0 or more"),
        ("one", "short", both, "short.csv:3: the row has 1 cells, the header has 2"),
        ("one", "infinite", both, "infinite.csv:2: force_n: `inf`: the number is not finite"),
        (
            "one",
            "columns",
            both,
            "columns.csv:1: indentation_um: unknown column; did you mean `indentation_mm`?",
        ),
        ("one", "missing", both, "missing.csv:2: force_n: the column is missing"),
        ("one", "sigma", both, "sigma.csv:3: sigma_n: `0`: must be above 0"),
        ("one", "some", both, "some.csv:3: sigma_n: some rows have a standard deviation"),
        ("one", "few", both, "few.csv: 1 measured points are too few for 2 unknowns"),
        ("one", "none", both, "none.csv: 0 measured points are too few for 2 unknowns"),
        ("one", "flat", both, "flat.csv: every measured force is zero"),
        (
            "half",
            "deep",
            both,
            "deep.csv: the config's joint has no answer at the measured points: at an indentation of",
        ),
        ("one", "absent", both, "cannot read absent.csv: "),
        (
            "one",
            "good",
            "plate_modulus",
            "`plate_modulus`: nothing that can be fitted; did you mean `plate_youngs_modulus`?",
        ),
        ("one", "good", "zero_offset,zero_offset", "`zero_offset`: it is named twice"),
        ("two", "good", both, "two.toml: a calibration is of one design, this config has 2"),
        (
            "closed",
            "good",
            both,
            "good.csv: the config's joint has no answer at the measured points: method: a closed form",
        ),
        ("absent", "good", both, "cannot read absent.toml: "),
    ] {
        let (config, data) = (format!("{config}.toml"), format!("{data}.csv"));
        let refused = work.run(&["calibrate", &config, "--measured", &data, "--fit", fit]).expect(1);
        let is_told =
            refused.stderr.starts_with(&format!("error: {expected}")) && refused.stderr.lines().count() == 1;
        assert!(is_told, "{expected}: {}", refused.stderr);
        assert_eq!(work.files(), before, "{data}");
    }
    // What is read is not written over, with whatever permission.
    work.write("out/residuals.csv", &work.read("good.csv"));
    let data = "out/residuals.csv";
    let arguments =
        ["calibrate", "one.toml", "--measured", data, "--fit", "zero_offset", "--out", "out", "--force"];
    let refused = work.run(&arguments).expect(1);
    assert!(
        refused.stderr.contains("out/residuals.csv is read and would be overwritten"),
        "{}",
        refused.stderr
    );
    assert_eq!(work.read(data), work.read("good.csv"));
}

/// Answers have a page of their own; who needs rows is told that there are none. Sensitivities stand on the page of their result.
#[test]
fn answers_without_rows_have_a_page_and_say_what_they_lack() {
    let work = Workdir::new("answers-page");
    let config =
        SMALL.replace("[\"0.1 mm\", \"0.03 mm\"]", "{ from = \"0.03 mm\", to = \"0.1 mm\", count = 40 }");
    let reduce = "[reduce]\nstatistics = \"force\"\nhistogram = { of = \"peak_pressure\" }\n[select]\nkeep = \"force > 1 N\"\n";
    work.write("answers.toml", &format!("{config}{reduce}"));
    let told = work.run(&["run", "answers.toml"]).expect(0).stdout;
    assert!(told.contains("kept: ") && !told.contains("jointsweep export"), "{told}");
    work.run(&["sensitivity", "answers.toml", "--samples", "64"]).expect(0);
    work.run(&["report", "out/answers"]).expect(0);
    let page = work.read("out/answers/report.html");
    for part in [
        "Answers",
        "How many rows have which peak_pressure",
        "met the requirement",
        "Sensitivity",
        "first order",
    ] {
        assert!(page.contains(part), "{part}");
    }
    for arguments in
        [&["export", "out/answers", "--to", "csv", "--design", "0"][..], &["laws", "out/answers", "--force"]]
    {
        let told = work.run(arguments).expect(1).stderr;
        assert!(told.contains("it has no rows, only answers: run the config with `table = true`"), "{told}");
    }
}
