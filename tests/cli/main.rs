//! The program as a user runs it: folder rules, exit codes, and what is on disk however a run ends.

#[path = "../common"]
mod common {
    pub mod ring_joint;
    pub mod greatest;
    pub mod workdir;
}
mod bench;
mod bench_gpu;
#[cfg(unix)]
mod cluster;
mod commands;
mod gpu;
mod laws;
mod press_fits;
mod pressure;
mod stresses;

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use crate::common::ring_joint::ring_joint;
use crate::common::workdir::{Ended, Workdir};

/// Two designs of three steps.
static SMALL: LazyLock<String> = LazyLock::new(|| {
    let joint = ring_joint("[\"0.1 mm\", \"0.03 mm\"]", "[\"0.001 mm\", \"0.002 mm\", \"0.005 mm\"]");
    format!("\ntitle = \"Two joints\"{joint}")
});

/// The same with another thickness: another config.
fn other() -> String {
    SMALL.replace("5 mm\"\n[joint.pin]", "6 mm\"\n[joint.pin]")
}

const COLUMNS: [&str; 28] = [
    "design",
    "hole_radius_mm",
    "radial_clearance_mm",
    "thickness_mm",
    "idealization",
    "pin_model",
    "core_radius_ratio",
    "pin_youngs_modulus_mpa",
    "pin_poissons_ratio",
    "plate_model",
    "outer_radius_ratio",
    "half_width_ratio",
    "depth_ratio",
    "height_ratio",
    "plate_support",
    "plate_youngs_modulus_mpa",
    "plate_poissons_ratio",
    "indentation_mm",
    "force_n",
    "tangent_stiffness_n_per_mm",
    "contact_half_angle_deg",
    "peak_pressure_mpa",
    "energy_mj",
    "force_error",
    "linearity_error",
    "method",
    "backend",
    "status",
];

fn small(name: &str) -> Workdir {
    let work = Workdir::new(name);
    work.write("small.toml", &SMALL);
    work
}

#[test]
fn the_table_has_the_contracts_columns_and_a_row_for_each_design_and_step() {
    let work = small("columns");
    work.run(&["run", "small.toml"]).expect(0);
    let table = work.table("out/small/table.csv");
    assert_eq!(table.names, COLUMNS.to_vec());
    assert_eq!(table.column("design"), ["0", "0", "0", "1", "1", "1"]);
    assert_eq!(table.column("radial_clearance_mm"), ["0.1", "0.1", "0.1", "0.03", "0.03", "0.03"]);
    assert_eq!(table.column("indentation_mm"), ["0.001", "0.002", "0.005", "0.001", "0.002", "0.005"]);
    assert_eq!(table.column("half_width_ratio"), [""; 6]);
    assert_eq!(table.column("method"), ["series"; 6]);
    assert_eq!(table.column("backend"), ["cpu"; 6]);
    assert_eq!(table.column("status"), ["ok"; 6]);
    for name in &COLUMNS[18..25] {
        assert!(table.column(name).iter().all(|cell| cell.parse::<f64>().unwrap() > 0.0), "{name}");
    }
}

#[test]
fn the_manifest_tells_what_was_run_and_what_came_of_it() {
    let work = small("manifest");
    work.run(&["run", "./small.toml", "--threads", "1"]).expect(0);
    let manifest = work.json("out/small/manifest.json");
    assert_eq!(manifest["program"], "jointsweep");
    assert_eq!(manifest["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(manifest["state"], "complete");
    assert_eq!(manifest["title"], "Two joints");
    assert_eq!(manifest["config"]["path"], "./small.toml");
    assert_eq!(manifest["config"]["text"], *SMALL);
    assert_eq!(manifest["backend"], "cpu");
    assert_eq!(manifest["threads"], 1);
    let counts = &manifest["counts"];
    assert_eq!((&counts["designs"], &counts["designs_asked"]), (&2.into(), &2.into()));
    assert_eq!((&counts["rows"], &counts["rows_asked"]), (&6.into(), &6.into()));
    assert_eq!(counts["distinct_bodies"], 2);
    assert_eq!(counts["statuses"]["ok"], 6);
    assert!(manifest["wall_seconds"].as_f64().unwrap() > 0.0);
    assert!(!manifest["stage_seconds"].as_object().unwrap().is_empty());
    assert!(manifest["started_utc"].as_str().unwrap().ends_with('Z'));
    assert_eq!(manifest["host"]["os"], std::env::consts::OS);

    let folder = work.path("").to_str().unwrap().to_string();
    assert!(!work.read("out/small/manifest.json").contains(&folder), "names a folder of this machine");
    assert_eq!(
        work.files(),
        ["out/small/laws.csv", "out/small/manifest.json", "out/small/table.csv", "small.toml"]
    );
}

#[test]
fn a_tables_inputs_are_a_list_of_designs_with_the_same_result() {
    let work = small("roundtrip");
    work.run(&["run", "small.toml"]).expect(0);
    let table = work.table("out/small/table.csv");
    let mut designs = csv::Writer::from_path(work.path("designs.csv")).unwrap();
    for record in std::iter::once(&table.names).chain(&table.records) {
        designs.write_record(record.iter().take(18).skip(1)).unwrap();
    }
    designs.flush().unwrap();
    let config = "[designs]\nfile = \"designs.csv\"\n[solve]\nmethod = \"series\"\n";
    work.write("listed.toml", config);
    work.run(&["run", "listed.toml"]).expect(0);
    let listed = work.table("out/listed/table.csv");
    assert_eq!(listed.records.len(), 6);
    for (row, listed) in table.records.iter().zip(&listed.records) {
        assert!(row.iter().skip(1).eq(listed.iter().skip(1)), "{row:?}\n{listed:?}");
    }
    assert_eq!(work.json("out/listed/manifest.json")["designs_file"], "designs.csv");
}

#[test]
fn threads_do_not_change_a_byte() {
    let work = small("threads");
    for threads in ["1", "2", "5"] {
        work.run(&["run", "small.toml", "--out", threads, "--threads", threads]).expect(0);
    }
    assert_eq!(work.read("1/table.csv"), work.read("2/table.csv"));
    assert_eq!(work.read("1/table.csv"), work.read("5/table.csv"));
}

/// A finished result is recognised by its config; a table that somebody has changed since is not.
#[test]
fn a_finished_result_is_not_made_again_unless_asked() {
    let work = small("again");
    work.run(&["run", "small.toml"]).expect(0);
    let (table, manifest) = (work.read("out/small/table.csv"), work.read("out/small/manifest.json"));
    let again = work.run(&["run", "small.toml"]).expect(0);
    for part in ["already complete, nothing to do", "--again", "out/small/table.csv"] {
        assert!(again.stdout.contains(part), "{part} not in: {}", again.stdout);
    }
    assert_eq!(
        (&work.read("out/small/table.csv"), &work.read("out/small/manifest.json")),
        (&table, &manifest)
    );
    work.run(&["run", "small.toml", "--again"]).expect(0);
    assert_eq!(work.read("out/small/table.csv"), table);
    assert_ne!(work.read("out/small/manifest.json"), manifest);

    // As long as before as well: a crash of the system may leave zeros.
    for changed in [format!("{table}{table}"), "\0".repeat(table.len())] {
        work.write("out/small/table.csv", &changed);
        let refused = work.run(&["run", "small.toml"]).expect(1);
        assert!(
            refused.stderr.contains("a table.csv that was changed after it was written"),
            "{}",
            refused.stderr
        );
        assert_eq!(work.read("out/small/table.csv"), changed);
    }
    work.run(&["run", "small.toml", "--again"]).expect(0);
    assert_eq!(work.read("out/small/table.csv"), table);
    assert_eq!(
        work.files(),
        ["out/small/laws.csv", "out/small/manifest.json", "out/small/table.csv", "small.toml"]
    );
}

/// What is wrong with a result is said as it is.
#[test]
fn a_damaged_or_unfinished_result_is_told_from_others() {
    let work = small("damaged");
    work.run(&["run", "small.toml"]).expect(0);
    let manifest = work.read("out/small/manifest.json");
    let refused = |arguments: &[&str], told: &str| {
        let refused = work.run(arguments).expect(1).stderr;
        assert!(refused.contains(told), "{arguments:?}: {refused}");
    };
    for damaged in ["", "nonsense", &manifest[..manifest.len() / 2]] {
        work.write("out/small/manifest.json", damaged);
        refused(&["run", "small.toml"], "out/small holds a manifest.json that is damaged");
        refused(&["report", "out/small"], "its manifest.json is damaged");
    }
    work.write("out/small/manifest.json", "{\"name\": \"something else\"}");
    refused(&["run", "small.toml"], "out/small holds a manifest.json that is of another program");
    refused(&["report", "out/small"], "its manifest.json is of another program");
    work.write("out/small/manifest.json", &manifest);
    std::fs::rename(work.path("out/small/table.csv"), work.path("table.csv")).unwrap();
    refused(&["run", "small.toml"], "out/small holds a result whose table.csv is missing");
    std::fs::rename(work.path("out/small/manifest.json"), work.path("out/small/manifest.json.partial"))
        .unwrap();
    refused(&["report", "out/small"], "its run is unfinished");
}

/// A list that was changed is another list, whatever its name.
#[test]
fn a_changed_list_of_designs_is_another_config() {
    let work = small("changed-list");
    work.run(&["run", "small.toml"]).expect(0);
    let list = designs_of(&work);
    work.write("designs.csv", &list);
    work.write("listed.toml", "[designs]\nfile = \"designs.csv\"\n[solve]\nmethod = \"series\"\n");
    work.run(&["run", "listed.toml"]).expect(0);
    assert!(work.run(&["run", "listed.toml"]).expect(0).stdout.contains("already complete"));
    let table = work.read("out/listed/table.csv");
    let inputs = work.json("out/listed/manifest.json")["inputs"].clone();
    assert_eq!((&inputs[0]["path"], &inputs[1]["path"]), (&"listed.toml".into(), &"designs.csv".into()));
    assert_eq!(inputs[1]["bytes"], list.len());

    work.write("designs.csv", &list.replacen("10,", "11,", 1));
    let refused = work.run(&["run", "listed.toml"]).expect(1);
    assert!(refused.stderr.contains("listed.toml for another list of designs"), "{}", refused.stderr);
    assert_eq!(work.read("out/listed/table.csv"), table);
    work.run(&["run", "listed.toml", "--force"]).expect(0);
    assert_ne!(work.read("out/listed/table.csv"), table);
    assert_ne!(work.json("out/listed/manifest.json")["inputs"][1], inputs[1]);
}

/// The designs of the result of small.toml as a list.
fn designs_of(work: &Workdir) -> String {
    let table = work.table("out/small/table.csv");
    let mut designs = csv::Writer::from_writer(Vec::new());
    for record in std::iter::once(&table.names).chain(&table.records) {
        designs.write_record(record.iter().take(18).skip(1)).unwrap();
    }
    String::from_utf8(designs.into_inner().unwrap()).unwrap()
}

#[test]
fn the_result_of_another_config_is_kept_unless_forced() {
    let work = small("another");
    work.run(&["run", "small.toml", "--out", "result"]).expect(0);
    let (table, manifest) = (work.read("result/table.csv"), work.read("result/manifest.json"));

    work.write("other.toml", &other());
    let refused = work.run(&["run", "other.toml", "--out", "result"]).expect(1);
    for part in ["error: result", "small.toml", "--out", "--force"] {
        assert!(refused.stderr.contains(part), "{part} not in: {}", refused.stderr);
    }
    assert_eq!(work.read("result/table.csv"), table);
    assert_eq!(work.read("result/manifest.json"), manifest);

    work.run(&["run", "other.toml", "--out", "result", "--force"]).expect(0);
    assert_ne!(work.read("result/table.csv"), table);
    assert_eq!(work.json("result/manifest.json")["config"]["text"], other());
}

#[test]
fn a_changed_config_is_another_config() {
    let work = small("changed");
    work.run(&["run", "small.toml"]).expect(0);
    work.write("small.toml", &other());
    let refused = work.run(&["run", "small.toml"]).expect(1);
    assert!(refused.stderr.contains("small.toml as it was before"), "{}", refused.stderr);
}

#[test]
fn a_table_nobody_vouches_for_is_kept_unless_forced() {
    let work = small("unvouched");
    work.write("mine/table.csv", "my own\n");
    let refused = work.run(&["run", "small.toml", "--out", "mine"]).expect(1);
    assert!(refused.stderr.contains("without a manifest.json"), "{}", refused.stderr);
    assert_eq!(work.read("mine/table.csv"), "my own\n");
    work.run(&["run", "small.toml", "--out", "mine", "--force"]).expect(0);
    assert_eq!(work.table("mine/table.csv").records.len(), 6);
}

#[test]
fn the_manifest_of_another_program_is_kept_unless_forced() {
    let work = small("foreign");
    work.write("app/manifest.json", "{\"name\": \"an app\"}");
    work.run(&["run", "small.toml", "--out", "app"]).expect(1);
    assert_eq!(work.files(), ["app/manifest.json", "small.toml"]);
    work.run(&["run", "small.toml", "--out", "app", "--force"]).expect(0);
}

#[test]
fn a_folder_with_other_files_can_hold_a_result() {
    let work = small("others");
    work.write("notes/read.me", "mine");
    work.run(&["run", "small.toml", "--out", "notes"]).expect(0);
    assert_eq!(
        work.files(),
        ["notes/laws.csv", "notes/manifest.json", "notes/read.me", "notes/table.csv", "small.toml"]
    );
}

#[test]
fn the_list_of_designs_is_never_overwritten() {
    let work = small("list");
    work.run(&["run", "small.toml"]).expect(0);
    let list = designs_of(&work);
    work.write("table.csv", &list);
    work.write("listed.toml", "[designs]\nfile = \"table.csv\"\n[solve]\nmethod = \"series\"\n");
    let refused = work.run(&["run", "listed.toml", "--out", ".", "--force"]).expect(1);
    assert!(refused.stderr.contains("list of designs"), "{}", refused.stderr);
    assert_eq!(work.read("table.csv"), list);
}

#[test]
fn an_unwritable_folder_is_an_error_before_anything_is_computed() {
    let work = small("unwritable");
    work.write("file", "not a folder");
    let refused = work.run(&["run", "small.toml", "--out", "file/result"]).expect(1);
    assert!(refused.stderr.starts_with("error: cannot create file/result: "), "{}", refused.stderr);
    assert_eq!(work.files(), ["file", "small.toml"]);

    // A place that even root cannot write to.
    if cfg!(target_os = "linux") {
        let refused = work.run(&["run", "small.toml", "--out", "/proc"]).expect(1);
        assert!(refused.stderr.contains("cannot write /proc/.jointsweep.lock"), "{}", refused.stderr);
    }
}

#[test]
fn a_bad_config_writes_nothing() {
    let work = Workdir::new("bad-config");
    work.write("bad.toml", &SMALL.replace("hole_radius", "hole_radios"));
    let refused = work.run(&["run", "bad.toml"]).expect(1);
    assert!(refused.stderr.starts_with("error: "), "{}", refused.stderr);
    work.run(&["run", "missing.toml"]).expect(1);
    assert_eq!(work.files(), ["bad.toml"]);
    assert!(!work.path("out").exists());
}

/// Exit code 2 is taken: it says that some designs failed.
#[test]
fn a_bad_command_line_exits_with_1_and_help_with_0() {
    let work = small("usage");
    let of_threads = "a whole number from 1 to 1024 is needed";
    let of_counts = "a whole number from 1 on is needed";
    for (arguments, reason) in [
        (&["run"][..], "required"),
        (&["run", "small.toml", "--bakend"], "--bakend"),
        (&["run", "small.toml", "--threads", "0"], of_threads),
        (&["run", "small.toml", "--threads", "5000"], of_threads),
        (&["bench", "small.toml", "--threads", "all"], of_threads),
        (&["bench", "small.toml", "--runs", "0"], of_counts),
        (&["bench-gpu", "--most", "many"], of_counts),
        (&["tradeoff", "small.toml", "--designs", "0"], of_counts),
        (&["run", "small.toml", "--threads", "-1"], of_threads),
        (&["tradeoff", "small.toml", "--designs", "-3"], of_counts),
        (&["bench-gpu", "--most", "-1"], of_counts),
        (&["stresses", "small.toml", "--design", "0", "--depth", "-1 mm"], "must be above 0"),
    ] {
        let refused = work.run(arguments).expect(1);
        let is_told = refused.stderr.starts_with("error: ") && refused.stderr.contains(reason);
        assert!(is_told, "{arguments:?}: {}", refused.stderr);
    }
    #[cfg(target_os = "linux")]
    {
        let endless = work.run(&["run", "/dev/zero"]).expect(1);
        let expected = "error: /dev/zero: this is no config: it has more than 16 MB\n";
        assert_eq!(endless.stderr, expected);
    }
    assert!(work.run(&["--help"]).expect(0).stdout.contains("Exit codes"));
    assert!(work.run(&["--version"]).expect(0).stdout.contains(env!("CARGO_PKG_VERSION")));
    assert_eq!(work.files(), ["small.toml"]);
}

/// With and without a Vulkan driver: a driver list that names no file leaves none.
#[test]
fn devices_are_listed_with_what_would_be_used() {
    let work = Workdir::new("devices");
    let listed = work.run(&["devices"]).expect(0).stdout;
    assert!(listed.contains("--backend auto   "), "{listed}");
    let mut without = work.command(&["devices"]);
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        without.env(variable, work.path("no-such-driver.json"));
    }
    let listed = Ended::new(without.output().unwrap()).expect(0).stdout;
    assert!(listed.contains("--backend auto   the processor\n"), "{listed}");
    assert!(listed.contains("--backend gpu    the processor: no Vulkan adapter"), "{listed}");
}

/// Asked for a GPU that is not there, the program says so in one line and computes all the same; asked for one by a
/// name that none has, or for both, it does not begin.
#[test]
fn a_missing_gpu_is_told() {
    let work = small("gpu");
    let without = |arguments: &[&str]| {
        let mut without = work.command(arguments);
        for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            without.env(variable, work.path("no-such-driver.json"));
        }
        Ended::new(without.output().unwrap())
    };
    let ended = without(&["run", "small.toml", "--backend", "gpu", "--quiet"]).expect(0);
    let warning = "warning: no Vulkan adapter: a Vulkan driver and its loader (libvulkan.so.1) must be installed; \
                   the processor computes instead\n";
    assert_eq!(ended.stderr, warning);
    let manifest = work.json("out/small/manifest.json");
    assert_eq!((&manifest["backend"], &manifest["precision"]), (&"cpu".into(), &"f64".into()));
    // What only hoped for one does not complain.
    let ended = without(&["run", "small.toml", "--quiet", "--again"]).expect(0);
    assert_eq!(ended.stderr, "");

    for (option, value) in [("--adapter", "any"), ("--precision", "f32")] {
        let refused = work.run(&["run", "small.toml", "--backend", "cpu", option, value]).expect(1);
        let expected =
            format!("error: {option} is for a GPU, --backend cpu asks for none: leave one of them out\n");
        assert_eq!(refused.stderr, expected);
    }
}

#[test]
fn a_dry_run_tells_the_work_and_writes_nothing() {
    let work = small("dry");
    let told = work.run(&["run", "small.toml", "--dry-run"]).expect(0);
    let words: Vec<Vec<&str>> = told.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(words.contains(&vec!["designs", "2"]), "{}", told.stdout);
    assert!(words.contains(&vec!["rows", "6"]), "{}", told.stdout);
    assert!(words.contains(&vec!["distinct", "bodies", "2"]), "{}", told.stdout);
    assert!(!work.path("out").exists());
    assert_eq!(work.files(), ["small.toml"]);
}

/// What is told by some of the designs says so; of all of them it would take hours.
#[test]
fn a_billion_designs_are_told_by_some() {
    let work = Workdir::new("billion");
    let random = include_str!("../../configs/random.toml");
    assert!(random.contains("count  = 10000"));
    work.write("large.toml", &random.replace("count  = 10000", "count = 1000000000"));
    let told = work.run(&["run", "large.toml", "--dry-run"]).expect(0);
    let words: Vec<Vec<&str>> = told.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(words.contains(&vec!["designs", "1000000000"]), "{}", told.stdout);
    assert!(words.contains(&vec!["distinct", "bodies", "about", "2000000000"]), "{}", told.stdout);
    assert!(
        told.stdout.contains("\nlooked at       65536 of them, spread over the sweep\n"),
        "{}",
        told.stdout
    );
    let told = work.run(&["explain", "large.toml"]).expect(0);
    for said in ["about 1000000000", "\nBy 65536 designs that are spread over the sweep; what is rarer"] {
        assert!(told.stdout.contains(said), "{said}: {}", told.stdout);
    }
}

#[test]
fn quiet_means_quiet() {
    let work = small("quiet");
    let told = work.run(&["run", "small.toml"]).expect(0);
    assert_eq!(told.stderr, "");
    assert!(told.stdout.contains("2 designs, 6 rows, 2 distinct bodies in"), "{}", told.stdout);
    assert!(told.stdout.contains("\n  out/small/table.csv\n"), "{}", told.stdout);
    for arguments in [&["run", "small.toml", "--quiet"][..], &["run", "small.toml", "--quiet", "--again"]] {
        let told = work.run(arguments).expect(0);
        assert_eq!((told.stdout.as_str(), told.stderr.as_str()), ("", ""));
    }
}

/// `series` cannot do a block.
#[test]
fn a_failed_design_is_a_row_with_its_status_and_exit_code_2() {
    let work = Workdir::new("failed");
    let header = "hole_radius_mm,radial_clearance_mm,thickness_mm,idealization,pin_model,core_radius_ratio,\
                  pin_youngs_modulus_mpa,pin_poissons_ratio,plate_model,outer_radius_ratio,half_width_ratio,\
                  depth_ratio,height_ratio,plate_support,plate_youngs_modulus_mpa,plate_poissons_ratio,indentation_mm";
    let pin = "10,0.1,5,plane-stress,rigid-core,0.2,210000,0.3";
    let annulus = format!("{pin},annulus,3,,,,,70000,0.33,0.002");
    let block = format!("{pin},block,,3,3,2,base,70000,0.33,0.002");
    work.write("designs.csv", &format!("{header}\n{annulus}\n{block}\n{annulus}\n"));
    work.write("mixed.toml", "[designs]\nfile = \"designs.csv\"\n[solve]\nmethod = \"series\"\n");
    let told = work.run(&["run", "mixed.toml"]).expect(2);
    assert!(told.stdout.contains("failed: 1 row of 1 design"), "{}", told.stdout);

    let table = work.table("out/mixed/table.csv");
    assert_eq!(table.records.len(), 3);
    assert_eq!(
        table.records[0].iter().skip(1).collect::<Vec<_>>(),
        table.records[2].iter().skip(1).collect::<Vec<_>>()
    );
    let failed: Vec<&str> = table.records[1].iter().collect();
    assert_eq!(&failed[12..18], ["3", "2", "base", "70000", "0.33", "0.002"]);
    assert_eq!(&failed[18..27], [""; 9]);
    assert!(!failed[27].is_empty() && failed[27] != "ok", "{}", failed[27]);

    let manifest = work.json("out/mixed/manifest.json");
    assert_eq!(manifest["state"], "complete");
    assert_eq!(manifest["counts"]["failed_designs"], 1);
    assert_eq!(manifest["counts"]["failures"][failed[27]], 1);
    assert_eq!(manifest["counts"]["rows"], 3);
}

/// A million designs of ten steps: some seconds at the least.
fn long() -> String {
    SMALL
        .replace(
            "hole_radius = \"10 mm\"",
            "hole_radius = { from = \"10 mm\", to = \"20 mm\", count = 1000 }",
        )
        .replace(
            "radial_clearance = [\"0.1 mm\", \"0.03 mm\"]",
            "radial_clearance = { from = \"0.01 mm\", to = \"0.1 mm\", count = 1000 }",
        )
        .replace(
            "[\"0.001 mm\", \"0.002 mm\", \"0.005 mm\"]",
            "{ from = \"0.001 mm\", to = \"0.01 mm\", count = 10 }",
        )
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_a_valid_table_and_says_so() {
    let work = Workdir::new("interrupt");
    work.write("long.toml", &long());
    let mut child = work.start(&["run", "long.toml"]);
    let path = work.path("out/long/table.csv.partial");
    let patience = Instant::now() + Duration::from_secs(60);
    while !path.metadata().is_ok_and(|file| file.len() > 100_000) {
        assert!(Instant::now() < patience && child.try_wait().unwrap().is_none(), "no rows came");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(work.json("out/long/manifest.json.partial")["state"], "incomplete");
    let kill = format!("kill -INT {}", child.id());
    assert!(std::process::Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let ended = Ended::new(child.wait_with_output().unwrap()).expect(130);
    assert!(ended.stderr.contains("interrupted: "), "{}", ended.stderr);

    let text = work.read("out/long/table.csv.partial");
    assert!(text.ends_with(",ok\n"), "the last row is cut");
    let table = work.table("out/long/table.csv.partial");
    assert!(table.records.len().is_multiple_of(10) && table.records.len() < 10_000_000);
    let manifest = work.json("out/long/manifest.json.partial");
    assert_eq!(manifest["state"], "interrupted");
    assert_eq!(manifest["counts"]["rows"], table.records.len());
    assert_eq!(manifest["counts"]["rows_asked"], 10_000_000);
}

/// What the planner has chosen, for the whole sweep and for one design of it.
#[test]
fn explain_says_what_is_chosen_and_why() {
    let work = Workdir::new("explain");
    let study =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/liu2007.toml")).unwrap();
    work.write("study.toml", &study);
    let all = work.run(&["explain", "study.toml"]).expect(0);
    for chosen in ["mesh level 0        4", "mesh level 1       10"] {
        assert!(all.stdout.contains(chosen), "{}", all.stdout);
    }
    let one = work.run(&["explain", "study.toml", "--design", "13"]).expect(0);
    for said in ["chosen      mesh level 0", "annulus: exact modes", "every row is ok", "ruled out"] {
        assert!(one.stdout.contains(said), "{said}: {}", one.stdout);
    }
    let beyond = work.run(&["explain", "study.toml", "--design", "14"]).expect(1);
    assert_eq!(beyond.stderr, "error: there is no design 14: the sweep has 14, counted from 0\n");
    assert!(beyond.stdout.is_empty());
}

/// A limit on file sizes stands for a full disk: the write that meets it is done in part.
#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_that_keeps_whole_rows() {
    let work = Workdir::new("full-disk");
    work.write("long.toml", &long());
    let program = env!("CARGO_BIN_EXE_jointsweep");
    // The signal for files that grow too large, which ends a process, is left to the program.
    let limited = format!("ulimit -f 300; exec '{program}' run long.toml");
    let output = std::process::Command::new("sh").args(["-c", &limited]).current_dir(work.path("")).output();
    let ended = Ended::new(output.unwrap()).expect(1);
    assert!(ended.stderr.starts_with("error: cannot write out/long/table.csv.partial: "), "{}", ended.stderr);

    assert!(work.read("out/long/table.csv.partial").ends_with(",ok\n"), "the last row is cut");
    assert!(work.table("out/long/table.csv.partial").records.len() > 100);
    let manifest = work.json("out/long/manifest.json.partial");
    assert_eq!(manifest["state"], "failed");
    assert!(manifest["error"].as_str().unwrap().contains("table.csv"));
}
